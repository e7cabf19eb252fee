//! Inputs and outputs of every sample, without those of faults.

use super::enumerations as of;
use crate::quantities as q;
use crate::table::ElementType::{Boolean, Count, Enumeration, Integer, Real};
use crate::table::{DeclaredVariable, variables};

/// Largest angle of a gimbal that its counts can hold, rad.
const GIMBAL_MAX_RAD: f64 = 16.0;

pub(super) const INPUTS: [DeclaredVariable; 2] = variables! {
    input("gimbal_command.azimuth", Real) of(&q::ANGLE) within(-GIMBAL_MAX_RAD, GIMBAL_MAX_RAD)
        nominal(1.0):
        "Set point of the inner gimbal, about body z, cumulative. It acts from the beginning of \
         the step on. Taken in counts of 2^-27 rad.";
    input("gimbal_command.roll", Real) of(&q::ANGLE) within(-GIMBAL_MAX_RAD, GIMBAL_MAX_RAD)
        nominal(1.0):
        "Set point of the outer gimbal, about case x, cumulative. It acts from the beginning of \
         the step on. Taken in counts of 2^-27 rad.";
};

pub(super) const OUTPUTS: [DeclaredVariable; 21] = variables! {
    output("gyro.delta_theta", Real) elements(3) of(&q::ANGLE_INCREMENT) nominal(1e-3):
        "Measured angular rate of the body against inertial space, integrated over the sample \
         period that ends at the sample; body axes x, y, z. Whole counts of 2^-36 rad.";
    output("accelerometer.delta_velocity", Real) elements(3) of(&q::VELOCITY_INCREMENT)
        nominal(0.05):
        "Measured specific force integrated over the sample period that ends at the sample; body \
         axes x, y, z. At rest it points up. Whole counts of 2^-30 m/s.";
    output("gimbal.azimuth", Real) of(&q::ANGLE) nominal(1.0):
        "Encoder angle of the inner gimbal at the sample, about body z, cumulative. c_cb = \
         Rx(roll) Rz(azimuth). Whole counts of 2^-27 rad.";
    output("gimbal.roll", Real) of(&q::ANGLE) nominal(1.0):
        "Encoder angle of the outer gimbal at the sample, about case x, cumulative. Whole counts \
         of 2^-27 rad.";
    output("imu.valid", Boolean):
        "A sample came with the last step. False before the first one, and where a fault has lost \
         it: then the other outputs of the instrument stay those of the last sample.";
    output("imu.status", Integer) within(0.0, 65535.0):
        "Flags of the instrument, added up. 1: a gyro count saturated. 2: an accelerometer count \
         saturated. 4: the gimbal angles are not to be used. 8: the inertial counts are not to be \
         used.";
    output("imu.sequence", Count): "Number of the sample, from 1.";
    output("imu.device_time_ns", Count) of(&q::NANOSECONDS):
        "Stamp of the sample: end of its interval by the instrument's clock, ns since the start of \
         its first interval.";
    output("reference.kind", Enumeration(&of::REFERENCE_KIND)):
        "What comes with this sample as reference, if anything.";
    output("reference.velocity", Real) elements(3) of(&q::VELOCITY) nominal(1.0):
        "Velocity over ground by the reference: north, east, down. A fault can make it no number.";
    output("reference.latitude", Real) of(&q::ANGLE) nominal(1.0):
        "Geodetic latitude by the reference. A fault can make it no number.";
    output("reference.longitude", Real) of(&q::ANGLE) nominal(1.0):
        "Longitude by the reference. A fault can make it no number.";
    output("reference.height", Real) of(&q::LENGTH) nominal(100.0):
        "Height above the ellipsoid by the reference. A fault can make it no number.";
    output("reference.age_ns", Real) of(&q::NANOSECONDS) nominal(5e6):
        "Stamp of the sample less the stamp of the reference, whole ns: 0 where the reference is \
         of this sample, positive where it is older.";
    output("truth.latitude", Real) of(&q::ANGLE) nominal(1.0):
        "True geodetic latitude at the end of the step, of the centre of rotation.";
    output("truth.longitude", Real) of(&q::ANGLE) nominal(1.0):
        "True longitude at the end of the step.";
    output("truth.height", Real) of(&q::LENGTH) nominal(100.0):
        "True height above the ellipsoid at the end of the step.";
    output("truth.velocity", Real) elements(3) of(&q::VELOCITY) nominal(1.0):
        "True velocity over ground at the end of the step: north, east, down.";
    output("truth.attitude", Real) elements(4) nominal(1.0):
        "True attitude at the end of the step as the unit quaternion q_nb (w, x, y, z), Hamilton: \
         it takes a vector in body axes into north, east, down.";
    output("truth.gimbal.azimuth", Real) of(&q::ANGLE) nominal(1.0):
        "True angle of the inner gimbal at the end of the step, without encoder error.";
    output("truth.gimbal.roll", Real) of(&q::ANGLE) nominal(1.0):
        "True angle of the outer gimbal at the end of the step, without encoder error.";
};
