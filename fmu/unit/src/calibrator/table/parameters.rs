//! Parameters of the core's configuration. Start values: the instrument of Table 1 of the paper,
//! eight positions in four hours on a still base, all screens on, then navigation without end.
//!
//! Names follow the keys of a scenario.

mod screening;

use super::enumerations as of;
use crate::groups::groups;
use crate::quantities as q;
use crate::table::ElementType::{Boolean, Count, Enumeration, Integer, Real};
use crate::table::{DeclaredVariable, concatenated, count, variables};
use octant_calibration::positions::{Degrees, EIGHT, SIXTEEN};
use octant_calibration::sequence::STOPS_MAX;
use octant_earth::units::{
    ARCSEC, DEG, DEG_PER_HOUR, DEG_PER_HOUR_PER_G, DEG_PER_SQRT_HOUR, MICRO_G, PPM,
};

const U32_MAX: f64 = u32::MAX as f64;
/// Largest angle of a stop, rad.
const STOP_MAX_RAD: f64 = 15.9;

/// One column of a table of stops; its remaining rows are `rest`.
const fn column(stops: &[Degrees], which: usize, rest: f64) -> [f64; STOPS_MAX] {
    let mut column = [rest; STOPS_MAX];
    let mut i = 0;
    while i < stops.len() {
        let (azimuth, roll, weight) = stops[i];
        column[i] = match which {
            0 => azimuth.to_radians(),
            1 => roll.to_radians(),
            _ => weight,
        };
        i += 1;
    }
    column
}

/// Number, azimuths, rolls and weights of a table of stops.
macro_rules! stops {
    ($prefix:literal, $named:literal, $stops:expr) => {
        variables! {
            parameter(concat!($prefix, ".stops.count"), Integer) within(1.0, STOPS_MAX as f64)
                start(&[$stops.len() as f64]):
                concat!("Number of stops, where ", $named, " is custom.");
            parameter(concat!($prefix, ".stops.azimuth"), Real) elements(STOPS_MAX) of(&q::ANGLE)
                within(-STOP_MAX_RAD, STOP_MAX_RAD) nominal(1.0)
                start(const { &column($stops, 0, 0.0) }):
                concat!("Inner gimbal at each stop, about body z, cumulative, where ", $named, " \
is custom; stops.count of them are used.");
            parameter(concat!($prefix, ".stops.roll"), Real) elements(STOPS_MAX) of(&q::ANGLE)
                within(-STOP_MAX_RAD, STOP_MAX_RAD) nominal(1.0)
                start(const { &column($stops, 1, 0.0) }):
                concat!("Outer gimbal at each stop, about case x, cumulative, where ", $named, " \
is custom; stops.count of them are used.");
            parameter(concat!($prefix, ".stops.weight"), Real) elements(STOPS_MAX) min(0.0)
                nominal(1.0) start(const { &column($stops, 2, 1.0) }):
                concat!("Dwell at each stop relative to weight 1, above 0, where ", $named, " is \
custom; stops.count of them are used.");
        }
    };
}

const INSTRUMENT: [DeclaredVariable; 9] = variables! {
    parameter("imu.period_ns", Count) of(&q::NANOSECONDS) within(1.0, 1e9) start(&[5e6]):
        "Sample period, ns: the communication step.";
    parameter("imu.external_stamps", Boolean):
        "Number and stamp of a sample are those of imu.sequence and imu.device_time_ns; else the \
         model counts its steps.";
    parameter("imu.angle_random_walk", Real) of(&q::ANGLE_RANDOM_WALK) min(0.0)
        nominal(0.0007 * DEG_PER_SQRT_HOUR) start(&[0.0007 * DEG_PER_SQRT_HOUR]):
        "Angle random walk of the gyros, as the core believes it.";
    parameter("imu.velocity_random_walk", Real) of(&q::VELOCITY_RANDOM_WALK) min(0.0)
        nominal(50.0 * MICRO_G) start(&[50.0 * MICRO_G]):
        "Noise density of the accelerometers, as the core believes it.";
    parameter("site.latitude", Real) of(&q::ANGLE) within(-1.56, 1.56) nominal(1.0)
        start(&[30.5 * DEG]):
        "Geodetic latitude of the instrument, north positive; navigation starts here.";
    parameter("site.longitude", Real) of(&q::ANGLE) nominal(1.0) start(&[114.4 * DEG]):
        "Longitude of the instrument, east positive.";
    parameter("site.height", Real) of(&q::LENGTH) nominal(100.0):
        "Height of the instrument above the ellipsoid.";
    parameter("turntable.rate", Real) of(&q::TURN_RATE) min(0.0) nominal(10.0 * DEG)
        start(&[10.0 * DEG]): "Largest rate of a gimbal's move, above 0.";
    parameter("turntable.acceleration", Real) of(&q::ANGULAR_ACCELERATION) min(0.0)
        nominal(10.0 * DEG) start(&[10.0 * DEG]): "Acceleration of a gimbal's move, above 0.";
};

const ALIGNMENT: [DeclaredVariable; 4] = variables! {
    parameter("procedure.alignment.method", Enumeration(&of::ALIGNMENT)) start(&[1.0]):
        "How the initial attitude is found.";
    parameter("procedure.alignment.duration", Real) of(&q::TIME) min(0.0) nominal(60.0)
        start(&[60.0]):
        "How long a coarse or inertial alignment takes, above 0 and 10 s. The first stop has to be at azimuth 0 and \
         roll 0, and to be held for so long.";
    parameter("procedure.alignment.attitude", Real) elements(4) within(-1.0, 1.0) nominal(1.0)
        start(&[1.0, 0.0, 0.0, 0.0]):
        "Attitude that is handed over: the unit quaternion q_nb (w, x, y, z) at the start, which \
         takes a vector in body axes into north, east, down.";
    parameter("procedure.alignment.velocity", Real) elements(3) of(&q::VELOCITY) nominal(1.0):
        "Velocity over ground that is handed over: north, east, down.";
};

const CALIBRATION: [DeclaredVariable; 2] = variables! {
    parameter("procedure.calibration.enabled", Boolean) start(&[1.0]):
        "There is a calibration; else the core navigates at once.";
    parameter("procedure.calibration.positions", Enumeration(&of::POSITIONS)) start(&[2.0]):
        "Sequence of positions: one that is known, or custom.";
};

const STOPS: [DeclaredVariable; 4] =
    stops!("procedure.calibration", "procedure.calibration.positions", EIGHT);

const ESTIMATION: [DeclaredVariable; 4] = variables! {
    parameter("procedure.calibration.passes", Count) within(1.0, U32_MAX) start(&[1.0]):
        "How often the sequence is walked within the duration.";
    parameter("procedure.calibration.duration", Real) of(&q::DURATION) min(0.0) nominal(14400.0)
        start(&[14400.0]):
        "Whole time of the calibration, above 0: moves and dwells of all passes.";
    parameter("procedure.calibration.estimator", Enumeration(&of::ESTIMATOR)):
        "How the parameters are estimated.";
    parameter("procedure.calibration.error_model", Enumeration(&of::ERROR_MODEL)):
        "Form of the Kalman filter's system error model.";
};

macro_rules! estimated {
    ($($group:literal $text:literal),*) => {
        variables! {$(
            parameter(concat!("procedure.calibration.estimated.", $group), Boolean) start(&[1.0]):
                concat!("The Kalman filter estimates the ", $text, ".");
        )*}
    };
}

const ESTIMATED: [DeclaredVariable; 7] = estimated!(
    "gyro_bias" "gyro biases",
    "gyro_scale" "gyro scale factor errors",
    "gyro_misalignment" "gyro misalignments",
    "g_dependent" "g-dependent gyro biases",
    "accel_bias" "accelerometer biases",
    "accel_scale" "accelerometer scale factor errors",
    "accel_misalignment" "accelerometer misalignments"
);

macro_rules! prior {
    ($($name:literal $quantity:ident $sigma:expr, $text:literal;)*) => {
        variables! {$(
            parameter(concat!("procedure.calibration.prior.", $name), Real) of(&q::$quantity)
                min(0.0) nominal($sigma) start(&[$sigma]):
                concat!("Standard deviation that the Kalman filter starts from: ", $text, ".");
        )*}
    };
}

const PRIOR_ATTITUDE: [DeclaredVariable; 1] = variables! {
    parameter("procedure.calibration.prior.attitude", Real) elements(3) of(&q::SMALL_ANGLE)
        min(0.0) nominal(60.0 * ARCSEC) start(&[60.0 * ARCSEC, 60.0 * ARCSEC, 0.1 * DEG]):
        "Standard deviation that the Kalman filter starts from: attitude error about north, \
         east, down.";
};

const PRIOR: [DeclaredVariable; 9] = prior! {
    "velocity" SMALL_VELOCITY 0.02, "velocity, each axis";
    "position" LENGTH 1.0, "position, each axis";
    "gyro_bias" GYRO_BIAS 0.005 * DEG_PER_HOUR, "each gyro bias";
    "gyro_scale" SCALE_ERROR 30.0 * PPM, "each gyro scale factor error";
    "gyro_misalignment" SMALL_ANGLE 40.0 * ARCSEC, "each gyro misalignment";
    "g_dependent" G_DEPENDENT 5e-4 * DEG_PER_HOUR_PER_G, "each g-dependent gyro bias";
    "accel_bias" ACCEL_BIAS 100.0 * MICRO_G, "each accelerometer bias";
    "accel_scale" SCALE_ERROR 30.0 * PPM, "each accelerometer scale factor error";
    "accel_misalignment" SMALL_ANGLE 40.0 * ARCSEC, "each accelerometer misalignment";
};

const AIDING: [DeclaredVariable; 6] = variables! {
    tunable_parameter("procedure.calibration.refuse_above_mean_nis", Real) nominal(9.0) start(&[9.0]):
        "Mean normalized innovation squared (three axes) above which the calibration is refused.";
    parameter("procedure.calibration.aiding.reference", Enumeration(&of::AIDING)):
        "The reference that the Kalman filter measures against.";
    tunable_parameter("procedure.calibration.aiding.velocity_sigma", Real) of(&q::SMALL_VELOCITY) min(0.0)
        nominal(1e-3) start(&[1e-3]):
        "Standard deviation of each axis of a velocity reference, above 0.";
    tunable_parameter("procedure.calibration.aiding.position_sigma", Real) of(&q::LENGTH) min(0.0)
        nominal(0.15) start(&[0.15]):
        "Standard deviation of each axis of a position reference, above 0.";
    parameter("procedure.calibration.aiding.period_ns", Count) of(&q::NANOSECONDS) min(1.0)
        start(&[1e9]): "Time between references, ns: a multiple of the sample period.";
    parameter("procedure.calibration.aiding.sway", Enumeration(&of::SWAY)):
        "What the sway of the base is to the Kalman filter.";
};

const LEAST_SQUARES: [DeclaredVariable; 8] = variables! {
    parameter("procedure.calibration.least_squares.gravity_given", Boolean):
        "Least squares: local gravity is as given; else it is normal gravity at the site.";
    parameter("procedure.calibration.least_squares.gravity", Real) of(&q::ACCELERATION) min(0.0)
        nominal(9.8) start(&[9.806_65]): "Least squares: local gravity, where it is given.";
    parameter("procedure.calibration.least_squares.gyro", Enumeration(&of::GYRO_REFERENCE)):
        "Least squares: what the gyros are measured against.";
    parameter("procedure.calibration.least_squares.intervals", Enumeration(&of::INTERVALS)):
        "Least squares: how static intervals are found.";
    parameter("procedure.calibration.least_squares.initial", Real) of(&q::TIME) min(0.0)
        nominal(50.0) start(&[50.0]):
        "Least squares, intervals detected: length of the first one, known to be static.";
    parameter("procedure.calibration.least_squares.window", Real) of(&q::TIME) min(0.0) nominal(1.0)
        start(&[1.0]): "Least squares, intervals detected: window of the standard deviation.";
    parameter("procedure.calibration.least_squares.threshold", Real) min(0.0) nominal(5.0)
        start(&[5.0]):
        "Least squares, intervals detected: multiple of the first one's standard deviation.";
    parameter("procedure.calibration.least_squares.shortest", Real) of(&q::TIME) min(0.0)
        nominal(2.0) start(&[2.0]): "Least squares, intervals detected: shortest one to use.";
};

const EXTERNAL_TURNTABLE: [DeclaredVariable; 2] = variables! {
    parameter("procedure.calibration.external_turntable.attitude", Real) elements(4)
        within(-1.0, 1.0) nominal(1.0) start(&[1.0, 0.0, 0.0, 0.0]):
        "External turntable: attitude of its base from its survey, the unit quaternion q_nc (w, x, \
         y, z), which takes a vector in case axes into north, east, down.";
    parameter("procedure.calibration.external_turntable.encoder_sigma", Real) of(&q::SMALL_ANGLE)
        min(0.0) nominal(ARCSEC) start(&[ARCSEC]):
        "External turntable: standard deviation of each of its angles.";
};

const NAVIGATION: [DeclaredVariable; 4] = variables! {
    parameter("procedure.navigation.enabled", Boolean) start(&[1.0]):
        "There is navigation after the calibration; else the core is done with it.";
    parameter("procedure.navigation.endless", Boolean) start(&[1.0]):
        "Navigation lasts for as long as there are samples.";
    parameter("procedure.navigation.duration", Real) of(&q::DURATION) min(0.0) nominal(86400.0)
        start(&[86400.0]): "Duration of the navigation, above 0, where it isn't endless.";
    parameter("procedure.navigation.rotation", Enumeration(&of::ROTATION)) start(&[1.0]):
        "Rotation of the gimbals while navigating: one that is known, or custom.";
};

const ROTATION: [DeclaredVariable; 4] =
    stops!("procedure.navigation", "procedure.navigation.rotation", SIXTEEN);

const NAVIGATION_STOPS: [DeclaredVariable; 2] = variables! {
    parameter("procedure.navigation.passes", Count) within(1.0, U32_MAX) start(&[1.0]):
        "Passes that the sequence of the rotation was made with. It is repeated for as long as the \
         navigation lasts.";
    parameter("procedure.navigation.dwell", Real) of(&q::TIME) min(0.0) nominal(300.0)
        start(&[300.0]):
        "Rest at each stop of weight 1, above 0; the move to the next stop comes on top.";
};

const INITIAL: [DeclaredVariable; 7] = groups!(
    parameter,
    "initial_parameters",
    "Parameters to start from, of an earlier calibration: ",
    ""
);

const PARTS: &[&[DeclaredVariable]] = &[
    &INSTRUMENT,
    &ALIGNMENT,
    &CALIBRATION,
    &STOPS,
    &ESTIMATION,
    &ESTIMATED,
    &PRIOR_ATTITUDE,
    &PRIOR,
    &AIDING,
    &LEAST_SQUARES,
    &EXTERNAL_TURNTABLE,
    &NAVIGATION,
    &ROTATION,
    &NAVIGATION_STOPS,
    &INITIAL,
    &screening::GATE,
    &screening::SCREENS,
    &screening::BASE,
    &screening::BOUNDS,
];

pub(crate) const PARAMETERS: [DeclaredVariable; count(PARTS)] = concatenated(PARTS);
