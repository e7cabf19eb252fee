//! A shock of the sensor block.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::plant::{fixed, something, within};
use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use octant_sample::disturbance::Disturbance;

pub(super) static SHOCK: FaultKind = FaultKind {
    name: "shock",
    family: Family::Physics,
    acts: Acts::Plant,
    summary: "A half-sine pulse of acceleration hits the sensor block, which its mounts bring back.",
    model: "The sensor block is displaced against the gimballed body, without turning. With t since \
            the onset its acceleration in body axes is\n\n\
            \u{20}   r̈ = A sin(πt/T)                  0 ≤ t ≤ T\n\n\
            after which it moves with Δv = 2AT/π at a distance of AT²/π, and within the recoil time \
            R its mounts bring it back to rest where it was, along the polynomial of fifth degree \
            that has no acceleration at either end:\n\n\
            \u{20}   r = AT²/π · (1−u)³(1+3u+6u²) + Δv R · u(1−u)³(1+3u)      u = (t−T)/R\n\n\
            It pulls with about 3.9 Δv/R in the opposite direction. The velocity felt over pulse and \
            recoil together is zero in axes that don't turn: a step of velocity that stays would be \
            a motion of the ship, not a shock of the instrument (IEC 60068-2-27 gives Δv of the \
            half-sine; its rebound is the mounts'). The sensors feel \
            f + r̈ + 2 ω × ṙ + ω̇ × r + ω × (ω × r); truth is that of the displaced block.\n\n\
            It is over after T + R, whatever the fault's end; increments are then those of the plant \
            without the fault, and counts differ by at most one. Beyond the accelerometers' range or \
            the format's they saturate and are flagged, and what is cut off is lost for good.\n\n\
            A real shock rings on in the structure and turns the block: add vibration-sine, after \
            it or with it.",
    parameters: &[
        FaultParameter {
            name: "peak",
            takes: Takes::Vector(&[Dimension::Acceleration]),
            default: None,
            doc: "Peak A of the acceleration in body axes.",
        },
        FaultParameter {
            name: "width",
            takes: Takes::Quantity(
                &[Dimension::Time],
                ParameterBounds::Within(1e-5, 1.0, "from 10 us to 1 s"),
            ),
            default: Some("11 ms"),
            doc: "Length T of the pulse.",
        },
        FaultParameter {
            name: "recoil",
            takes: Takes::Quantity(
                &[Dimension::Time],
                ParameterBounds::Within(1e-4, 10.0, "from 0.1 ms to 10 s"),
            ),
            default: Some("0.2 s"),
            doc: "Time R in which the mounts bring the block back.",
        },
    ],
    lasts: Lasts::Instant,
    example: Example::of(&[("peak", r#"["0 g", "0 g", "5 g"]"#)]).showing_s(0.25),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let peak_mps2 = something(values, "peak", 1e6, "m/s²")?;
    let width_s = values.quantity("width")?;
    let recoil_s = values.quantity("recoil")?;
    // The largest value of u(1−u)³(1+3u) is 16/81, at u = 1/3.
    let reach_s2 = (width_s + 2.0 * recoil_s * 16.0 / 81.0) * width_s / core::f64::consts::PI;
    within("peak", &peak_mps2.map(|peak| peak * reach_s2), 1.0, "m of displacement")?;
    Ok(fixed(Disturbance::Shock { peak_mps2, width_s, recoil_s }))
}
