//! A pulse on one or more channels.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::Added;
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static SPIKE: FaultKind = FaultKind {
    name: "spike",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "A pulse of constant height on one or more channels.",
    model: "While it lasts, every sample of the channels gets the pulse's height:\n\n\
            \u{20}   Δθ' = Δθ + A dt      or      Δv' = Δv + A dt\n\n\
            in counts, with the remainder carried from sample to sample, so that a pulse of N \
            samples adds N·A·dt to within half a count. Its width is its duration; single, \
            periodic and Poisson spikes differ by their trigger.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Channels that get the pulse: gyros or accelerometers.",
        },
        FaultParameter {
            name: "amplitude",
            takes: Takes::Quantity(
                &[Dimension::GyroBias, Dimension::AccelBias],
                ParameterBounds::NotZero,
            ),
            default: None,
            doc: "Height of the pulse: an angular rate for gyros, an acceleration for accelerometers.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("amplitude", r#""1000 deg/h""#), ("duration", r#""100 samples""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let added = Added::of(values, "channels", "amplitude", setup)?;
    Ok(FaultRule::Samples(Box::new(Spike { added })))
}

#[derive(Clone, Debug)]
struct Spike {
    added: Added,
}

octant_state::state! { Spike { values: ; parts: added; kept:  } }

impl SampleRule for Spike {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if now.since_onset == 0 {
            self.added.clear();
        }
        self.added.add(&mut epoch.sample, now.strength);
    }
}
