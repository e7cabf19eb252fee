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

/// Gimbal angles as measurements of attitude, with the errors of the gimbals. For a case at rest: its
/// attitude is a constant that the filter estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct AngleMeasurements {
    /// White noise of a reading about each axis, 1σ, rad: encoders and wobble of the gimbals.
    pub sigma_rad: f64,
    /// Rest of an encoder's error curve that no other state has, 1σ, rad: a constant of each stop, another
    /// one after each move of the gimbal; 0: none.
    pub curve_sigma_rad: f64,
    /// Treatment of each group, in the order of [`FurtherGroup::OF_GIMBALS`].
    pub groups: [FurtherUse; 3],
}

/// Case of a base at rest: where gimbals rest, the body doesn't turn, but for what the case itself does.
///
/// At a stop the attitude is a constant of which nothing else is known. A move of one gimbal changes it about that axis
/// alone, by its angle within [`Self::ANGLE_SIGMA_RAD`], so that encoders are trusted for no more than that.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct CaseRest {
    /// Random walk of the case about each axis, rad/√s: a floor that settles, a quay. 0: none.
    pub wander_rad_per_sqrt_s: f64,
    /// Turn about any axis since the first measurement, beyond what its uncertainty explains, that contradicts a case at
    /// rest, rad.
    pub range_rad: f64,
    /// White noise of the case's attitude about each axis, 1σ, rad: people, machines.
    pub jitter_rad: f64,
}

impl CaseRest {
    /// Uncertainty of a gimbal's angle after each move, 1σ, rad: that of an encoder of which nothing is known.
    pub const ANGLE_SIGMA_RAD: f64 = 0.1 * core::f64::consts::PI / 180.0;
}

/// Errors that follow the temperature of the instrument linearly. The core has to be told the temperature
/// ([`Core::feel`](crate::Core::feel)).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct TemperatureErrors {
    /// Treatment of each group, in the order of [`FurtherGroup::OF_TEMPERATURE`].
    pub groups: [FurtherUse; 4],
    /// Temperature at which the parameters are as they are estimated, °C; `None`: the first one that the core is
    /// told.
    pub reference_c: Option<f64>,
}

/// Errors beside the thirty parameters that the filter takes into account. The default has none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Further {
    /// Treatment of the first eight groups of [`FurtherGroup::ALL`].
    pub groups: [FurtherUse; 8],
    /// Correlation time of [`FurtherGroup::GyroGaussMarkov`], s; not used while that is off.
    pub gyro_correlation_time_s: f64,
    /// Correlation time of [`FurtherGroup::AccelGaussMarkov`], s; not used while that is off.
    pub accel_correlation_time_s: f64,
    /// Rate random walk of the gyros, (rad/s)/√s; 0: none. No further state: a process noise of the
    /// gyro biases, which are then no constants, so that the drift test is off.
    pub gyro_rate_random_walk: f64,
    /// Errors that follow the temperature; `None`: the temperature tells the filter nothing. Not beside angles as
    /// measurements. A configuration is stored with them: see `stored`.
    #[cfg_attr(feature = "state", serde(skip))]
    pub temperature: Option<TemperatureErrors>,
    /// Gimbal angles as measurements; `None`: the angles tell the filter nothing. A configuration is stored
    /// with them: see `stored`.
    #[cfg_attr(feature = "state", serde(skip))]
    pub angles: Option<AngleMeasurements>,
    /// Case that doesn't turn; `None`: its attitude tells the filter nothing, or is a constant where angles are
    /// measurements. A configuration is stored with it: see `stored`.
    #[cfg_attr(feature = "state", serde(skip))]
    pub rest: Option<CaseRest>,
}

impl Further {
    /// Measurement of the attitude at rest by the angles of the gimbals; `None` where there is none.
    #[must_use]
    pub fn attitude_at_rest(&self) -> Option<AngleMeasurements> {
        self.angles.or_else(|| {
            self.rest.map(|rest| AngleMeasurements {
                sigma_rad: rest.jitter_rad,
                curve_sigma_rad: CaseRest::ANGLE_SIGMA_RAD,
                groups: [FurtherUse::Off; 3],
            })
        })
    }

    /// Returns whether the filter has a border: further states, or the attitude of a case at rest.
    #[must_use]
    pub fn has_border(&self) -> bool {
        self.rest.is_some() || self.has_states()
    }

    /// Treatment of a group.
    #[must_use]
    pub fn of(&self, group: FurtherGroup) -> FurtherUse {
        { *self }.treatment(group).map_or(FurtherUse::Off, |found| *found)
    }

    /// Place of a group's treatment; `None` where there can't be one.
    fn treatment(&mut self, group: FurtherGroup) -> Option<&mut FurtherUse> {
        let place = |groups: &[FurtherGroup]| groups.iter().position(|other| *other == group);
        if let Some(place) = place(&FurtherGroup::OF_TEMPERATURE) {
            return self.temperature.as_mut()?.groups.get_mut(place);
        }
        if let Some(place) = place(&FurtherGroup::OF_GIMBALS) {
            return self.angles.as_mut()?.groups.get_mut(place);
        }
        self.groups.get_mut(group as usize)
    }

    /// The same with another treatment of a group. A group of the gimbals stays off without angles as
    /// measurements, and one of the temperature without errors that follow it.
    #[must_use]
    pub fn with(mut self, group: FurtherGroup, treatment: FurtherUse) -> Self {
        if let Some(found) = self.treatment(group) {
            *found = treatment;
        }
        self
    }

    /// Returns whether a group is on, or angles are measurements, whose case attitude is a state.
    #[must_use]
    pub fn has_states(&self) -> bool {
        let is_on = |group: &FurtherUse| *group != FurtherUse::Off;
        self.angles.is_some() || self.follows_temperature() || self.groups.iter().any(is_on)
    }

    /// Returns whether a group of errors that follow the temperature is on.
    #[must_use]
    pub fn follows_temperature(&self) -> bool {
        let is_on = |group: &FurtherUse| *group != FurtherUse::Off;
        self.temperature.is_some_and(|temperature| temperature.groups.iter().any(is_on))
    }
}
