//! Stamps with noise.

use super::clock::{CLOCK, Clocks, to_ns};
use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static TIME_JITTER: FaultKind = FaultKind {
    name: "time-jitter",
    family: Family::Time,
    acts: Acts::Samples,
    summary: "Stamps carry white noise.",
    model: "While it lasts, every stamp is off by a Gaussian number of its own:\n\n\
            \u{20}   t' = t + round(s · sigma · n)      n white, normal, 1σ; s: strength\n\n\
            in whole nanoseconds, and never below zero. The increments are those of the true \
            interval: only the stamp is noisy, as where software stamps a sample when it gets \
            round to it. The error of the interval between two stamps has √2 sigma.\n\n\
            With `monotonic = true` the error is clipped below half a sample period either way, so \
            that every stamp is after the one before, at the onset and the end too: with a sigma \
            of a fifth of a period that clips 1.2 % of the stamps, far below it none. With \
            `monotonic = false` it isn't clipped, and from a sigma of about a third of a period on \
            stamps go back now and then.\n\n\
            Where one clock stamps samples and aiding (`clock = \"both\"`), they get the same \
            number. Epochs that an earlier fault delivers in one step share one too: clock faults \
            belong before faults of delivery.",
    parameters: &[
        FaultParameter {
            name: "sigma",
            takes: Takes::Quantity(&[Dimension::Time], ParameterBounds::Positive),
            default: None,
            doc: "Standard deviation of the error of a stamp.",
        },
        FaultParameter {
            name: "monotonic",
            takes: Takes::Flag,
            default: Some("true"),
            doc: "Errors are clipped below half a period, so that stamps never go back.",
        },
        CLOCK,
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("sigma", r#""0.1 ms""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let limit = if values.flag("monotonic")? {
        (setup.sample_period_ns.saturating_sub(1) / 2) as i64
    } else {
        i64::MAX
    };
    Ok(FaultRule::Samples(Box::new(TimeJitter {
        clocks: Clocks::of(values)?,
        sigma_ns: values.quantity("sigma")? * 1e9,
        limit_ns: limit,
        noise: setup.stream("jitter"),
    })))
}

#[derive(Clone, Debug)]
struct TimeJitter {
    clocks: Clocks,
    sigma_ns: f64,
    limit_ns: i64,
    noise: Stream,
}

octant_state::state! { TimeJitter { values: ; parts: ; kept: clocks, sigma_ns, limit_ns, noise } }

impl SampleRule for TimeJitter {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        let [normal, ..] = now.normals(&self.noise);
        let error_ns = to_ns(now.strength * self.sigma_ns * normal);
        self.clocks.shift(epoch, error_ns.clamp(-self.limit_ns, self.limit_ns));
    }
}
