//! Samples without content: they arrive, but carry no new measurement.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::channel::{counts, write};
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::{Epoch, GimbalAngles, Sample};

const CHANNELS: FaultParameter = FaultParameter {
    name: "channels",
    takes: Takes::Channels,
    default: Some("all"),
    doc: "Channels that drop out.",
};
const GIMBAL: FaultParameter = FaultParameter {
    name: "gimbal",
    takes: Takes::Flag,
    default: Some("false"),
    doc: "Whether the gimbal angles drop out with them.",
};

pub(super) static DROPOUT_ZERO: FaultKind = FaultKind {
    name: "dropout-zero",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "One or more channels read zero: samples come, but empty.",
    model: "While it lasts the counts of the channels are 0, with `gimbal` both gimbal angles too. \
            Stamps, sequence numbers, the other channels and all flags go on as they were: the \
            sample claims to be good. What the channels would have measured is lost, 1 g on a \
            vertical accelerometer included.\n\n\
            A driver that fills missed reads with zeros does this. For samples that don't come at \
            all take `dropout`.",
    parameters: &[CHANNELS, GIMBAL],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.1 s""#)]),
    build: build_zero,
};

pub(super) static DROPOUT_HELD: FaultKind = FaultKind {
    name: "dropout-held",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "One or more channels repeat their last value: samples come, but stale.",
    model: "While it lasts the counts of the channels, with `gimbal` both gimbal angles too, are \
            those of the sample before the onset as it left the source, before any fault (0 if \
            there was none). Stamps, sequence numbers, the other channels and all flags go on as \
            they were: the sample claims to be fresh. What the channels would have measured is \
            lost.\n\n\
            A driver that fills missed reads with the last message does this. A single sensor \
            that stands is `stuck-at-current`; samples that don't come at all are `dropout`.",
    parameters: &[CHANNELS, GIMBAL],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.1 s""#)]),
    build: build_held,
};

pub(super) static INTERMITTENT: FaultKind = FaultKind {
    name: "intermittent",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "One or more channels drop out and come back at random.",
    model: "A two-state Markov chain, one for all its channels (a loose connector): out at the \
            onset; before each further sample it changes with probability dt/mean_out when out, \
            dt/mean_in when in, so that the times out and in are geometric with these means. \
            While in, samples pass. While out, the counts of the channels, with `gimbal` both \
            gimbal angles too, are 0 (`fill` zero) or those of the last sample that passed it \
            (`fill` held; at the onset those of the sample before it as it left the source, before \
            any fault). Stamps, sequence numbers, the other channels and all flags go on as they \
            were. What isn't delivered is lost.\n\n\
            The changes depend on the seed, the fault's id and the sample alone. For samples that \
            don't come at all take `dropout`.",
    parameters: &[
        CHANNELS,
        GIMBAL,
        FaultParameter {
            name: "fill",
            takes: Takes::Choice(&[
                ("zero", "the counts are 0"),
                ("held", "the counts are those of the last sample that passed"),
            ]),
            default: Some("zero"),
            doc: "What the sample holds while it is out.",
        },
        FaultParameter {
            name: "mean_out",
            takes: Takes::Quantity(&[Dimension::Time], ParameterBounds::Positive),
            default: None,
            doc: "Mean time that it is out, at least a sample.",
        },
        FaultParameter {
            name: "mean_in",
            takes: Takes::Quantity(&[Dimension::Time], ParameterBounds::Positive),
            default: None,
            doc: "Mean time that it is in, at least a sample.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("mean_out", r#""20 ms""#), ("mean_in", r#""0.1 s""#)]),
    build: build_intermittent,
};

fn build_zero(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    Dropout::rule(values, false, None)
}

fn build_held(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    Dropout::rule(values, true, None)
}

fn build_intermittent(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let chance = |name| {
        let mean_s = values.quantity(name)?;
        let chance = setup.dt_s() / mean_s;
        if chance <= 1.0 {
            return Ok(chance);
        }
        let problem = alloc::format!(
            "{mean_s} s was found, at least {} s, a sample, is expected",
            setup.dt_s()
        );
        Err(FaultBuildError::value(name, problem))
    };
    let chain = Chain {
        leaves_out: chance("mean_out")?,
        leaves_in: chance("mean_in")?,
        stream: setup.stream("contact"),
    };
    Dropout::rule(values, values.choice("fill")? == "held", Some(chain))
}

/// Probabilities of a change before a sample.
#[derive(Clone, Copy, Debug)]
struct Chain {
    leaves_out: f64,
    leaves_in: f64,
    stream: Stream,
}

/// Content that fills a sample.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
struct Fill {
    counts: [i32; 6],
    gimbal: GimbalAngles,
}

impl Fill {
    fn of(sample: &Sample) -> Self {
        Self { counts: counts(sample), gimbal: sample.gimbal }
    }
}

#[derive(Clone, Debug)]
struct Dropout {
    channels: Channels,
    gimbal: bool,
    held: bool,
    /// `None`: the samples are out all the time.
    chain: Option<Chain>,
    out: bool,
    fill: Fill,
    onset: Onset,
}

octant_state::state! { Dropout { values: out, fill, onset; parts: ; kept: channels, gimbal, held, chain } }

impl Dropout {
    fn rule(
        values: &Values,
        held: bool,
        chain: Option<Chain>,
    ) -> Result<FaultRule, FaultBuildError> {
        Ok(FaultRule::Samples(Box::new(Self {
            channels: values.channels("channels")?,
            gimbal: values.flag("gimbal")?,
            held,
            chain,
            out: true,
            fill: Fill::default(),
            onset: Onset::default(),
        })))
    }
}

impl SampleRule for Dropout {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.out = true;
            if self.held {
                self.fill = Fill::of(&now.last.sample);
            }
        } else if let Some(chain) = &self.chain {
            let chance = if self.out { chain.leaves_out } else { chain.leaves_in };
            self.out ^= now.uniforms(&chain.stream)[0] < chance;
        }
        if !self.out {
            if self.held {
                self.fill = Fill::of(&epoch.sample);
            }
            return;
        }
        for channel in self.channels.iter() {
            write(&mut epoch.sample, channel, self.fill.counts[channel]);
        }
        if self.gimbal {
            epoch.sample.gimbal = self.fill.gimbal;
        }
    }

    fn looks_back(&self) -> bool {
        self.held
    }
}
