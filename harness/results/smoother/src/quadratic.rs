//! Tail of a quadratic form in normal variables, Q = Σ λᵢ zᵢ² with zᵢ independent and λᵢ ≥ 0.
//!
//! The saddlepoint approximation of Lugannani and Rice in the form of Kuonen (1999, Biometrika 86): with the cumulant
//! function K(s) = −½ Σ ln(1 − 2 s λᵢ) and K′(ŝ) = q, w = ±√(2 (ŝ q − K(ŝ))), v = ŝ √K″(ŝ) the probability above q is
//! 1 − Φ(w + ln(v/w)/w). Its relative error is below six percent
//! however far in the tail, also for few terms.

use octant_statistics::normal;

/// Sums of the cumulant function at s: K, K′, K″.
fn cumulants(weights: &[f64], s: f64) -> (f64, f64, f64) {
    let mut sums = (0.0, 0.0, 0.0);
    for weight in weights {
        let left = 1.0 - 2.0 * s * weight;
        let share = weight / left;
        sums.0 -= 0.5 * libm::log(left);
        sums.1 += share;
        sums.2 += 2.0 * share * share;
    }
    sums
}

/// Probability that Σ λᵢ zᵢ² is above `q`; weights below a 1e-12th of the largest are left out. One if there is no weight.
#[must_use]
pub fn probability_above(weights: &[f64], q: f64) -> f64 {
    let largest = weights.iter().copied().fold(0.0, f64::max);
    if !(largest > 0.0) || !q.is_finite() {
        return 1.0;
    }
    // In units of the largest weight: s is below one half.
    let kept: Vec<f64> =
        weights.iter().map(|weight| weight / largest).filter(|weight| *weight > 1e-12).collect();
    let q = q / largest;
    if q <= 0.0 {
        return 1.0;
    }
    // K′ rises from zero to infinity between minus infinity and one half.
    let (mut low, mut high) = (-1.0, 0.5);
    while cumulants(&kept, low).1 > q {
        low *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if cumulants(&kept, middle).1 > q {
            high = middle;
        } else {
            low = middle;
        }
    }
    let s = 0.5 * (low + high);
    let (k, _, second) = cumulants(&kept, s);
    let w = libm::copysign(libm::sqrt((2.0 * (s * q - k)).max(0.0)), s);
    let v = s * libm::sqrt(second);
    if w.abs() < 1e-4 {
        // At the mean the formula is 0/0; its limit has the third cumulant.
        let third: f64 = kept.iter().map(|weight| 8.0 * weight * weight * weight).sum();
        let (_, _, second) = cumulants(&kept, 0.0);
        return 0.5
            - third
                / (6.0 * libm::sqrt(2.0 * core::f64::consts::PI) * second * libm::sqrt(second));
    }
    normal::cdf(-(w + libm::log(v / w) / w))
}
