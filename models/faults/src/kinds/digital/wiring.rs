//! Channels with wrong wiring or decoding.

use crate::catalogue::{Acts, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::kinds::channel::{pair, read, write, write_saturating};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static SIGN_FLIP: FaultKind = FaultKind {
    name: "sign-flip",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "One or more channels have the wrong sign.",
    model: "While it lasts every sample of the channels is Δ' = −Δ. The smallest count, \
            −2147483648, becomes the largest and sets the saturation flag of its triad; no other \
            flag changes.\n\n\
            A swapped pair of wires, a wrong axis convention after a change of software.",
    parameters: &[FaultParameter {
        name: "channels",
        takes: Takes::Channels,
        default: None,
        doc: "Channels with the wrong sign.",
    }],
    lasts: Lasts::Span,
    example: Example::NONE,
    build: build_flip,
};

pub(super) static AXIS_SWAP: FaultKind = FaultKind {
    name: "axis-swap",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "Two channels of a triad are exchanged.",
    model: "While it lasts every sample has Δ'_first = Δ_second and Δ'_second = Δ_first. No flag \
            changes. It makes a left-handed triad: no rotation of the instrument explains it.",
    parameters: &[
        FaultParameter {
            name: "first",
            takes: Takes::Channels,
            default: None,
            doc: "One gyro or one accelerometer.",
        },
        FaultParameter {
            name: "second",
            takes: Takes::Channels,
            default: None,
            doc: "Another of the same triad.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("second", r#""gyro y""#)]),
    build: build_swap,
};

fn build_flip(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Samples(Box::new(SignFlip { channels: values.channels("channels")? })))
}

#[derive(Clone, Debug)]
struct SignFlip {
    channels: Channels,
}

octant_state::state! { SignFlip { values: ; parts: ; kept: channels } }

impl SampleRule for SignFlip {
    fn on_epoch(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        for channel in self.channels.iter() {
            let count = read(&epoch.sample, channel);
            write_saturating(&mut epoch.sample, channel, -i64::from(count));
        }
    }
}

fn build_swap(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Samples(Box::new(AxisSwap { channels: pair(values, "first", "second")? })))
}

#[derive(Clone, Debug)]
struct AxisSwap {
    channels: [usize; 2],
}

octant_state::state! { AxisSwap { values: ; parts: ; kept: channels } }

impl SampleRule for AxisSwap {
    fn on_epoch(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        let counts = self.channels.map(|channel| read(&epoch.sample, channel));
        write(&mut epoch.sample, self.channels[0], counts[1]);
        write(&mut epoch.sample, self.channels[1], counts[0]);
    }
}
