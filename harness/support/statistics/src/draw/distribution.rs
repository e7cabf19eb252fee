//! Distributions of factors, truncated through their inverse.

use super::error::DrawError;
use crate::normal;
use serde::{Deserialize, Serialize};

/// A distribution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// Uniform between two values.
    Uniform {
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
    /// Gaussian.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sigma: f64,
    },
    /// Log-normal: the logarithm is Gaussian.
    LogNormal {
        /// Median, above 0.
        median: f64,
        /// Standard deviation of the natural logarithm.
        sigma_ln: f64,
    },
    /// One of several options, with these weights.
    Choice {
        /// Weights, not negative; their sum is arbitrary.
        weights: Vec<f64>,
    },
}

/// A drawn value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DrawnFactor {
    /// Value of a continuous distribution.
    Number(f64),
    /// Index of the option, from 0.
    Choice(usize),
}

impl DrawnFactor {
    /// Value as a number; for a choice, the index of the option.
    #[must_use]
    pub fn number(self) -> f64 {
        match self {
            Self::Number(number) => number,
            Self::Choice(index) => index as f64,
        }
    }
}

/// A factor that is varied between runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Factor {
    /// Name, which determines its stream.
    pub name: String,
    /// Distribution.
    pub distribution: Distribution,
    /// Lower limit of truncation.
    pub low: Option<f64>,
    /// Upper limit of truncation.
    pub high: Option<f64>,
}

impl Factor {
    /// Makes a factor without truncation.
    #[must_use]
    pub fn new(name: &str, distribution: Distribution) -> Self {
        Self { name: name.to_owned(), distribution, low: None, high: None }
    }

    /// Truncates the factor to values from `low` to `high`.
    #[must_use]
    pub fn truncated(mut self, low: f64, high: f64) -> Self {
        (self.low, self.high) = (Some(low), Some(high));
        self
    }

    /// True if the factor is a choice.
    #[must_use]
    pub const fn is_choice(&self) -> bool {
        matches!(self.distribution, Distribution::Choice { .. })
    }

    fn wrong(&self, message: impl Into<String>) -> DrawError {
        DrawError::Factor { factor: self.name.clone(), message: message.into() }
    }

    pub(super) fn check(&self) -> Result<(), DrawError> {
        let positive = |what: &str, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(self.wrong(format!("{what} is {value}, expected more than 0"))),
        };
        match &self.distribution {
            Distribution::Uniform { low, high } => {
                if !(low < high && (high - low).is_finite()) {
                    return Err(self.wrong(format!(
                        "it is even from {low} to {high}: there is nothing between"
                    )));
                }
            }
            Distribution::Normal { mean, sigma } => {
                positive("sigma", *sigma)?;
                if !mean.is_finite() {
                    return Err(self.wrong(format!("its mean is {mean}")));
                }
            }
            Distribution::LogNormal { median, sigma_ln } => {
                positive("median", *median)?;
                positive("sigma_ln", *sigma_ln)?;
            }
            Distribution::Choice { weights } => {
                if let Some(weight) = weights.iter().find(|w| !(**w >= 0.0 && w.is_finite())) {
                    return Err(
                        self.wrong(format!("found the weight {weight}, expected 0 or more"))
                    );
                }
                positive("the sum of the weights", weights.iter().sum())?;
                if self.low.is_some() || self.high.is_some() {
                    return Err(self.wrong("a choice can't be truncated"));
                }
                return Ok(());
            }
        }
        if [self.low, self.high].into_iter().flatten().any(f64::is_nan) {
            return Err(self.wrong("a limit is not a number"));
        }
        let mirrored = self.mirrored();
        let (from, to) = self.range(mirrored);
        // The two are equal if both limits are in a tail that a double can't resolve.
        if !(from < to) {
            let limit = |x: Option<f64>, none: &str| x.map_or(none.to_owned(), |x| x.to_string());
            let (low, high) = (limit(self.low, "-inf"), limit(self.high, "inf"));
            return Err(
                self.wrong(format!("nothing of the distribution is between {low} and {high}"))
            );
        }
        Ok(())
    }

    /// Standardised value: a normal one has mean 0 and σ 1, a uniform one lies in 0 to 1, a choice is its own.
    #[must_use]
    pub fn standard(&self, x: f64) -> f64 {
        match self.distribution {
            Distribution::Uniform { low, high } => (x - low) / (high - low),
            Distribution::Normal { mean, sigma } => (x - mean) / sigma,
            Distribution::LogNormal { median, sigma_ln } => {
                if x > 0.0 {
                    libm::log(x / median) / sigma_ln
                } else {
                    f64::NEG_INFINITY
                }
            }
            Distribution::Choice { .. } => x,
        }
    }

    /// True if the limits are in the upper tail, where probabilities near 1 would lose digits: then
    /// they are counted from the other end.
    fn mirrored(&self) -> bool {
        let normal = !matches!(self.distribution, Distribution::Uniform { .. });
        normal && self.low.is_some_and(|low| self.standard(low) > 0.0)
    }

    /// Probabilities at the limits, counted from the upper end if mirrored.
    fn range(&self, mirrored: bool) -> (f64, f64) {
        let at = |limit: Option<f64>, none: f64| match limit.map(|x| self.standard(x)) {
            None => none,
            Some(z) if matches!(self.distribution, Distribution::Uniform { .. }) => {
                z.clamp(0.0, 1.0)
            }
            Some(z) => normal::cdf(if mirrored { -z } else { z }),
        };
        if mirrored {
            (at(self.high, 0.0), at(self.low, 1.0))
        } else {
            (at(self.low, 0.0), at(self.high, 1.0))
        }
    }

    /// Value at a probability in (0, 1) of the truncated distribution.
    ///
    /// # Errors
    /// If the distribution has no value.
    pub fn at(&self, u: f64) -> Result<DrawnFactor, DrawError> {
        if let Distribution::Choice { weights } = &self.distribution {
            let total: f64 = weights.iter().sum();
            let mut left = u * total;
            let mut last = None;
            for (index, weight) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
                if left < *weight {
                    return Ok(DrawnFactor::Choice(index));
                }
                left -= weight;
                last = Some(index);
            }
            // Reached only by rounding.
            return last.map(DrawnFactor::Choice).ok_or_else(|| self.wrong("it has no weight"));
        }
        let mirrored = self.mirrored();
        let (from, to) = self.range(mirrored);
        // In the mirrored case the largest probability belongs to the smallest value; this keeps the
        // value increasing with u.
        let u = if mirrored { 1.0 - u } else { u };
        let p = from + u * (to - from);
        let z = || if mirrored { -normal::quantile(p) } else { normal::quantile(p) };
        let x = match self.distribution {
            Distribution::Uniform { low, high } => low + p * (high - low),
            Distribution::Normal { mean, sigma } => mean + sigma * z(),
            Distribution::LogNormal { median, sigma_ln } => median * libm::exp(sigma_ln * z()),
            Distribution::Choice { .. } => p,
        };
        // Rounding may exceed a limit.
        let x = self.low.map_or(x, |low| x.max(low));
        Ok(DrawnFactor::Number(self.high.map_or(x, |high| x.min(high))))
    }
}
