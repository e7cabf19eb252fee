//! Further states of a calibration: errors beside the thirty parameters. What each of them is stands in the core's
//! module of the same name.

use crate::parameters::{ParameterGroup, STANDARD_GRAVITY};
use core::ops::Range;

/// Number of further states.
pub const FURTHER_COUNT: usize = 47;

/// Number of those that drive attitude and velocity, the first ones: errors of sensors and of gravity. The
/// others are errors of the gimbals and their encoders, which drive nothing.
pub const DRIVING_COUNT: usize = 39;

/// First of those that follow the temperature: the last that drive attitude and velocity.
pub const TEMPERATURE_START: usize = 27;

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
    "gyro_bias_temperature_x",
    "gyro_bias_temperature_y",
    "gyro_bias_temperature_z",
    "gyro_scale_temperature_x",
    "gyro_scale_temperature_y",
    "gyro_scale_temperature_z",
    "accel_bias_temperature_x",
    "accel_bias_temperature_y",
    "accel_bias_temperature_z",
    "accel_scale_temperature_x",
    "accel_scale_temperature_y",
    "accel_scale_temperature_z",
    "gimbal_mounting_x",
    "gimbal_mounting_y",
    "gimbal_mounting_z",
    "gimbal_non_orthogonality",
    "encoder_azimuth_cosine",
    "encoder_azimuth_sine",
    "encoder_roll_cosine",
    "encoder_roll_sine",
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
    /// Temperature coefficients of the gyro biases, (rad/s)/K.
    GyroBiasTemperature,
    /// Temperature coefficients of the gyros' scale factors, 1/K.
    GyroScaleTemperature,
    /// Temperature coefficients of the accelerometer biases, (m/s²)/K.
    AccelBiasTemperature,
    /// Temperature coefficients of the accelerometers' scale factors, 1/K.
    AccelScaleTemperature,
    /// Mounting of the body on the inner gimbal, rad: the body is turned by this vector in its own
    /// axes. The zero error of the azimuth encoder counts as minus z.
    GimbalMounting,
    /// Angle by which the gimbal axes miss a right angle, rad: the inner leans towards the outer.
    GimbalNonOrthogonality,
    /// Eccentricity of the encoders, rad: coefficients of cosine and sine of the angle in the error of
    /// azimuth, then of roll.
    EncoderEccentricity,
}

impl FurtherGroup {
    /// All groups, in the order in which they are stored.
    pub const ALL: [Self; 15] = [
        Self::AccelLever,
        Self::GyroAsymmetry,
        Self::AccelAsymmetry,
        Self::AccelQuadratic,
        Self::GyroGaussMarkov,
        Self::AccelGaussMarkov,
        Self::Deflection,
        Self::GravityAnomaly,
        Self::GyroBiasTemperature,
        Self::GyroScaleTemperature,
        Self::AccelBiasTemperature,
        Self::AccelScaleTemperature,
        Self::GimbalMounting,
        Self::GimbalNonOrthogonality,
        Self::EncoderEccentricity,
    ];

    /// Groups of errors of the gimbals, which only angles as measurements show.
    pub const OF_GIMBALS: [Self; 3] =
        [Self::GimbalMounting, Self::GimbalNonOrthogonality, Self::EncoderEccentricity];

    /// Groups of errors that follow the temperature, which only a thermometer shows.
    pub const OF_TEMPERATURE: [Self; 4] = [
        Self::GyroBiasTemperature,
        Self::GyroScaleTemperature,
        Self::AccelBiasTemperature,
        Self::AccelScaleTemperature,
    ];

    /// Returns whether the errors are those of the gimbals.
    #[must_use]
    pub const fn is_of_gimbals(self) -> bool {
        self.start() >= DRIVING_COUNT
    }

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
            Self::GyroBiasTemperature => 27..30,
            Self::GyroScaleTemperature => 30..33,
            Self::AccelBiasTemperature => 33..36,
            Self::AccelScaleTemperature => 36..39,
            Self::GimbalMounting => 39..42,
            Self::GimbalNonOrthogonality => 42..43,
            Self::EncoderEccentricity => 43..47,
        }
    }

    /// First place among the further states.
    #[must_use]
    pub const fn start(self) -> usize {
        self.range().start
    }

    /// Group of the further state at this place; `None` beyond the last.
    #[must_use]
    pub fn of(index: usize) -> Option<Self> {
        Self::ALL.into_iter().find(|group| group.range().contains(&index))
    }

    /// Unit shown to users.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::AccelLever => "mm",
            Self::GyroAsymmetry | Self::AccelAsymmetry => "ppm",
            Self::AccelQuadratic => "ug/g^2",
            Self::GyroGaussMarkov => "deg/h",
            Self::AccelGaussMarkov | Self::GravityAnomaly => "ug",
            Self::GyroBiasTemperature => "deg/h/K",
            Self::GyroScaleTemperature | Self::AccelScaleTemperature => "ppm/K",
            Self::AccelBiasTemperature => "ug/K",
            Self::Deflection
            | Self::GimbalMounting
            | Self::GimbalNonOrthogonality
            | Self::EncoderEccentricity => "arcsec",
        }
    }

    /// SI value of one unit shown to users.
    #[must_use]
    pub const fn si_per_unit(self) -> f64 {
        match self {
            Self::AccelLever => 1e-3,
            Self::GyroAsymmetry
            | Self::AccelAsymmetry
            | Self::GyroScaleTemperature
            | Self::AccelScaleTemperature => 1e-6,
            Self::AccelQuadratic => 1e-6 / STANDARD_GRAVITY,
            Self::GyroGaussMarkov | Self::GyroBiasTemperature => {
                ParameterGroup::GyroBias.si_per_unit()
            }
            Self::AccelGaussMarkov | Self::GravityAnomaly | Self::AccelBiasTemperature => {
                ParameterGroup::AccelBias.si_per_unit()
            }
            Self::Deflection
            | Self::GimbalMounting
            | Self::GimbalNonOrthogonality
            | Self::EncoderEccentricity => ParameterGroup::GyroMisalignment.si_per_unit(),
        }
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
            Self::GyroBiasTemperature => "gyro_bias_temperature",
            Self::GyroScaleTemperature => "gyro_scale_temperature",
            Self::AccelBiasTemperature => "accel_bias_temperature",
            Self::AccelScaleTemperature => "accel_scale_temperature",
            Self::GimbalMounting => "gimbal_mounting",
            Self::GimbalNonOrthogonality => "gimbal_non_orthogonality",
            Self::EncoderEccentricity => "encoder_eccentricity",
        }
    }
}

/// Estimates of all further states with their standard deviations, SI, in the order of
/// [`FURTHER_NAMES`]. Those of a group that is off are zero; of one that is considered, the estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
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
