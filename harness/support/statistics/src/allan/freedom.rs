//! Degrees of freedom of an Allan variance, and its interval.
//!
//! The estimate is a mean of squares of Gaussian differences that overlap and are correlated. Its
//! variance is that of χ² with ν degrees of freedom, divided by ν, where M squares in all have
//!
//! ```text
//! ν = M² / (M + 2 Σⱼ ρⱼ² Pⱼ)
//! ```
//!
//! ρⱼ is the correlation of two differences j strides apart ([`NoiseTerm::correlation`]), Pⱼ the number
//! of such pairs within a stretch (Greenhall and Riley, Uncertainty of stability variances based on
//! finite differences, PTTI 2003; NIST SP 1065, 5.4.1). Stretches are taken as independent.

use super::term::NoiseTerm;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Number of strides over which differences are correlated: 2 τ. Of bias instability, the only term
/// whose correlation doesn't end there, 1.1 % of the sum lies beyond.
pub(super) const LAGS: usize = 4;

/// Degrees of freedom from which χ² is taken as normal in the cube root (Wilson and Hilferty), whose
/// error is then below 1e-6.
const MANY: f64 = 2000.0;

/// Number of differences that an estimate is made of, and of pairs of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DifferenceCounts {
    /// Differences.
    pub terms: u64,
    /// Pairs within a stretch that are 1, 2, 3 and 4 strides apart.
    pub pairs: [u64; LAGS],
    /// Strides in the averaging time: 1 without overlap, 2 with half overlap.
    pub strides: u32,
}

impl DifferenceCounts {
    /// Creates counts of no stretch.
    #[must_use]
    pub fn new(strides: u32) -> Self {
        Self { terms: 0, pairs: [0; LAGS], strides }
    }

    /// Adds a stretch with this number of differences.
    pub fn add_stretch(&mut self, terms: u64) {
        self.terms += terms;
        for (pairs, lag) in self.pairs.iter_mut().zip(1..) {
            *pairs += terms.saturating_sub(lag);
        }
    }

    /// Degrees of freedom of the estimate, where `shares` are the parts of the variance that are from
    /// each term, in the order of [`NoiseTerm::ALL`]; together 1.
    #[must_use]
    pub fn degrees_of_freedom(&self, shares: &[f64; NoiseTerm::COUNT]) -> f64 {
        let terms = self.terms as f64;
        let mut sum = terms;
        for (pairs, lag) in self.pairs.iter().zip(1u32..) {
            let distance = f64::from(lag) / f64::from(self.strides);
            let of_terms = NoiseTerm::ALL.iter().zip(shares);
            let correlation: f64 =
                of_terms.map(|(term, share)| share * term.correlation(distance)).sum();
            sum += 2.0 * correlation * correlation * *pairs as f64;
        }
        if sum > 0.0 { terms * terms / sum } else { 0.0 }
    }
}

/// Interval of 95 % of a variance that was estimated with these degrees of freedom.
#[must_use]
pub fn interval(variance: f64, freedom: f64) -> [f64; 2] {
    [0.975, 0.025].map(|p| variance * freedom / chi_squared_quantile(p, freedom))
}

/// Quantile of χ²; NaN for degrees of freedom that aren't positive.
fn chi_squared_quantile(p: f64, freedom: f64) -> f64 {
    if freedom > MANY {
        let part = 2.0 / (9.0 * freedom);
        let root = 1.0 - part + crate::normal::quantile(p) * libm::sqrt(part);
        return freedom * root * root * root;
    }
    ChiSquared::new(freedom).map_or(f64::NAN, |distribution| distribution.inverse_cdf(p))
}
