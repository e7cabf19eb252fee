//! Squared coefficients with the least deviance.

use crate::freedom::{Covariances, SquaredCoefficients};
use crate::kernel::{DifferenceOrder, Kernel, RandomTerm, TERMS};

/// Largest number of steps of a fit, and the change of the deviance at which it ends.
const STEPS_MAX: usize = 40;
const SETTLED: f64 = 1e-8;
/// Steps of the search of the correlation time, and its reach as a factor.
const TIME_STEPS: usize = 18;
const TIME_REACH: f64 = 3.0;

/// Coefficients with their deviance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    pub(super) squares: SquaredCoefficients,
    /// Correlation time, s.
    pub(super) time_s: f64,
    pub(super) deviance: f64,
}

impl Model {
    /// White noise alone, of the size of the first variance.
    pub(super) fn white(variances: &[f64], tau_s: &[f64]) -> Self {
        let mut squares = [0.0; TERMS];
        if let (Some(variance), Some(tau_s)) = (variances.first(), tau_s.first()) {
            squares[RandomTerm::RandomWalk as usize] = variance * tau_s;
        }
        Self {
            squares,
            time_s: 4.0 * tau_s.first().copied().unwrap_or(1.0),
            deviance: f64::INFINITY,
        }
    }
}

/// Coefficient that is held.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fixed {
    pub(super) index: usize,
    pub(super) value: f64,
}

/// One variance as the fit takes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Number among the octaves.
    pub(super) number: usize,
    pub(super) tau_s: f64,
    pub(super) variance: f64,
    pub(super) freedom: f64,
    /// Variances of coefficients 1; the last term follows from the correlation time.
    terms: [f64; TERMS],
}

/// Data of a fit.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    pub(super) period_s: f64,
    pub(super) all: Vec<Row>,
}

impl Rows {
    pub(super) fn new(
        (tau_s, variances, period_s): (&[f64], &[f64], f64),
        model: &Model,
        covariances: &Covariances,
        freedom_min: f64,
    ) -> Self {
        let kernel = Kernel { period_s, correlation_time_s: model.time_s };
        let row = |(number, (tau_s, variance)): (usize, (&f64, &f64))| {
            let terms =
                RandomTerm::ALL.map(|term| kernel.variance(term, DifferenceOrder::Third, *tau_s));
            let mean: f64 = terms.iter().zip(&model.squares).map(|(a, b)| a * b).sum();
            let freedom = 2.0 * mean * mean / covariances.at(number, number, &model.squares);
            let usable = *variance > 0.0 && variance.is_finite() && freedom >= freedom_min;
            usable.then_some(Row { number, tau_s: *tau_s, variance: *variance, freedom, terms })
        };
        let all = tau_s.iter().zip(variances).enumerate().filter_map(row).collect();
        Self { period_s, all }
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// Smallest squared coefficient that any variance could notice.
    pub(super) fn least(&self, index: usize) -> f64 {
        let of = |row: &Row| row.variance / row.terms[index] / row.freedom;
        1e-3 * self.all.iter().map(of).fold(f64::INFINITY, f64::min)
    }

    /// Variances of coefficients 1 at a correlation time.
    pub(super) fn terms(&self, time_s: f64) -> Vec<[f64; TERMS]> {
        let kernel = Kernel { period_s: self.period_s, correlation_time_s: time_s };
        let of = |row: &Row| {
            let mut terms = row.terms;
            terms[TERMS - 1] =
                kernel.variance(RandomTerm::GaussMarkov, DifferenceOrder::Third, row.tau_s);
            terms
        };
        self.all.iter().map(of).collect()
    }

    /// Fits the free terms and, where the Gauss-Markov term is among them or held, its correlation time from near a
    /// value.
    pub(super) fn fit_time(
        &self,
        free: &[usize],
        fixed: Option<Fixed>,
        near_s: f64,
    ) -> Option<Model> {
        let of_time = free.contains(&(TERMS - 1)) || fixed.is_some_and(|f| f.index == TERMS - 1);
        let centre = self.fit(free, fixed, near_s);
        if !of_time {
            return centre;
        }
        // Golden section in the logarithm.
        const RATIO: f64 = 0.618_033_988_749_894_9;
        let mut best = centre;
        let mut at = |place: f64| -> f64 {
            let found = self.fit(free, fixed, libm::exp(place));
            let deviance = found.map_or(f64::INFINITY, |found| found.deviance);
            if best.is_none_or(|best| deviance < best.deviance) {
                best = found;
            }
            deviance
        };
        let middle = libm::log(near_s);
        let (mut low, mut high) = (middle - TIME_REACH.ln(), middle + TIME_REACH.ln());
        let (mut a, mut b) = (high - RATIO * (high - low), low + RATIO * (high - low));
        let (mut of_a, mut of_b) = (at(a), at(b));
        for _ in 0..TIME_STEPS {
            if of_a < of_b {
                (high, b, of_b) = (b, a, of_a);
                a = high - RATIO * (high - low);
                of_a = at(a);
            } else {
                (low, a, of_a) = (a, b, of_b);
                b = low + RATIO * (high - low);
                of_b = at(b);
            }
        }
        best
    }

    /// Fits the free terms at a correlation time. `None` where nothing is free or held.
    pub(super) fn fit(&self, free: &[usize], fixed: Option<Fixed>, time_s: f64) -> Option<Model> {
        let terms = self.terms(time_s);
        let mut means: Vec<f64> = self.all.iter().map(|row| row.variance).collect();
        let mut best: Option<Model> = None;
        for _ in 0..STEPS_MAX {
            let aim = self.least_squares((&terms, &means), free, fixed)?;
            let mut next = Model { squares: aim, time_s, deviance: self.deviance(&terms, &aim) };
            if let Some(best) = &best {
                let mut part = 1.0;
                while !(next.deviance <= best.deviance) && part > 1e-4 {
                    part *= 0.5;
                    next.squares = core::array::from_fn(|i| {
                        best.squares[i] + part * (aim[i] - best.squares[i])
                    });
                    next.deviance = self.deviance(&terms, &next.squares);
                }
                if !(next.deviance < best.deviance - SETTLED) {
                    break;
                }
            }
            for (mean, terms) in means.iter_mut().zip(&terms) {
                *mean = mean_of(terms, &next.squares);
            }
            best = Some(next);
        }
        best
    }

    fn deviance(&self, terms: &[[f64; TERMS]], squares: &SquaredCoefficients) -> f64 {
        let of = |(row, terms): (&Row, &[f64; TERMS])| {
            let ratio = row.variance / mean_of(terms, squares);
            row.freedom * (ratio - 1.0 - libm::log(ratio))
        };
        self.all.iter().zip(terms).map(of).sum()
    }

    /// Weighted least squares about a model: the best of all choices among the free terms that come out positive.
    fn least_squares(
        &self,
        (terms, means): (&[[f64; TERMS]], &[f64]),
        free: &[usize],
        fixed: Option<Fixed>,
    ) -> Option<SquaredCoefficients> {
        let mut held = [0.0; TERMS];
        if let Some(Fixed { index, value }) = fixed {
            held[index] = value;
        }
        let mut matrix = [[0.0; TERMS]; TERMS];
        let mut right = [0.0; TERMS];
        for ((row, terms), mean) in self.all.iter().zip(terms).zip(means) {
            let weight = 0.5 * row.freedom / (mean * mean);
            let rest = row.variance - mean_of(terms, &held);
            for &i in free {
                right[i] += weight * terms[i] * rest;
                for &j in free {
                    matrix[i][j] += weight * terms[i] * terms[j];
                }
            }
        }
        let mut best: Option<(f64, SquaredCoefficients)> = None;
        for choice in 1u32..1 << free.len() {
            let mut some = [0; TERMS];
            let mut count = 0;
            for (bit, index) in free.iter().enumerate() {
                if choice >> bit & 1 == 1 {
                    some[count] = *index;
                    count += 1;
                }
            }
            let some = &some[..count];
            let Some(solution) = solve(some, &matrix, &right) else { continue };
            if some.iter().any(|i| !(solution[*i] > 0.0)) {
                continue;
            }
            let gain: f64 = some.iter().map(|i| right[*i] * solution[*i]).sum();
            if best.as_ref().is_none_or(|(most, _)| gain > *most) {
                best = Some((gain, solution));
            }
        }
        let mut squares = best.map_or([0.0; TERMS], |(_, squares)| squares);
        if let Some(Fixed { index, value }) = fixed {
            squares[index] = value;
        }
        squares.iter().any(|square| *square > 0.0).then_some(squares)
    }
}

fn mean_of(terms: &[f64; TERMS], squares: &SquaredCoefficients) -> f64 {
    terms.iter().zip(squares).map(|(term, square)| term * square).sum()
}

/// Solves the normal equations of some terms by Cholesky's method, with columns of length 1.
fn solve(
    some: &[usize],
    matrix: &[[f64; TERMS]; TERMS],
    right: &[f64; TERMS],
) -> Option<SquaredCoefficients> {
    let n = some.len();
    let mut length = [0.0; TERMS];
    for &i in some {
        length[i] = libm::sqrt(matrix[i][i]);
    }
    let mut factor = [[0.0; TERMS]; TERMS];
    let mut x = [0.0; TERMS];
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
    let mut solution = [0.0; TERMS];
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= factor[k][i] * x[k];
        }
        x[i] /= factor[i][i];
        solution[some[i]] = x[i] / length[some[i]];
    }
    Some(solution)
}
