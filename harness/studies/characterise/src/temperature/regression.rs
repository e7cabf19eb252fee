//! A coefficient by regression under noise whose correlation isn't known.
//!
//! Block means y of a rate within a stretch are an offset of the stretch, c times the block mean t of the
//! temperature, and noise: white noise and a random walk, of any sizes. Differences of neighbouring means have no offset,
//! and are all that is left of the data without it. With a block as the unit of time their covariances at lags of 0 and 1
//! are N² (2, −1) and K² (2/3, 1/6), and none further apart. Matrices of three diagonals with equal elements have the same
//! eigenvectors, sines, and the eigenvalues 2 − 2 cos θ and (2 + cos θ)/3 at θ = jπ/(m + 1), j = 1 … m, for m differences
//! of a stretch. Sine transforms of t and y therefore have the diagonal covariance σ² V, v = 2 − 2 cos θ + r (2 + cos θ)/3,
//! with the ratio r = K²/N².
//!
//! For a given ratio the generalized least squares estimate ĉ = tᵀV⁻¹y / tᵀV⁻¹t has Student's distribution with n − 1
//! degrees of freedom and the scale s² = S / (n − 1) / tᵀV⁻¹t, S the weighted sum of the squared residuals. The
//! restricted likelihood, which knows that c is fitted (Patterson and Thompson, Biometrika 58, 1971), is
//!
//! ```text
//! |V|^(−1/2) (tᵀV⁻¹t)^(−1/2) S^(−(n−1)/2)
//! ```
//!
//! Few blocks don't tell the ratio well, and an interval with the best one would be too narrow. The interval is
//! therefore that of the mixture over all ratios, weighted by the restricted likelihood and Jeffreys' prior: the
//! root of the information on ln r with σ² profiled out (Harville, JASA 69, 1974, has the likelihood as that of a flat
//! prior of c). A random walk that the record can't exclude is in the interval, which then is wider than one for
//! white noise.
//!
//! Noise of the regressor itself, white from block to block, is a part of tᵀV⁻¹t and makes ĉ too small by that part:
//! more where the noise of the rates wanders, as differences then weigh more than the whole change.
//!
//! Assumed: the noise is Gaussian; what isn't white wanders as a random walk does, or less; and the rate follows the
//! temperature at once and linearly.

use statrs::distribution::{ContinuousCDF, StudentsT};
use std::f64::consts::PI;

/// Step of the ratio, as a factor.
const STEP: f64 = 2.5;
/// Largest ratio: white noise is a thousandth of the walk from block to block.
const MOST: f64 = 1e3;
/// Weight of a part of the mixture, against the largest, below which it is left out.
const NEGLIGIBLE: f64 = 1e-12;
/// Fewest differences.
pub const DIFFERENCES_MIN: usize = 5;

/// A coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// Median of the mixture.
    pub value: f64,
    /// Interval of 95 %.
    pub interval: [f64; 2],
    /// Part by which the regressor's own noise makes it too small.
    pub too_small: f64,
}

/// One part of the mixture.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Logarithm of the weight, then the weight against the largest.
    weight: f64,
    centre: f64,
    scale: f64,
    too_small: f64,
}

/// Variances of the sine transforms: of white noise and of a random walk.
fn variances(lengths: &[usize]) -> Vec<[f64; 2]> {
    let of = |length: &usize| {
        let step = PI / (length + 1) as f64;
        (1..=*length).map(move |j| libm::cos(j as f64 * step))
    };
    lengths.iter().flat_map(of).map(|cosine| [2.0 - 2.0 * cosine, (2.0 + cosine) / 3.0]).collect()
}

/// Orthonormal sine transform of each stretch.
fn transformed(lengths: &[usize], values: &[f64]) -> Vec<f64> {
    let mut all = Vec::with_capacity(values.len());
    let mut rest = values;
    for length in lengths {
        let (here, after) = rest.split_at((*length).min(rest.len()));
        rest = after;
        let (step, factor) = (PI / (length + 1) as f64, libm::sqrt(2.0 / (length + 1) as f64));
        for j in 1..=here.len() {
            let of = |(k, value): (usize, &f64)| value * libm::sin((j * (k + 1)) as f64 * step);
            all.push(factor * here.iter().enumerate().map(of).sum::<f64>());
        }
    }
    all
}

/// Fits the coefficient of a regressor to responses. All are differences of neighbouring block means, those of the
/// first stretch first; `lengths` has the number of differences of each stretch. `None` for a response that is all
/// zero or not finite, and for all where there are too few differences or the regressor is zero. The regressor comes with
/// the standard deviation of its own noise in a block.
#[must_use]
pub fn regress(
    lengths: &[usize],
    (regressor, noise): (&[f64], f64),
    responses: &[Vec<f64>],
) -> Vec<Option<Coefficient>> {
    let count: usize = lengths.iter().sum();
    let is_usable = regressor.len() == count && regressor.iter().any(|t| *t != 0.0);
    if count < DIFFERENCES_MIN || !is_usable {
        return vec![None; responses.len()];
    }
    let variances = variances(lengths);
    let t = transformed(lengths, regressor);
    let ratios = ratios(count);
    let of = |response: &Vec<f64>| {
        let y = transformed(lengths, response);
        let parts = ratios.iter().map(|ratio| under(*ratio, &variances, (&t, noise), &y)).collect();
        (response.len() == count).then(|| mixed(parts, (count - 1) as f64)).flatten()
    };
    responses.iter().map(of).collect()
}

/// Ratios of the mixture, evenly in the logarithm.
fn ratios(count: usize) -> Vec<f64> {
    // A tenth of what could be noticed: a walk over all blocks that is as large as their white noise.
    let least = 0.1 / ((count + 1) * (count + 1)) as f64;
    let steps = (libm::log(MOST / least) / libm::log(STEP)).ceil() as i32;
    (0..=steps).map(|step| least * libm::pow(STEP, f64::from(step))).collect()
}

/// Part of the mixture under a ratio.
fn under(ratio: f64, variances: &[[f64; 2]], (t, noise): (&[f64], f64), y: &[f64]) -> Part {
    let (mut log_determinant, mut weight, mut both, mut squares) = (0.0, 0.0, 0.0, 0.0);
    // With V′ the derivative of V by ln r: traces of V⁻¹V′ and of its square, and tᵀV⁻¹V′V⁻¹t and tᵀV⁻¹V′V⁻¹V′V⁻¹t.
    let (mut traces, mut turned, mut rough) = ([0.0; 2], [0.0; 2], 0.0);
    for (([white, walk], t), y) in variances.iter().zip(t).zip(y) {
        let variance = white + ratio * walk;
        let part = ratio * walk / variance;
        log_determinant += libm::log(variance);
        weight += t * t / variance;
        both += t * y / variance;
        squares += y * y / variance;
        rough += noise * noise * white / variance;
        traces[0] += part;
        traces[1] += part * part;
        turned[0] += t * t / variance * part;
        turned[1] += t * t / variance * part * part;
    }
    let freedom = t.len() as f64 - 1.0;
    // The matrix of the restricted likelihood is P = V⁻¹ − uuᵀ/w with u = V⁻¹t and w = tᵀu, in place of V⁻¹.
    let first = traces[0] - turned[0] / weight;
    let second = traces[1] - 2.0 * turned[1] / weight + turned[0] * turned[0] / (weight * weight);
    let information = 0.5 * (second - first * first / freedom);
    let log_prior = 0.5 * libm::log(information.max(f64::MIN_POSITIVE));
    let centre = both / weight;
    // Of data without noise rounding alone is left.
    let left = (squares - both * centre).max(f64::EPSILON * squares);
    let log_likelihood = -0.5 * (log_determinant + libm::log(weight) + freedom * libm::log(left));
    Part {
        weight: log_prior + log_likelihood,
        centre,
        scale: libm::sqrt(left / freedom / weight),
        too_small: rough / weight,
    }
}

/// Median and interval of a mixture of Student's distributions.
fn mixed(parts: Vec<Part>, freedom: f64) -> Option<Coefficient> {
    let most = parts.iter().map(|part| part.weight).fold(f64::NEG_INFINITY, f64::max);
    let parts: Vec<Part> = parts
        .into_iter()
        .map(|part| Part { weight: libm::exp(part.weight - most), ..part })
        .filter(|part| part.weight > NEGLIGIBLE)
        .collect();
    let total: f64 = parts.iter().map(|part| part.weight).sum();
    let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
    let below = |value: f64| -> f64 {
        let of = |part: &Part| part.weight * student.cdf((value - part.centre) / part.scale);
        parts.iter().map(of).sum::<f64>() / total
    };
    // The quantile of the mixture is between the least and the largest of its parts.
    let quantile = |p: f64| {
        let of = student.inverse_cdf(p);
        let all = || parts.iter().map(|part| part.centre + of * part.scale);
        let (mut low, mut high) =
            (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if below(middle) < p { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    (!parts.is_empty()).then(|| Coefficient {
        value: quantile(0.5),
        interval: [quantile(0.025), quantile(0.975)],
        too_small: parts.iter().map(|part| part.weight * part.too_small).sum::<f64>() / total,
    })
}
