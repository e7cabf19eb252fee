//! Motions of the body against its drive: slip, play, ringing.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::plant::{fixed, frequency, within};
use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use octant_sample::disturbance::{Disturbance, Gimbal, GimbalAction};

/// Parameter for the gimbal.
pub(super) const GIMBAL: FaultParameter = FaultParameter {
    name: "gimbal",
    takes: Takes::Choice(&[
        ("azimuth", "the inner one, about body z"),
        ("roll", "the outer one, about case x"),
    ]),
    default: None,
    doc: "The gimbal that it happens to.",
};

/// The gimbal that was chosen.
pub(super) fn chosen(values: &Values) -> Result<Gimbal, FaultBuildError> {
    Ok(if values.choice(GIMBAL.name)? == "azimuth" { Gimbal::Azimuth } else { Gimbal::Roll })
}

/// Makes the rule of an action on the chosen gimbal.
pub(super) fn happens(values: &Values, action: GimbalAction) -> Result<FaultRule, FaultBuildError> {
    Ok(fixed(Disturbance::Gimbal { gimbal: chosen(values)?, action }))
}

/// Reads a quantity of a size up to a limit.
pub(super) fn limited(
    values: &Values,
    name: &'static str,
    limit: f64,
    unit: &str,
) -> Result<f64, FaultBuildError> {
    let value = values.quantity(name)?;
    within(name, &[value], limit, unit)?;
    Ok(value)
}

pub(super) static GIMBAL_SLIP: FaultKind = FaultKind {
    name: "gimbal-slip",
    family: Family::Turntable,
    acts: Acts::Plant,
    summary: "The body slips against its drive by an angle, and the gyros feel it.",
    model: "With t since the onset the body of the gimbal turns against its drive by\n\n\
            \u{20}   a (10u³ − 15u⁴ + 6u⁵)            u = t/T, 0 ≤ u ≤ 1\n\n\
            and stays there: every later position is off by the angle a. It is a real motion, with \
            a largest rate of 1.875 a/T: gyros and accelerometers feel it (with lever arms too), \
            truth has it. The encoder sits on the drive and goes on reading the drive's angle; or \
            it sits on the body, and reads the slip.\n\n\
            It is over after T, whatever the fault's end, and nothing brings the body back but \
            another slip. A slip while the gimbal moves adds to the move.\n\n\
            It is what a clamp, a coupling or a belt does. An estimator that uses the gyros alone \
            takes no harm; one that trusts encoders for attitude takes the slip in full.",
    parameters: &[
        GIMBAL,
        FaultParameter {
            name: "angle",
            takes: Takes::Quantity(&[Dimension::Angle], ParameterBounds::NotZero),
            default: None,
            doc: "Angle a, at most half a turn.",
        },
        FaultParameter {
            name: "within",
            takes: Takes::Quantity(
                &[Dimension::Time],
                ParameterBounds::Within(1e-3, 1e5, "from 1 ms to 100000 s"),
            ),
            default: Some("0.1 s"),
            doc: "Time T that it takes.",
        },
        FaultParameter {
            name: "encoder",
            takes: Takes::Choice(&[
                ("drive", "it sits on the drive and doesn't see the slip"),
                ("body", "it sits on the body and sees the slip"),
            ]),
            default: Some("drive"),
            doc: "Where the encoder sits.",
        },
    ],
    lasts: Lasts::Instant,
    example: Example::of(&[("angle", r#""0.5 deg""#)]).showing_s(0.2),
    build: build_slip,
};

fn build_slip(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let angle_rad = limited(values, "angle", core::f64::consts::PI, "rad")?;
    let within_s = values.quantity("within")?;
    let seen = values.choice("encoder")? == "body";
    happens(values, GimbalAction::Slip { angle_rad, within_s, seen })
}

pub(super) static BACKLASH: FaultKind = FaultKind {
    name: "backlash",
    family: Family::Turntable,
    acts: Acts::Plant,
    summary: "The gear of a gimbal gets play: the body lags behind its drive.",
    model: "The body follows its drive with a play of ±p/2, in addition to the play that the gear is \
            configured with: it stands until the drive has crossed the play, then follows at its \
            edge, and so ends half of the play short of the drive, on the side it came from. At the \
            onset it stands in the middle, and nothing happens until the next move. The gyros feel \
            what the body does, truth has it; the encoder sits on the drive and reads the drive. \
            When the drive takes the body along, the body's rate jumps.\n\n\
            When the fault ends, the play closes within 0.1 s along 10u³ − 15u⁴ + 6u⁵: the body is \
            brought to where it would have been, and the gyros feel that too. From then on \
            increments are those of the plant without the fault, to rounding; counts differ by at \
            most one.\n\n\
            A real gear has friction and elasticity as well, and gravity pulls an unbalanced body \
            to one side of its play.",
    parameters: &[
        GIMBAL,
        FaultParameter {
            name: "play",
            takes: Takes::Quantity(&[Dimension::SmallAngle], ParameterBounds::Positive),
            default: None,
            doc: "Play p between the two sides, at most 0.1 rad.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("trigger", "{ moving_to = 3 }"), ("duration", r#""15 s""#)]),
    build: build_backlash,
};

fn build_backlash(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let play_rad = limited(values, "play", 0.1, "rad")?;
    happens(values, GimbalAction::Backlash { play_rad })
}

pub(super) static SHORT_SETTLE: FaultKind = FaultKind {
    name: "short-settle",
    family: Family::Turntable,
    acts: Acts::Plant,
    summary: "After a move the body rings: the dwell has begun, but the table has not settled.",
    model: "After every move of the gimbal that begins while the fault lasts, with t since the end \
            of the move, the body turns against its drive by\n\n\
            \u{20}   w(t) A exp(−t/τ) sin(2πft)\n\n\
            w rises along 10u³ − 15u⁴ + 6u⁵ from 0 to 1 within the first quarter of a period, so that \
            the rate has no jump. After 30 τ, when less than 1e-13 of A is left, it is over. The \
            gyros and accelerometers feel it, truth has it; the encoder sits on the drive and reads \
            the drive, which stands. A move that gets a new set point on its way doesn't ring, the \
            new one does. Rings that have begun die out, also after the fault's end and during the \
            next move; then increments are those of the plant without the fault, to rounding, and \
            counts differ by at most one.\n\n\
            A real table rings at the resonance of its drive, some hertz to some ten, and the \
            settling time that the procedure allows is too short for it.",
    parameters: &[
        GIMBAL,
        FaultParameter {
            name: "amplitude",
            takes: Takes::Quantity(&[Dimension::SmallAngle], ParameterBounds::NotZero),
            default: None,
            doc: "Amplitude A, at most 0.1 rad.",
        },
        FaultParameter {
            name: "frequency",
            takes: Takes::Quantity(&[Dimension::Frequency], ParameterBounds::Positive),
            default: Some("5 Hz"),
            doc: "Frequency f, at most 100 periods in a sample.",
        },
        FaultParameter {
            name: "decay",
            takes: Takes::Quantity(
                &[Dimension::Time],
                ParameterBounds::Within(1e-3, 1e3, "from 1 ms to 1000 s"),
            ),
            default: Some("1 s"),
            doc: "Decay time τ.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("trigger", "{ moving_to = 3 }"), ("duration", r#""15 s""#)]),
    build: build_ringing,
};

fn build_ringing(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let amplitude_rad = limited(values, "amplitude", 0.1, "rad")?;
    let frequency_hz = frequency(values, "frequency", setup)?;
    let decay_s = values.quantity("decay")?;
    happens(values, GimbalAction::Ringing { amplitude_rad, frequency_hz, decay_s })
}
