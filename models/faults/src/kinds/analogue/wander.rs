//! Biases that wander at random.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::{Adder, counts_per_si, fitting};
use crate::kinds::parameters::Six;
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

const CHANNELS: FaultParameter = FaultParameter {
    name: "channels",
    takes: Takes::Channels,
    default: None,
    doc: "Channels whose bias wanders, each on its own: gyros or accelerometers.",
};

pub(super) static RATE_RANDOM_WALK: FaultKind = FaultKind {
    name: "rate-random-walk",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "The bias of one or more channels walks at random, without bound.",
    model: "From its onset, and from zero, each channel has a bias of its own that is a Wiener \
            process with coefficient K:\n\n\
            \u{20}   db = K dW,      Δθ' = Δθ + s ∫ b dt      or      Δv' = Δv + s ∫ b dt\n\n\
            The integral over the sample is exact: with w, v independent standard normals of the \
            sample\n\n\
            \u{20}   ∫ b dt = b dt + K dt^1.5 (w/2 + v/√12),      b ← b + K √dt w\n\n\
            The bias has the standard deviation K √t at a time t after the onset; the Allan \
            deviation is K √(τ/3) (IEEE Std 952, rate random walk; IEEE Std 1293, acceleration \
            random walk). It is added in counts with the remainder carried. s is 1 while the fault \
            lasts and falls linearly to 0 over its recovery. A sum outside the format saturates \
            and sets the saturation flag of its triad.\n\n\
            The numbers depend on the seed, the fault's id and the sample alone.",
    parameters: &[
        CHANNELS,
        FaultParameter {
            name: "coefficient",
            takes: Takes::Quantity(
                &[Dimension::RateRandomWalk, Dimension::AccelRandomWalk],
                ParameterBounds::Positive,
            ),
            default: None,
            doc: "K: that of a rate for gyros, that of an acceleration for accelerometers.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("coefficient", r#""0.3 deg/h/sqrt(h)""#), ("duration", r#""10 s""#)]),
    build: build_walk,
};

pub(super) static GAUSS_MARKOV: FaultKind = FaultKind {
    name: "gauss-markov",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "The bias of one or more channels wanders at random about zero.",
    model: "From its onset each channel has a bias of its own, constant over a sample, that is a \
            first-order Gauss-Markov process with standard deviation σ and correlation time τ:\n\n\
            \u{20}   b ← e^(−dt/τ) b + σ √(1 − e^(−2 dt/τ)) w,      Δθ' = Δθ + s b dt  (Δv alike)\n\n\
            w is a standard normal of the sample. It starts from zero (the variance then grows as \
            σ² (1 − e^(−2t/τ))) or from a value drawn with σ (then it is stationary: \
            autocorrelation σ² e^(−|Δt|/τ)). It is added in counts with the remainder carried. s is \
            1 while the fault lasts and falls linearly to 0 over its recovery. A sum outside the \
            format saturates and sets the saturation flag of its triad.\n\n\
            It is the exponentially correlated (Markov) noise of IEEE Std 952, the usual model of \
            bias instability: temperature control, mode hopping.",
    parameters: &[
        CHANNELS,
        FaultParameter {
            name: "sigma",
            takes: Takes::Quantity(
                &[Dimension::GyroBias, Dimension::AccelBias],
                ParameterBounds::Positive,
            ),
            default: None,
            doc: "Standard deviation of the bias: an angular rate for gyros, an acceleration for \
                  accelerometers.",
        },
        FaultParameter {
            name: "correlation_time",
            takes: Takes::Quantity(&[Dimension::Time], ParameterBounds::Positive),
            default: None,
            doc: "Time over which the correlation falls to 1/e.",
        },
        FaultParameter {
            name: "start",
            takes: Takes::Choice(&[
                ("zero", "the bias starts from zero and begins to wander"),
                ("drawn", "the bias jumps to a value drawn with sigma"),
            ]),
            default: Some("zero"),
            doc: "Where the bias starts from.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[
        ("sigma", r#""0.05 deg/h""#),
        ("correlation_time", r#""2 s""#),
        ("duration", r#""10 s""#),
    ]),
    build: build_markov,
};

fn build_walk(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let coefficient = fitting(values, channels, "coefficient")?;
    let dt = setup.dt_s();
    let process = Process {
        keeps: 1.0,
        drives: coefficient * libm::sqrt(dt),
        starts: 0.0,
        bridge: 1.0 / libm::sqrt(12.0),
        mean: 0.5,
    };
    Ok(Wander::rule(channels, process, setup))
}

fn build_markov(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let sigma = fitting(values, channels, "sigma")?;
    let steps = setup.dt_s() / values.quantity("correlation_time")?;
    let drawn = values.choice("start")? == "drawn";
    let process = Process {
        keeps: libm::exp(-steps),
        drives: sigma * libm::sqrt(-libm::expm1(-2.0 * steps)),
        starts: if drawn { sigma } else { 0.0 },
        bridge: 0.0,
        mean: 1.0,
    };
    Ok(Wander::rule(channels, process, setup))
}

/// A bias from sample to sample: `b ← keeps b + drives w`; the sample gets `keeps b + drives (mean
/// w + bridge v)`. All in SI.
#[derive(Clone, Copy, Debug)]
struct Process {
    keeps: f64,
    drives: f64,
    /// Standard deviation of the initial bias.
    starts: f64,
    bridge: f64,
    mean: f64,
}

#[derive(Clone, Debug)]
struct Wander {
    channels: Channels,
    process: Process,
    counts: [f64; 6],
    walk: Six,
    second: Six,
    bias: [f64; 6],
    adder: Adder,
    onset: Onset,
}

octant_state::state! { Wander { values: bias, adder, onset; parts: ; kept: channels, process, counts, walk, second } }

impl Wander {
    fn rule(channels: Channels, process: Process, setup: &Setup) -> FaultRule {
        FaultRule::Samples(Box::new(Self {
            channels,
            process,
            counts: core::array::from_fn(|channel| setup.dt_s() * counts_per_si(channel)),
            walk: Six::new(setup, channels, "walk"),
            second: Six::new(setup, channels, "second"),
            bias: [0.0; 6],
            adder: Adder::default(),
            onset: Onset::default(),
        }))
    }
}

impl SampleRule for Wander {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        let Process { keeps, drives, starts, bridge, mean } = self.process;
        let fresh = self.onset.is_new(now);
        // The second numbers serve as the start of a Markov process and as the bridge of a walk.
        let v = if bridge > 0.0 || fresh { self.second.normals(now) } else { [0.0; 6] };
        if fresh {
            self.adder.clear();
            self.bias = v.map(|v| starts * v);
        }
        let w = self.walk.normals(now);
        for channel in self.channels.iter() {
            let kept = keeps * self.bias[channel];
            let felt = kept + drives * (mean * w[channel] + bridge * v[channel]);
            self.bias[channel] = kept + drives * w[channel];
            let counts = now.strength * felt * self.counts[channel];
            self.adder.add(&mut epoch.sample, channel, counts);
        }
    }
}
