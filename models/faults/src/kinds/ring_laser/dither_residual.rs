//! Dither that remains in the increments.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::{Adder, counts_per_si};
use crate::kinds::channel::gyros;
use crate::kinds::parameters::Six;
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use core::f64::consts::TAU;
use octant_sample::Epoch;

pub(super) static DITHER_RESIDUAL: FaultKind = FaultKind {
    name: "dither-residual",
    family: Family::RingLaser,
    acts: Acts::Samples,
    summary: "A part of the dither's motion is left in the increments of one or more gyros.",
    model: "The dither's angle is stripped from the gyro's counts but for a residual angle\n\n\
            \u{20}   ϑ(t) = A sin(2π f t + φ + p(t)),      t from the onset\n\n\
            and every sample of the gyros gets its difference over the interval, s (ϑ(t) − ϑ(t − \
            dt)), in counts with the remainder carried. p is a Wiener process of each gyro's own, \
            from zero, with the coefficient `phase_random_walk`: p ← p + κ √dt w with a standard \
            normal w of the sample. s is 1 while the fault lasts and falls linearly to 0 over its \
            recovery. A sum outside the format saturates and sets the saturation flag of the \
            gyros.\n\n\
            The angle is bounded by 2A at any time: it is noise in the increments, no drift. The \
            dither (Aronowitz 1971; usually 300 to 700 Hz) lies above half the sample rate, so the \
            increments show it at its alias, with the amplitude 2A |sin(π f dt)|, as in a real \
            instrument that differences its stripped angle; a frequency that is a multiple of the \
            sample rate shows nothing and is refused unless its phase walks. What coning the \
            residual makes between axes follows from the increments alone: the body doesn't move.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Gyros with the residual.",
        },
        FaultParameter {
            name: "amplitude",
            takes: Takes::Quantity(&[Dimension::SmallAngle], ParameterBounds::NotZero),
            default: None,
            doc: "A: amplitude of the residual angle.",
        },
        FaultParameter {
            name: "frequency",
            takes: Takes::Quantity(&[Dimension::Frequency], ParameterBounds::Positive),
            default: None,
            doc: "f: frequency of the dither.",
        },
        FaultParameter {
            name: "phase",
            takes: Takes::Quantity(&[Dimension::Angle], ParameterBounds::Any),
            default: Some("0 deg"),
            doc: "φ: phase at the onset.",
        },
        FaultParameter {
            name: "phase_random_walk",
            takes: Takes::Quantity(&[Dimension::AngleRandomWalk], ParameterBounds::NotNegative),
            default: Some("0 deg/sqrt(h)"),
            doc: "κ: random walk of the dither's phase (not of the residual angle); zero is a pure \
                  line.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("amplitude", r#""0.01 arcsec""#), ("frequency", r#""37 Hz""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = gyros(values, "channels")?;
    let frequency_hz = values.quantity("frequency")?;
    let walk = values.quantity("phase_random_walk")? * libm::sqrt(setup.dt_s());
    let cycles = frequency_hz * setup.dt_s();
    if walk == 0.0 && (cycles - libm::round(cycles)).abs() < 1e-9 {
        let problem = alloc::format!(
            "{frequency_hz} Hz was found, a multiple of the sample rate, which no sample shows; \
             another frequency is expected"
        );
        return Err(FaultBuildError::value("frequency", problem));
    }
    Ok(FaultRule::Samples(Box::new(DitherResidual {
        channels,
        amplitude_counts: values.quantity("amplitude")? * counts_per_si(0),
        cycles,
        phase_rad: values.quantity("phase")?,
        walk,
        noise: Six::new(setup, channels, "phase"),
        walked: [0.0; 3],
        sine: [0.0; 3],
        adder: Adder::default(),
        onset: Onset::default(),
    })))
}

#[derive(Clone, Debug)]
struct DitherResidual {
    channels: Channels,
    amplitude_counts: f64,
    /// Cycles per sample.
    cycles: f64,
    phase_rad: f64,
    /// Standard deviation of the phase's step, rad.
    walk: f64,
    noise: Six,
    walked: [f64; 3],
    /// Sine at the end of the sample before.
    sine: [f64; 3],
    adder: Adder,
    onset: Onset,
}

octant_state::state! { DitherResidual { values: walked, sine, adder, onset; parts: ; kept: channels, amplitude_counts, cycles, phase_rad, walk, noise } }

impl SampleRule for DitherResidual {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.adder.clear();
            self.walked = [0.0; 3];
            self.sine = [libm::sin(self.phase_rad); 3];
        }
        let turns = (now.since_onset + 1) as f64 * self.cycles;
        let phase = TAU * (turns - libm::floor(turns)) + self.phase_rad;
        let steps = if self.walk > 0.0 { self.noise.normals(now) } else { [0.0; 6] };
        for gyro in self.channels.iter().filter(|channel| *channel < 3) {
            self.walked[gyro] += self.walk * steps[gyro];
            let sine = libm::sin(phase + self.walked[gyro]);
            let counts = self.amplitude_counts * (sine - self.sine[gyro]);
            self.sine[gyro] = sine;
            self.adder.add(&mut epoch.sample, gyro, now.strength * counts);
        }
    }
}
