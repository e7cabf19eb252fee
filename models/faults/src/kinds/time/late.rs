//! Samples that arrive late.

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

pub(super) static LATE_DELIVERY: FaultKind = FaultKind {
    name: "late-delivery",
    family: Family::Time,
    acts: Acts::Delivery,
    summary: "Samples arrive late by a fixed time.",
    model: "While it lasts, every epoch is delivered so many steps of the source after its own:\n\n\
            \u{20}   step of delivery = k + n      n = delay / period, to the nearest whole number\n\n\
            For the first n steps nothing arrives, then one epoch a step, in order, unaltered: \
            stamps and numbers are right, only the time of arrival is not, and every set point of \
            the core comes as much later. Aiding stays with its sample.\n\n\
            At its end the n epochs that are held catch up: all at once, in the first step after \
            the end and before its own epoch; gradually, with one more in each step than comes \
            in, in order, so that it takes n steps; or they are overtaken: epochs after the end \
            are on time, and each late one still comes at its time, before the epoch of that step, \
            which is a sample out of order. A fault without a duration stays late. Where another \
            onset comes before all have caught up, what has been waiting comes out first.\n\n\
            What is held at the end of the run never comes. At most 4096 epochs are held: with \
            more, which takes another fault that delivers several in a step, the oldest comes out \
            early.",
    parameters: &[
        FaultParameter {
            name: "delay",
            takes: Takes::Quantity(
                &[Dimension::Time, Dimension::Samples],
                ParameterBounds::Positive,
            ),
            default: None,
            doc: "How late samples are: at least one sample period, at most 4096.",
        },
        FaultParameter {
            name: "catch_up",
            takes: Takes::Choice(&[
                ("at once", "all that is held comes in the first step after the end"),
                ("gradually", "one more in each step than comes in, in order"),
                ("overtaken", "each at its late time, out of order"),
            ]),
            default: Some("at once"),
            doc: "How the samples that are held at the end of the fault come out.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("delay", r#""0.1 s""#), ("duration", r#""0.3 s""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let catch_up = match values.choice("catch_up")? {
        "gradually" => CatchUp::Gradually,
        "overtaken" => CatchUp::Overtaken,
        _ => CatchUp::AtOnce,
    };
    Ok(FaultRule::Delivery(Box::new(LateDelivery {
        delay: samples(values, "delay", 1..=FLIGHT_MAX as u64, setup)?,
        catch_up,
        queue: VecDeque::with_capacity(FLIGHT_MAX),
    })))
}

#[derive(Clone, Copy, Debug)]
enum CatchUp {
    AtOnce,
    Gradually,
    Overtaken,
}

#[derive(Clone, Debug)]
struct LateDelivery {
    delay: u64,
    catch_up: CatchUp,
    /// Step of delivery of each epoch, not falling, and the epoch.
    queue: VecDeque<(u64, Epoch)>,
}

octant_state::state! { LateDelivery { values: queue; parts: ; kept: delay, catch_up; check: Self::check_queue } }

impl LateDelivery {
    fn check_queue(&mut self) -> Result<(), octant_state::StateError> {
        check_queue(&mut self.queue)
    }

    fn hold(&mut self, until: u64, epoch: &Epoch, out: &mut Vec<Epoch>) {
        if self.queue.len() == FLIGHT_MAX {
            out.extend(self.queue.pop_front().map(|(_, oldest)| oldest));
        }
        self.queue.push_back((until, *epoch));
    }

    fn let_out_due(&mut self, step: u64, out: &mut Vec<Epoch>) {
        while self.queue.front().is_some_and(|(due, _)| *due <= step) {
            out.extend(self.queue.pop_front().map(|(_, epoch)| epoch));
        }
    }
}

impl DeliveryRule for LateDelivery {
    fn on_step(
        &mut self,
        incoming: &[Epoch],
        active: bool,
        now: &Context<'_>,
        out: &mut Vec<Epoch>,
    ) {
        match (active, self.catch_up) {
            (true, _) => {
                for epoch in incoming {
                    self.hold(now.epoch.saturating_add(self.delay), epoch, out);
                }
                self.let_out_due(now.epoch, out);
            }
            (false, CatchUp::AtOnce) => {
                out.extend(self.queue.drain(..).map(|(_, epoch)| epoch));
                out.extend_from_slice(incoming);
            }
            (false, CatchUp::Gradually) => {
                for epoch in incoming {
                    self.hold(now.epoch, epoch, out);
                }
                let count = self.queue.len().min(incoming.len() + 1);
                out.extend(self.queue.drain(..count).map(|(_, epoch)| epoch));
            }
            (false, CatchUp::Overtaken) => {
                self.let_out_due(now.epoch, out);
                out.extend_from_slice(incoming);
            }
        }
    }

    fn holds(&self) -> usize {
        self.queue.len()
    }

    fn most_out(&self, incoming: usize) -> usize {
        // Epochs of as many steps as the delay has, or as many as there is room for.
        incoming + incoming.saturating_mul(self.delay as usize).min(FLIGHT_MAX)
    }
}
