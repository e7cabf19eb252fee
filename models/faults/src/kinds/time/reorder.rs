//! Samples that arrive in another order.

use crate::catalogue::{Acts, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::rule::{Context, DeliveryRule, FaultRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::station::FLIGHT_MAX;
use crate::values::Values;
use alloc::boxed::Box;
use alloc::vec::Vec;
use octant_sample::Epoch;

pub(super) static REORDER: FaultKind = FaultKind {
    name: "reorder",
    family: Family::Time,
    acts: Acts::Delivery,
    summary: "Samples arrive in another order: neighbours swapped, or a window shuffled.",
    model: "While it lasts, epochs are held back until there are as many as the window; then all of \
            them are delivered in the step of the last one, in reversed or in random order:\n\n\
            \u{20}   window = 3, reversed:   1 2 3 4 5 6  arrives as  3 2 1 6 5 4\n\n\
            With `window = 2` neighbours are swapped. With `order = \"random\"` every permutation is \
            as likely as any other, the unchanged one included (inside-out shuffle of Fisher and \
            Yates). Nothing is altered, lost or doubled; aiding stays with its sample.\n\n\
            What is held when the fault ends comes out in the step after, in the order that it \
            would have had, before the epoch of that step; what is held at the end of the run \
            never comes. A network that sends over several paths does this; so does a buffer that \
            is read from the wrong end.",
    parameters: &[
        FaultParameter {
            name: "window",
            takes: Takes::Integer(2, FLIGHT_MAX as i64),
            default: Some("2"),
            doc: "Samples among which the order changes.",
        },
        FaultParameter {
            name: "order",
            takes: Takes::Choice(&[
                ("reversed", "the last comes first"),
                ("random", "any order is as likely as any other"),
            ]),
            default: Some("reversed"),
            doc: "Order within the window.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("window", "4"), ("duration", r#""0.1 s""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let window = values.integer("window")?.clamp(2, FLIGHT_MAX as i64) as usize;
    let random = values.choice("order")? == "random";
    Ok(FaultRule::Delivery(Box::new(Reorder {
        window,
        shuffle: random.then(|| setup.stream("order")),
        held: Vec::with_capacity(window),
    })))
}

#[derive(Clone, Debug)]
struct Reorder {
    window: usize,
    /// Stream of random numbers, if the order is random.
    shuffle: Option<Stream>,
    /// Epochs held, in the order of their arrival, or shuffled on arrival.
    held: Vec<Epoch>,
}

octant_state::state! { Reorder { values: held; parts: ; kept: window, shuffle; check: Self::check_held } }

impl Reorder {
    fn check_held(&mut self) -> Result<(), octant_state::StateError> {
        octant_state::check_below("held", self.held.len() as u64, self.window as u64 - 1)?;
        self.held.reserve_exact(self.window - self.held.len());
        Ok(())
    }

    fn let_out(&mut self, out: &mut Vec<Epoch>) {
        match self.shuffle {
            Some(_) => out.extend_from_slice(&self.held),
            None => out.extend(self.held.iter().rev()),
        }
        self.held.clear();
    }
}

impl DeliveryRule for Reorder {
    fn on_step(
        &mut self,
        incoming: &[Epoch],
        active: bool,
        now: &Context<'_>,
        out: &mut Vec<Epoch>,
    ) {
        if !active {
            self.let_out(out);
            out.extend_from_slice(incoming);
            return;
        }
        for (nth, epoch) in incoming.iter().enumerate() {
            self.held.push(*epoch);
            if let Some(stream) = &self.shuffle {
                let (last, count) = (self.held.len() - 1, self.held.len() as f64);
                let place = (now.uniforms_of(stream, nth)[0] * count) as usize;
                self.held.swap(last, place.min(last));
            }
            if self.held.len() == self.window {
                self.let_out(out);
            }
        }
    }

    fn holds(&self) -> usize {
        self.held.len()
    }

    fn most_out(&self, incoming: usize) -> usize {
        incoming + self.window - 1
    }
}
