//! Channels that are read less often than they are sent.

use crate::catalogue::{Acts, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::kinds::channel::{counts, read, write, write_saturating};
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static SLOW_RATE: FaultKind = FaultKind {
    name: "slow-rate",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "Only every n-th sample of one or more channels is fresh.",
    model: "From its onset on only every n-th sample is fresh (the n-th, the 2n-th …, the first of \
            the fault being number 1). By choice:\n\n\
            \u{20}   repeated   those between repeat the last fresh one; before the first fresh one, \
            the sample before the onset as it left the source, before any fault\n\
            \u{20}   zero       those between are zero: n − 1 of n increments are lost\n\
            \u{20}   summed     those between are zero, and the fresh one is the sum of the n: no \
            increment is lost but those since the last fresh one when the fault ends\n\n\
            Stamps, sequence numbers, gimbal angles and the other channels go on as they were. A \
            sum outside the format saturates and sets the saturation flag of its triad; no other \
            flag changes.\n\n\
            A converter that falls back to a slower rate, or two clocks of which nobody knew, do \
            this. Repeated increments make motion that never was, in the mean right while the rate \
            is steady, wrong at every start and stop.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: Some("all"),
            doc: "Channels that are read less often.",
        },
        FaultParameter {
            name: "every",
            takes: Takes::Integer(2, 1_000_000),
            default: None,
            doc: "n: every n-th sample is fresh.",
        },
        FaultParameter {
            name: "between",
            takes: Takes::Choice(&[
                ("repeated", "the last fresh sample is repeated"),
                ("zero", "zeros, and what was measured then is lost"),
                ("summed", "zeros, and the fresh sample holds the sum"),
            ]),
            default: Some("repeated"),
            doc: "What the samples between hold.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("every", "4"), ("duration", r#""0.2 s""#)]),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let every = values.integer("every")?;
    if !(2..=1_000_000).contains(&every) {
        let problem = alloc::format!("{every} was found, 2 to 1000000 is expected");
        return Err(FaultBuildError::value("every", problem));
    }
    let between = match values.choice("between")? {
        "zero" => Between::Zero,
        "summed" => Between::Summed,
        _ => Between::Repeated,
    };
    let onset = Onset::default();
    Ok(FaultRule::Samples(Box::new(SlowRate {
        channels,
        every,
        between,
        seen: 0,
        kept: [0; 6],
        onset,
    })))
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Between {
    Repeated,
    Zero,
    Summed,
}

#[derive(Clone, Debug)]
struct SlowRate {
    channels: Channels,
    every: i64,
    between: Between,
    /// Samples since the last fresh one.
    seen: i64,
    /// The last fresh counts, or the sums since then.
    kept: [i64; 6],
    onset: Onset,
}

octant_state::state! { SlowRate { values: seen, kept, onset; parts: ; kept: channels, every, between; check: Self::check_counts } }

impl SlowRate {
    fn check_counts(&self) -> Result<(), octant_state::StateError> {
        let every = self.every.unsigned_abs();
        octant_state::check_below("seen", self.seen as u64, every - 1)?;
        // Limit: the sum of `every` samples.
        let largest = every.saturating_mul(1 << 31);
        self.kept
            .iter()
            .try_for_each(|sum| octant_state::check_below("kept", sum.unsigned_abs(), largest))
    }
}

impl SampleRule for SlowRate {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.seen = 0;
            self.kept = match self.between {
                Between::Repeated => counts(&now.last.sample).map(i64::from),
                Between::Zero | Between::Summed => [0; 6],
            };
        }
        self.seen += 1;
        let fresh = self.seen == self.every;
        if fresh {
            self.seen = 0;
        }
        for channel in self.channels.iter() {
            let count = i64::from(read(&epoch.sample, channel));
            let kept = &mut self.kept[channel];
            match self.between {
                Between::Repeated if fresh => *kept = count,
                // A stored count was read from a count, so that the cast is exact.
                Between::Repeated => write(&mut epoch.sample, channel, *kept as i32),
                Between::Zero if fresh => {}
                Between::Zero => write(&mut epoch.sample, channel, 0),
                Between::Summed if fresh => {
                    write_saturating(&mut epoch.sample, channel, *kept + count);
                    *kept = 0;
                }
                Between::Summed => {
                    *kept += count;
                    write(&mut epoch.sample, channel, 0);
                }
            }
        }
    }

    fn looks_back(&self) -> bool {
        self.between == Between::Repeated
    }
}
