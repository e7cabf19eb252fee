//! The rule of all faults of the wire, and parameters that they share.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::{Context, FaultRule, WireRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::Values;
use crate::wire::{Ways, WireAction, WireFault};
use alloc::boxed::Box;
use octant_random::philox::block;
use octant_random::stream::Phase;

/// Parameter for the directions in which a fault acts.
pub(super) const WAYS: FaultParameter = FaultParameter {
    name: "ways",
    takes: Takes::Choice(&[
        ("both", "what is sent to the device and what it answers"),
        ("to-device", "what is sent to the device"),
        ("to-harness", "what the device answers"),
    ]),
    default: Some("both"),
    doc: "Which ways it acts on.",
};

/// Share of the frames that a fault acts on.
pub(super) const SHARE: FaultParameter = FaultParameter {
    name: "share",
    takes: Takes::Quantity(
        &[Dimension::Ratio],
        ParameterBounds::Within(0.0, 1.0, "above 0, up to 100 %"),
    ),
    default: Some("100 %"),
    doc: "Probability that it acts on a frame, each on its own, above 0; 100 %: on all.",
};

pub(super) const fn wire(
    name: &'static str,
    summary: &'static str,
    model: &'static str,
    parameters: &'static [FaultParameter],
    lasts: Lasts,
    build: fn(&Values, &Setup) -> Result<FaultRule, FaultBuildError>,
) -> FaultKind {
    let (family, acts, example) = (Family::Wire, Acts::Wire, Example::NONE);
    FaultKind { name, family, acts, summary, model, parameters, lasts, example, build }
}

/// Makes the rule of a fault that acts on frames.
pub(super) fn rule(
    values: &Values,
    setup: &Setup,
    action: WireAction,
) -> Result<FaultRule, FaultBuildError> {
    let chance = match values.get(SHARE.name) {
        Some(_) => values.quantity(SHARE.name)?,
        None => 1.0,
    };
    if !(chance > 0.0 && chance <= 1.0) {
        let problem = alloc::format!("{chance}, a probability above 0 up to 1 is expected");
        return Err(FaultBuildError::value(SHARE.name, problem));
    }
    let ways = match values.get(WAYS.name) {
        Some(_) => values.choice(WAYS.name)?,
        None => "both",
    };
    let ways = Ways { to_device: ways != "to-harness", to_harness: ways != "to-device" };
    Ok(FaultRule::Wire(Box::new(Wire { ways, chance, action, stream: setup.stream("wire") })))
}

#[derive(Clone, Debug)]
struct Wire {
    ways: Ways,
    chance: f64,
    action: WireAction,
    stream: Stream,
}

octant_state::state! { Wire { values: ; parts: ; kept: ways, chance, action, stream } }

impl WireRule for Wire {
    fn begin(&mut self, now: &Context<'_>) -> WireFault {
        let Self { ways, chance, action, stream } = *self;
        // Each onset has its own numbers.
        let [low, high] = stream.key(Phase::Calibration);
        let key = block([low, high], [now.firing.into(), 0, 0, 0]);
        WireFault { ways, chance, action, key: [key[0], key[1]] }
    }
}

/// Makes a parameter for a time above zero.
pub(super) const fn time(
    name: &'static str,
    default: &'static str,
    doc: &'static str,
) -> FaultParameter {
    FaultParameter {
        name,
        takes: Takes::Quantity(
            &[Dimension::Time],
            ParameterBounds::Within(0.0, 3600.0, "from 0 s to 1 h"),
        ),
        default: Some(default),
        doc,
    }
}

/// Makes a parameter for a whole number.
pub(super) const fn count(
    name: &'static str,
    from: i64,
    to: i64,
    default: &'static str,
    doc: &'static str,
) -> FaultParameter {
    FaultParameter { name, takes: Takes::Integer(from, to), default: Some(default), doc }
}

pub(super) fn number(values: &Values, name: &'static str) -> Result<u32, FaultBuildError> {
    u32::try_from(values.integer(name)?).map_err(|_| FaultBuildError::missing(name))
}
