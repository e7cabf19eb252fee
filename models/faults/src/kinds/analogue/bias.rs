//! A constant error that sets in at once or grows.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::Added;
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::Epoch;

const CHANNELS: FaultParameter = FaultParameter {
    name: "channels",
    takes: Takes::Channels,
    default: None,
    doc: "Channels that get the bias: gyros or accelerometers.",
};
const BIAS: Takes =
    Takes::Quantity(&[Dimension::GyroBias, Dimension::AccelBias], ParameterBounds::NotZero);

pub(super) static BIAS_STEP: FaultKind = FaultKind {
    name: "bias-step",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "A bias jumps: a constant error is added to one or more channels.",
    model: "From its onset every sample of the channels gets the bias B:\n\n\
            \u{20}   Δθ' = Δθ + s B dt      or      Δv' = Δv + s B dt\n\n\
            in counts, with the remainder carried from sample to sample: N samples get N·B·dt to \
            within half a count. s is 1 while the fault lasts and falls linearly to 0 over its \
            recovery. A sum outside the format saturates and sets the saturation flag of its \
            triad; no other flag changes.\n\n\
            A real instrument does this after a shock, a mirror contamination or a change of the \
            power supply: it is the change of the fixed drift D_F of IEEE Std 952, of the \
            accelerometer bias K_0 of IEEE Std 1293. A calibration that has the bias among its \
            states follows it as far as its process noise lets it.",
    parameters: &[
        CHANNELS,
        FaultParameter {
            name: "amplitude",
            takes: BIAS,
            default: None,
            doc: "The bias that is added: an angular rate for gyros, an acceleration for \
                  accelerometers.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("amplitude", r#""0.05 deg/h""#)]),
    build: build_step,
};

pub(super) static BIAS_RAMP: FaultKind = FaultKind {
    name: "bias-ramp",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "A bias grows linearly to a value and stays there.",
    model: "t seconds after its onset the bias is\n\n\
            \u{20}   b(t) = B t/T   for t < T,      b(t) = B   from then on,\n\n\
            and every sample of the channels gets s ∫ b dt over its interval, in counts with the \
            remainder carried: the sum over the ramp is B·T/2 to within half a count. s is 1 while \
            the fault lasts and falls linearly to 0 over its recovery. A sum outside the format \
            saturates and sets the saturation flag of its triad.\n\n\
            It is the drift rate ramp of IEEE Std 952 (R; Allan deviation R τ/√2) with an end, as \
            a warm-up or a slow leak of the cavity shows it. For a ramp without end choose `rise` \
            longer than the fault.",
    parameters: &[
        CHANNELS,
        FaultParameter {
            name: "amplitude",
            takes: BIAS,
            default: None,
            doc: "The bias that is reached: an angular rate for gyros, an acceleration for \
                  accelerometers.",
        },
        FaultParameter {
            name: "rise",
            takes: Takes::Quantity(&[Dimension::Time], ParameterBounds::Positive),
            default: None,
            doc: "Time from the onset to the full bias.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[
        ("amplitude", r#""0.05 deg/h""#),
        ("rise", r#""5 s""#),
        ("duration", r#""10 s""#),
    ]),
    build: build_ramp,
};

fn build_step(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let added = Added::of(values, "channels", "amplitude", setup)?;
    Ok(FaultRule::Samples(Box::new(Bias { added, rise_s: 0.0, onset: Onset::default() })))
}

fn build_ramp(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let added = Added::of(values, "channels", "amplitude", setup)?;
    let rise_s = values.quantity("rise")?;
    Ok(FaultRule::Samples(Box::new(Bias { added, rise_s, onset: Onset::default() })))
}

#[derive(Clone, Debug)]
struct Bias {
    added: Added,
    /// Rise time, s; 0: at once.
    rise_s: f64,
    onset: Onset,
}

octant_state::state! { Bias { values: onset; parts: added; kept: rise_s } }

impl SampleRule for Bias {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.added.clear();
        }
        let share = mean_of_ramp(now.since_onset as f64 * now.dt_s, now.dt_s, self.rise_s);
        self.added.add(&mut epoch.sample, now.strength * share);
    }
}

/// Mean of `min(t / rise, 1)` over an interval of `dt` from `start` on.
fn mean_of_ramp(start_s: f64, dt_s: f64, rise_s: f64) -> f64 {
    let end_s = start_s + dt_s;
    if start_s >= rise_s {
        1.0
    } else if end_s <= rise_s {
        (start_s + 0.5 * dt_s) / rise_s
    } else {
        let rising_s = rise_s - start_s;
        (rising_s * 0.5 * (start_s + rise_s) / rise_s + (end_s - rise_s)) / dt_s
    }
}
