//! Inputs and outputs of every sample.

use super::enumerations as of;
use crate::groups::groups;
use crate::quantities as q;
use crate::table::ElementType::{Boolean, Count, Enumeration, Integer, Real};
use crate::table::{DeclaredVariable, variables};

/// Largest angle of a gimbal that its counts can hold, rad.
const GIMBAL_MAX_RAD: f64 = 16.0;
/// Limit above which whole numbers are not exact as Real.
const EXACT_MAX: f64 = 9_007_199_254_740_992.0;

pub(super) const INPUTS: [DeclaredVariable; 14] = variables! {
    input("gyro.delta_theta", Real) elements(3) of(&q::ANGLE_INCREMENT) nominal(1e-3):
        "Angular rate of the body against inertial space, integrated over the sample period that \
         ends at the sample; body axes x, y, z. Taken in counts of 2^-36 rad, whose remainder is \
         carried; beyond 2^-5 rad it saturates and is flagged.";
    input("accelerometer.delta_velocity", Real) elements(3) of(&q::VELOCITY_INCREMENT)
        nominal(0.05):
        "Specific force integrated over the sample period that ends at the sample; body axes x, y, \
         z. At rest it points up. Taken in counts of 2^-30 m/s, whose remainder is carried; beyond \
         2 m/s it saturates and is flagged.";
    input("gimbal.azimuth", Real) of(&q::ANGLE) within(-GIMBAL_MAX_RAD, GIMBAL_MAX_RAD)
        nominal(1.0):
        "Encoder angle of the inner gimbal at the sample, about body z, cumulative. c_cb = \
         Rx(roll) Rz(azimuth). Taken in counts of 2^-27 rad.";
    input("gimbal.roll", Real) of(&q::ANGLE) within(-GIMBAL_MAX_RAD, GIMBAL_MAX_RAD) nominal(1.0):
        "Encoder angle of the outer gimbal at the sample, about case x, cumulative. Taken in \
         counts of 2^-27 rad.";
    input("imu.valid", Boolean):
        "A sample is there. Without one the core isn't stepped, and its outputs stay those of the \
         last sample.";
    input("imu.status", Integer) within(0.0, 65535.0):
        "Flags of the instrument, added up. 1: a gyro count saturated. 2: an accelerometer count \
         saturated. 4: the gimbal angles are not to be used. 8: the inertial counts are not to be \
         used.";
    input("imu.sequence", Count):
        "Number of the sample, from 1; a jump means loss. Used where imu.external_stamps is true; \
         else the model counts its steps from the first sample on.";
    input("imu.device_time_ns", Count) of(&q::NANOSECONDS):
        "Stamp of the sample: end of its interval by the instrument's clock, ns since the start of \
         its first interval. Used where imu.external_stamps is true; else it is the number of the \
         sample times imu.period_ns.";
    input("reference.kind", Enumeration(&of::REFERENCE_KIND)):
        "What comes with this sample as reference, if anything.";
    input("reference.velocity", Real) elements(3) of(&q::VELOCITY) nominal(1.0) non_finite():
        "Velocity over ground at the reference's stamp: north, east, down. What isn't a number is \
         handed to the core, which answers for it.";
    input("reference.latitude", Real) of(&q::ANGLE) nominal(1.0) non_finite():
        "Geodetic latitude at the reference's stamp, north positive. What isn't a number is handed \
         to the core, which answers for it.";
    input("reference.longitude", Real) of(&q::ANGLE) nominal(1.0) non_finite():
        "Longitude at the reference's stamp, east positive. What isn't a number is handed to the \
         core, which answers for it.";
    input("reference.height", Real) of(&q::LENGTH) nominal(100.0) non_finite():
        "Height above the ellipsoid at the reference's stamp. What isn't a number is handed to the \
         core, which answers for it.";
    input("reference.age_ns", Real) of(&q::NANOSECONDS) within(-EXACT_MAX, EXACT_MAX) nominal(5e6):
        "Stamp of the sample less the stamp of the reference, whole ns: 0 where the reference is \
         of this sample, positive where it is older.";
};

const ESTIMATES: [DeclaredVariable; 7] = groups!(
    output,
    "parameters",
    "Estimate (error: measured less true, so compensation subtracts it): ",
    ""
);
const SIGMAS: [DeclaredVariable; 7] = groups!(
    output,
    "sigma",
    "Standard deviation of the estimate: ",
    " No number where the estimator doesn't estimate it."
);

const SOLUTION: [DeclaredVariable; 16] = variables! {
    output("gimbal_command.azimuth", Real) of(&q::ANGLE) nominal(1.0):
        "Set point of the inner gimbal, about body z, cumulative. It acts from the end of the next \
         sample period on.";
    output("gimbal_command.roll", Real) of(&q::ANGLE) nominal(1.0):
        "Set point of the outer gimbal, about case x, cumulative. It acts from the end of the next \
         sample period on.";
    output("mode", Enumeration(&of::MODE)): "Mode after the sample.";
    output("stop", Integer) within(0.0, 65535.0):
        "Stop of the sequence that the gimbals are at or move to, from 0, over all passes.";
    output("moving", Boolean): "The gimbals are on their way to the stop.";
    output("navigation.latitude", Real) of(&q::ANGLE) nominal(1.0):
        "Geodetic latitude at the sample, north positive.";
    output("navigation.longitude", Real) of(&q::ANGLE) nominal(1.0):
        "Longitude at the sample, east positive, not wrapped.";
    output("navigation.height", Real) of(&q::LENGTH) nominal(100.0):
        "Height above the ellipsoid at the sample.";
    output("navigation.velocity", Real) elements(3) of(&q::VELOCITY) nominal(1.0):
        "Velocity over ground at the sample: north, east, down.";
    output("navigation.attitude", Real) elements(4) nominal(1.0):
        "Attitude at the sample as the unit quaternion q_nb (w, x, y, z), Hamilton: it takes a \
         vector in body axes into north, east, down.";
    output("filter.nis", Real) nominal(3.0):
        "Normalized innovation squared of the measurement that was used with the sample: 3 on \
         average, on three axes. 0 where there was none: see filter.measured.";
    output("filter.measured", Boolean): "A measurement was used with the sample.";
    output("health", Integer) min(0.0):
        "Flags of the core for the sample, added up. 1: measurement rejected by the gate. 2: \
         recovering. 4: gyro stuck. 8: accelerometer stuck. 16: samples missing. 32: out of order, \
         not used. 64: inertial counts saturated or invalid. 128: encoders disagree with the set \
         point. 256: reference lost. 512: innovations contradict the tuning. 1024: a number that \
         isn't one was kept out. 2048: increments jumped. 4096: gimbal slipped. 8192: parameters \
         drift. 16384: reference of another sample, not used.";
    output("answer.sequence", Count):
        "Number of the sample that the outputs answer; 0 before the first.";
    output("answer.device_time_ns", Count) of(&q::NANOSECONDS):
        "Stamp of the sample that the outputs answer.";
    output("parameters.revision", Count):
        "Number of times that the estimated parameters have changed.";
};

pub(crate) const OUTPUTS: [DeclaredVariable; SOLUTION.len() + 2 * 7] =
    crate::table::concatenated(&[&SOLUTION, &ESTIMATES, &SIGMAS]);
