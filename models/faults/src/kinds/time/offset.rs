//! Stamps that are off by a constant.

use super::clock::{CLOCK, Clocks, nanoseconds, to_ns};
use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static TIME_OFFSET: FaultKind = FaultKind {
    name: "time-offset",
    family: Family::Time,
    acts: Acts::Samples,
    summary: "Stamps are off by a constant while it lasts.",
    model: "While it lasts, every stamp of the clock is off by a constant; in its recovery the \
            clock is brought back at a constant rate:\n\n\
            \u{20}   t' = t + round(s · offset)      s: 1, then down to 0 over the recovery\n\n\
            in whole nanoseconds, and never below zero. At its onset the stamps jump by the \
            offset: from the first sample of a run on there is no jump to be seen, only a wrong \
            time; later, the first interval is longer or shorter by the offset, and a negative \
            one of a period or more makes stamps go back. Without recovery the opposite jump \
            comes at its end. Numbers, counts and order of the samples are untouched.\n\n\
            With `clock = \"reference\"` samples and aiding disagree about the time: the \
            synchronisation error of a reference. A core that goes by the arrival of aiding and \
            not by its stamp doesn't notice.\n\n\
            A jump that stays for good is `time-step`.",
    parameters: &[
        FaultParameter {
            name: "offset",
            takes: Takes::Quantity(&[Dimension::Time], ParameterBounds::NotZero),
            default: None,
            doc: "Time that is added to the stamps; negative: they are too early.",
        },
        CLOCK,
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("offset", r#""2 ms""#), ("duration", r#""0.1 s""#)]),
    build: build_offset,
};

fn build_offset(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let (clocks, offset_ns) = (Clocks::of(values)?, nanoseconds(values, "offset")?);
    Ok(FaultRule::Samples(Box::new(TimeOffset { clocks, offset_ns })))
}

#[derive(Clone, Debug)]
struct TimeOffset {
    clocks: Clocks,
    offset_ns: i64,
}

octant_state::state! { TimeOffset { values: ; parts: ; kept: clocks, offset_ns } }

impl SampleRule for TimeOffset {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        // The product with a strength of 1 is exact up to 104 days.
        self.clocks.shift(epoch, to_ns(self.offset_ns as f64 * now.strength));
    }
}

pub(super) static TIME_STEP: FaultKind = FaultKind {
    name: "time-step",
    family: Family::Time,
    acts: Acts::Samples,
    summary: "The clock is stepped, once or again and again, and stays so.",
    model: "At its onset the clock jumps, and from there on, to the end of the run, every stamp \
            is off by it; each further onset adds another step:\n\n\
            \u{20}   t' = t + n · step      n: onsets so far\n\n\
            in whole nanoseconds, and never below zero. One interval is longer or shorter by the \
            step, all others are right: what a leap second, a change of the time source or a \
            clock set by hand do. A negative step of a period or more makes stamps jump back. \
            The sample at the onset is the first with the new time.\n\n\
            A jump that is taken back is `time-offset`.",
    parameters: &[
        FaultParameter {
            name: "step",
            takes: Takes::Quantity(&[Dimension::Time], ParameterBounds::NotZero),
            default: None,
            doc: "Height of the jump; negative: back in time.",
        },
        CLOCK,
    ],
    lasts: Lasts::Instant,
    example: Example::of(&[("step", r#""1 s""#)]).showing_s(0.1),
    build: build_step,
};

fn build_step(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let (clocks, step_ns) = (Clocks::of(values)?, nanoseconds(values, "step")?);
    Ok(FaultRule::Samples(Box::new(TimeStep { clocks, step_ns, error_ns: 0 })))
}

#[derive(Clone, Debug)]
struct TimeStep {
    clocks: Clocks,
    step_ns: i64,
    error_ns: i64,
}

octant_state::state! { TimeStep { values: error_ns; parts: ; kept: clocks, step_ns } }

impl SampleRule for TimeStep {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if now.since_onset == 0 {
            self.error_ns = self.error_ns.saturating_add(self.step_ns);
        }
        self.clocks.shift(epoch, self.error_ns);
    }

    fn lingers(&self) -> bool {
        self.error_ns != 0
    }

    fn afterwards(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        self.clocks.shift(epoch, self.error_ns);
    }
}
