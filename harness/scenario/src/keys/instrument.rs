//! Keys of the sensors and of the turntable.

use super::definition::{Bounds, Default, Key, Kind, Section, key, one_of, section};
use crate::quantity::Dimension;
use octant_earth::units::DEG;

/// Keys of one parameter group: a distribution to draw from, or the values.
macro_rules! group {
    ($keys:ident, $dimension:expr, $count:expr, $order:literal) => {
        static $keys: Section = one_of(&[
            key(
                "normal",
                Kind::Quantity(&[$dimension], Bounds::NotNegative),
                Default::Absent("another is given"),
                "Drawn from a normal distribution of this standard deviation, each entry alone.",
            ),
            key(
                "uniform",
                Kind::Quantity(&[$dimension], Bounds::NotNegative),
                Default::Absent("another is given"),
                "Drawn evenly within plus and minus this half width, each entry alone.",
            ),
            key(
                "constant",
                Kind::Quantities($dimension, $count),
                Default::Absent("another is given"),
                concat!("The values themselves: ", $order, "."),
            ),
        ]);
    };
}
group!(GYRO_BIAS, Dimension::GYRO_BIAS, 3, "x, y, z");
group!(SCALE, Dimension::RATIO, 3, "x, y, z");
group!(GYRO_MISALIGNMENT, Dimension::SMALL_ANGLE, 6, "xy, xz, yx, yz, zx, zy");
group!(G_DEPENDENT, Dimension::G_DEPENDENT, 9, "by rows xx, xy, xz, yx, yy, yz, zx, zy, zz");
group!(ACCEL_BIAS, Dimension::ACCEL_BIAS, 3, "x, y, z");
group!(ACCEL_MISALIGNMENT, Dimension::SMALL_ANGLE, 3, "yx, zx, zy");

pub(crate) static IMU: Section = section(&[
    key(
        "model",
        Kind::Choice(&[(
            "table-1",
            "the reference instrument of the paper (Zheng, Han and Zheng, 2015, Table 1)",
        )]),
        Default::Value("table-1"),
        "Instrument whose values stand where no others are given.",
    ),
    key(
        "rate",
        Kind::Quantity(&[Dimension::FREQUENCY], Bounds::Within(1.0, 10e3, "from 1 Hz to 10 kHz")),
        Default::Value("200 Hz"),
        "Samples per second; the period is a whole number of nanoseconds.",
    ),
    key(
        "angle_random_walk",
        Kind::Quantity(&[Dimension::ANGLE_RANDOM_WALK], Bounds::NotNegative),
        Default::Value("0.0007 deg/sqrt(h)"),
        "Angle random walk of each gyro.",
    ),
    key(
        "velocity_random_walk",
        Kind::Quantity(&[Dimension::VELOCITY_RANDOM_WALK], Bounds::NotNegative),
        Default::Value("50 ug/sqrt(Hz)"),
        "Noise density of each accelerometer.",
    ),
    key(
        "gyro_bias",
        Kind::Table(&GYRO_BIAS),
        Default::Value(r#"{ normal = "0.005 deg/h" }"#),
        "Constant gyro biases.",
    ),
    key(
        "gyro_scale",
        Kind::Table(&SCALE),
        Default::Value(r#"{ uniform = "30 ppm" }"#),
        "Gyro scale factor errors.",
    ),
    key(
        "gyro_misalignment",
        Kind::Table(&GYRO_MISALIGNMENT),
        Default::Value(r#"{ uniform = "40 arcsec" }"#),
        "Gyro misalignments.",
    ),
    key(
        "g_dependent",
        Kind::Table(&G_DEPENDENT),
        Default::Value(r#"{ normal = "0.0005 deg/h/g" }"#),
        "g-dependent gyro biases, a full matrix.",
    ),
    key(
        "accel_bias",
        Kind::Table(&ACCEL_BIAS),
        Default::Value(r#"{ normal = "100 ug" }"#),
        "Constant accelerometer biases.",
    ),
    key(
        "accel_scale",
        Kind::Table(&SCALE),
        Default::Value(r#"{ uniform = "30 ppm" }"#),
        "Accelerometer scale factor errors.",
    ),
    key(
        "accel_misalignment",
        Kind::Table(&ACCEL_MISALIGNMENT),
        Default::Value(r#"{ uniform = "40 arcsec" }"#),
        "Accelerometer misalignments; the accelerometers define the body frame.",
    ),
    key(
        "extensions",
        Kind::Table(&EXTENSIONS),
        Default::Section,
        "What the sensors have and the filter doesn't model.",
    ),
]);

static EXTENSIONS: Section = section(&[
    key(
        "gyro_gauss_markov",
        Kind::Table(&GYRO_GAUSS_MARKOV),
        Default::Absent("none"),
        "First-order Gauss-Markov gyro bias.",
    ),
    key(
        "accel_gauss_markov",
        Kind::Table(&ACCEL_GAUSS_MARKOV),
        Default::Absent("none"),
        "First-order Gauss-Markov accelerometer bias.",
    ),
    key(
        "gyro_rate_random_walk",
        Kind::Quantity(&[Dimension::RATE_RANDOM_WALK], Bounds::NotNegative),
        Default::Value("0 deg/h/sqrt(h)"),
        "Rate random walk of each gyro.",
    ),
    key(
        "gyro_quantization",
        Kind::Quantity(&[Dimension::SMALL_ANGLE], Bounds::NotNegative),
        Default::Value("0 arcsec"),
        "Angle of one gyro count, where coarser than the format's 3e-6 arcsec; 0: none.",
    ),
    key(
        "accel_quantization",
        Kind::Quantity(&[Dimension::VELOCITY], Bounds::NotNegative),
        Default::Value("0 m/s"),
        "Velocity of one accelerometer count, where coarser than the format's 1e-9 m/s; 0: none.",
    ),
    key(
        "gyro_range",
        Kind::Quantity(&[Dimension::ANGULAR_RATE], Bounds::NotNegative),
        Default::Value("300 deg/s"),
        "Rate at which the gyros saturate; 0: the format's own range.",
    ),
    key(
        "accel_range",
        Kind::Quantity(&[Dimension::ACCELERATION], Bounds::NotNegative),
        Default::Value("40 g"),
        "Specific force at which the accelerometers saturate; 0: the format's own range.",
    ),
    key(
        "temperature",
        Kind::Table(&TEMPERATURE),
        Default::Absent("constant temperature"),
        "A linear temperature ramp that ends at a plateau, and what it does.",
    ),
    key(
        "vibration",
        Kind::Table(&VIBRATION),
        Default::Absent("none"),
        "Sinusoidal vibration of the sensor block, felt alike by gyros and accelerometers.",
    ),
    key(
        "lever_arm",
        Kind::Table(&LEVER_ARM),
        Default::Section,
        "Position of each accelerometer from the centre of rotation (size effect).",
    ),
    key(
        "time_skew",
        Kind::Quantity(&[Dimension::TIME], Bounds::Within(-1.0, 1.0, "within ±1 s")),
        Default::Value("0 s"),
        "Stamp minus true time of validity of the inertial data, against the gimbal angles.",
    ),
]);

const CORRELATION_TIME: Key = key(
    "correlation_time",
    Kind::Quantity(&[Dimension::TIME], Bounds::Positive),
    Default::Required,
    "Correlation time.",
);

static GYRO_GAUSS_MARKOV: Section = section(&[
    key(
        "sigma",
        Kind::Quantity(&[Dimension::GYRO_BIAS], Bounds::NotNegative),
        Default::Required,
        "Stationary standard deviation.",
    ),
    CORRELATION_TIME,
]);

static ACCEL_GAUSS_MARKOV: Section = section(&[
    key(
        "sigma",
        Kind::Quantity(&[Dimension::ACCEL_BIAS], Bounds::NotNegative),
        Default::Required,
        "Stationary standard deviation.",
    ),
    CORRELATION_TIME,
]);

static TEMPERATURE: Section = section(&[
    key(
        "ramp",
        Kind::Quantity(&[Dimension::TEMPERATURE_RATE], Bounds::Any),
        Default::Required,
        "Change per time, negative when cooling.",
    ),
    key(
        "plateau",
        Kind::Quantity(&[Dimension::TEMPERATURE], Bounds::Any),
        Default::Required,
        "Change at which the ramp ends, of the ramp's sign.",
    ),
    key(
        "gyro_bias",
        Kind::Quantities(Dimension::GYRO_BIAS_PER_K, 3),
        Default::Value(r#"["0 deg/h/K", "0 deg/h/K", "0 deg/h/K"]"#),
        "Gyro bias per kelvin, x, y, z.",
    ),
    key(
        "accel_bias",
        Kind::Quantities(Dimension::ACCEL_BIAS_PER_K, 3),
        Default::Value(r#"["0 ug/K", "0 ug/K", "0 ug/K"]"#),
        "Accelerometer bias per kelvin, x, y, z.",
    ),
    key(
        "gyro_scale",
        Kind::Quantities(Dimension::SCALE_PER_K, 3),
        Default::Value(r#"["0 ppm/K", "0 ppm/K", "0 ppm/K"]"#),
        "Gyro scale factor per kelvin, x, y, z.",
    ),
    key(
        "accel_scale",
        Kind::Quantities(Dimension::SCALE_PER_K, 3),
        Default::Value(r#"["0 ppm/K", "0 ppm/K", "0 ppm/K"]"#),
        "Accelerometer scale factor per kelvin, x, y, z.",
    ),
]);

static VIBRATION: Section = section(&[
    key(
        "frequency",
        Kind::Quantity(&[Dimension::FREQUENCY], Bounds::Positive),
        Default::Required,
        "Frequency.",
    ),
    key(
        "displacement",
        Kind::Quantities(Dimension::LENGTH, 3),
        Default::Value(r#"["0 m", "0 m", "0 m"]"#),
        "Amplitude of the linear motion in body axes x, y, z.",
    ),
    key(
        "angle",
        Kind::Quantities(Dimension::SMALL_ANGLE, 3),
        Default::Value(r#"["0 arcsec", "0 arcsec", "0 arcsec"]"#),
        "Amplitude of the angular motion about body axes x, y, z.",
    ),
    key(
        "phase",
        Kind::Quantity(&[Dimension::ANGLE], Bounds::Any),
        Default::Value("0 deg"),
        "Phase of the angular motion against the linear one.",
    ),
]);

const ARM: &str = r#"["0 m", "0 m", "0 m"]"#;

static LEVER_ARM: Section = section(&[
    key(
        "x",
        Kind::Quantities(Dimension::LENGTH, 3),
        Default::Value(ARM),
        "Of the x accelerometer.",
    ),
    key(
        "y",
        Kind::Quantities(Dimension::LENGTH, 3),
        Default::Value(ARM),
        "Of the y accelerometer.",
    ),
    key(
        "z",
        Kind::Quantities(Dimension::LENGTH, 3),
        Default::Value(ARM),
        "Of the z accelerometer.",
    ),
]);

pub(crate) static TURNTABLE: Section = section(&[
    key(
        "rate",
        Kind::Quantity(
            &[Dimension::ANGULAR_RATE],
            Bounds::Within(0.01 * DEG, 350.0 * DEG, "from 0.01 deg/s to 350 deg/s"),
        ),
        Default::Value("10 deg/s"),
        "Largest rate of a move.",
    ),
    key(
        "acceleration",
        Kind::Quantity(&[Dimension::ANGULAR_ACCELERATION], Bounds::Positive),
        Default::Value("10 deg/s^2"),
        "Acceleration of a move.",
    ),
    key(
        "encoder_error",
        Kind::Quantity(&[Dimension::SMALL_ANGLE], Bounds::NotNegative),
        Default::Value("18 arcsec"),
        "Error of the angle encoders, one standard deviation: a fixed curve over the angle.",
    ),
    key(
        "non_orthogonality",
        Kind::Quantity(&[Dimension::SMALL_ANGLE], Bounds::Within(-DEG, DEG, "within ±1 deg")),
        Default::Value("0 arcsec"),
        "Angle by which the two gimbal axes miss a right angle.",
    ),
    key(
        "backlash",
        Kind::Quantity(&[Dimension::SMALL_ANGLE], Bounds::Within(0.0, DEG, "from 0 to 1 deg")),
        Default::Value("0 arcsec"),
        "Play of each gear.",
    ),
    key(
        "drive",
        Kind::Table(&super::drive::DRIVE),
        Default::Absent("no table is turned: the gimbals are those of the source"),
        "A real table that the core's set points turn, under a real instrument. It can hurt people: read docs/turntable.md first.",
    ),
]);
