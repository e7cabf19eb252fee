//! Size effect.

use crate::catalogue::{Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::kinds::plant::{fixed, within};
use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use octant_sample::disturbance::Disturbance;

const ZERO: Option<&str> = Some(r#"["0 m", "0 m", "0 m"]"#);
const ARMS: [&str; 3] = ["accelerometer_x", "accelerometer_y", "accelerometer_z"];

const fn arm(name: &'static str, doc: &'static str) -> FaultParameter {
    FaultParameter { name, takes: Takes::Vector(&[Dimension::Length]), default: ZERO, doc }
}

pub(super) static LEVER_ARM: FaultKind = FaultKind {
    name: "lever-arm",
    family: Family::Physics,
    acts: Acts::Plant,
    summary: "Proof masses sit away from the centre of rotation, and nobody compensates it.",
    model: "The proof mass of accelerometer i lies at r_i (m, body axes) from the centre of \
            rotation, in addition to the lever arms that the instrument is configured with. While \
            the fault lasts it feels in addition the component on its axis of\n\n\
            \u{20}   ω̇ × r_i + ω × (ω × r_i)\n\n\
            with the rate ω of the sensor block (Earth rate, ship, gimbals, vibration and slips \
            together), integrated over the interval; ω̇ × r as the exact difference of ω × r. Gyros \
            feel nothing of it. At 10 deg/s an arm of 5 cm gives 1.5e-3 m/s²; at rest it gives \
            nothing.\n\n\
            From onset and end on the arms are there or not; nothing moves in between. After the end \
            increments are those of the plant without the fault, and counts differ by at most \
            one.\n\n\
            A real instrument always has arms of centimetres, and compensates them (Savage, 1998): \
            the fault is what a wrong or lost compensation leaves.",
    parameters: &[
        arm(ARMS[0], "Where the x accelerometer's proof mass is."),
        arm(ARMS[1], "Where the y accelerometer's proof mass is."),
        arm(ARMS[2], "Where the z accelerometer's proof mass is."),
    ],
    lasts: Lasts::Span,
    example: Example::of(&[
        ("accelerometer_x", r#"["0 m", "0.05 m", "0 m"]"#),
        ("trigger", "{ moving_to = 3 }"),
        ("duration", r#""12 s""#),
    ]),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let mut arms = [[0.0; 3]; 3];
    for (arm, name) in arms.iter_mut().zip(ARMS) {
        *arm = values.vector(name)?;
        within(name, arm, 10.0, "m")?;
    }
    if arms == [[0.0; 3]; 3] {
        let problem = "zeros were found, here or in one of the others one that isn't is expected";
        return Err(FaultBuildError::value(ARMS[0], problem));
    }
    Ok(fixed(Disturbance::LeverArm(arms)))
}
