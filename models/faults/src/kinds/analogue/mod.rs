//! Errors of the sensors that are still measurements.

mod bias;
mod cross;
mod noise_gain;
mod quantization;
mod range;
mod scale;
mod wander;

use crate::catalogue::FaultKind;

pub(super) static KINDS: &[&FaultKind] = &[
    &bias::BIAS_STEP,
    &bias::BIAS_RAMP,
    &wander::RATE_RANDOM_WALK,
    &wander::GAUSS_MARKOV,
    &noise_gain::NOISE_GAIN,
    &scale::SCALE_STEP,
    &scale::ASYMMETRY,
    &cross::CROSS_AXIS,
    &cross::G_SENSITIVITY,
    &range::SATURATION,
    &range::DEAD_ZONE,
    &quantization::QUANTIZATION,
];
