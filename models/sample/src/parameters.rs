//! The thirty calibrated parameters: the coefficients of the error, measured − true.
//!
//! ```text
//! ω̃ = (I + M_g) ω + b_g + G f        M_g full 3×3
//! f̃ = (I + M_a) f + b_a              M_a lower triangular
//! ```

/// Number of calibrated parameters.
pub const PARAMETER_COUNT: usize = 30;

/// Standard gravity, the g of "µg" and "per g", m/s².
pub(crate) const STANDARD_GRAVITY: f64 = 9.806_65;
const RAD_PER_DEG: f64 = core::f64::consts::PI / 180.0;

/// Parameters in SI, in the order of the filter's states. They are errors: compensation subtracts
/// them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Parameters {
    /// Gyro bias b_g, rad/s.
    pub gyro_bias: [f64; 3],
    /// Gyro scale factor errors, the diagonal of M_g.
    pub gyro_scale: [f64; 3],
    /// Gyro misalignments, rad: M_g at xy, xz, yx, yz, zx, zy (row, column).
    pub gyro_misalignment: [f64; 6],
    /// g-dependent gyro bias G by rows, (rad/s)/(m/s²).
    pub g_dependent: [f64; 9],
    /// Accelerometer bias b_a, m/s².
    pub accel_bias: [f64; 3],
    /// Accelerometer scale factor errors, the diagonal of M_a.
    pub accel_scale: [f64; 3],
    /// Accelerometer misalignments, rad: M_a at yx, zx, zy.
    pub accel_misalignment: [f64; 3],
}

/// A group of parameters that share a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ParameterGroup {
    /// b_g, shown in deg/h.
    GyroBias,
    /// Diagonal of M_g, shown in ppm.
    GyroScale,
    /// Off-diagonal of M_g, shown in arcsec.
    GyroMisalignment,
    /// G, shown in deg/h/g.
    GDependent,
    /// b_a, shown in ug.
    AccelBias,
    /// Diagonal of M_a, shown in ppm.
    AccelScale,
    /// Lower triangle of M_a, shown in arcsec.
    AccelMisalignment,
}

impl ParameterGroup {
    /// The groups in the order of the parameters.
    pub const ALL: [Self; 7] = [
        Self::GyroBias,
        Self::GyroScale,
        Self::GyroMisalignment,
        Self::GDependent,
        Self::AccelBias,
        Self::AccelScale,
        Self::AccelMisalignment,
    ];

    /// Name of the group as used in scenarios and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::GyroBias => "gyro_bias",
            Self::GyroScale => "gyro_scale",
            Self::GyroMisalignment => "gyro_misalignment",
            Self::GDependent => "g_dependent",
            Self::AccelBias => "accel_bias",
            Self::AccelScale => "accel_scale",
            Self::AccelMisalignment => "accel_misalignment",
        }
    }

    /// Index of the first parameter and number of parameters of the group.
    #[must_use]
    pub const fn range(self) -> core::ops::Range<usize> {
        match self {
            Self::GyroBias => 0..3,
            Self::GyroScale => 3..6,
            Self::GyroMisalignment => 6..12,
            Self::GDependent => 12..21,
            Self::AccelBias => 21..24,
            Self::AccelScale => 24..27,
            Self::AccelMisalignment => 27..30,
        }
    }

    /// Unit shown to users.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::GyroBias => "deg/h",
            Self::GyroScale | Self::AccelScale => "ppm",
            Self::GyroMisalignment | Self::AccelMisalignment => "arcsec",
            Self::GDependent => "deg/h/g",
            Self::AccelBias => "ug",
        }
    }

    /// SI value of one unit shown to users.
    #[must_use]
    pub const fn si_per_unit(self) -> f64 {
        match self {
            Self::GyroBias => RAD_PER_DEG / 3600.0,
            Self::GyroScale | Self::AccelScale => 1e-6,
            Self::GyroMisalignment | Self::AccelMisalignment => RAD_PER_DEG / 3600.0,
            Self::GDependent => RAD_PER_DEG / 3600.0 / STANDARD_GRAVITY,
            Self::AccelBias => 1e-6 * STANDARD_GRAVITY,
        }
    }

    /// Group of the parameter with this index.
    ///
    /// # Panics
    /// If `index` is not below [`PARAMETER_COUNT`].
    #[must_use]
    pub fn of(index: usize) -> Self {
        assert!(index < PARAMETER_COUNT, "parameter index {index} out of range");
        let mut found = Self::GyroBias;
        for group in Self::ALL {
            if group.range().contains(&index) {
                found = group;
            }
        }
        found
    }
}

/// Names of the parameters in order, as used in results, FMUs and golden files.
pub const NAMES: [&str; PARAMETER_COUNT] = [
    "gyro_bias_x",
    "gyro_bias_y",
    "gyro_bias_z",
    "gyro_scale_x",
    "gyro_scale_y",
    "gyro_scale_z",
    "gyro_misalignment_xy",
    "gyro_misalignment_xz",
    "gyro_misalignment_yx",
    "gyro_misalignment_yz",
    "gyro_misalignment_zx",
    "gyro_misalignment_zy",
    "g_xx",
    "g_xy",
    "g_xz",
    "g_yx",
    "g_yy",
    "g_yz",
    "g_zx",
    "g_zy",
    "g_zz",
    "accel_bias_x",
    "accel_bias_y",
    "accel_bias_z",
    "accel_scale_x",
    "accel_scale_y",
    "accel_scale_z",
    "accel_misalignment_yx",
    "accel_misalignment_zx",
    "accel_misalignment_zy",
];

impl Parameters {
    /// Returns the parameters as one vector, in the order of [`NAMES`].
    #[must_use]
    pub fn to_array(&self) -> [f64; PARAMETER_COUNT] {
        let mut all = [0.0; PARAMETER_COUNT];
        all[0..3].copy_from_slice(&self.gyro_bias);
        all[3..6].copy_from_slice(&self.gyro_scale);
        all[6..12].copy_from_slice(&self.gyro_misalignment);
        all[12..21].copy_from_slice(&self.g_dependent);
        all[21..24].copy_from_slice(&self.accel_bias);
        all[24..27].copy_from_slice(&self.accel_scale);
        all[27..30].copy_from_slice(&self.accel_misalignment);
        all
    }

    /// Makes the parameters from one vector, in the order of [`NAMES`].
    #[must_use]
    pub fn from_array(all: &[f64; PARAMETER_COUNT]) -> Self {
        let mut parameters = Self::default();
        parameters.gyro_bias.copy_from_slice(&all[0..3]);
        parameters.gyro_scale.copy_from_slice(&all[3..6]);
        parameters.gyro_misalignment.copy_from_slice(&all[6..12]);
        parameters.g_dependent.copy_from_slice(&all[12..21]);
        parameters.accel_bias.copy_from_slice(&all[21..24]);
        parameters.accel_scale.copy_from_slice(&all[24..27]);
        parameters.accel_misalignment.copy_from_slice(&all[27..30]);
        parameters
    }

    /// M_g by rows.
    #[must_use]
    pub fn gyro_matrix(&self) -> [[f64; 3]; 3] {
        let (s, m) = (&self.gyro_scale, &self.gyro_misalignment);
        [[s[0], m[0], m[1]], [m[2], s[1], m[3]], [m[4], m[5], s[2]]]
    }

    /// G by rows.
    #[must_use]
    pub fn g_matrix(&self) -> [[f64; 3]; 3] {
        let g = &self.g_dependent;
        [[g[0], g[1], g[2]], [g[3], g[4], g[5]], [g[6], g[7], g[8]]]
    }

    /// M_a by rows, lower triangular.
    #[must_use]
    pub fn accel_matrix(&self) -> [[f64; 3]; 3] {
        let (s, m) = (&self.accel_scale, &self.accel_misalignment);
        [[s[0], 0.0, 0.0], [m[0], s[1], 0.0], [m[1], m[2], s[2]]]
    }
}

/// The estimated parameters with their standard deviations, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterEstimate {
    /// Revision: equal to [`Output::parameters_revision`](crate::Output::parameters_revision) of the output that it belongs to.
    pub revision: u32,
    /// Estimates.
    pub parameters: Parameters,
    /// 1σ in the order of [`NAMES`].
    pub sigma: [f64; PARAMETER_COUNT],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vector_form_keeps_every_parameter_in_its_place() {
        let mut all = [0.0; PARAMETER_COUNT];
        for (i, value) in all.iter_mut().enumerate() {
            *value = i as f64;
        }
        let parameters = Parameters::from_array(&all);
        assert_eq!(parameters.to_array(), all);
        assert_eq!(parameters.gyro_matrix()[1][2], 9.0, "gyro_misalignment_yz is state 9");
        assert_eq!(parameters.g_matrix()[2][2], 20.0, "g_zz is state 20");
        assert_eq!(parameters.accel_matrix()[2][1], 29.0, "accel_misalignment_zy is state 29");
    }

    #[test]
    fn every_parameter_belongs_to_one_group() {
        for (i, name) in NAMES.iter().enumerate() {
            let group = ParameterGroup::of(i);
            let prefix = if group == ParameterGroup::GDependent { "g_" } else { group.name() };
            assert!(name.starts_with(prefix), "{name} in {group:?}");
        }
    }
}
