//! Stamps that are given twice.

use crate::catalogue::{Acts, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::{DeviceTime, Epoch};

pub(super) static DUPLICATE_STAMP: FaultKind = FaultKind {
    name: "duplicate-stamp",
    family: Family::Time,
    acts: Acts::Samples,
    summary: "Samples carry the stamp of the sample before.",
    model: "The sample at the onset gets the stamp that the sample before it left the source with. \
            While the fault lasts, stamps go on in runs of equal ones: with `run = 2` every other \
            sample repeats the stamp before it, the others have their own; with `run = n` n − 1 \
            samples follow each right stamp with the same:\n\n\
            \u{20}   t'(k) = t(k − j)      j = (k − k₀ + 1) mod run, k₀: sample at the onset\n\n\
            Numbers, counts and aiding are untouched: the samples are different ones, and only \
            their stamps say otherwise, as where a stamp is read before it was updated, or where \
            the clock ticks slower than samples come. A duration of one sample repeats a single \
            stamp. A core that refuses a stamp that doesn't advance loses the sample, and takes \
            the next one for the end of a longer interval.\n\n\
            A sample that is delivered twice is `duplicate`; a clock that stands is \
            `frozen-clock`.",
    parameters: &[FaultParameter {
        name: "run",
        takes: Takes::Integer(2, 1000),
        default: Some("2"),
        doc: "Samples in a row that share a stamp, the right one included.",
    }],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.1 s""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Samples(Box::new(DuplicateStamp {
        run: values.integer("run")? as u64,
        period_ns: setup.sample_period_ns,
        nth: 0,
        stamp: DeviceTime::default(),
    })))
}

#[derive(Clone, Debug)]
struct DuplicateStamp {
    run: u64,
    period_ns: u64,
    /// Place in the run: 0 is the sample with its own stamp.
    nth: u64,
    stamp: DeviceTime,
}

octant_state::state! { DuplicateStamp { values: nth, stamp; parts: ; kept: run, period_ns; check: |rule: &Self| octant_state::check_below("nth", rule.nth, rule.run - 1) } }

impl SampleRule for DuplicateStamp {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        let own = &mut epoch.sample.device_time;
        if now.since_onset == 0 {
            self.nth = 1;
            self.stamp = if now.epoch > 1 {
                now.last.sample.device_time
            } else {
                DeviceTime::from_ns(own.ns.saturating_sub(self.period_ns))
            };
        }
        if self.nth == 0 {
            self.stamp = *own;
        }
        *own = self.stamp;
        self.nth = (self.nth + 1) % self.run;
    }

    fn looks_back(&self) -> bool {
        true
    }
}
