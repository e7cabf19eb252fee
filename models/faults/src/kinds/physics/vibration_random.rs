//! Random vibration of the sensor block by its spectral density.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::plant::{EDGE, angular, frequency, not_nothing, within};
use crate::rule::{Context, FaultRule, PlantRule};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::Values;
use alloc::boxed::Box;
use alloc::format;
use alloc::vec::Vec;
use octant_random::normal::{uniform, words};
use octant_sample::disturbance::{Disturbance, Motor, SpectralLine};

/// Distance of the counters of two onsets: more than there can be lines.
const PER_FIRING: u64 = 1000;

pub(super) static VIBRATION_RANDOM: FaultKind = FaultKind {
    name: "vibration-random",
    family: Family::Physics,
    acts: Acts::Plant,
    summary: "The sensor block vibrates at random, with a flat spectrum between two frequencies.",
    model: "The sensor block moves against the gimballed body as one rigid body. On each body axis \
            its linear acceleration has the one-sided spectral density S ((m/s²)²/Hz, written in \
            g²/Hz) between f1 and f2 and nothing outside, and its angular rate a flat one of the \
            given rms in the same band. Both are sums of N lines, one in each of N bins of the \
            width Δf = (f2 − f1)/N, the frequency drawn within the bin and the phases within a \
            turn:\n\n\
            \u{20}   r̈ = Σ √(2 S Δf) sin(2πf_i t + φ_i)      rms √(S (f2 − f1))\n\
            \u{20}   θ̇ = Σ σ √(2/N) cos(2πf_i t + ψ_i)       rms σ\n\n\
            A sum's rms over a long time is exactly that; in one second of it, it differs by \
            the chance of few lines. Peaks are those of a Gaussian process up to √(2N) of the rms. \
            Axes are independent of each other, and rotation of displacement. As the \
            frequencies are drawn, the sum doesn't repeat.\n\n\
            Window, what the sensors feel, truth, and what is left after the end are those of \
            vibration-sine. The numbers come from the fault's own streams x, y and z; each onset \
            draws its own.\n\n\
            Real spectra have slopes and resonances: give several faults, one for each band. See \
            IEC 60068-2-64 and RTCA DO-160 section 8 for levels.",
    parameters: &[
        FaultParameter {
            name: "psd",
            takes: Takes::Vector(&[Dimension::AccelerationPsd]),
            default: Some(r#"["0 g^2/Hz", "0 g^2/Hz", "0 g^2/Hz"]"#),
            doc: "Spectral density S of the linear acceleration along each body axis, one-sided.",
        },
        FaultParameter {
            name: "rate",
            takes: Takes::Vector(&[Dimension::AngularRate]),
            default: Some(r#"["0 deg/s", "0 deg/s", "0 deg/s"]"#),
            doc: "Rms σ of the angular rate about each body axis.",
        },
        FaultParameter {
            name: "low_frequency",
            takes: Takes::Quantity(&[Dimension::Frequency], ParameterBounds::Positive),
            default: Some("20 Hz"),
            doc: "Lower corner f1.",
        },
        FaultParameter {
            name: "high_frequency",
            takes: Takes::Quantity(&[Dimension::Frequency], ParameterBounds::Positive),
            default: Some("500 Hz"),
            doc: "Upper corner f2, above the lower one, at most 100 periods in a sample.",
        },
        FaultParameter {
            name: "lines",
            takes: Takes::Integer(10, 500),
            default: Some("100"),
            doc: "Number N of lines on each axis.",
        },
        EDGE,
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("psd", r#"["0.01 g^2/Hz", "0.01 g^2/Hz", "0.01 g^2/Hz"]"#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let psd = values.vector("psd")?;
    let rate = values.vector("rate")?;
    not_nothing("psd", "rate", [&psd, &rate])?;
    for (name, vector) in [("psd", &psd), ("rate", &rate)] {
        if let Some(value) = vector.iter().find(|value| !(**value >= 0.0)) {
            let problem = format!("{value} was found, 0 or more is expected");
            return Err(FaultBuildError::value(name, problem));
        }
    }
    let low_hz = frequency(values, "low_frequency", setup)?;
    let high_hz = frequency(values, "high_frequency", setup)?;
    if high_hz <= low_hz {
        let problem = format!("{high_hz} Hz was found, more than {low_hz} Hz is expected");
        return Err(FaultBuildError::value("high_frequency", problem));
    }
    let lines = values.integer("lines")?;
    let random = Random {
        psd,
        rate,
        low_hz,
        bin_hz: (high_hz - low_hz) / lines as f64,
        lines: lines as u64,
        edge_s: values.quantity("edge")?,
        streams: ["x", "y", "z"].map(|axis| setup.stream(axis)),
    };
    let displacement = psd.map(|psd| random.acceleration(psd) / square(angular(low_hz)));
    within("psd", &displacement, 1.0, "m of displacement in a line")?;
    let angle = rate.map(|rate| random.rate(rate) / angular(low_hz));
    within("rate", &angle, 1.0, "rad in a line")?;
    Ok(FaultRule::Plant(Box::new(random)))
}

fn square(value: f64) -> f64 {
    value * value
}

#[derive(Clone, Debug)]
struct Random {
    psd: [f64; 3],
    rate: [f64; 3],
    low_hz: f64,
    bin_hz: f64,
    lines: u64,
    edge_s: f64,
    streams: [Stream; 3],
}

octant_state::state! { Random { values: ; parts: ; kept: psd, rate, low_hz, bin_hz, lines, edge_s, streams } }

impl Random {
    /// Amplitude of the acceleration of a line.
    fn acceleration(&self, psd: f64) -> f64 {
        libm::sqrt(2.0 * psd * self.bin_hz)
    }

    /// Amplitude of the angular rate of a line.
    fn rate(&self, rms: f64) -> f64 {
        rms * libm::sqrt(2.0 / self.lines as f64)
    }
}

impl PlantRule for Random {
    fn begin(&mut self, now: &Context<'_>, _: &Motor) -> Disturbance {
        let mut lines = Vec::with_capacity(3 * self.lines as usize);
        for axis in 0..3 {
            if self.psd[axis] == 0.0 && self.rate[axis] == 0.0 {
                continue;
            }
            let key = self.streams[axis].key(now.phase);
            for index in 0..self.lines {
                let counter = u64::from(now.firing) * PER_FIRING + index;
                let [place, phase, angle_phase, _] = words(key, counter).map(uniform);
                let frequency_hz = self.low_hz + (index as f64 + place) * self.bin_hz;
                let omega = angular(frequency_hz);
                let mut line = SpectralLine {
                    frequency_hz,
                    displacement_m: [0.0; 3],
                    angle_rad: [0.0; 3],
                    phase_rad: angular(phase),
                    angle_phase_rad: angular(angle_phase),
                };
                line.displacement_m[axis] = -self.acceleration(self.psd[axis]) / square(omega);
                line.angle_rad[axis] = self.rate(self.rate[axis]) / omega;
                lines.push(line);
            }
        }
        Disturbance::Vibration { lines, edge_s: self.edge_s }
    }
}
