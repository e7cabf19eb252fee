//! Sinusoidal vibration of the sensor block.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::plant::{EDGE, angular, fixed, frequency, not_nothing, within};
use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::vec;
use octant_sample::disturbance::{Disturbance, SpectralLine};

pub(super) static VIBRATION_SINE: FaultKind = FaultKind {
    name: "vibration-sine",
    family: Family::Physics,
    acts: Acts::Plant,
    summary: "The sensor block vibrates at one frequency, linearly and angularly.",
    model: "The sensor block moves against the gimballed body as one rigid body. With t since the \
            onset, its displacement r (m) and its rotation vector θ (rad), in body axes, are\n\n\
            \u{20}   r = −w(t) a/(2πf)² sin(2πft)      θ = w(t) α sin(2πft + φ)\n\n\
            with the acceleration amplitude a, the angle α and the phase φ: at full window \
            r̈ = a sin(2πft). The window w rises along 10u³ − 15u⁴ + 6u⁵ from 0 to 1 within the edge \
            and falls the same way in the edge that follows the end, so that velocity, rate and \
            acceleration never jump. The sensors feel\n\n\
            \u{20}   ω' = Exp(−θ) ω + J(θ) θ̇\n\
            \u{20}   f' = Exp(−θ) (f + r̈ + 2 ω × ṙ + ω̇ × r + ω × (ω × r))\n\n\
            (ω, f: rate and specific force of the gimballed body), integrated over each interval \
            before the sensors' errors. Linear and angular vibration in step scull: \
            −½ cos φ α × a on the mean. The size effect of lever arms goes with ω'. Truth \
            (attitude, velocity, position) is that of the shaken block; encoders don't see it.\n\n\
            After end and edge the motion is gone and increments are those of the plant without the \
            fault; counts differ by the remainder that the sensors' counters carry, at most one.\n\n\
            A real instrument has resonances of its mounts that turn linear into angular \
            vibration: here both are given. See IEC 60068-2-6 for tests with sinusoidal vibration; \
            Titterton and Weston (2004) for sculling and coning.",
    parameters: &[
        FaultParameter {
            name: "frequency",
            takes: Takes::Quantity(&[Dimension::Frequency], ParameterBounds::Positive),
            default: None,
            doc: "Frequency f, at most 100 periods in a sample.",
        },
        FaultParameter {
            name: "acceleration",
            takes: Takes::Vector(&[Dimension::Acceleration]),
            default: Some(r#"["0 m/s^2", "0 m/s^2", "0 m/s^2"]"#),
            doc: "Amplitude a of the linear acceleration in body axes.",
        },
        FaultParameter {
            name: "angle",
            takes: Takes::Vector(&[Dimension::Angle]),
            default: Some(r#"["0 deg", "0 deg", "0 deg"]"#),
            doc: "Amplitude α of the rotation about body axes.",
        },
        FaultParameter {
            name: "phase",
            takes: Takes::Quantity(&[Dimension::Angle], ParameterBounds::Any),
            default: Some("0 deg"),
            doc: "Phase φ of the rotation against the linear motion; without one of both it shifts \
                  the rotation in time.",
        },
        EDGE,
    ],
    lasts: Lasts::Span,
    example: Example::of(&[
        ("frequency", r#""35 Hz""#),
        ("acceleration", r#"["1 m/s^2", "0 m/s^2", "0 m/s^2"]"#),
    ]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let frequency_hz = frequency(values, "frequency", setup)?;
    let acceleration = values.vector("acceleration")?;
    let angle_rad = values.vector("angle")?;
    not_nothing("acceleration", "angle", [&acceleration, &angle_rad])?;
    let omega = angular(frequency_hz);
    let displacement_m = acceleration.map(|a| -a / (omega * omega));
    within("acceleration", &displacement_m, 1.0, "m of displacement")?;
    within("angle", &angle_rad, 1.0, "rad")?;
    let line = SpectralLine {
        frequency_hz,
        displacement_m,
        angle_rad,
        phase_rad: 0.0,
        angle_phase_rad: values.quantity("phase")?,
    };
    let edge_s = values.quantity("edge")?;
    Ok(fixed(Disturbance::Vibration { lines: vec![line], edge_s }))
}
