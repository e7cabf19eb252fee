//! Configuration of the further states, see [`crate::further`].

use crate::further::FurtherGroup;

/// Treatment of a group of further states by the filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum FurtherUse {
    /// The error doesn't exist for the filter.
    #[default]
    Off,
    /// Its uncertainty counts, and the filter never moves it (Schmidt).
    Considered {
        /// Prior standard deviation of each state, SI.
        sigma: f64,
    },
    /// It is estimated and compensated.
    Estimated {
        /// Prior standard deviation of each state, SI.
        sigma: f64,
    },
}

impl FurtherUse {
    /// Prior standard deviation; `None` if the group is off.
    #[must_use]
    pub fn sigma(self) -> Option<f64> {
        match self {
            Self::Off => None,
            Self::Considered { sigma } | Self::Estimated { sigma } => Some(sigma),
        }
    }
}

/// Errors beside the thirty parameters that the filter takes into account. The default has none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Further {
    /// Treatment of each group, in the order of [`FurtherGroup::ALL`].
    pub groups: [FurtherUse; 8],
    /// Correlation time of [`FurtherGroup::GyroGaussMarkov`], s; not used while that is off.
    pub gyro_correlation_time_s: f64,
    /// Correlation time of [`FurtherGroup::AccelGaussMarkov`], s; not used while that is off.
    pub accel_correlation_time_s: f64,
    /// Rate random walk of the gyros, (rad/s)/√s; 0: none. No further state: a process noise of the
    /// gyro biases, which are then no constants, so that the drift test is off.
    pub gyro_rate_random_walk: f64,
}

impl Further {
    /// Treatment of a group.
    #[must_use]
    pub fn of(&self, group: FurtherGroup) -> FurtherUse {
        self.groups[group as usize]
    }

    /// The same with another treatment of a group.
    #[must_use]
    pub fn with(mut self, group: FurtherGroup, treatment: FurtherUse) -> Self {
        self.groups[group as usize] = treatment;
        self
    }

    /// Returns whether a group is on.
    #[must_use]
    pub fn has_states(&self) -> bool {
        self.groups.iter().any(|group| *group != FurtherUse::Off)
    }
}
