//! Lock-in: the two beams couple, and slow rotation is not measured.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::counts_per_si;
use crate::kinds::channel::gyros;
use crate::kinds::mapped::Mapped;
use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;

pub(super) static LOCK_IN: FaultKind = FaultKind {
    name: "lock-in",
    family: Family::RingLaser,
    acts: Acts::Samples,
    summary: "The beams of one or more ring lasers lock: no output below a rate, too little above.",
    model: "With the lock-in rate ω_L every sample of the gyros becomes\n\n\
            \u{20}   Δθ' = 0                               for |Δθ| ≤ ω_L dt\n\
            \u{20}   Δθ' = sign(Δθ) √(Δθ² − (ω_L dt)²)     beyond\n\n\
            This is the mean beat rate of a gyro without dither whose phase obeys Adler's \
            equation, dψ/dt = ω − ω_L sin ψ, at a constant rate ω: Aronowitz, \"The laser gyro\", \
            in Laser Applications 1 (1971); Titterton and Weston, Strapdown Inertial Navigation \
            Technology. Near the threshold the scale factor error is −(ω_L/ω)²/2. The change \
            Δθ' − Δθ is multiplied by s, 1 while the fault lasts and falling linearly to 0 over \
            its recovery, and added in counts with the remainder carried. No flag changes.\n\n\
            In a real instrument this happens when the dither stops. Limits of the model: the \
            ripple of the beat within a beat period is left out, so that it holds where a beat is \
            short against a sample or the rate is steady; and the rate is that of the sample, with \
            the instrument's bias and noise, which move it across the threshold as a real bias \
            does.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Gyros that lock.",
        },
        FaultParameter {
            name: "threshold",
            takes: Takes::Quantity(&[Dimension::GyroBias], ParameterBounds::Positive),
            default: None,
            doc: "ω_L: rate at which the beams lock; 100 deg/h is usual for a ring laser without \
                  dither.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("threshold", r#""100 deg/h""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = gyros(values, "channels")?;
    let limit = values.quantity("threshold")? * setup.dt_s() * counts_per_si(0);
    Ok(Mapped::rule(channels, move |_, count: f64| {
        let size = count.abs();
        if size <= limit {
            -count
        } else {
            // The product keeps the digits that a difference of squares would lose.
            let seen = libm::sqrt((size - limit) * (size + limit));
            libm::copysign(seen, count) - count
        }
    }))
}
