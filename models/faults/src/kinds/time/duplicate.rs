//! Samples that are delivered more than once.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::parameters::samples;
use crate::rule::{Context, DeliveryRule, FaultRule};
use crate::setup::{FaultBuildError, Setup};
use crate::station::{FLIGHT_MAX, check_queue};
use crate::values::Values;
use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use octant_sample::Epoch;

pub(super) static DUPLICATE: FaultKind = FaultKind {
    name: "duplicate",
    family: Family::Time,
    acts: Acts::Delivery,
    summary: "Samples are delivered twice, or more often.",
    model: "While it lasts, every epoch arrives in its own step and so many times again, each copy \
            the same to the last bit, aiding included:\n\n\
            \u{20}   copies = 1, delay = 0:           1 1 2 2 3 3\n\
            \u{20}   copies = 1, delay = 2 samples:   1, 2, 3 1, 4 2, 5 3   (a comma is a step)\n\n\
            With a delay the copies come so many steps later, after the epoch of that step, as a \
            link does that repeats what was not acknowledged in time. A core that integrates a \
            copy counts its rotation twice; one that demands that numbers advance refuses it.\n\n\
            Copies that are still to come when the fault ends come at their time; those that are \
            to come after the end of the run never do.",
    parameters: &[
        FaultParameter {
            name: "copies",
            takes: Takes::Integer(1, 8),
            default: Some("1"),
            doc: "How often an epoch is delivered again.",
        },
        FaultParameter {
            name: "delay",
            takes: Takes::Quantity(
                &[Dimension::Time, Dimension::Samples],
                ParameterBounds::NotNegative,
            ),
            default: Some("0 s"),
            doc: "How much later the copies come, to the nearest sample: up to 4096 samples.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.1 s""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let delay = samples(values, "delay", 0..=FLIGHT_MAX as u64, setup)?;
    Ok(FaultRule::Delivery(Box::new(Duplicate {
        copies: values.integer("copies")?.clamp(1, 8) as usize,
        delay,
        queue: VecDeque::with_capacity(FLIGHT_MAX),
    })))
}

#[derive(Clone, Debug)]
struct Duplicate {
    copies: usize,
    delay: u64,
    /// Step in which the copies of an epoch are due, and the epoch.
    queue: VecDeque<(u64, Epoch)>,
}

octant_state::state! { Duplicate { values: queue; parts: ; kept: copies, delay; check: Self::check_queue } }

impl Duplicate {
    fn check_queue(&mut self) -> Result<(), octant_state::StateError> {
        check_queue(&mut self.queue)
    }

    fn let_out(&mut self, out: &mut Vec<Epoch>) {
        if let Some((_, epoch)) = self.queue.pop_front() {
            out.extend(core::iter::repeat_n(epoch, self.copies));
        }
    }
}

impl DeliveryRule for Duplicate {
    fn on_step(
        &mut self,
        incoming: &[Epoch],
        active: bool,
        now: &Context<'_>,
        out: &mut Vec<Epoch>,
    ) {
        for epoch in incoming {
            out.push(*epoch);
            if active && self.delay == 0 {
                out.extend(core::iter::repeat_n(*epoch, self.copies));
            } else if active {
                if self.queue.len() == FLIGHT_MAX {
                    self.let_out(out);
                }
                self.queue.push_back((now.epoch.saturating_add(self.delay), *epoch));
            }
        }
        while self.queue.front().is_some_and(|(due, _)| *due <= now.epoch) {
            self.let_out(out);
        }
    }

    fn holds(&self) -> usize {
        self.queue.len()
    }

    fn most_out(&self, incoming: usize) -> usize {
        // The epochs themselves, the copies that are due, and those that have to make room for
        // them.
        let rounds = if self.delay == 0 { 1 } else { 2 };
        incoming.saturating_mul(1 + rounds * self.copies)
    }
}
