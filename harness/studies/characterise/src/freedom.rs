//! Degrees of freedom of variances, and covariances among Hadamard variances of one record.
//!
//! Variances of Gaussian differences have `Cov(V, W) = 2/(M_V M_W) Σ C²` over all pairs of differences, with the
//! covariance C of a pair. It is quadratic in the squared coefficients of the terms, so that its parts are computed
//! once. Degrees of freedom are `2 E[V]² / Var(V)` (Greenhall and Riley, Uncertainty of stability variances based on
//! finite differences, PTTI 2003; NIST SP 1065, 5.4.1), with the mixture of terms that the record has in place of one
//! power of the frequency.

use super::kernel::{DifferenceOrder, Kernel, RandomTerm, TERMS};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Starts in an averaging time that are counted among variances: more add nothing but for quantization.
const STARTS: u64 = 8;
/// Starts in an averaging time that the estimator has at least.
const STARTS_MADE: u64 = 48;
/// Degrees of freedom from which χ² is taken as normal in the cube root (Wilson and Hilferty).
const MANY: f64 = 2000.0;
/// Averaging times beyond the span of a difference, until which correlations are counted.
const TAIL: u64 = 2;
/// Ratio of averaging times from which sums over lags are taken in growing steps.
const WIDE: u64 = 32;

/// Squared coefficients of the terms.
pub type SquaredCoefficients = [f64; TERMS];

/// Samples from one start to the next, as counted.
fn stride(samples: u64) -> u64 {
    (samples / STARTS).max(1)
}

/// Samples from one start to the next, as [`super::deviations`] makes them.
fn stride_made(samples: u64) -> u64 {
    if samples <= 64 { 1 } else { 1 << (samples / STARTS_MADE).max(1).ilog2() }
}

/// Kinds of variances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VarianceKind {
    /// Allan variance.
    Allan,
    /// Modified Allan variance.
    Modified,
    /// Hadamard variance.
    Hadamard,
}

/// Degrees of freedom of a variance over stretches of these lengths, in samples.
#[must_use]
pub fn degrees_of_freedom(
    kernel: &Kernel,
    kind: VarianceKind,
    samples: u64,
    (stretches, squares): (&[u64], &SquaredCoefficients),
) -> f64 {
    let tau_s = samples as f64 * kernel.period_s;
    let (span, order) = match kind {
        VarianceKind::Allan => (2 * samples, DifferenceOrder::Second),
        VarianceKind::Hadamard => (3 * samples, DifferenceOrder::Third),
        VarianceKind::Modified => (3 * samples - 1, DifferenceOrder::Second),
    };
    let covariance = |lag: u64| -> f64 {
        let lag_s = lag as f64 * kernel.period_s;
        let of = |(term, square): (&RandomTerm, &f64)| match (*square > 0.0, kind) {
            (false, _) => 0.0,
            (_, VarianceKind::Modified) => square * kernel.modified_covariance(*term, tau_s, lag_s),
            _ => square * kernel.covariance(*term, order, tau_s, lag_s),
        };
        RandomTerm::ALL.iter().zip(squares).map(of).sum()
    };
    let stride = stride_made(samples);
    let starts = |length: u64| length.checked_sub(span).map_or(0, |rest| rest / stride + 1);
    let all: Vec<u64> = stretches.iter().map(|length| starts(*length)).collect();
    let zero = covariance(0);
    let total = all.iter().sum::<u64>() as f64;
    let mut sum = total;
    for lag in 1..=(span + TAIL * samples) / stride {
        let pairs: u64 = all.iter().map(|starts| starts.saturating_sub(lag)).sum();
        if pairs == 0 {
            break;
        }
        let correlation = covariance(lag * stride) / zero;
        sum += 2.0 * correlation * correlation * pairs as f64;
    }
    if sum > 0.0 && zero > 0.0 { total * total / sum } else { 0.0 }
}

/// Interval of 95 % of a variance that was estimated with these degrees of freedom.
#[must_use]
pub fn interval(variance: f64, freedom: f64) -> [f64; 2] {
    [0.975, 0.025].map(|p| variance * freedom / chi_squared_quantile(p, freedom))
}

/// Quantile of χ²; NaN for degrees of freedom that aren't positive.
#[must_use]
pub fn chi_squared_quantile(p: f64, freedom: f64) -> f64 {
    if freedom > MANY {
        let part = 2.0 / (9.0 * freedom);
        let normal = statrs::distribution::Normal::standard().inverse_cdf(p);
        let root = 1.0 - part + normal * libm::sqrt(part);
        return freedom * root * root * root;
    }
    ChiSquared::new(freedom).map_or(f64::NAN, |distribution| distribution.inverse_cdf(p))
}

/// Number of products of two terms.
const PRODUCTS: usize = TERMS * (TERMS + 1) / 2;

/// Parts of the covariances among the Hadamard variances of one record.
#[derive(Clone, Debug)]
pub struct Covariances {
    rows: usize,
    /// For each pair of rows, i ≤ j, the sums of products of two terms.
    parts: Vec<[f64; PRODUCTS]>,
}

/// Index of a pair, i ≤ j.
fn pair(i: usize, j: usize) -> usize {
    j * (j + 1) / 2 + i
}

impl Covariances {
    /// Computes the parts for averaging times, in samples, each a multiple of the one before.
    #[must_use]
    pub fn new(kernel: &Kernel, samples: &[u64], stretches: &[u64]) -> Self {
        let rows = samples.len();
        let mut parts = Vec::with_capacity(rows * (rows + 1) / 2);
        for j in 0..rows {
            for i in 0..=j {
                parts.push(of_pair(kernel, [samples[i], samples[j]], stretches));
            }
        }
        Self { rows, parts }
    }

    /// Covariance of two variances under squared coefficients.
    #[must_use]
    pub fn at(&self, i: usize, j: usize, squares: &SquaredCoefficients) -> f64 {
        let parts = &self.parts[pair(i.min(j), i.max(j))];
        let mut sum = 0.0;
        for q in 0..TERMS {
            for p in 0..=q {
                let twice = if p == q { 1.0 } else { 2.0 };
                sum += twice * squares[p] * squares[q] * parts[pair(p, q)];
            }
        }
        sum
    }

    /// Number of variances.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }
}

/// Lags at which covariances are computed, in strides of the shorter time, with the number of lags each stands for.
fn lags(ratio: i64, starts: i64) -> Vec<(i64, f64)> {
    let short = starts;
    let long = ratio * starts;
    let (first, last) = (-3 * short - TAIL as i64 * long, (3 + TAIL as i64) * long);
    if ratio <= WIDE as i64 {
        return (first..=last).map(|lag| (lag, 1.0)).collect();
    }
    // The covariance changes fast where a point of the long difference meets the short one, and slowly elsewhere.
    let mut all = Vec::new();
    let mut lag = first;
    let near = |lag: i64| (0..4).map(|k| (lag + 3 * short / 2 - k * long).abs()).min().unwrap_or(0);
    while lag <= last {
        let step = ((near(lag) - 8 * short) / 16).max(1);
        // A step must not jump into the neighbourhood of the next point.
        let step = step.min(((near(lag + step) - 8 * short) / 8).max(1).max(step / 2));
        all.push((lag + step / 2, step as f64));
        lag += step;
    }
    all
}

fn of_pair(kernel: &Kernel, samples: [u64; 2], stretches: &[u64]) -> [f64; PRODUCTS] {
    let [short, long] = samples;
    let strides = [stride(short), stride(long)];
    let tau_s = samples.map(|samples| samples as f64 * kernel.period_s);
    let scale = tau_s.map(|tau_s| 6.0 * tau_s * tau_s);
    let room = |samples: u64| {
        let of = move |length: &u64| *length as i64 - 3 * samples as i64;
        stretches.iter().map(of).collect::<Vec<i64>>()
    };
    let (short_room, long_room) = (room(short), room(long));
    let count = |rooms: &[i64], stride: u64| -> f64 {
        let of = |room: &i64| if *room < 0 { 0 } else { *room as u64 / stride + 1 };
        rooms.iter().map(of).sum::<u64>() as f64
    };
    let (m_short, m_long) = (count(&short_room, strides[0]), count(&long_room, strides[1]));
    let mut sums = [0.0; PRODUCTS];
    if m_short == 0.0 || m_long == 0.0 {
        return sums;
    }
    let per_tau = (short / strides[0]) as i64;
    for (lag, weight) in lags((long / short) as i64, per_tau) {
        let lag = lag * strides[0] as i64;
        // Starts of the long difference whose short one, a lag later, is in the stretch.
        let of = |(short, long): (&i64, &i64)| {
            let (from, to) = ((-lag).max(0), (*long).min(*short - lag));
            if to < from { 0.0 } else { (to - from) as f64 / strides[1] as f64 + 1.0 }
        };
        let pairs: f64 = short_room.iter().zip(&long_room).map(of).sum();
        if pairs == 0.0 {
            continue;
        }
        let lag_s = lag as f64 * kernel.period_s;
        let c = RandomTerm::ALL.map(|term| kernel.cross_covariance(term, tau_s, lag_s));
        for q in 0..TERMS {
            for p in 0..=q {
                sums[pair(p, q)] += weight * pairs * c[p] * c[q];
            }
        }
    }
    let factor = 2.0 / (m_short * m_long * scale[0] * scale[1]);
    // Differences of quantization share a sample or nothing: all starts count, and dense sums have one lag of many.
    let coarser = stride(short) as f64 / stride_made(short) as f64;
    for term in 0..TERMS {
        sums[pair(RandomTerm::Quantization as usize, term)] /= coarser;
    }
    sums.map(|sum| sum * factor)
}
