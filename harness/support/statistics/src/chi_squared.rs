//! Distribution of χ².

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Probability of less than `value` with these degrees of freedom; `None` where they aren't positive.
#[must_use]
pub fn below(value: f64, freedom: f64) -> Option<f64> {
    Some(ChiSquared::new(freedom).ok()?.cdf(value))
}
