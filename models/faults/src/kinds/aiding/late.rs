//! References that arrive late.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::parameters::samples;
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::station::FLIGHT_MAX;
use crate::values::Values;
use alloc::boxed::Box;
use alloc::collections::VecDeque;
use octant_sample::{Aiding, Epoch};

pub(super) static AIDING_LATE: FaultKind = FaultKind {
    name: "aiding-late",
    family: Family::Aiding,
    acts: Acts::Samples,
    summary: "Aiding comes late, with its old stamp or with a new one.",
    model: "While it lasts, every aiding message leaves its sample and goes with the n-th sample \
            after it:\n\n\
            \u{20}   aiding'(k + n) = aiding(k)      n = delay / period, to the nearest whole number\n\n\
            With its old stamp it says that it is late, and a core that goes by stamps can account \
            for it; with the stamp of the sample that it goes with (`stamp = \"new\"`) it lies. In a \
            dwell nothing moves and the delay hardly shows; on a swaying ship a velocity reference \
            is wrong by the acceleration times the delay. Samples are untouched.\n\n\
            Messages that are held when the fault ends come at their time; where the sample then \
            has aiding of its own, which is on time again, the late one goes with the next sample \
            that has none. What is held at the end of the run never comes.",
    parameters: &[
        FaultParameter {
            name: "delay",
            takes: Takes::Quantity(
                &[Dimension::Time, Dimension::Samples],
                ParameterBounds::Positive,
            ),
            default: None,
            doc: "How late aiding is: at least one sample period, at most 4096.",
        },
        FaultParameter {
            name: "stamp",
            takes: Takes::Choice(&[
                ("old", "that of the sample that it was measured at"),
                ("new", "that of the sample that it comes with"),
            ]),
            default: Some("old"),
            doc: "Stamp of a late message.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("delay", r#""2 s""#), ("duration", r#""10 s""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let delay = samples(values, "delay", 1..=FLIGHT_MAX as u64, setup)?;
    Ok(FaultRule::Samples(Box::new(AidingLate {
        delay,
        restamps: values.choice("stamp")? == "new",
        count: 0,
        queue: VecDeque::with_capacity(FLIGHT_MAX + 1),
    })))
}

#[derive(Clone, Debug)]
struct AidingLate {
    delay: u64,
    restamps: bool,
    /// Number of samples so far.
    count: u64,
    /// Due sample of each message, and the message. While the fault lasts, at most one message
    /// comes in with a sample and one that is due goes out: never more than `delay` are held.
    queue: VecDeque<(u64, Aiding)>,
}

octant_state::state! { AidingLate { values: count, queue; parts: ; kept: delay, restamps; check: Self::check_queue } }

impl AidingLate {
    /// Checks that the count and the length of the queue are within limits, and reserves the
    /// queue's room.
    fn check_queue(&mut self) -> Result<(), octant_state::StateError> {
        octant_state::check_count("count", self.count)?;
        octant_state::check_below("queue", self.queue.len() as u64, FLIGHT_MAX as u64)?;
        self.queue.reserve_exact(FLIGHT_MAX + 1 - self.queue.len());
        Ok(())
    }

    /// Adds the oldest message, if due, to a sample without aiding.
    fn give(&mut self, epoch: &mut Epoch) {
        let due = self.queue.front().is_some_and(|(due, _)| *due <= self.count);
        if !due || epoch.aiding.is_some() {
            return;
        }
        epoch.aiding = self.queue.pop_front().map(|(_, mut aiding)| {
            if self.restamps {
                aiding.device_time = epoch.sample.device_time;
            }
            aiding
        });
    }
}

impl SampleRule for AidingLate {
    fn on_epoch(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        self.count += 1;
        if let Some(aiding) = epoch.aiding.take() {
            self.queue.push_back((self.count + self.delay, aiding));
        }
        self.give(epoch);
    }

    fn lingers(&self) -> bool {
        !self.queue.is_empty()
    }

    fn afterwards(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        self.count += 1;
        self.give(epoch);
    }
}
