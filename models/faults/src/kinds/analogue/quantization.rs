//! A coarser least significant bit.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::{counts_per_si, fitting};
use crate::kinds::channel::{read, write_saturating};
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static QUANTIZATION: FaultKind = FaultKind {
    name: "quantization",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "The increments of one or more channels come in coarser steps.",
    model: "With a step of q counts (the resolution over the format's LSB of 2⁻³⁶ rad or \
            2⁻³⁰ m/s, rounded to a whole number, at least 2) every sample of the channels \
            becomes\n\n\
            \u{20}   Δ' = q round((r + Δ)/q),      r ← r + Δ − Δ'\n\n\
            with halves rounded away from zero. The remainder r, zero at the onset, is carried as \
            in a pulse counter: the sum of Δ' follows the sum of Δ to within q/2, so that \
            nothing but noise is added (quantization noise, IEEE Std 952: Allan deviation \
            √3 (q/√12)/τ). When the fault ends, r is lost. A multiple of q outside the format \
            saturates, its excess is lost and the saturation flag of its triad is set.\n\n\
            A readout that has lost its interpolation, one fringe a count, does this.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Channels with the coarser steps: gyros or accelerometers.",
        },
        FaultParameter {
            name: "resolution",
            takes: Takes::Quantity(
                &[Dimension::SmallAngle, Dimension::Velocity],
                ParameterBounds::Positive,
            ),
            default: None,
            doc: "The step: an angle for gyros, a velocity for accelerometers.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("resolution", r#""0.02 arcsec""#)]),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let resolution = fitting(values, channels, "resolution")?;
    let channel = if channels.gyros_only() { 0 } else { 3 };
    let step = libm::round(resolution * counts_per_si(channel));
    if !(2.0..=f64::from(i32::MAX)).contains(&step) {
        let problem = alloc::format!(
            "{step} counts of the format were found, from 2 to {} are expected",
            i32::MAX
        );
        return Err(FaultBuildError::value("resolution", problem));
    }
    let step = step as i64;
    Ok(FaultRule::Samples(Box::new(Quantization {
        channels,
        step,
        remainder: [0; 6],
        onset: Onset::default(),
    })))
}

#[derive(Clone, Debug)]
struct Quantization {
    channels: Channels,
    step: i64,
    remainder: [i64; 6],
    onset: Onset,
}

octant_state::state! { Quantization { values: remainder, onset; parts: ; kept: channels, step; check: Self::check_remainder } }

impl Quantization {
    fn check_remainder(&self) -> Result<(), octant_state::StateError> {
        let step = self.step.unsigned_abs();
        self.remainder
            .iter()
            .try_for_each(|left| octant_state::check_below("remainder", left.unsigned_abs(), step))
    }
}

impl SampleRule for Quantization {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.remainder = [0; 6];
        }
        for channel in self.channels.iter() {
            let total = self.remainder[channel] + i64::from(read(&epoch.sample, channel));
            let half = if total < 0 { -self.step } else { self.step };
            let coarse = (2 * total + half) / (2 * self.step) * self.step;
            // The remainder is against the coarse count before saturation: the excess over the
            // format is lost.
            self.remainder[channel] = total - coarse;
            write_saturating(&mut epoch.sample, channel, coarse);
        }
    }
}
