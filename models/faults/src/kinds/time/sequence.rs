//! Sequence numbers that jump although no sample was lost.

use crate::catalogue::{Acts, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static SEQUENCE_GAP: FaultKind = FaultKind {
    name: "sequence-gap",
    family: Family::Time,
    acts: Acts::Samples,
    summary: "Sequence numbers jump although no sample is lost.",
    model: "At its onset the counter of the samples jumps:\n\n\
            \u{20}   sequence' = sequence + n · skip      n: onsets so far\n\n\
            from that sample on to the end of the run, or, with `afterwards = \"corrected\"`, in \
            that one sample only (a number that was damaged). Never below zero. Stamps, counts and \
            order are untouched: a core that counts its losses by numbers alone sees a gap that \
            its clock doesn't. A negative skip makes numbers come again, as after a restart of the \
            counter: a core that demands that they advance refuses every sample until the counter \
            has come as far as it was.\n\n\
            Samples that are really lost are `dropout`.",
    parameters: &[
        FaultParameter {
            name: "skip",
            takes: Takes::Integer(-1_000_000_000, 1_000_000_000),
            default: None,
            doc: "Numbers that the counter skips; negative: it goes back. Not 0.",
        },
        FaultParameter {
            name: "afterwards",
            takes: Takes::Choice(&[
                ("stays", "the counter goes on from where it jumped to"),
                ("corrected", "the next sample has its right number"),
            ]),
            default: Some("stays"),
            doc: "What becomes of the numbers after the sample at the onset.",
        },
    ],
    lasts: Lasts::Instant,
    example: Example::of(&[("skip", "10")]).showing_s(0.1),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let skip = values.integer("skip")?;
    if skip == 0 {
        return Err(FaultBuildError::value(
            "skip",
            "0: no number would change, another is expected",
        ));
    }
    Ok(FaultRule::Samples(Box::new(SequenceGap {
        skip,
        stays: super::clock::stays(values)?,
        error: 0,
    })))
}

#[derive(Clone, Debug)]
struct SequenceGap {
    skip: i64,
    stays: bool,
    error: i64,
}

octant_state::state! { SequenceGap { values: error; parts: ; kept: skip, stays } }

impl SampleRule for SequenceGap {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if now.since_onset == 0 {
            let before = if self.stays { self.error } else { 0 };
            self.error = before.saturating_add(self.skip);
        }
        self.afterwards(epoch, now);
    }

    fn lingers(&self) -> bool {
        self.stays && self.error != 0
    }

    fn afterwards(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        epoch.sample.sequence = epoch.sample.sequence.saturating_add_signed(self.error);
    }
}
