//! Further states: errors beside the thirty parameters that a calibration can take into account.
//!
//! Each group is off, considered or estimated (see [`crate::config::Further`]). Errors are measured
//! − true, and the estimates are their coefficients, as with the parameters:
//!
//! | group | error of the sensor or of the model | unit |
//! |---|---|---|
//! | [`AccelLever`](FurtherGroup::AccelLever) | ∇_i = (ω̇ × r_i + ω × (ω × r_i))_i: size effect, r_i the position of proof mass i from the centre of rotation, in b | m |
//! | [`GyroAsymmetry`](FurtherGroup::GyroAsymmetry) | ε_i = a_i abs(ω_i) | 1 |
//! | [`AccelAsymmetry`](FurtherGroup::AccelAsymmetry) | ∇_i = a_i abs(f_i) | 1 |
//! | [`AccelQuadratic`](FurtherGroup::AccelQuadratic) | ∇_i = k_i f_i² (K2 of IEEE Std 1293) | 1/(m/s²) |
//! | [`GyroGaussMarkov`](FurtherGroup::GyroGaussMarkov) | ε_i = x_i, first-order Gauss-Markov | rad/s |
//! | [`AccelGaussMarkov`](FurtherGroup::AccelGaussMarkov) | ∇_i = x_i, first-order Gauss-Markov | m/s² |
//! | [`Deflection`](FurtherGroup::Deflection) | gravity in n is (−ξ g, −η g, g) | rad |
//! | [`GravityAnomaly`](FurtherGroup::GravityAnomaly) | gravity in n is (0, 0, g + Δg), g normal gravity | m/s² |
//!
//! Sign of the deflection of the vertical: ξ is positive where the astronomic zenith is north of the
//! geodetic one, η where it is east (Torge, *Geodesy*). The plumb line then points to the south
//! and west.
//!
//! Only some of them can be observed on two gimbals over a base at rest:
//!
//! - Size effect: all nine. A turn about body z (azimuth) shows r_xx and r_yy by `−ω²` and r_xy and
//!   r_yx by `±ω̇`; one about an axis across it (roll, at azimuths of 0° and 90°) shows the others. A
//!   zero velocity is that of the point where the gimbals' axes cross, which rests, and the arms
//!   count from there: one hour through the eight positions brings each from 30 mm to 2 mm (1σ). The
//!   six that the literature counts are those of an instrument whose own point is that of one of its
//!   accelerometers, r_x = 0. Then, or where the axes don't cross, three combinations are the place of
//!   that point. The nine remain states: a combination that the motion doesn't show keeps its prior.
//! - Asymmetry: on positions with both signs of an axis it is separated from the scale factor.
//! - Deflection: at rest it is inseparable from a tilt of the whole attitude, and the anomaly from a
//!   common scale factor of the accelerometers. Both are there to be considered.

pub(crate) mod compensation;
pub(crate) mod size_effect;

use core::ops::Range;

/// Number of further states.
pub const FURTHER_COUNT: usize = 27;

/// Names of the further states, in the order in which they are stored.
pub const FURTHER_NAMES: [&str; FURTHER_COUNT] = [
    "accel_lever_xx",
    "accel_lever_xy",
    "accel_lever_xz",
    "accel_lever_yx",
    "accel_lever_yy",
    "accel_lever_yz",
    "accel_lever_zx",
    "accel_lever_zy",
    "accel_lever_zz",
    "gyro_asymmetry_x",
    "gyro_asymmetry_y",
    "gyro_asymmetry_z",
    "accel_asymmetry_x",
    "accel_asymmetry_y",
    "accel_asymmetry_z",
    "accel_quadratic_x",
    "accel_quadratic_y",
    "accel_quadratic_z",
    "gyro_gauss_markov_x",
    "gyro_gauss_markov_y",
    "gyro_gauss_markov_z",
    "accel_gauss_markov_x",
    "accel_gauss_markov_y",
    "accel_gauss_markov_z",
    "deflection_north",
    "deflection_east",
    "gravity_anomaly",
];

/// Group of further states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FurtherGroup {
    /// Inner lever arms of the accelerometers, m: row i is the position of proof mass i.
    AccelLever,
    /// Asymmetry of the gyros' scale factors.
    GyroAsymmetry,
    /// Asymmetry of the accelerometers' scale factors.
    AccelAsymmetry,
    /// Second-order coefficients of the accelerometers, 1/(m/s²).
    AccelQuadratic,
    /// Gauss-Markov biases of the gyros, rad/s.
    GyroGaussMarkov,
    /// Gauss-Markov biases of the accelerometers, m/s².
    AccelGaussMarkov,
    /// Deflection of the vertical, north (ξ) and east (η), rad.
    Deflection,
    /// Gravity anomaly, m/s²: true minus normal gravity.
    GravityAnomaly,
}

impl FurtherGroup {
    /// All groups, in the order in which they are stored.
    pub const ALL: [Self; 8] = [
        Self::AccelLever,
        Self::GyroAsymmetry,
        Self::AccelAsymmetry,
        Self::AccelQuadratic,
        Self::GyroGaussMarkov,
        Self::AccelGaussMarkov,
        Self::Deflection,
        Self::GravityAnomaly,
    ];

    /// Place among the further states.
    #[must_use]
    pub const fn range(self) -> Range<usize> {
        match self {
            Self::AccelLever => 0..9,
            Self::GyroAsymmetry => 9..12,
            Self::AccelAsymmetry => 12..15,
            Self::AccelQuadratic => 15..18,
            Self::GyroGaussMarkov => 18..21,
            Self::AccelGaussMarkov => 21..24,
            Self::Deflection => 24..26,
            Self::GravityAnomaly => 26..27,
        }
    }

    /// First place among the further states.
    pub(crate) const fn start(self) -> usize {
        self.range().start
    }

    /// Name, as in a scenario.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::AccelLever => "accel_lever",
            Self::GyroAsymmetry => "gyro_asymmetry",
            Self::AccelAsymmetry => "accel_asymmetry",
            Self::AccelQuadratic => "accel_quadratic",
            Self::GyroGaussMarkov => "gyro_gauss_markov",
            Self::AccelGaussMarkov => "accel_gauss_markov",
            Self::Deflection => "deflection",
            Self::GravityAnomaly => "gravity_anomaly",
        }
    }
}

/// Estimates of all further states with their standard deviations, SI, in the order of
/// [`FURTHER_NAMES`]. Those of a group that is off are zero; of one that is considered, the estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct FurtherEstimates {
    /// Estimates: zero where a group isn't estimated.
    pub value: [f64; FURTHER_COUNT],
    /// Standard deviations: zero where a group is off.
    pub sigma: [f64; FURTHER_COUNT],
}

impl FurtherEstimates {
    /// Estimates of a group.
    #[must_use]
    pub fn value_of(&self, group: FurtherGroup) -> &[f64] {
        &self.value[group.range()]
    }

    /// Standard deviations of a group.
    #[must_use]
    pub fn sigma_of(&self, group: FurtherGroup) -> &[f64] {
        &self.sigma[group.range()]
    }
}
