//! Samples that are lost.

use crate::catalogue::{Acts, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::kinds::parameters;
use crate::kinds::parameters::LOSS;
use crate::rule::{Context, DeliveryRule, FaultRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::Values;
use alloc::boxed::Box;
use alloc::vec::Vec;
use octant_sample::{Aiding, Epoch};

pub(super) static DROPOUT: FaultKind = FaultKind {
    name: "dropout",
    family: Family::Time,
    acts: Acts::Delivery,
    summary: "Samples are lost on their way: all of them, or some at random.",
    model: "While it lasts, every epoch is lost with a probability, each on its own:\n\n\
            \u{20}   P(lost) = loss\n\n\
            What is lost has had its number and its stamp: the samples after it are as they were, \
            and numbers and stamps jump. Its increments never come: rotation and velocity of those \
            intervals are missing for good. Loss in bursts is this fault with a duration of its \
            own and a trigger at random.\n\n\
            Aiding that belongs to a lost sample is lost with it, or, with `aiding = \"kept\"`, \
            goes with the next sample that arrives, with its old stamp; where that one has aiding \
            of its own, the older message is lost. Nothing is left at the end, but for a message \
            that was kept.",
    parameters: &[
        LOSS,
        FaultParameter {
            name: "aiding",
            takes: Takes::Choice(&[
                ("lost", "it is lost with its sample: they share a link"),
                ("kept", "it goes with the next sample that arrives: it has a link of its own"),
            ]),
            default: Some("lost"),
            doc: "What becomes of aiding that belongs to a lost sample.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.1 s""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Delivery(Box::new(Dropout {
        loss: parameters::loss(values)?,
        keeps_aiding: values.choice("aiding")? == "kept",
        stream: setup.stream("loss"),
        kept: None,
    })))
}

#[derive(Clone, Debug)]
struct Dropout {
    loss: f64,
    keeps_aiding: bool,
    stream: Stream,
    kept: Option<Aiding>,
}

octant_state::state! { Dropout { values: kept; parts: ; kept: loss, keeps_aiding, stream } }

impl DeliveryRule for Dropout {
    fn on_step(
        &mut self,
        incoming: &[Epoch],
        active: bool,
        now: &Context<'_>,
        out: &mut Vec<Epoch>,
    ) {
        for (nth, epoch) in incoming.iter().enumerate() {
            if active && now.uniforms_of(&self.stream, nth)[0] < self.loss {
                if self.keeps_aiding && epoch.aiding.is_some() {
                    self.kept = epoch.aiding;
                }
                continue;
            }
            let kept = self.kept.take();
            out.push(Epoch { aiding: epoch.aiding.or(kept), ..*epoch });
        }
    }

    fn holds(&self) -> usize {
        usize::from(self.kept.is_some())
    }

    fn most_out(&self, incoming: usize) -> usize {
        incoming
    }
}
