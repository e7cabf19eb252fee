//! Additional noise.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::{Adder, counts_per_si};
use crate::kinds::parameters::Six;
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static NOISE_GAIN: FaultKind = FaultKind {
    name: "noise-gain",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "The white noise of one or more channels becomes several times as large.",
    model: "Every sample of the channels gets white noise of its own that makes the \
            instrument's noise `gain` times as large:\n\n\
            \u{20}   Δθ' = Δθ + s √(gain² − 1) N √dt w      (Δv alike)\n\n\
            N is the angle random walk of the scenario's instrument, rad/√s, or the noise density \
            of its accelerometers, (m/s²)/√Hz; w is a standard normal of the sample and the \
            channel. Added to the instrument's independent noise it gives a random walk of \
            gain·N. It is added in counts with the remainder carried (without correlation beyond \
            a count). s is 1 while the fault lasts and falls linearly to 0 over its recovery, so \
            that the whole noise is then √(1 + s² (gain² − 1)) times the instrument's. A sum \
            outside the format saturates and sets the saturation flag of its triad.\n\n\
            A fading beam, a loose shield or electronics near their end do this. On recorded data \
            N is what the scenario says of the instrument, whatever the recording's noise is.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Channels that get the noise; gyros and accelerometers together if you like.",
        },
        FaultParameter {
            name: "gain",
            takes: Takes::Quantity(
                &[Dimension::Ratio],
                ParameterBounds::Within(1.0, 1e6, "more than 1 (100 %), up to 1000000"),
            ),
            default: None,
            doc: "The noise afterwards in units of the noise before; more than 1.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("gain", r#""300 %""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let gain = values.quantity("gain")?;
    if !(gain > 1.0) {
        let problem = alloc::format!("{gain} was found, more than 1 is expected");
        return Err(FaultBuildError::value("gain", problem));
    }
    let more = libm::sqrt((gain - 1.0) * (gain + 1.0)) * libm::sqrt(setup.dt_s());
    let mut counts = [0.0; 6];
    for channel in channels.iter() {
        let density =
            if channel < 3 { setup.angle_random_walk } else { setup.velocity_random_walk };
        if !(density > 0.0) {
            let problem = "the instrument has no noise on one of the channels: there is nothing to \
                           multiply";
            return Err(FaultBuildError::value("channels", problem));
        }
        counts[channel] = more * density * counts_per_si(channel);
    }
    Ok(FaultRule::Samples(Box::new(NoiseGain {
        channels,
        counts,
        noise: Six::new(setup, channels, "noise"),
        adder: Adder::default(),
        onset: Onset::default(),
    })))
}

#[derive(Clone, Debug)]
struct NoiseGain {
    channels: Channels,
    /// Standard deviation, counts.
    counts: [f64; 6],
    noise: Six,
    adder: Adder,
    onset: Onset,
}

octant_state::state! { NoiseGain { values: adder, onset; parts: ; kept: channels, counts, noise } }

impl SampleRule for NoiseGain {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.adder.clear();
        }
        let normals = self.noise.normals(now);
        for channel in self.channels.iter() {
            let counts = now.strength * self.counts[channel] * normals[channel];
            self.adder.add(&mut epoch.sample, channel, counts);
        }
    }
}
