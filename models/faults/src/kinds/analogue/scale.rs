//! Errors of scale factors.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::mapped::Mapped;
use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;

const CHANNELS: FaultParameter = FaultParameter {
    name: "channels",
    takes: Takes::Channels,
    default: None,
    doc: "Channels whose scale factor changes; gyros and accelerometers together if you like.",
};

pub(super) static SCALE_STEP: FaultKind = FaultKind {
    name: "scale-step",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "The scale factor of one or more channels jumps.",
    model: "Every sample of the channels becomes\n\n\
            \u{20}   Δθ' = (1 + s S) Δθ      or      Δv' = (1 + s S) Δv\n\n\
            The change s S Δ is taken from the count of the sample, which is exact, and added in \
            counts with the remainder carried. s is 1 while the fault lasts and falls linearly to \
            0 over its recovery. A sum outside the format saturates and sets the saturation flag \
            of its triad.\n\n\
            The scale factor error of IEEE Std 952 and 1293 sets in at once: a mode jump, another \
            reference voltage. It multiplies all that is in the count, the instrument's own bias \
            and noise too, a relative change of S.",
    parameters: &[
        CHANNELS,
        FaultParameter {
            name: "error",
            takes: Takes::Quantity(&[Dimension::Ratio], ParameterBounds::NotZero),
            default: None,
            doc: "S: the change of the scale factor, as a part of it.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[
        ("channels", r#""gyro z""#),
        ("error", r#""100 ppm""#),
        ("trigger", "{ moving_to = 3 }"),
        ("duration", r#""12 s""#),
    ]),
    build: build_step,
};

pub(super) static ASYMMETRY: FaultKind = FaultKind {
    name: "asymmetry",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "The scale factors for positive and for negative input part.",
    model: "Every sample of the channels becomes\n\n\
            \u{20}   Δθ' = Δθ + s (A/2) |Δθ|      or      Δv' = Δv + s (A/2) |Δv|\n\n\
            so that the scale factor is larger by A/2 for positive input, smaller by A/2 for \
            negative: A is the difference of the two over their mean (scale factor asymmetry, \
            IEEE Std 528). The change is added in counts with the remainder carried. s is 1 while the fault lasts \
            and falls linearly to 0 over its recovery. A sum outside the format saturates and sets \
            the saturation flag of its triad.\n\n\
            The sign is that of the sample's increment, the mean over its interval: motion that \
            changes sign within a sample isn't rectified.",
    parameters: &[
        CHANNELS,
        FaultParameter {
            name: "error",
            takes: Takes::Quantity(&[Dimension::Ratio], ParameterBounds::NotZero),
            default: None,
            doc: "A: scale factor for positive input less that for negative, as a part of their \
                  mean.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[
        ("channels", r#""gyro z""#),
        ("error", r#""100 ppm""#),
        ("trigger", "{ moving_to = 3 }"),
        ("duration", r#""12 s""#),
    ]),
    build: build_asymmetry,
};

fn build_step(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let error = values.quantity("error")?;
    Ok(Mapped::rule(values.channels("channels")?, move |_, count| error * count))
}

fn build_asymmetry(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let half = 0.5 * values.quantity("error")?;
    Ok(Mapped::rule(values.channels("channels")?, move |_, count: f64| half * count.abs()))
}
