//! Bias instability (1/f noise) as a sum of first-order Gauss-Markov processes.
//!
//! Flicker noise of coefficient B has the two-sided spectral density `S(f) = B² / (2π |f|)` and the
//! Allan deviation `√(2 ln 2 / π) B = 0.664 B` at every cluster time (IEEE Std 952-1997, C.1.3).
//! A Gauss-Markov process of variance s² and correlation time T has `2 s² T / (1 + (2π f T)²)`.
//! Processes of equal variance, whose correlation times have the ratio r to each other, add up to
//! `s² / (2 |f| ln r)`, since the sum over ln T is nearly its integral. The two densities are equal
//! for
//!
//! ```text
//! s² = B² ln r / π
//! ```
//!
//! With r = 4 the sum differs from its integral by a ripple of `2 / cosh(π² / ln 4)`, 0.3 % of the
//! density. The first and the last process also stand for those beyond the ends of the band, `s² (1/r +
//! 1/r² + …) = s² / (r − 1)` more: beside a longer time all of the missing fast ones are white noise
//! of density `2 s² T`, and beside a shorter one all of the missing slow ones are random walks of
//! density `2 s² / T`. That makes the Allan deviation flat within 1 % from 16 s to 9 h, and within
//! 3 % from 8 s to 18 h; without these terms it would miss 5 % at 32 s and at 18 h. Below 2 s it
//! falls with decreasing cluster time, where white noise hides it.

use crate::config::GaussMarkov;

/// Number of processes.
pub const COUNT: usize = 9;
/// Shortest correlation time, s. The longest is 2 s · 4⁸ = 131 072 s, 36.4 h.
pub const SHORTEST_S: f64 = 2.0;
/// Ratio of a correlation time to the one before.
pub const RATIO: f64 = 4.0;

/// Returns the processes of a coefficient B, from the shortest correlation time to the longest, in
/// the unit of the coefficient: rad/s or m/s².
///
/// The sum has the standard deviation 2.07 B.
#[must_use]
pub fn processes(coefficient: f64) -> [GaussMarkov; COUNT] {
    let equal = libm::log(RATIO) / core::f64::consts::PI;
    let mut correlation_time_s = SHORTEST_S;
    core::array::from_fn(|index| {
        let is_end = index == 0 || index + 1 == COUNT;
        let variance = if is_end { equal * RATIO / (RATIO - 1.0) } else { equal };
        let process = GaussMarkov { sigma: coefficient * libm::sqrt(variance), correlation_time_s };
        correlation_time_s *= RATIO;
        process
    })
}
