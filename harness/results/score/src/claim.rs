//! The published claim, and the verdict of a comparison on it.

use octant_statistics::paired::Improvement;
use serde::{Deserialize, Serialize};

/// Improvement of the published claim, 1.
pub const CLAIM: f64 = 0.5;

/// Verdict of a comparison on the claim that the second method is more than 50 % better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Claim {
    /// The whole interval of improvement is above 50 %.
    Holds,
    /// The improvement in these runs is more than 50 %, but the interval reaches below.
    Likely,
    /// The improvement is significant and at most 50 % in these runs, but the interval reaches above.
    Better,
    /// The improvement is significant and below 50 %: the whole interval lies between.
    BetterByLess,
    /// The interval includes 0: the result is inconclusive.
    NotShown,
    /// The second method is significantly worse.
    Worse,
}

impl Claim {
    /// Judges an improvement by its interval.
    #[must_use]
    pub fn of(i: &Improvement) -> Self {
        if i.high < 0.0 {
            Self::Worse
        } else if i.low <= 0.0 {
            Self::NotShown
        } else if i.low > CLAIM {
            Self::Holds
        } else if i.value > CLAIM {
            Self::Likely
        } else if i.high > CLAIM {
            Self::Better
        } else {
            Self::BetterByLess
        }
    }
}

/// Text of an interval, `[−14 %, 1 %]`.
#[must_use]
pub fn interval(i: &Improvement) -> String {
    format!("[{} %, {} %]", percent(i.low), percent(i.high))
}

/// Text of a fraction in whole per cent, with a true minus sign.
#[must_use]
pub fn percent(fraction: f64) -> String {
    octant_base::number::fixed(100.0 * fraction, 0)
}
