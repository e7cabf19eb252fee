//! Clocks with a wrong rate: too fast or slow, stopped, backwards.

use super::clock::{AFTERWARDS, CLOCK, Clocks, stays, to_ns};
use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static CLOCK_SKEW: FaultKind = FaultKind {
    name: "clock-skew",
    family: Family::Time,
    acts: Acts::Samples,
    summary: "The clock runs too fast or too slow: stamps drift.",
    model: "From its onset t₀ (the start of the first interval that it alters) the clock is wrong \
            by a part of the time that passes:\n\n\
            \u{20}   t' = t + e₀ + round(skew · (t − t₀))\n\n\
            in whole nanoseconds, computed from t and not summed, so that nothing but the skew \
            accumulates; e₀ is the error that was left from onsets before. Every interval is \
            longer by the skew: a core that multiplies by the interval between stamps takes that \
            part of gravity, Earth rate and biases for motion. Crystal oscillators are off by 1 to \
            100 ppm, temperature-compensated ones by 0.1 to 2 ppm.\n\n\
            At its end the rate is right again; the error that has built up stays to the end of \
            the run, or is corrected in one jump (`afterwards`).",
    parameters: &[
        FaultParameter {
            name: "skew",
            takes: Takes::Quantity(&[Dimension::Ratio], ParameterBounds::NotZero),
            default: None,
            doc: "Relative error of the clock's rate; positive: stamps run ahead. Above -1.",
        },
        CLOCK,
        FaultParameter {
            name: "afterwards",
            takes: Takes::Choice(AFTERWARDS),
            default: Some("stays"),
            doc: "What becomes of the error at the end of the fault.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("skew", r#""50 ppm""#)]),
    build: build_skew,
};

fn build_skew(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let skew = values.quantity("skew")?;
    if !(skew > -1.0) {
        let problem = alloc::format!(
            "{skew}, a value above -1 is expected: at -1 the clock stands (frozen-clock), below \
             it runs backwards (time-backwards)"
        );
        return Err(FaultBuildError::value("skew", problem));
    }
    rate(skew, values, setup)
}

pub(super) static FROZEN_CLOCK: FaultKind = FaultKind {
    name: "frozen-clock",
    family: Family::Time,
    acts: Acts::Samples,
    summary: "The clock stands still: every stamp is the same.",
    model: "While it lasts, every stamp is the time at which the clock stopped, the end of the \
            last interval before the onset t₀:\n\n\
            \u{20}   t' = t₀ + e₀      e₀: error that was left from onsets before\n\n\
            Samples and their numbers go on. A core that trusts stamps refuses the samples: no \
            time has passed. At its end the clock shows the right time at once, as where a stale \
            register was read, and the stamps jump by the length of the fault; or, with \
            `afterwards = \"stays\"`, it goes on from where it stood, as a counter that was \
            stopped, and is slow by the length of the fault to the end of the run.",
    parameters: &[
        CLOCK,
        FaultParameter {
            name: "afterwards",
            takes: Takes::Choice(AFTERWARDS),
            default: Some("corrected"),
            doc: "What becomes of the error at the end of the fault.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.1 s""#)]),
    build: build_frozen,
};

fn build_frozen(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    rate(-1.0, values, setup)
}

pub(super) static TIME_BACKWARDS: FaultKind = FaultKind {
    name: "time-backwards",
    family: Family::Time,
    acts: Acts::Samples,
    summary: "The clock runs backwards: every stamp is before the last one.",
    model: "While it lasts, the clock goes back from its onset t₀ (the start of the first interval \
            that it alters):\n\n\
            \u{20}   t' = t₀ + e₀ − round(speed · (t − t₀))      e₀: error left from onsets before\n\n\
            in whole nanoseconds, and never below zero. Samples and their numbers go on. At its \
            end the clock shows the right time at once, a jump ahead of (1 + speed) times the \
            length of the fault; or, with `afterwards = \"stays\"`, it runs forwards from where it \
            came to, so that stamps of before the fault come again.\n\n\
            Of real clocks: a time base that is disciplined too hard, or a counter read while it \
            is reversed. A single jump back is `time-step` with a negative step.",
    parameters: &[
        FaultParameter {
            name: "speed",
            takes: Takes::Quantity(&[Dimension::Ratio], ParameterBounds::Positive),
            default: Some("100 %"),
            doc: "How fast the stamps go back, relative to how fast time passes.",
        },
        CLOCK,
        FaultParameter {
            name: "afterwards",
            takes: Takes::Choice(AFTERWARDS),
            default: Some("corrected"),
            doc: "What becomes of the error at the end of the fault.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""0.1 s""#)]),
    build: build_backwards,
};

fn build_backwards(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    rate(-1.0 - values.quantity("speed")?, values, setup)
}

fn rate(change: f64, values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Samples(Box::new(WrongRate {
        clocks: Clocks::of(values)?,
        change,
        stays: stays(values)?,
        period_ns: setup.sample_period_ns,
        start_ns: 0,
        left_ns: 0,
        gained_ns: 0,
        elapsed_ns: 0,
    })))
}

#[derive(Clone, Debug)]
struct WrongRate {
    clocks: Clocks,
    /// Error of the clock's rate.
    change: f64,
    stays: bool,
    period_ns: u64,
    /// True time at which the rate went wrong.
    start_ns: u64,
    /// Error left from earlier onsets.
    left_ns: i64,
    /// Error gained since the onset.
    gained_ns: i64,
    elapsed_ns: u64,
}

octant_state::state! { WrongRate { values: start_ns, left_ns, gained_ns, elapsed_ns; parts: ; kept: clocks, change, stays, period_ns } }

impl WrongRate {
    fn error_ns(&self) -> i64 {
        self.left_ns.saturating_add(self.gained_ns)
    }
}

impl SampleRule for WrongRate {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        let stamp_ns = epoch.sample.device_time.ns;
        if now.since_onset == 0 {
            self.left_ns = if self.stays { self.error_ns() } else { 0 };
            (self.gained_ns, self.elapsed_ns) = (0, 0);
            self.start_ns = stamp_ns.saturating_sub(self.period_ns);
        }
        let (start_ns, left_ns, change) = (self.start_ns, self.left_ns, self.change);
        let gained = |ns: u64| to_ns(change * ns.saturating_sub(start_ns) as f64);
        // A late sample was stamped earlier, but must not make the error smaller.
        self.elapsed_ns = self.elapsed_ns.max(stamp_ns.saturating_sub(start_ns));
        self.gained_ns = gained(start_ns.saturating_add(self.elapsed_ns));
        self.clocks.shift_by(epoch, |ns| left_ns.saturating_add(gained(ns)));
    }

    fn lingers(&self) -> bool {
        self.stays && self.error_ns() != 0
    }

    fn afterwards(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        self.clocks.shift(epoch, self.error_ns());
    }
}
