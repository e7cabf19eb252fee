//! Keys of the procedure: alignment, calibration, navigation, screening, baseline.

use super::definition::{Bounds, Default, Key, Kind, Section, key, section};
use crate::quantity::Dimension;
use octant_calibration::positions::SEQUENCES;
use octant_earth::units::DEG;

const fn positions() -> [(&'static str, &'static str); SEQUENCES.len()] {
    let mut all = [("", ""); SEQUENCES.len()];
    let mut index = 0;
    while index < all.len() {
        all[index] = (SEQUENCES[index].0, SEQUENCES[index].2);
        index += 1;
    }
    all
}

/// Names and meanings of the core's sequences.
const POSITIONS: &[(&str, &str)] = &positions();

const DURATION: Kind = Kind::Quantity(
    &[Dimension::TIME],
    Bounds::Within(1e-3, 366.0 * 86400.0, "above 0, up to 366 day"),
);

pub(crate) static PROCEDURE: Section = section(&[
    key(
        "alignment",
        Kind::Table(&ALIGNMENT),
        Default::Section,
        "How the initial attitude is found.",
    ),
    key(
        "calibration",
        Kind::Table(&CALIBRATION),
        Default::Absent("no calibration: navigate at once"),
        "Turning through positions and estimating the sensors' errors.",
    ),
    key(
        "navigation",
        Kind::Table(&NAVIGATION),
        Default::Absent("no navigation: the run ends with the calibration"),
        "Free inertial navigation with the compensated sensors, height held.",
    ),
    key(
        "initial_parameters",
        Kind::Table(&INITIAL),
        Default::Absent("zero"),
        "Parameters that the core starts from, of an earlier calibration.",
    ),
]);

static ALIGNMENT: Section = section(&[
    key(
        "method",
        Kind::Choice(&[
            ("given", "attitude and velocity are handed over, with an error drawn from the seed"),
            ("coarse", "gravity and Earth rate averaged over the first seconds of the first stop"),
        ]),
        Default::Value("given"),
        "How the initial attitude is found.",
    ),
    key(
        "tilt",
        Kind::Quantity(
            &[Dimension::SMALL_ANGLE],
            Bounds::Within(0.0, 5.0 * DEG, "from 0 to 5 deg"),
        ),
        Default::Value("60 arcsec"),
        "Error of the tilt handed over, one standard deviation, about north and east.",
    ),
    key(
        "azimuth",
        Kind::Quantity(&[Dimension::ANGLE], Bounds::Within(0.0, 5.0 * DEG, "from 0 to 5 deg")),
        Default::Value("0.1 deg"),
        "Error of the azimuth handed over, one standard deviation.",
    ),
    key(
        "velocity",
        Kind::Quantity(&[Dimension::VELOCITY], Bounds::NotNegative),
        Default::Value("0.02 m/s"),
        "Error of each velocity handed over, one standard deviation.",
    ),
    key(
        "attitude_error",
        Kind::Quantities(Dimension::SMALL_ANGLE, 3),
        Default::Absent("drawn from tilt and azimuth"),
        "The attitude error itself, north, east, down: computed = (I − [φ×]) true.",
    ),
    key(
        "velocity_error",
        Kind::Quantities(Dimension::VELOCITY, 3),
        Default::Absent("drawn from velocity"),
        "The velocity error itself, north, east, down.",
    ),
    key("duration", DURATION, Default::Value("60 s"), "Coarse alignment: how long to average."),
]);

static INITIAL: Section = section(&[
    key(
        "table",
        Kind::Text,
        Default::Absent("the groups below"),
        "Calibration table of an earlier run, such as runs/quick/calibration.octcal, relative to the \
         scenario's folder; stands in place of the groups.",
    ),
    key(
        "gyro_bias",
        Kind::Quantities(Dimension::GYRO_BIAS, 3),
        Default::Absent("zero"),
        "x, y, z.",
    ),
    key("gyro_scale", Kind::Quantities(Dimension::RATIO, 3), Default::Absent("zero"), "x, y, z."),
    key(
        "gyro_misalignment",
        Kind::Quantities(Dimension::SMALL_ANGLE, 6),
        Default::Absent("zero"),
        "xy, xz, yx, yz, zx, zy.",
    ),
    key(
        "g_dependent",
        Kind::Quantities(Dimension::G_DEPENDENT, 9),
        Default::Absent("zero"),
        "By rows.",
    ),
    key(
        "accel_bias",
        Kind::Quantities(Dimension::ACCEL_BIAS, 3),
        Default::Absent("zero"),
        "x, y, z.",
    ),
    key("accel_scale", Kind::Quantities(Dimension::RATIO, 3), Default::Absent("zero"), "x, y, z."),
    key(
        "accel_misalignment",
        Kind::Quantities(Dimension::SMALL_ANGLE, 3),
        Default::Absent("zero"),
        "yx, zx, zy.",
    ),
]);

static STOP: Section = section(&[
    key(
        "azimuth",
        ANGLE,
        Default::Value("0 deg"),
        "Cumulative angle of the inner gimbal, about body z.",
    ),
    key(
        "roll",
        ANGLE,
        Default::Value("0 deg"),
        "Cumulative angle of the outer gimbal, about case x.",
    ),
    key(
        "weight",
        Kind::Number(Bounds::Positive),
        Default::Value("1.0"),
        "Dwell relative to the other stops.",
    ),
]);

const ANGLE: Kind = Kind::Quantity(
    &[Dimension::ANGLE],
    Bounds::Within(-15.9, 15.9, "within ±15.9 rad (±911 deg), the range of the encoders"),
);

const STOPS: Kind = Kind::Tables(&STOP, 1, octant_calibration::sequence::STOPS_MAX);

const GROUPS: &[&str] = &[
    "gyro_bias",
    "gyro_scale",
    "gyro_misalignment",
    "g_dependent",
    "accel_bias",
    "accel_scale",
    "accel_misalignment",
];

const ESTIMATORS: &[(&str, &str)] = &[
    ("kalman", "error-state Kalman filter, 39 states"),
    ("least-squares", "multi-position least squares on the norm of gravity and of Earth rate"),
    (
        "external-turntable",
        "the case on a precise external turntable whose angles are the reference",
    ),
];
const ERROR_MODELS: &[(&str, &str)] = &[
    ("phi", "attitude error against the true navigation frame"),
    ("psi", "attitude error against the computer frame"),
];
const PASSES: Kind = Kind::Integer(1, 1000);

static CALIBRATION: Section = section(&[
    key(
        "positions",
        Kind::Choice(POSITIONS),
        Default::Derived("\"eight\", unless stops are given"),
        "Named sequence of positions.",
    ),
    key("stops", STOPS, Default::Absent("positions are used"), "A sequence of one's own."),
    key(
        "passes",
        PASSES,
        Default::Value("1"),
        "How often the sequence is walked within the duration.",
    ),
    key("duration", DURATION, Default::Value("4 h"), "Whole time: moves and dwells of all passes."),
    key(
        "estimator",
        Kind::Choice(ESTIMATORS),
        Default::Value("kalman"),
        "How the parameters are estimated.",
    ),
    key(
        "error_model",
        Kind::Choice(ERROR_MODELS),
        Default::Value("phi"),
        "Form of the filter's system error model.",
    ),
    key(
        "g_states",
        Kind::Boolean,
        Default::Value("true"),
        "Whether the filter estimates the g-dependent biases.",
    ),
    key(
        "not_estimated",
        Kind::Choices(GROUPS),
        Default::Value("[]"),
        "Further parameter groups that the filter does not estimate.",
    ),
    key(
        "refuse_above_mean_nis",
        Kind::Number(Bounds::Positive),
        Default::Value("9.0"),
        "Mean normalized innovation squared (three axes) above which the calibration is refused.",
    ),
    key(
        "prior",
        Kind::Table(&PRIOR),
        Default::Section,
        "Standard deviations that the filter starts from.",
    ),
    key(
        "aiding",
        Kind::Table(&AIDING),
        Default::Section,
        "The reference that the filter measures against.",
    ),
    key(
        "least_squares",
        Kind::Table(&LEAST_SQUARES),
        Default::Section,
        "Settings of the least-squares estimator.",
    ),
]);

static PRIOR: Section = section(&[
    key(
        "attitude",
        Kind::Quantities(Dimension::SMALL_ANGLE, 3),
        Default::Value(r#"["60 arcsec", "60 arcsec", "0.1 deg"]"#),
        "Attitude error north, east, down.",
    ),
    key(
        "velocity",
        Kind::Quantity(&[Dimension::VELOCITY], Bounds::Positive),
        Default::Value("0.02 m/s"),
        "Velocity, each axis.",
    ),
    key(
        "position",
        Kind::Quantity(&[Dimension::LENGTH], Bounds::Positive),
        Default::Value("1 m"),
        "Position, each axis.",
    ),
    key(
        "gyro_bias",
        Kind::Quantity(&[Dimension::GYRO_BIAS], Bounds::Positive),
        Default::Value("0.005 deg/h"),
        "Gyro biases.",
    ),
    key(
        "gyro_scale",
        Kind::Quantity(&[Dimension::RATIO], Bounds::Positive),
        Default::Value("30 ppm"),
        "Gyro scale factors.",
    ),
    key(
        "gyro_misalignment",
        Kind::Quantity(&[Dimension::SMALL_ANGLE], Bounds::Positive),
        Default::Value("40 arcsec"),
        "Gyro misalignments.",
    ),
    key(
        "g_dependent",
        Kind::Quantity(&[Dimension::G_DEPENDENT], Bounds::Positive),
        Default::Derived(
            "the standard deviation from which imu.g_dependent is drawn, else 0.0005 deg/h/g",
        ),
        "g-dependent gyro biases.",
    ),
    key(
        "accel_bias",
        Kind::Quantity(&[Dimension::ACCEL_BIAS], Bounds::Positive),
        Default::Value("100 ug"),
        "Accelerometer biases.",
    ),
    key(
        "accel_scale",
        Kind::Quantity(&[Dimension::RATIO], Bounds::Positive),
        Default::Value("30 ppm"),
        "Accelerometer scale factors.",
    ),
    key(
        "accel_misalignment",
        Kind::Quantity(&[Dimension::SMALL_ANGLE], Bounds::Positive),
        Default::Value("40 arcsec"),
        "Accelerometer misalignments.",
    ),
]);

static AIDING: Section = section(&[
    key(
        "reference",
        Kind::Choice(&[
            ("zero-velocity", "the ground or dock doesn't move; knows nothing of sway"),
            ("velocity", "true velocity of the instrument over ground"),
            ("dock-position", "position of the dock; sway is noise to the filter"),
        ]),
        Default::Derived("static: \"zero-velocity\"; dockside: \"dock-position\""),
        "What is measured.",
    ),
    key(
        "period",
        Kind::Quantity(&[Dimension::TIME], Bounds::Within(1e-4, 3600.0, "above 0, up to 1 h")),
        Default::Value("1 s"),
        "Time between measurements: a multiple of the sample period.",
    ),
    key(
        "sigma",
        Kind::Quantity(&[Dimension::VELOCITY, Dimension::LENGTH], Bounds::Positive),
        Default::Derived("velocities: 1 mm/s; dock-position: 0.15 m"),
        "Standard deviation of each axis, as the filter believes it.",
    ),
    key(
        "noise",
        Kind::Quantity(&[Dimension::VELOCITY, Dimension::LENGTH], Bounds::NotNegative),
        Default::Derived("velocities: 1 mm/s; dock-position: 0.01 m"),
        "Standard deviation of the white noise that the reference really has.",
    ),
]);

static LEAST_SQUARES: Section = section(&[
    key(
        "gravity",
        Kind::Quantity(&[Dimension::ACCELERATION], Bounds::Within(9.0, 11.0, "from 9 to 11 m/s^2")),
        Default::Absent("normal gravity at the site"),
        "Local gravity.",
    ),
    key(
        "gyro",
        Kind::Choice(&[
            ("earth-rate", "norm of Earth rate: gyros that see it"),
            (
                "rotated-gravity",
                "gravity turned between static attitudes: gyros that don't see Earth rate",
            ),
        ]),
        Default::Value("earth-rate"),
        "What the gyros are measured against.",
    ),
    key(
        "intervals",
        Kind::Choice(&[
            ("commanded", "from the procedure"),
            ("detected", "from the data, by windowed standard deviation"),
        ]),
        Default::Value("commanded"),
        "How static intervals are found.",
    ),
    key(
        "initial",
        DURATION,
        Default::Value("50 s"),
        "Detected: length of the first interval, known to be static.",
    ),
    key("window", DURATION, Default::Value("1 s"), "Detected: window of the standard deviation."),
    key(
        "threshold",
        Kind::Number(Bounds::Positive),
        Default::Value("5.0"),
        "Detected: multiple of the first interval's standard deviation.",
    ),
    key("shortest", DURATION, Default::Value("2 s"), "Detected: shortest interval to use."),
]);

static NAVIGATION: Section = section(&[
    key(
        "duration",
        DURATION,
        Default::Derived("plant: has to be given; recordings: until they end"),
        "How long.",
    ),
    key(
        "rotation",
        Kind::Either(&[
            Kind::Choice(&[
                (
                    "sixteen",
                    "sixteen moves of 180° about both gimbals, that average out most drifts",
                ),
                ("none", "gimbals stand at zero"),
            ]),
            STOPS,
        ]),
        Default::Value("sixteen"),
        "Rotation while navigating: a named scheme, or stops that are repeated.",
    ),
    key(
        "dwell",
        DURATION,
        Default::Value("300 s"),
        "Rest at each stop of weight 1; the move to the next stop comes on top.",
    ),
]);

const fn as_primary(name: &'static str, kind: Kind, doc: &'static str) -> Key {
    key(name, kind, Default::Absent("as in procedure.calibration"), doc)
}

pub(crate) static BASELINE: Section = section(&[
    as_primary("positions", Kind::Choice(POSITIONS), "Named sequence of positions."),
    as_primary("stops", STOPS, "A sequence of one's own."),
    as_primary("passes", PASSES, "How often the sequence is walked."),
    as_primary("estimator", Kind::Choice(ESTIMATORS), "How the parameters are estimated."),
    as_primary(
        "error_model",
        Kind::Choice(ERROR_MODELS),
        "Form of the filter's system error model.",
    ),
    as_primary("g_states", Kind::Boolean, "Whether the filter estimates the g-dependent biases."),
    as_primary(
        "not_estimated",
        Kind::Choices(GROUPS),
        "Further groups that the filter does not estimate.",
    ),
]);
