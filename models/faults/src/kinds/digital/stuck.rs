//! Counts that stay constant.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::{counts_per_si, fitting};
use crate::kinds::channel::{counts, read, saturated, write};
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static STUCK_AT_CURRENT: FaultKind = FaultKind {
    name: "stuck-at-current",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "One or more channels stick at their last value.",
    model: "From its onset every sample of the channels has the count that the channel had in the \
            sample before the onset:\n\n\
            \u{20}   Δ'(k) = Δ(onset − 1)\n\n\
            as it left the source, before any fault; 0 if the fault sets in at the first sample of \
            the run. Stamps, sequence numbers, gimbal angles, the other channels and all flags go \
            on as they were. What the channel would have measured is lost.\n\n\
            A register or a converter that isn't written any more does this. In a dwell the held \
            value is nearly right and innovations don't show it; identical samples do.",
    parameters: &[FaultParameter {
        name: "channels",
        takes: Takes::Channels,
        default: None,
        doc: "Channels that stick.",
    }],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.2 s""#)]),
    build: build_current,
};

pub(super) static STUCK_AT_VALUE: FaultKind = FaultKind {
    name: "stuck-at-value",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "One or more channels stick at a given value.",
    model: "While it lasts every sample of the channels has the same count:\n\n\
            \u{20}   Δθ' = round(V dt / 2⁻³⁶ rad)      or      Δv' = round(V dt / 2⁻³⁰ m/s)\n\n\
            halves away from zero, nothing carried: the register stands. Zero is a value like \
            any other. No flag changes. What the channel would have measured is lost. A value \
            beyond the instrument's range but within the format is a wrong number that looks \
            like one; for the limits of the format take `out-of-range`.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Channels that stick: gyros or accelerometers.",
        },
        FaultParameter {
            name: "value",
            takes: Takes::Quantity(
                &[Dimension::AngularRate, Dimension::Acceleration],
                ParameterBounds::Any,
            ),
            default: None,
            doc: "V: the angular rate or the acceleration that is read.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("value", r#""10 deg/s""#), ("duration", r#""0.2 s""#)]),
    build: build_value,
};

pub(super) static OUT_OF_RANGE: FaultKind = FaultKind {
    name: "out-of-range",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "One or more channels read the limit of the format.",
    model: "While it lasts every sample of the channels has the count 2147483647 (upper) or \
            −2147483648 (lower): at 200 Hz 358 deg/s and 40.8 g, beyond the range of the \
            instrument of Table 1. With `flag` the saturation flag of the triad is set, as an \
            instrument would; without it all flags stay as they were, and the core has to see it \
            by itself. What the channel would have measured is lost.\n\n\
            It is the overflow of a counter, or a bus that reads all ones.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Channels that read the limit.",
        },
        FaultParameter {
            name: "at",
            takes: Takes::Choice(&[
                ("upper", "the largest count"),
                ("lower", "the smallest count"),
                ("sign", "the limit on the side of the sample's sign; zero is above"),
            ]),
            default: Some("upper"),
            doc: "Which limit.",
        },
        FaultParameter {
            name: "flag",
            takes: Takes::Flag,
            default: Some("true"),
            doc: "Whether the instrument says that it saturates.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.1 s""#)]),
    build: build_limit,
};

fn build_current(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    Ok(FaultRule::Samples(Box::new(Current { channels, held: [0; 6], onset: Onset::default() })))
}

#[derive(Clone, Debug)]
struct Current {
    channels: Channels,
    held: [i32; 6],
    onset: Onset,
}

octant_state::state! { Current { values: held, onset; parts: ; kept: channels } }

impl SampleRule for Current {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.held = counts(&now.last.sample);
        }
        for channel in self.channels.iter() {
            write(&mut epoch.sample, channel, self.held[channel]);
        }
    }

    fn looks_back(&self) -> bool {
        true
    }
}

fn build_value(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let value = fitting(values, channels, "value")?;
    let channel = if channels.gyros_only() { 0 } else { 3 };
    let count = libm::round(value * setup.dt_s() * counts_per_si(channel));
    if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&count) {
        let problem = alloc::format!(
            "{count} counts a sample were found, from {} to {} are expected: the format ends there",
            i32::MIN,
            i32::MAX
        );
        return Err(FaultBuildError::value("value", problem));
    }
    Ok(FaultRule::Samples(Box::new(Constant { channels, count: count as i32 })))
}

#[derive(Clone, Debug)]
struct Constant {
    channels: Channels,
    count: i32,
}

octant_state::state! { Constant { values: ; parts: ; kept: channels, count } }

impl SampleRule for Constant {
    fn on_epoch(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        for channel in self.channels.iter() {
            write(&mut epoch.sample, channel, self.count);
        }
    }
}

fn build_limit(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let at = match values.choice("at")? {
        "lower" => Some(i32::MIN),
        "sign" => None,
        _ => Some(i32::MAX),
    };
    Ok(FaultRule::Samples(Box::new(Limit { channels, at, flag: values.flag("flag")? })))
}

#[derive(Clone, Debug)]
struct Limit {
    channels: Channels,
    /// `None`: the limit on the side of the count's sign.
    at: Option<i32>,
    flag: bool,
}

octant_state::state! { Limit { values: ; parts: ; kept: channels, at, flag } }

impl SampleRule for Limit {
    fn on_epoch(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        for channel in self.channels.iter() {
            let below = read(&epoch.sample, channel) < 0;
            let limit = self.at.unwrap_or(if below { i32::MIN } else { i32::MAX });
            write(&mut epoch.sample, channel, limit);
            if self.flag {
                epoch.sample.status |= saturated(channel);
            }
        }
    }
}
