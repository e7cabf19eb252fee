//! Verdicts: none < pass < inconclusive < fail < error, of which the worst decides; and the comparison
//! of a measure with a limit.

use serde::{Deserialize, Serialize};

/// Verdict on a run, a requirement or a finding, in the order from best to worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Nothing was required, so nothing is shown: the lowest verdict, which changes no other.
    None,
    /// The requirement is shown to be met.
    Pass,
    /// Nothing is shown: a measure is missing, a fault never fired, a record was dropped.
    Inconclusive,
    /// The requirement is shown not to be met.
    Fail,
    /// The bench failed: device gone, disk full.
    Error,
}

impl Verdict {
    /// All verdicts, from best to worst.
    pub const ALL: [Self; 5] =
        [Self::None, Self::Pass, Self::Inconclusive, Self::Fail, Self::Error];

    /// Worse one of two verdicts.
    #[must_use]
    pub fn worst(self, other: Self) -> Self {
        self.max(other)
    }

    /// Exit status of the program; 2 is reserved for bad input or usage.
    #[must_use]
    pub const fn exit_code(self) -> u8 {
        match self {
            Self::None | Self::Pass => 0,
            Self::Fail => 1,
            Self::Inconclusive => 3,
            Self::Error => 4,
        }
    }

    /// Name used in files and on the screen.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Pass => "pass",
            Self::Inconclusive => "inconclusive",
            Self::Fail => "fail",
            Self::Error => "error",
        }
    }
}

/// Comparison of a measure with a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Comparison {
    /// The measure may not be above the limit.
    #[serde(rename = "<=")]
    AtMost,
    /// The measure must be below the limit.
    #[serde(rename = "<")]
    Below,
    /// The measure may not be below the limit.
    #[serde(rename = ">=")]
    AtLeast,
    /// The measure must be above the limit.
    #[serde(rename = ">")]
    Above,
}

impl Comparison {
    /// All comparisons.
    pub const ALL: [Self; 4] = [Self::AtMost, Self::Below, Self::AtLeast, Self::Above];

    /// Sign of the comparison.
    #[must_use]
    pub const fn sign(self) -> &'static str {
        match self {
            Self::AtMost => "<=",
            Self::Below => "<",
            Self::AtLeast => ">=",
            Self::Above => ">",
        }
    }

    /// Comparison with a sign.
    #[must_use]
    pub fn of_sign(sign: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.sign() == sign)
    }

    /// Margin to the limit, positive on the good side.
    #[must_use]
    pub fn margin(self, value: f64, limit: f64) -> f64 {
        match self {
            Self::AtMost | Self::Below => limit - value,
            Self::AtLeast | Self::Above => value - limit,
        }
    }

    /// True if a value keeps a limit; NaN keeps none.
    #[must_use]
    pub fn holds(self, value: f64, limit: f64) -> bool {
        match self {
            Self::AtMost => value <= limit,
            Self::Below => value < limit,
            Self::AtLeast => value >= limit,
            Self::Above => value > limit,
        }
    }
}

/// A limit on one measure of the summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitCheck {
    /// Id of the requirement that this check verifies.
    pub id: String,
    /// Path of the measure in the summary, with dots: `navigation.longitude_error_arcmin.max`,
    /// `calibration.parameters.g_zz.error`. Bars around it take the magnitude:
    /// `|calibration.parameters.g_zz.error|`.
    pub measure: String,
    /// Comparison with the limit.
    pub comparison: Comparison,
    /// The limit, in the unit of the measure.
    pub limit: f64,
    /// True if the limit is multiplied by the secant of the site's latitude: `limit` is that at the equator.
    #[serde(default, skip_serializing_if = "is_false")]
    pub secant_latitude: bool,
}

/// True for a key that needn't be written.
fn is_false(flag: &bool) -> bool {
    !flag
}

/// Limit with the factor sec φ at a latitude, in its own unit.
#[must_use]
pub fn at_latitude(limit_at_equator: f64, latitude_deg: f64) -> f64 {
    limit_at_equator / libm::cos(latitude_deg.to_radians())
}
