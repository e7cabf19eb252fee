//! Keys of the sensors and of the turntable.

use super::definition::Bounds;
use super::drive::DriveKeys;
use super::further::{DrawnExtensionsKeys, DrawnTurntableKeys};
use super::table::{At, choice, keys, si, si_array, si_list, table, time, within};
use crate::model::ParameterDistribution;
use crate::quantity::UnitDimension;
use octant_earth::units::DEG;

/// Keys of one parameter group: a distribution to draw from, or the values.
macro_rules! group {
    ($name:ident, $dimension:expr, $count:expr, $order:literal) => {
        keys! {
            /// A parameter group.
            pub(crate) one of $name {
                normal: Option<f64> = si(&[$dimension], Bounds::NotNegative),
                    "Drawn from a normal distribution of this standard deviation, each entry alone.";
                uniform: Option<f64> = si(&[$dimension], Bounds::NotNegative),
                    "Drawn evenly within plus and minus this half width, each entry alone.";
                constant: Option<Vec<f64>> = si_list($dimension, $count),
                    concat!("The values themselves: ", $order, ".");
            }
        }

        impl $name {
            /// ParameterDistribution of the group.
            pub(crate) fn distribution(&self) -> ParameterDistribution {
                let spread = self.normal.map(ParameterDistribution::Normal);
                let spread = spread.or(self.uniform.map(ParameterDistribution::Uniform));
                spread.unwrap_or_else(|| {
                    ParameterDistribution::Constant(self.constant.clone().unwrap_or_default())
                })
            }
        }
    };
}
group!(GyroBiasKeys, UnitDimension::GYRO_BIAS, 3, "x, y, z");
group!(ScaleKeys, UnitDimension::RATIO, 3, "x, y, z");
group!(GyroMisalignmentKeys, UnitDimension::SMALL_ANGLE, 6, "xy, xz, yx, yz, zx, zy");
group!(GDependentKeys, UnitDimension::G_DEPENDENT, 9, "by rows xx, xy, xz, yx, yy, yz, zx, zy, zz");
group!(AccelBiasKeys, UnitDimension::ACCEL_BIAS, 3, "x, y, z");
group!(AccelMisalignmentKeys, UnitDimension::SMALL_ANGLE, 3, "yx, zx, zy");

keys! {
    /// `[imu]`.
    pub(crate) struct ImuKeys {
        #[expect(dead_code, reason = "it is read before: its values are the defaults of other keys")]
        model: () = choice! {
                "table-1" => (), "the reference instrument of the paper (Zheng, Han and Zheng, 2015, Table 1)";
                "navigation-laser" => (), "laser gyros, navigation grade: Honeywell HG9900";
                "navigation-fibre-optic" => (), "fibre-optic gyros, navigation grade: the inertial grade of Yazdi, Ayazi and Najafi (1998)";
                "tactical-fibre-optic" => (), "fibre-optic gyros, tactical grade: Northrop Grumman LN-200";
                "tactical-mems" => (), "MEMS gyros, tactical grade: Sensonor STIM300";
            }, "table-1",
            "Instrument whose values stand where no others are given, here and in procedure.calibration.prior.";
        rate: At<f64> = within(&[UnitDimension::FREQUENCY], 1.0, 10e3, "from 1 Hz to 10 kHz"), "200 Hz",
            "Samples per second; the period is a whole number of nanoseconds.";
        angle_random_walk: f64
            = si(&[UnitDimension::ANGLE_RANDOM_WALK], Bounds::NotNegative), "0.0007 deg/sqrt(h)",
            "Angle random walk of each gyro.";
        velocity_random_walk: f64
            = si(&[UnitDimension::VELOCITY_RANDOM_WALK], Bounds::NotNegative), "50 ug/sqrt(Hz)",
            "Noise density of each accelerometer.";
        gyro_bias: GyroBiasKeys = table(), r#"{ normal = "0.005 deg/h" }"#, "Constant gyro biases.";
        gyro_scale: ScaleKeys = table(), r#"{ uniform = "30 ppm" }"#, "Gyro scale factor errors.";
        gyro_misalignment: GyroMisalignmentKeys = table(), r#"{ uniform = "40 arcsec" }"#,
            "Gyro misalignments.";
        g_dependent: GDependentKeys = table(), r#"{ normal = "0.0005 deg/h/g" }"#,
            "g-dependent gyro biases, a full matrix.";
        accel_bias: AccelBiasKeys = table(), r#"{ normal = "100 ug" }"#,
            "Constant accelerometer biases.";
        accel_scale: ScaleKeys = table(), r#"{ uniform = "30 ppm" }"#,
            "Accelerometer scale factor errors.";
        accel_misalignment: AccelMisalignmentKeys = table(), r#"{ uniform = "40 arcsec" }"#,
            "Accelerometer misalignments; the accelerometers define the body frame.";
        extensions: ExtensionsKeys = table(), section,
            "What the sensors have and the filter doesn't model.";
    }
}

keys! {
    /// `[imu.extensions]`.
    pub(crate) struct ExtensionsKeys {
        gyro_gauss_markov: Option<GyroGaussMarkovKeys>
            = table::<GyroGaussMarkovKeys>(), absent("none"),
            "First-order Gauss-Markov gyro bias.";
        accel_gauss_markov: Option<AccelGaussMarkovKeys>
            = table::<AccelGaussMarkovKeys>(), absent("none"),
            "First-order Gauss-Markov accelerometer bias.";
        gyro_rate_random_walk: f64
            = si(&[UnitDimension::RATE_RANDOM_WALK], Bounds::NotNegative), "0 deg/h/sqrt(h)",
            "Rate random walk of each gyro.";
        gyro_bias_instability: f64 = si(&[UnitDimension::GYRO_BIAS], Bounds::NotNegative), "0 deg/h",
            "Bias instability (1/f noise) of each gyro: coefficient B of IEEE Std 952, the floor of the Allan deviation divided by 0.664.";
        accel_bias_instability: f64 = si(&[UnitDimension::ACCEL_BIAS], Bounds::NotNegative), "0 ug",
            "Bias instability (1/f noise) of each accelerometer: coefficient B, the floor of the Allan deviation divided by 0.664.";
        gyro_quantization: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::NotNegative), "0 arcsec",
            "Angle of one gyro count, where coarser than the format's 3e-6 arcsec; 0: none.";
        accel_quantization: f64 = si(&[UnitDimension::VELOCITY], Bounds::NotNegative), "0 m/s",
            "Velocity of one accelerometer count, where coarser than the format's 1e-9 m/s; 0: none.";
        gyro_range: f64 = si(&[UnitDimension::ANGULAR_RATE], Bounds::NotNegative), "300 deg/s",
            "Rate at which the gyros saturate; 0: the format's own range.";
        accel_range: f64 = si(&[UnitDimension::ACCELERATION], Bounds::NotNegative), "40 g",
            "Specific force at which the accelerometers saturate; 0: the format's own range.";
        temperature: Option<TemperatureKeys>
            = table::<TemperatureKeys>(), absent("constant temperature"),
            "A linear temperature ramp that ends at a plateau, and what it does.";
        vibration: Option<VibrationKeys> = table::<VibrationKeys>(), absent("none"),
            "Sinusoidal vibration of the sensor block, felt alike by gyros and accelerometers.";
        lever_arm: LeverArmKeys = table(), section,
            "Position of each accelerometer from the centre of rotation (size effect).";
        gyro_asymmetry: [f64; 3] = si_array(UnitDimension::RATIO), RATIOS,
            "Asymmetry of the gyros' scale factors a, x, y, z: a reading is too large by a |rate|.";
        accel_asymmetry: [f64; 3] = si_array(UnitDimension::RATIO), RATIOS,
            "Asymmetry of the accelerometers' scale factors a, x, y, z: a reading is too large by a |specific force|.";
        accel_quadratic: [f64; 3]
            = si_array(UnitDimension::ACCEL_QUADRATIC), r#"["0 ug/g^2", "0 ug/g^2", "0 ug/g^2"]"#,
            "Second-order coefficients of the accelerometers (K2), x, y, z.";
        time_skew: f64 = time(-1.0, 1.0, "within ±1 s"), "0 s",
            "Stamp minus true time of validity of the inertial data, against the gimbal angles.";
        drawn: Option<DrawnExtensionsKeys>
            = table::<DrawnExtensionsKeys>(), absent("nothing is drawn"),
            "Errors that the seed draws, each group from its own stream; they add to the values given above.";
    }
}

keys! {
    /// `[imu.extensions.gyro_gauss_markov]`.
    pub(crate) struct GyroGaussMarkovKeys {
        sigma: f64 = si(&[UnitDimension::GYRO_BIAS], Bounds::NotNegative), required,
            "Stationary standard deviation.";
        correlation_time: f64 = si(&[UnitDimension::TIME], Bounds::Positive), required,
            "Correlation time.";
    }
}

keys! {
    /// `[imu.extensions.accel_gauss_markov]`.
    pub(crate) struct AccelGaussMarkovKeys {
        sigma: f64 = si(&[UnitDimension::ACCEL_BIAS], Bounds::NotNegative), required,
            "Stationary standard deviation.";
        correlation_time: f64 = si(&[UnitDimension::TIME], Bounds::Positive), required,
            "Correlation time.";
    }
}

keys! {
    /// `[imu.extensions.temperature]`.
    pub(crate) struct TemperatureKeys {
        ramp: At<f64> = si(&[UnitDimension::TEMPERATURE_RATE], Bounds::Any), required,
            "Change per time, negative when cooling.";
        plateau: At<f64> = si(&[UnitDimension::TEMPERATURE], Bounds::Any), required,
            "Change at which the ramp ends, of the ramp's sign.";
        gyro_bias: [f64; 3]
            = si_array(UnitDimension::GYRO_BIAS_PER_K), r#"["0 deg/h/K", "0 deg/h/K", "0 deg/h/K"]"#,
            "Gyro bias per kelvin, x, y, z.";
        accel_bias: [f64; 3]
            = si_array(UnitDimension::ACCEL_BIAS_PER_K), r#"["0 ug/K", "0 ug/K", "0 ug/K"]"#,
            "Accelerometer bias per kelvin, x, y, z.";
        gyro_scale: [f64; 3]
            = si_array(UnitDimension::SCALE_PER_K), r#"["0 ppm/K", "0 ppm/K", "0 ppm/K"]"#,
            "Gyro scale factor per kelvin, x, y, z.";
        accel_scale: [f64; 3]
            = si_array(UnitDimension::SCALE_PER_K), r#"["0 ppm/K", "0 ppm/K", "0 ppm/K"]"#,
            "Accelerometer scale factor per kelvin, x, y, z.";
    }
}

keys! {
    /// `[imu.extensions.vibration]`.
    pub(crate) struct VibrationKeys {
        frequency: f64 = si(&[UnitDimension::FREQUENCY], Bounds::Positive), required, "Frequency.";
        displacement: [f64; 3] = si_array(UnitDimension::LENGTH), r#"["0 m", "0 m", "0 m"]"#,
            "Amplitude of the linear motion in body axes x, y, z.";
        angle: [f64; 3]
            = si_array(UnitDimension::SMALL_ANGLE), r#"["0 arcsec", "0 arcsec", "0 arcsec"]"#,
            "Amplitude of the angular motion about body axes x, y, z.";
        phase: f64 = si(&[UnitDimension::ANGLE], Bounds::Any), "0 deg",
            "Phase of the angular motion against the linear one.";
    }
}

const RATIOS: &str = r#"["0 ppm", "0 ppm", "0 ppm"]"#;
const ANGLES_2: &str = r#"["0 arcsec", "0 arcsec"]"#;
const ANGLES_3: &str = r#"["0 arcsec", "0 arcsec", "0 arcsec"]"#;
const ARM: &str = r#"["0 m", "0 m", "0 m"]"#;

keys! {
    /// `[imu.extensions.lever_arm]`.
    pub(crate) struct LeverArmKeys {
        x: [f64; 3] = si_array(UnitDimension::LENGTH), ARM, "Of the x accelerometer.";
        y: [f64; 3] = si_array(UnitDimension::LENGTH), ARM, "Of the y accelerometer.";
        z: [f64; 3] = si_array(UnitDimension::LENGTH), ARM, "Of the z accelerometer.";
    }
}

keys! {
    /// `[turntable]`.
    pub(crate) struct TurntableKeys {
        rate: f64
            = within(&[UnitDimension::ANGULAR_RATE], 0.01 * DEG, 350.0 * DEG, "from 0.01 deg/s to 350 deg/s"),
            "10 deg/s",
            "Largest rate of a move.";
        acceleration: f64 = si(&[UnitDimension::ANGULAR_ACCELERATION], Bounds::Positive), "10 deg/s^2",
            "Acceleration of a move.";
        encoder_error: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::NotNegative), "18 arcsec",
            "Error of the angle encoders, one standard deviation: a fixed curve over the angle.";
        non_orthogonality: f64
            = within(&[UnitDimension::SMALL_ANGLE], -DEG, DEG, "within ±1 deg"), "0 arcsec",
            "Angle by which the two gimbal axes miss a right angle.";
        mounting: [f64; 3] = si_array(UnitDimension::SMALL_ANGLE), ANGLES_3,
            "Turn of the body on the inner gimbal about its x, y and z.";
        encoder_zero: [f64; 2] = si_array(UnitDimension::SMALL_ANGLE), ANGLES_2,
            "Zero errors of the encoders of azimuth and roll: measured minus true.";
        eccentricity_azimuth: [f64; 2] = si_array(UnitDimension::SMALL_ANGLE), ANGLES_2,
            "Coefficients c and s of the azimuth encoder's error c cos(angle) + s sin(angle), beside encoder_error.";
        eccentricity_roll: [f64; 2] = si_array(UnitDimension::SMALL_ANGLE), ANGLES_2,
            "The same of the roll encoder.";
        encoder_noise: f64 = si(&[UnitDimension::SMALL_ANGLE], Bounds::NotNegative), "0 arcsec",
            "White noise of each encoder's readings, one standard deviation.";
        drawn: Option<DrawnTurntableKeys>
            = table::<DrawnTurntableKeys>(), absent("nothing is drawn"),
            "Errors of the gimbals that the seed draws, each group from its own stream; they add to the values given above.";
        backlash: f64 = within(&[UnitDimension::SMALL_ANGLE], 0.0, DEG, "from 0 to 1 deg"), "0 arcsec",
            "Play of each gear.";
        drive: Option<DriveKeys>
            = table::<DriveKeys>(),
            absent("no table is turned: the gimbals are those of the source"),
            "A real table that the core's set points turn, under a real instrument. It can hurt people: read docs/turntable.md first.";
    }
}
