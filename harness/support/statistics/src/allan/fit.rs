//! Noise terms that describe an Allan variance.
//!
//! The variance is a sum of the terms with squared coefficients that aren't negative. An estimate with ν
//! degrees of freedom is the true variance times χ²/ν. So the best coefficients have the least deviance
//!
//! ```text
//! D = Σ ν (V/m − 1 − ln V/m)        V estimate, m sum of the terms
//! ```
//!
//! found by least squares with the weights ν / (2 m²), repeated until m settles (Fisher's scoring). Each
//! step takes the best of all choices of terms whose coefficients come out positive.
//!
//! Octaves of one record share its samples, and the deviance counts them as independent. So its rise
//! about the minimum is more than χ² of one degree of freedom: in simulations its mean is 1.8 to 2.7 for
//! quantization, random walk and bias instability, 2.9 to 4.0 for the rate random walk. Intervals and
//! decisions take 2.5 and 4 (`shared`). A term is resolved if the interval of 95 % of its coefficient
//! excludes zero; the others leave the fit, the least needed first, and get an upper bound of 95 %. A few
//! stretches of a rate random walk look like a ramp: a ramp leaves first unless it is needed beside it.

use super::freedom::{DifferenceCounts, interval};
use super::term::NoiseTerm;

/// Number of terms.
const COUNT: usize = NoiseTerm::COUNT;
/// 95th percentile of χ² with one degree of freedom, two-sided and one-sided.
const TWO_SIDED: f64 = 3.841_458_820_694_124;
const ONE_SIDED: f64 = 2.705_543_454_095_404;
/// Degrees of freedom below which an estimate is left out: its interval spans a factor of 5 and more.
const FREEDOM_MIN: f64 = 3.0;
/// Rounds in which degrees of freedom and terms find each other.
const ROUNDS: usize = 4;
/// Largest number of steps of a fit, and the change of the deviance at which it ends.
const STEPS_MAX: usize = 60;
const SETTLED: f64 = 1e-9;
/// Steps of a search for the end of an interval: nine digits.
const HALVINGS: usize = 30;

/// Factor by which the deviance rises more than χ² where octaves share their samples.
const fn shared(term: NoiseTerm) -> f64 {
    match term {
        NoiseTerm::Quantization | NoiseTerm::RandomWalk | NoiseTerm::BiasInstability => 2.5,
        NoiseTerm::RateRandomWalk | NoiseTerm::RateRamp => 4.0,
    }
}

/// Estimate of the Allan variance at one averaging time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllanPoint {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Variance.
    pub variance: f64,
    /// Differences that it is the mean square of.
    pub counts: DifferenceCounts,
}

/// Estimate with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllanEstimate {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Variance.
    pub variance: f64,
    /// Degrees of freedom.
    pub freedom: f64,
    /// Interval of 95 % of the variance.
    pub interval: [f64; 2],
}

/// Coefficient of a term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermEstimate {
    /// Best value; `None`: not resolved.
    pub value: Option<f64>,
    /// Interval of 95 %; of a term that isn't resolved from 0 to an upper bound of 95 %.
    pub interval: [f64; 2],
}

/// Terms that describe the estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseFit {
    /// Coefficients, in the order of [`NoiseTerm::ALL`]; `None`: not looked for.
    pub terms: [Option<TermEstimate>; COUNT],
    /// Deviance, and its degrees of freedom: estimates minus resolved terms.
    pub deviance: f64,
    /// Degrees of freedom of the deviance.
    pub freedom: usize,
}

impl NoiseFit {
    /// Allan variance of the resolved terms at an averaging time, s.
    #[must_use]
    pub fn variance(&self, tau_s: f64) -> f64 {
        let of = |(term, estimate): (&NoiseTerm, &Option<TermEstimate>)| {
            let value = estimate.and_then(|estimate| estimate.value).unwrap_or(0.0);
            value * value * term.variance(tau_s)
        };
        NoiseTerm::ALL.iter().zip(&self.terms).map(of).sum()
    }
}

/// Allan variance of a sensor with its uncertainty, and the terms that describe it.
#[derive(Clone, Debug, PartialEq)]
pub struct AllanAnalysis {
    /// Estimates with at least three degrees of freedom, the shortest averaging time first.
    pub estimates: Vec<AllanEstimate>,
    /// Terms; `None` for fewer than three estimates above zero.
    pub fit: Option<NoiseFit>,
}

/// Analyses estimates of one sensor; `terms` are those that are looked for.
///
/// The degrees of freedom depend on the terms, and the weights of the fit on the degrees of freedom: both
/// are computed in turn, from white noise on.
#[must_use]
pub fn analyse(points: &[AllanPoint], terms: &[NoiseTerm]) -> AllanAnalysis {
    let mut shares = vec![white(); points.len()];
    let mut chosen: Option<(Fitting, Chosen)> = None;
    for _ in 0..ROUNDS {
        let fitting = Fitting::new(points, &shares);
        let Some(found) = fitting.choose(terms) else { break };
        for (share, point) in shares.iter_mut().zip(points) {
            *share = found.best.shares(point.tau_s);
        }
        chosen = Some((fitting, found));
    }
    let estimate = |(point, shares): (&AllanPoint, &[f64; COUNT])| {
        let freedom = point.counts.degrees_of_freedom(shares);
        let interval = interval(point.variance, freedom);
        AllanEstimate { tau_s: point.tau_s, variance: point.variance, freedom, interval }
    };
    AllanAnalysis {
        estimates: points
            .iter()
            .zip(&shares)
            .map(estimate)
            .filter(|estimate| estimate.freedom >= FREEDOM_MIN)
            .collect(),
        fit: chosen.map(|(fitting, chosen)| fitting.finish(&chosen, terms)),
    }
}

/// Shares of the variance if all of it is a random walk.
fn white() -> [f64; COUNT] {
    let mut shares = [0.0; COUNT];
    shares[NoiseTerm::RandomWalk as usize] = 1.0;
    shares
}

/// Squared coefficients with their deviance.
#[derive(Clone, Copy, Debug)]
struct Squares {
    values: [f64; COUNT],
    deviance: f64,
}

impl Squares {
    /// Shares of the terms in the variance at an averaging time.
    fn shares(&self, tau_s: f64) -> [f64; COUNT] {
        let parts: [f64; COUNT] =
            core::array::from_fn(|i| self.values[i] * NoiseTerm::ALL[i].variance(tau_s));
        let sum: f64 = parts.iter().sum();
        parts.map(|part| part / sum)
    }
}

/// Terms that are resolved.
struct Chosen {
    free: Vec<usize>,
    best: Squares,
}

/// One estimate as the fit takes it.
struct Row {
    /// Variance.
    variance: f64,
    /// Degrees of freedom.
    freedom: f64,
    /// Variances of coefficients 1, as multiples of the estimate's variance.
    terms: [f64; COUNT],
}

/// A fit's data.
struct Fitting {
    rows: Vec<Row>,
}

impl Fitting {
    fn new(points: &[AllanPoint], shares: &[[f64; COUNT]]) -> Self {
        let row = |(point, shares): (&AllanPoint, &[f64; COUNT])| {
            let freedom = point.counts.degrees_of_freedom(shares);
            let usable = point.variance > 0.0 && point.variance.is_finite();
            (usable && freedom >= FREEDOM_MIN).then(|| Row {
                variance: point.variance,
                freedom,
                terms: NoiseTerm::ALL.map(|term| term.variance(point.tau_s)),
            })
        };
        Self { rows: points.iter().zip(shares).filter_map(row).collect() }
    }

    /// Sum of the terms at an estimate.
    fn model(row: &Row, values: &[f64; COUNT]) -> f64 {
        row.terms.iter().zip(values).map(|(term, value)| term * value).sum()
    }

    fn deviance(&self, values: &[f64; COUNT]) -> f64 {
        let of = |row: &Row| {
            let ratio = row.variance / Self::model(row, values);
            row.freedom * (ratio - 1.0 - libm::log(ratio))
        };
        self.rows.iter().map(of).sum()
    }

    /// Fits the free terms; a fixed one keeps its squared coefficient. `None` where nothing is free or
    /// fixed.
    fn fit(&self, free: &[usize], fixed: Option<(usize, f64)>) -> Option<Squares> {
        let mut model: Vec<f64> = self.rows.iter().map(|row| row.variance).collect();
        let mut best: Option<Squares> = None;
        for _ in 0..STEPS_MAX {
            let aim = self.least_squares(&model, free, fixed)?;
            let mut next = Squares { values: aim, deviance: self.deviance(&aim) };
            if let Some(best) = &best {
                let mut part = 1.0;
                while !(next.deviance <= best.deviance) && part > 1e-4 {
                    part *= 0.5;
                    next.values =
                        core::array::from_fn(|i| best.values[i] + part * (aim[i] - best.values[i]));
                    next.deviance = self.deviance(&next.values);
                }
                if !(next.deviance < best.deviance - SETTLED) {
                    break;
                }
            }
            for (model, row) in model.iter_mut().zip(&self.rows) {
                *model = Self::model(row, &next.values);
            }
            best = Some(next);
        }
        best
    }

    /// Squared coefficients by weighted least squares about a model: the best of all choices among the
    /// free terms that come out positive.
    fn least_squares(
        &self,
        model: &[f64],
        free: &[usize],
        fixed: Option<(usize, f64)>,
    ) -> Option<[f64; COUNT]> {
        let mut none = [0.0; COUNT];
        if let Some((term, value)) = fixed {
            none[term] = value;
        }
        // Normal equations of all free terms, with columns of length 1.
        let mut matrix = [[0.0; COUNT]; COUNT];
        let (mut right, mut length) = ([0.0; COUNT], [0.0; COUNT]);
        for (row, model) in self.rows.iter().zip(model) {
            let weight = 0.5 * row.freedom / (model * model);
            let rest = row.variance - Self::model(row, &none);
            for &i in free {
                right[i] += weight * row.terms[i] * rest;
                for &j in free {
                    matrix[i][j] += weight * row.terms[i] * row.terms[j];
                }
            }
        }
        for &i in free {
            length[i] = libm::sqrt(matrix[i][i]);
        }
        let mut best: Option<(f64, [f64; COUNT])> = None;
        for choice in 1u32..1 << free.len() {
            let some: Vec<usize> = free
                .iter()
                .enumerate()
                .filter(|(bit, _)| choice >> bit & 1 == 1)
                .map(|(_, i)| *i)
                .collect();
            let Some(solution) = solve(&some, &matrix, &right, &length) else { continue };
            if some.iter().any(|i| !(solution[*i] > 0.0)) {
                continue;
            }
            // Reduction of the sum of squares: the larger, the better.
            let gain: f64 = some.iter().map(|i| right[*i] * solution[*i]).sum();
            if best.as_ref().is_none_or(|(most, _)| gain > *most) {
                best = Some((gain, solution));
            }
        }
        let mut values = best.map_or([0.0; COUNT], |(_, values)| values);
        if let Some((term, value)) = fixed {
            values[term] = value;
        }
        values.iter().any(|value| *value > 0.0).then_some(values)
    }

    /// Chooses the terms: all of them first, then without those that the deviance doesn't need.
    fn choose(&self, terms: &[NoiseTerm]) -> Option<Chosen> {
        if self.rows.len() < 3 {
            return None;
        }
        let mut free: Vec<usize> = terms.iter().map(|term| *term as usize).collect();
        free.sort_unstable();
        free.dedup();
        let best = self.fit(&free, None)?;
        let mut chosen = Chosen { free, best };
        let ramp = NoiseTerm::RateRamp as usize;
        if chosen.free.len() > 1
            && chosen.free.contains(&ramp)
            && let Some((rise, without)) = self.without(&chosen, ramp)
            && rise < TWO_SIDED
        {
            chosen = without;
        }
        while chosen.free.len() > 1 {
            let all = chosen.free.iter().filter_map(|index| self.without(&chosen, *index));
            match all.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((rise, without)) if rise < TWO_SIDED => chosen = without,
                _ => break,
            }
        }
        Some(chosen)
    }

    /// Leaves a term out; returns by how much the deviance rises, as χ², and the rest.
    fn without(&self, chosen: &Chosen, index: usize) -> Option<(f64, Chosen)> {
        let free: Vec<usize> = chosen.free.iter().copied().filter(|i| *i != index).collect();
        let best = self.fit(&free, None)?;
        let rise = (best.deviance - chosen.best.deviance) / shared(NoiseTerm::ALL[index]);
        Some((rise, Chosen { free, best }))
    }

    /// Adds intervals to the resolved terms, and bounds to the others.
    fn finish(&self, chosen: &Chosen, terms: &[NoiseTerm]) -> NoiseFit {
        let estimate = |term: NoiseTerm| {
            terms.contains(&term).then(|| {
                if chosen.free.contains(&(term as usize)) {
                    self.resolved(chosen, term)
                } else {
                    TermEstimate { value: None, interval: [0.0, self.bound(chosen, term)] }
                }
            })
        };
        NoiseFit {
            terms: NoiseTerm::ALL.map(estimate),
            deviance: chosen.best.deviance,
            freedom: self.rows.len().saturating_sub(chosen.free.len()),
        }
    }

    fn resolved(&self, chosen: &Chosen, term: NoiseTerm) -> TermEstimate {
        let index = term as usize;
        let value = chosen.best.values[index];
        let others: Vec<usize> = chosen.free.iter().copied().filter(|i| *i != index).collect();
        let limit = chosen.best.deviance + TWO_SIDED * shared(term);
        let rises = |value: f64| {
            self.fit(&others, Some((index, value))).is_none_or(|found| found.deviance > limit)
        };
        let low = end(value, 0.0, &rises);
        let high = end(value, beyond(value, &rises), &rises);
        TermEstimate {
            value: Some(libm::sqrt(value)),
            interval: [libm::sqrt(low), libm::sqrt(high)],
        }
    }

    /// Upper bound of a term that isn't resolved: the others are fitted anew.
    fn bound(&self, chosen: &Chosen, term: NoiseTerm) -> f64 {
        let index = term as usize;
        let mut all = chosen.free.clone();
        all.push(index);
        let Some(best) = self.fit(&all, None) else { return f64::NAN };
        let limit = best.deviance + ONE_SIDED * shared(term);
        let rises = |value: f64| {
            self.fit(&chosen.free, Some((index, value))).is_none_or(|found| found.deviance > limit)
        };
        // The smallest value that any single estimate could notice.
        let least = |row: &Row| row.variance / row.terms[index] / row.freedom;
        let start = self.rows.iter().map(least).fold(f64::INFINITY, f64::min) * 1e-3;
        let from = best.values[index].max(start);
        libm::sqrt(end(from, beyond(from, &rises), &rises))
    }
}

/// Solves the normal equations of some terms by Cholesky's method, with columns of length 1; `None` if
/// they can't be told apart.
fn solve(
    some: &[usize],
    matrix: &[[f64; COUNT]; COUNT],
    right: &[f64; COUNT],
    length: &[f64; COUNT],
) -> Option<[f64; COUNT]> {
    let n = some.len();
    let mut factor = [[0.0; COUNT]; COUNT];
    let mut x = [0.0; COUNT];
    for i in 0..n {
        for j in 0..=i {
            let (a, b) = (some[i], some[j]);
            let mut value = matrix[a][b] / (length[a] * length[b]);
            for k in 0..j {
                value -= factor[i][k] * factor[j][k];
            }
            if i > j {
                factor[i][j] = value / factor[j][j];
            } else if value > 1e-12 {
                factor[i][i] = libm::sqrt(value);
            } else {
                return None;
            }
        }
        let mut value = right[some[i]] / length[some[i]];
        for k in 0..i {
            value -= factor[i][k] * x[k];
        }
        x[i] = value / factor[i][i];
    }
    let mut solution = [0.0; COUNT];
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= factor[k][i] * x[k];
        }
        x[i] /= factor[i][i];
        solution[some[i]] = x[i] / length[some[i]];
    }
    Some(solution)
}

/// First of the values 2, 4, 8 … times `from` at which the deviance has risen.
fn beyond(from: f64, rises: &dyn Fn(f64) -> bool) -> f64 {
    let mut value = 2.0 * from;
    while value.is_finite() && !rises(value) {
        value *= 2.0;
    }
    value
}

/// Place between `inside`, where the deviance hasn't risen, and `outside`, where it has.
fn end(inside: f64, outside: f64, rises: &dyn Fn(f64) -> bool) -> f64 {
    let (mut inside, mut outside) = (inside, outside);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        if rises(middle) { outside = middle } else { inside = middle }
    }
    0.5 * (inside + outside)
}
