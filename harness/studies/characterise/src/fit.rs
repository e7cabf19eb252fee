//! Noise terms that describe the Hadamard variances of a record.
//!
//! The variance at an octave is a sum of the terms with squared coefficients that aren't negative. Hadamard's doesn't
//! see a steady change of the rate, so that a drift can't be taken for a random walk. An estimate V with ν degrees of
//! freedom is the model m times χ²/ν, and the coefficients have the least deviance
//!
//! ```text
//! D = Σ ν (V/m − 1 − ln V/m)
//! ```
//!
//! by Fisher's scoring. Octaves share the samples of the record, so D isn't −2 ln of their likelihood: it is that of
//! a composite likelihood. Its rise about the minimum along a coefficient is a χ² with one degree of freedom times
//!
//! ```text
//! a = (H⁻¹ J H⁻¹) / (H⁻¹)     H = Σ ν ∇m ∇mᵀ / 2m²,   J = covariance of Σ ν ∇m (V − m) / 2m²
//! ```
//!
//! (Varin, Reid, Firth: An overview of composite likelihood methods, Statistica Sinica 21, 2011). J is exact: it
//! follows from the covariances among the variances of the model ([`super::freedom`]), as in the generalized method of
//! wavelet moments (Guerrier et al., JASA 108, 2013). An interval of 95 % has D − D_min ≤ 3.84 a, with a at its ends.
//!
//! A term that left, but lowers D by more than a, may be there all the same: the intervals of the others span those of the
//! models with and without it. So do they for the Gauss-Markov term, where it isn't shown but lowers D by more than 6.63 a,
//! the criterion of the other terms: flicker noise and a random walk can stand for it, and the other intervals would be
//! those of a wrong model.
//!
//! A term is in the model if D rises by more than 6.63 a without it (99 % of χ²); the least needed leaves first. A
//! term outside gets the upper end of its interval of 95 % as a limit. The Gauss-Markov term enters last, if it lowers D by more than 13.8 a
//! (99.9 % for its two parameters), since some correlation time fits some part of any record.

mod choice;
mod intervals;
mod scoring;
mod uncertainty;

use super::freedom::{Covariances, SquaredCoefficients, chi_squared_quantile};
use super::kernel::{DifferenceOrder, Kernel, RandomTerm, TERMS};
use choice::{Choice, Chosen, GAUSS_MARKOV, LEAVES, Rival, reduce};
use intervals::{Parameter, limit, profile, span, widened};
use scoring::{Model, Rows};
use serde::Serialize;
use std::collections::BTreeMap;
use std::rc::Rc;
use uncertainty::Uncertainty;

/// Fall of the deviance, as χ², above which the Gauss-Markov term enters.
pub const ENTERS: f64 = 13.815_510_557_964_274;
/// Fall of the deviance, as χ², above which the Gauss-Markov term widens the intervals of the others without being shown.
const RIVALS: f64 = LEAVES;
/// Degrees of freedom below which a variance is left out.
const FREEDOM_MIN: f64 = 2.0;
/// Rounds in which degrees of freedom and terms find each other.
const ROUNDS: usize = 3;
/// Correlation times that are tried in an octave.
const TIMES_IN_OCTAVE: i32 = 3;
/// Octaves below which nothing is fitted.
const OCTAVES_MIN: usize = 4;

/// Coefficient of a term.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TermFit {
    /// Term.
    pub term: RandomTerm,
    /// Best value; `None`: the record doesn't show it.
    pub value: Option<f64>,
    /// Interval of 95 %; without a value from 0 to the upper end of the interval.
    pub interval: [f64; 2],
}

/// Correlation time of the Gauss-Markov term.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TimeFit {
    /// Best value, s.
    pub value_s: f64,
    /// Interval of 95 %, s.
    pub interval_s: [f64; 2],
}

/// Terms that describe a channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RandomTermsFit {
    /// Random terms, in the order of [`RandomTerm::ALL`]. The Gauss-Markov term has no limit where it isn't shown: it
    /// would be one for each correlation time.
    pub terms: Vec<TermFit>,
    /// Correlation time, where the Gauss-Markov term is shown.
    pub correlation_time: Option<TimeFit>,
    /// Deviance of the fit.
    pub deviance: f64,
    /// Probability of a larger deviance if the terms are true.
    pub probability: f64,
    #[serde(skip)]
    squares: SquaredCoefficients,
    #[serde(skip)]
    kernel_time_s: f64,
    #[serde(skip)]
    wide: (SquaredCoefficients, f64),
    #[serde(skip)]
    covariance: [[f64; TERMS]; TERMS],
}

impl RandomTermsFit {
    /// Squared coefficients of the terms that are shown.
    #[must_use]
    pub fn squares(&self) -> SquaredCoefficients {
        self.squares
    }

    /// Covariances of the phase under the terms.
    #[must_use]
    pub fn kernel(&self, period_s: f64) -> Kernel {
        Kernel { period_s, correlation_time_s: self.kernel_time_s }
    }

    /// Squared coefficients of the model with the terms that may be there too, and covariances of the phase under it.
    #[must_use]
    pub fn wide(&self, period_s: f64) -> (SquaredCoefficients, Kernel) {
        (self.wide.0, Kernel { period_s, correlation_time_s: self.wide.1 })
    }

    /// Covariance of two squared coefficients of [`Self::wide`].
    #[must_use]
    pub fn covariance(&self) -> &[[f64; TERMS]; TERMS] {
        &self.covariance
    }

    /// Estimate of a term.
    #[must_use]
    pub fn term(&self, term: RandomTerm) -> Option<&TermFit> {
        self.terms.iter().find(|fit| fit.term == term)
    }
}

/// Parts of a fit that depend on the length of the record alone.
#[derive(Debug)]
pub struct NoiseFitter {
    period_s: f64,
    stretches: Vec<u64>,
    octaves: Vec<u64>,
    /// By the number of the correlation time in a grid of quarters of an octave.
    covariances: BTreeMap<i32, Rc<Covariances>>,
}

impl NoiseFitter {
    /// Prepares fits of records with these stretches, in samples.
    #[must_use]
    pub fn new(period_s: f64, stretches: &[u64]) -> Self {
        let longest = stretches.iter().copied().max().unwrap_or(0);
        let octaves = (0..40).map(|k| 1u64 << k).take_while(|m| 3 * m <= longest).collect();
        Self { period_s, stretches: stretches.to_vec(), octaves, covariances: BTreeMap::new() }
    }

    /// Averaging times of the Hadamard variances that are fitted, in samples.
    #[must_use]
    pub fn octaves(&self) -> &[u64] {
        &self.octaves
    }

    fn covariances(&mut self, time_s: f64) -> Rc<Covariances> {
        let number = (4.0 * libm::log2(time_s / self.period_s)).round() as i32;
        let Self { period_s, octaves, stretches, .. } = self;
        let near_s = *period_s * libm::exp2(f64::from(number) / 4.0);
        let kernel = Kernel { period_s: *period_s, correlation_time_s: near_s };
        let made = self.covariances.entry(number);
        made.or_insert_with(|| Rc::new(Covariances::new(&kernel, octaves, stretches))).clone()
    }

    /// Fits the Hadamard variances at [`Self::octaves`]; `None` where too few of them are above zero.
    #[must_use]
    pub fn fit(&mut self, hadamard: &[f64]) -> Option<RandomTermsFit> {
        let tau_s: Vec<f64> =
            self.octaves.iter().map(|samples| *samples as f64 * self.period_s).collect();
        let span_s = self.stretches.iter().copied().max().unwrap_or(0) as f64 * self.period_s;
        let mut model = Model::white(hadamard, &tau_s);
        let mut chosen = None;
        for _ in 0..ROUNDS {
            let covariances = self.covariances(model.time_s);
            let rows =
                Rows::new((&tau_s, hadamard, self.period_s), &model, &covariances, FREEDOM_MIN);
            if rows.len() < OCTAVES_MIN {
                return None;
            }
            let found = self.choose(&rows, &covariances, span_s)?;
            model = found.chosen.model;
            chosen = Some((rows, found));
        }
        let (rows, found) = chosen?;
        let covariances = self.covariances(found.chosen.model.time_s);
        Some(finish(&rows, &covariances, &found))
    }

    /// Chooses the terms.
    fn choose(&mut self, rows: &Rows, covariances: &Covariances, span_s: f64) -> Option<Choice> {
        let linear: Vec<usize> = (0..TERMS - 1).collect();
        let without = reduce(rows, covariances, &linear, 4.0 * self.period_s, None)?;
        // The correlation time that fits best beside all other terms.
        let first_s = 4.0 * self.period_s;
        let steps = (libm::log2(span_s / 6.0 / first_s) * f64::from(TIMES_IN_OCTAVE)) as i32;
        let all: Vec<usize> = (0..TERMS).collect();
        let times = (0..=steps.max(0))
            .map(|step| first_s * libm::exp2(f64::from(step) / f64::from(TIMES_IN_OCTAVE)));
        let fits = times.filter_map(|time_s| rows.fit(&all, None, time_s));
        let best = fits.min_by(|a, b| a.deviance.total_cmp(&b.deviance))?;
        // Not worth the covariances of this time: the factor a is rarely below 1/2.
        let falls = without.model.deviance - best.deviance;
        if falls < 0.5 * RIVALS || best.squares[GAUSS_MARKOV] <= 0.0 {
            return Some(Choice { chosen: without, rival: None });
        }
        let with_time = self.covariances(best.time_s);
        let mut with = reduce(rows, &with_time, &all, best.time_s, None)?;
        let needs = with.shows(GAUSS_MARKOV);
        if !needs {
            with = reduce(rows, &with_time, &all, best.time_s, Some(GAUSS_MARKOV))?;
        }
        if !with.shows(GAUSS_MARKOV) {
            return Some(Choice { chosen: without, rival: None });
        }
        let a = Uncertainty::of(rows, &with_time, &with.model, &with.free).factor(GAUSS_MARKOV);
        let falls = (without.model.deviance - with.model.deviance) / a;
        if needs && falls > ENTERS {
            return Some(Choice { chosen: with, rival: None });
        }
        let rival = (falls > RIVALS).then_some(Rival { chosen: with, covariances: with_time });
        Some(Choice { chosen: without, rival })
    }
}

/// Adds intervals and limits.
fn finish(rows: &Rows, covariances: &Covariances, choice: &Choice) -> RandomTermsFit {
    let Choice { chosen, rival } = choice;
    let Chosen { free, model } = chosen;
    let wider = widened(rows, covariances, chosen);
    let estimate = |index: usize| {
        let shown = chosen.shows(index);
        let own = if shown {
            let [a, b] = [chosen, &wider]
                .map(|model| profile(rows, covariances, model, Parameter::Square(index)));
            span(a, b)
        } else {
            [0.0, limit(rows, covariances, chosen, index)]
        };
        let interval = rival.as_ref().map_or(own, |rival| span(own, rival.interval(rows, index)));
        TermFit {
            term: RandomTerm::ALL[index],
            value: shown.then(|| libm::sqrt(model.squares[index])),
            interval: interval.map(libm::sqrt),
        }
    };
    let shows_time = chosen.shows(GAUSS_MARKOV);
    let uncertainty = Uncertainty::of(rows, covariances, model, free);
    let (mean, variance) = uncertainty.deviance(rows, covariances, model);
    RandomTermsFit {
        terms: (0..TERMS)
            .filter(|index| *index != GAUSS_MARKOV || shows_time)
            .map(estimate)
            .collect(),
        correlation_time: shows_time.then(|| TimeFit {
            value_s: model.time_s,
            interval_s: profile(rows, covariances, &wider, Parameter::Time),
        }),
        deviance: model.deviance,
        probability: exceeded(model.deviance, mean, variance),
        squares: model.squares,
        kernel_time_s: model.time_s,
        wide: (wider.model.squares, wider.model.time_s),
        covariance: Uncertainty::of(rows, covariances, &wider.model, &wider.free).covariance(),
    }
}

/// Probability that a scaled χ² of this mean and variance is above a value.
fn exceeded(value: f64, mean: f64, variance: f64) -> f64 {
    let freedom = 2.0 * mean * mean / variance;
    let scaled = value * freedom / mean;
    // By bisection of the quantile, which has the cases of many degrees of freedom.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if chi_squared_quantile(middle, freedom) < scaled { low = middle } else { high = middle }
    }
    1.0 - 0.5 * (low + high)
}

/// Variance of the terms of a model at an averaging time.
#[must_use]
pub fn variance_of(
    kernel: &Kernel,
    squares: &SquaredCoefficients,
    order: DifferenceOrder,
    tau_s: f64,
) -> f64 {
    let of = |(term, square): (&RandomTerm, &f64)| {
        if *square > 0.0 { square * kernel.variance(*term, order, tau_s) } else { 0.0 }
    };
    RandomTerm::ALL.iter().zip(squares).map(of).sum()
}
