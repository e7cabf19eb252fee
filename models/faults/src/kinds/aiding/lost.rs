//! References that are lost.

use crate::catalogue::{Acts, Example, Family, FaultKind, Lasts};
use crate::kinds::parameters;
use crate::kinds::parameters::LOSS;
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static AIDING_LOST: FaultKind = FaultKind {
    name: "aiding-lost",
    family: Family::Aiding,
    acts: Acts::Samples,
    summary: "Aiding doesn't come: no message, or only some at random.",
    model: "While it lasts, every aiding message is lost with a probability, each on its own:\n\n\
            \u{20}   P(lost) = loss\n\n\
            The samples go on untouched, without it. A core notices when aiding is due and hasn't \
            come; between messages its errors grow as in free navigation, and the parameters that \
            the reference would have shown stay as uncertain as they were. Nothing is left at its \
            end.\n\n\
            A message of an epoch that is lost altogether is `dropout`.",
    parameters: &[LOSS],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""10 s""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let (loss, stream) = (parameters::loss(values)?, setup.stream("loss"));
    Ok(FaultRule::Samples(Box::new(AidingLost { loss, stream })))
}

#[derive(Clone, Debug)]
struct AidingLost {
    loss: f64,
    stream: Stream,
}

octant_state::state! { AidingLost { values: ; parts: ; kept: loss, stream } }

impl SampleRule for AidingLost {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if epoch.aiding.is_some() && now.uniforms(&self.stream)[0] < self.loss {
            epoch.aiding = None;
        }
    }
}
