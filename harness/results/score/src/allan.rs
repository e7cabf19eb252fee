//! Allan deviation of a sensor at rest, as it stands in the summary: in the units of data sheets, with
//! intervals, and with the noise terms that describe it.

use octant_earth::units::{ARCSEC, DEG_PER_HOUR, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_statistics::allan::{AllanPoint, DifferenceCounts, NoiseTerm, analyse};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Number of noise terms.
const TERMS: usize = NoiseTerm::COUNT;
/// Unit with its SI value.
type NoiseUnit = (&'static str, f64);

/// Units of a gyro: of its deviation, and of the terms in the order of [`NoiseTerm::ALL`].
const GYRO: (NoiseUnit, [NoiseUnit; TERMS]) = (
    ("deg/h", DEG_PER_HOUR),
    [
        ("arcsec", ARCSEC),
        ("deg/sqrt(h)", DEG_PER_SQRT_HOUR),
        ("deg/h", DEG_PER_HOUR),
        ("deg/h/sqrt(h)", DEG_PER_HOUR / 60.0),
        ("deg/h/h", DEG_PER_HOUR / 3600.0),
    ],
);
/// The same of an accelerometer.
const ACCELEROMETER: (NoiseUnit, [NoiseUnit; TERMS]) = (
    ("ug", MICRO_G),
    [
        ("m/s", 1.0),
        ("ug/sqrt(Hz)", MICRO_G),
        ("ug", MICRO_G),
        ("ug/sqrt(h)", MICRO_G / 60.0),
        ("ug/h", MICRO_G / 3600.0),
    ],
);

/// Allan variance of six channels at one averaging time: gyros x, y, z, then accelerometers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestOctave {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Variances, (rad/s)² and (m/s²)².
    pub variance: [f64; 6],
    /// Differences that they are the mean squares of.
    pub counts: DifferenceCounts,
}

/// Samples of a run that were taken at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct RestRecord {
    /// Interval of the samples, s.
    pub sample_period_s: f64,
    /// True if the base may move.
    pub base_moves: bool,
    /// Number of stretches at rest.
    pub stretches: u64,
    /// Their length together, s.
    pub at_rest_s: f64,
    /// Length of the longest, s.
    pub longest_s: f64,
    /// Octaves, the shortest first.
    pub octaves: Vec<RestOctave>,
}

/// Coefficients of a simulated instrument, SI, in the order of [`NoiseTerm::ALL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstrumentNoise {
    /// Each gyro.
    pub gyro: [f64; TERMS],
    /// Each accelerometer.
    pub accelerometer: [f64; TERMS],
}

/// Allan deviation of what the source delivered at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AllanDeviation {
    /// Interval of the samples, s.
    pub sample_period_s: f64,
    /// True if the base may move: then the deviation shows the motion, and no terms are fitted.
    pub base_moves: bool,
    /// Number of stretches at rest that are pooled.
    pub stretches: u64,
    /// Their length together, s.
    pub at_rest_s: f64,
    /// Length of the longest, s.
    pub longest_s: f64,
    /// Gyros, deg/h.
    pub gyro: SensorAllan,
    /// Accelerometers, µg.
    pub accelerometer: SensorAllan,
}

/// Allan deviation of a triad.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SensorAllan {
    /// Unit of the deviation.
    pub unit: String,
    /// Body axis x.
    pub x: AxisAllan,
    /// Body axis y.
    pub y: AxisAllan,
    /// Body axis z.
    pub z: AxisAllan,
}

/// Allan deviation of one axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AxisAllan {
    /// Rows: averaging time, s; deviation; lower and upper end of its interval of 95 %; degrees of
    /// freedom.
    pub series: Vec<[f64; 5]>,
    /// Noise terms by their names; empty where the base moves, and for too few rows.
    pub terms: BTreeMap<String, NoiseTermScore>,
    /// Deviance of the fit per degree of freedom: about 1 where the terms describe the curve; null
    /// without a fit.
    pub misfit: Option<f64>,
}

/// Coefficient of a noise term.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseTermScore {
    /// Coefficient of the simulated instrument; null where the source isn't one.
    pub r#true: Option<f64>,
    /// Fitted coefficient; null: not resolved.
    pub estimate: Option<f64>,
    /// Lower end of the interval of 95 %; 0 where the term isn't resolved.
    pub low: f64,
    /// Upper end of the interval of 95 %; of a term that isn't resolved the upper bound of 95 %.
    pub high: f64,
    /// Unit.
    pub unit: String,
}

impl AllanDeviation {
    /// Analyses a record; `None` without a deviation that has three degrees of freedom.
    #[must_use]
    pub fn of(record: &RestRecord, instrument: Option<&InstrumentNoise>) -> Option<Self> {
        let axis = |channel: usize| {
            let (units, truth) = if channel < 3 {
                (&GYRO, instrument.map(|noise| &noise.gyro))
            } else {
                (&ACCELEROMETER, instrument.map(|noise| &noise.accelerometer))
            };
            AxisAllan::of(record, channel, units, truth)
        };
        let sensor = |unit: &str, first: usize| SensorAllan {
            unit: unit.to_owned(),
            x: axis(first),
            y: axis(first + 1),
            z: axis(first + 2),
        };
        let (gyro, accelerometer) = (sensor(GYRO.0.0, 0), sensor(ACCELEROMETER.0.0, 3));
        let known = |sensor: &SensorAllan| sensor.axes().iter().any(|(_, a)| !a.series.is_empty());
        (known(&gyro) || known(&accelerometer)).then_some(Self {
            sample_period_s: record.sample_period_s,
            base_moves: record.base_moves,
            stretches: record.stretches,
            at_rest_s: record.at_rest_s,
            longest_s: record.longest_s,
            gyro,
            accelerometer,
        })
    }
}

impl SensorAllan {
    /// Axes with their names.
    #[must_use]
    pub fn axes(&self) -> [(&'static str, &AxisAllan); 3] {
        [("x", &self.x), ("y", &self.y), ("z", &self.z)]
    }
}

impl AxisAllan {
    fn of(
        record: &RestRecord,
        channel: usize,
        ((_, per_unit), terms): &(NoiseUnit, [NoiseUnit; TERMS]),
        truth: Option<&[f64; TERMS]>,
    ) -> Self {
        let point = |octave: &RestOctave| AllanPoint {
            tau_s: octave.tau_s,
            variance: octave.variance[channel],
            counts: octave.counts,
        };
        let points: Vec<AllanPoint> = record.octaves.iter().map(point).collect();
        // A base that moves has no noise terms of its own.
        let wanted: &[NoiseTerm] = if record.base_moves { &[] } else { &NoiseTerm::ALL };
        let analysis = analyse(&points, wanted);
        let deviation = |variance: f64| libm::sqrt(variance) / per_unit;
        let series = analysis.estimates.iter().map(|estimate| {
            let [low, high] = estimate.interval.map(deviation);
            [estimate.tau_s, deviation(estimate.variance), low, high, estimate.freedom]
        });
        let score = |index: usize| {
            let fitted = analysis.fit.as_ref()?.terms[index]?;
            let (unit, per_unit) = terms[index];
            let score = NoiseTermScore {
                r#true: truth.map(|truth| truth[index] / per_unit),
                estimate: fitted.value.map(|value| value / per_unit),
                low: fitted.interval[0] / per_unit,
                high: fitted.interval[1] / per_unit,
                unit: unit.to_owned(),
            };
            Some((NoiseTerm::ALL[index].name().to_owned(), score))
        };
        let misfit = analysis.fit.as_ref().map(|fit| fit.deviance / fit.freedom as f64);
        Self {
            series: series.collect(),
            terms: (0..TERMS).filter_map(score).collect(),
            misfit: misfit.filter(|misfit| misfit.is_finite()),
        }
    }

    /// Deviation of the terms that `coefficient` picks, at an averaging time, s, in the unit of the
    /// series; `None` if it picks none.
    #[must_use]
    pub fn of_terms(
        &self,
        tau_s: f64,
        coefficient: impl Fn(&NoiseTermScore) -> Option<f64>,
        is_gyro: bool,
    ) -> Option<f64> {
        let ((_, per_deviation), units) = if is_gyro { &GYRO } else { &ACCELEROMETER };
        let mut variance = None;
        for (term, (_, per_unit)) in NoiseTerm::ALL.iter().zip(units) {
            let found = self.terms.get(term.name()).and_then(&coefficient);
            if let Some(value) = found.map(|value| value * per_unit) {
                let part = value * value * term.variance(tau_s);
                variance = Some(variance.unwrap_or(0.0) + part);
            }
        }
        variance.map(|variance: f64| libm::sqrt(variance) / per_deviation)
    }
}
