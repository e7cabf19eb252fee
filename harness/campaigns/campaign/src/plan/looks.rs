//! How often the results of a campaign are looked at.

use octant_scenario::campaign::LookSpec;
use octant_statistics::proportion::Demand;
use serde::{Deserialize, Serialize};

/// How often the results of a campaign are looked at before a required probability counts as shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Looks {
    /// Once, when every case has run.
    #[default]
    Once,
    /// So many times, after equal parts of the draws.
    Planned(u32),
    /// At any time.
    Open,
}

impl From<LookSpec> for Looks {
    fn from(spec: LookSpec) -> Self {
        match spec {
            LookSpec::Once => Self::Once,
            LookSpec::Planned(count) => Self::Planned(count),
            LookSpec::Open => Self::Open,
        }
    }
}

impl Looks {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
    pub(super) fn is_once(&self) -> bool {
        *self == Self::Once
    }
}

/// Way in which a campaign is looked at: that of its plan, or that of its stopping rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookWay {
    /// Once.
    Once,
    /// So many times, each with its part of the draws.
    Planned(u32),
    /// At any time.
    Open,
    /// By the stopping rule, at most so many times.
    Stop(u64),
}

/// Demand with the part of the error that each of several looks has.
#[must_use]
pub fn at_each_of(demand: Demand, looks: u64) -> Demand {
    Demand { confidence: 1.0 - (1.0 - demand.confidence) / looks.max(1) as f64, ..demand }
}
