//! Quantities and units of the tables. Values are SI, except whole nanoseconds; the display units
//! are those of the field.
//!
//! Names of units are those that tools recognise: `rad/s`, `m/s2`, `deg`, `deg/h`.

use crate::table::{DeclaredQuantity, DeclaredUnit};
use octant_earth::units::{
    ARCSEC, DEG, DEG_PER_HOUR, DEG_PER_HOUR_PER_G, DEG_PER_SQRT_HOUR, MICRO_G, PPM,
    STANDARD_GRAVITY_MPS2,
};

/// Exponents of kg, m, s and rad.
const fn base(kg: i8, m: i8, s: i8, rad: i8) -> Option<[i8; 8]> {
    Some([kg, m, s, 0, 0, 0, 0, rad])
}

/// Exponents of m, s, K and rad, for effects of temperature.
const fn thermal(m: i8, s: i8, k: i8, rad: i8) -> Option<[i8; 8]> {
    Some([0, m, s, 0, k, 0, 0, rad])
}

macro_rules! units {
    ($($(#[$doc:meta])* $unit:ident = $name:literal $exponents:expr, $factor:expr, [$($display:literal $si:expr),*];)*) => {$(
        $(#[$doc])*
        pub static $unit: DeclaredUnit = DeclaredUnit {
            name: $name,
            exponents: $exponents,
            factor: $factor,
            display: &[$(($display, $factor / $si)),*],
        };
    )*};
}

units! {
    /// Angle.
    RAD = "rad" base(0, 0, 0, 1), 1.0, ["deg" DEG, "arcmin" DEG / 60.0, "arcsec" ARCSEC];
    /// Angular rate.
    RAD_PER_S = "rad/s" base(0, 0, -1, 1), 1.0, ["deg/s" DEG, "deg/h" DEG_PER_HOUR];
    /// Angular acceleration.
    RAD_PER_S2 = "rad/s2" base(0, 0, -2, 1), 1.0, ["deg/s2" DEG];
    /// Angular rate per specific force.
    RAD_PER_S_PER_MPS2 = "rad/s/(m/s2)" base(0, -1, 1, 1), 1.0, ["deg/h/g" DEG_PER_HOUR_PER_G];
    /// Angle random walk.
    RAD_PER_SQRT_S = "rad/s^(1/2)" None, 1.0, ["deg/h^(1/2)" DEG_PER_SQRT_HOUR];
    /// Length.
    M = "m" base(0, 1, 0, 0), 1.0, [];
    /// Velocity.
    M_PER_S = "m/s" base(0, 1, -1, 0), 1.0, ["mm/s" 1e-3];
    /// Acceleration.
    M_PER_S2 = "m/s2" base(0, 1, -2, 0), 1.0, ["ug" MICRO_G, "g" STANDARD_GRAVITY_MPS2];
    /// Rate of change of acceleration.
    M_PER_S3 = "m/s3" base(0, 1, -3, 0), 1.0, [];
    /// Velocity random walk.
    M_PER_S2_PER_SQRT_HZ = "m/s^(3/2)" None, 1.0, ["ug/Hz^(1/2)" MICRO_G];
    /// Time.
    S = "s" base(0, 0, 1, 0), 1.0, ["min" 60.0, "h" 3600.0];
    /// Time as whole nanoseconds.
    NS = "ns" base(0, 0, 1, 0), 1e-9, ["ms" 1e-3];
    /// Rate random walk.
    RAD_PER_S_SQRT_S = "rad/s^(3/2)" None, 1.0, ["deg/h^(3/2)" DEG_PER_HOUR / 60.0];
    /// Frequency.
    HZ = "Hz" base(0, 0, -1, 0), 1.0, [];
    /// Temperature.
    K = "K" thermal(0, 0, 1, 0), 1.0, [];
    /// Rate of change of temperature.
    K_PER_S = "K/s" thermal(0, -1, 1, 0), 1.0, ["K/h" 1.0 / 3600.0];
    /// Angular rate per temperature.
    RAD_PER_S_PER_K = "rad/(s.K)" thermal(0, -1, -1, 1), 1.0, ["deg/(h.K)" DEG_PER_HOUR];
    /// Acceleration per temperature.
    M_PER_S2_PER_K = "m/(s2.K)" thermal(1, -2, -1, 0), 1.0, ["ug/K" MICRO_G];
    /// Ratio per temperature.
    PER_K = "1/K" thermal(0, 0, -1, 0), 1.0, ["ppm/K" PPM];
    /// A ratio.
    ONE = "1" base(0, 0, 0, 0), 1.0, ["ppm" PPM];
}

macro_rules! quantities {
    ($($(#[$doc:meta])* $quantity:ident = $name:literal $unit:ident $display:expr;)*) => {$(
        $(#[$doc])*
        pub static $quantity: DeclaredQuantity = DeclaredQuantity { name: $name, unit: &$unit, display: $display };
    )*};
}

quantities! {
    /// Angle.
    ANGLE = "Angle" RAD Some("deg");
    /// Angle of the size of an error.
    SMALL_ANGLE = "SmallAngle" RAD Some("arcsec");
    /// Integrated angular rate of a sample.
    ANGLE_INCREMENT = "AngleIncrement" RAD Some("arcsec");
    /// Angular rate of a turntable.
    TURN_RATE = "TurnRate" RAD_PER_S Some("deg/s");
    /// Angular rate of the size of a gyro's error.
    GYRO_BIAS = "GyroBias" RAD_PER_S Some("deg/h");
    /// Angular acceleration.
    ANGULAR_ACCELERATION = "AngularAcceleration" RAD_PER_S2 Some("deg/s2");
    /// Gyro bias per specific force.
    G_DEPENDENT = "GDependentBias" RAD_PER_S_PER_MPS2 Some("deg/h/g");
    /// Angle random walk.
    ANGLE_RANDOM_WALK = "AngleRandomWalk" RAD_PER_SQRT_S Some("deg/h^(1/2)");
    /// Length.
    LENGTH = "Length" M None;
    /// Velocity.
    VELOCITY = "Velocity" M_PER_S None;
    /// Velocity of the size of an error.
    SMALL_VELOCITY = "SmallVelocity" M_PER_S Some("mm/s");
    /// Integrated specific force of a sample.
    VELOCITY_INCREMENT = "VelocityIncrement" M_PER_S None;
    /// Acceleration.
    ACCELERATION = "Acceleration" M_PER_S2 None;
    /// Acceleration of the size of an accelerometer's error.
    ACCEL_BIAS = "AccelerometerBias" M_PER_S2 Some("ug");
    /// Rate of change of acceleration.
    JERK = "Jerk" M_PER_S3 None;
    /// Velocity random walk.
    VELOCITY_RANDOM_WALK = "VelocityRandomWalk" M_PER_S2_PER_SQRT_HZ Some("ug/Hz^(1/2)");
    /// Rate random walk.
    RATE_RANDOM_WALK = "RateRandomWalk" RAD_PER_S_SQRT_S Some("deg/h^(3/2)");
    /// Frequency.
    FREQUENCY = "Frequency" HZ None;
    /// Change of temperature.
    TEMPERATURE = "TemperatureChange" K None;
    /// Rate of change of temperature.
    TEMPERATURE_RATE = "TemperatureRate" K_PER_S Some("K/h");
    /// Sensitivity of a gyro's bias to temperature.
    GYRO_BIAS_PER_K = "GyroBiasPerTemperature" RAD_PER_S_PER_K Some("deg/(h.K)");
    /// Sensitivity of an accelerometer's bias to temperature.
    ACCEL_BIAS_PER_K = "AccelerometerBiasPerTemperature" M_PER_S2_PER_K Some("ug/K");
    /// Sensitivity of a scale factor to temperature.
    SCALE_PER_K = "ScaleFactorPerTemperature" PER_K Some("ppm/K");
    /// Time.
    TIME = "Time" S None;
    /// Time of the length of a procedure.
    DURATION = "Duration" S Some("h");
    /// Time as whole nanoseconds.
    NANOSECONDS = "Nanoseconds" NS Some("ms");
    /// Ratio of the size of a scale factor error.
    SCALE_ERROR = "ScaleFactorError" ONE Some("ppm");
}

/// Quantities of the parameter groups, in the order of [`octant_sample::parameters::ParameterGroup::ALL`].
pub static OF_GROUP: [&DeclaredQuantity; 7] =
    [&GYRO_BIAS, &SCALE_ERROR, &SMALL_ANGLE, &G_DEPENDENT, &ACCEL_BIAS, &SCALE_ERROR, &SMALL_ANGLE];
