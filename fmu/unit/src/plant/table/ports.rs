//! Inputs and outputs of every sample, without those of faults.

use super::enumerations as of;
use crate::quantities as q;
use crate::table::DeclaredVariable;
use crate::table::ElementType::{Boolean, Count, Enumeration, Integer, Real};

/// Largest angle of a gimbal that its counts can hold, rad.
const GIMBAL_MAX_RAD: f64 = 16.0;

pub(super) const INPUTS: [DeclaredVariable; 2] = [
    DeclaredVariable::input("gimbal_command.azimuth", Real)
        .of(&q::ANGLE)
        .within(-GIMBAL_MAX_RAD, GIMBAL_MAX_RAD)
        .nominal(1.0)
        .described(
            "Set point of the inner gimbal, about body z, cumulative. It acts from the beginning of \
             the step on. Taken in counts of 2^-27 rad.",
        ),
    DeclaredVariable::input("gimbal_command.roll", Real)
        .of(&q::ANGLE)
        .within(-GIMBAL_MAX_RAD, GIMBAL_MAX_RAD)
        .nominal(1.0)
        .described(
            "Set point of the outer gimbal, about case x, cumulative. It acts from the beginning of \
             the step on. Taken in counts of 2^-27 rad.",
        ),
];

pub(super) const OUTPUTS: [DeclaredVariable; 21] = [
    DeclaredVariable::output("gyro.delta_theta", Real)
        .elements(3)
        .of(&q::ANGLE_INCREMENT)
        .nominal(1e-3)
        .described(
            "Measured angular rate of the body against inertial space, integrated over the sample \
             period that ends at the sample; body axes x, y, z. Whole counts of 2^-36 rad.",
        ),
    DeclaredVariable::output("accelerometer.delta_velocity", Real)
        .elements(3)
        .of(&q::VELOCITY_INCREMENT)
        .nominal(0.05)
        .described(
            "Measured specific force integrated over the sample period that ends at the sample; \
             body axes x, y, z. At rest it points up. Whole counts of 2^-30 m/s.",
        ),
    DeclaredVariable::output("gimbal.azimuth", Real).of(&q::ANGLE).nominal(1.0).described(
        "Encoder angle of the inner gimbal at the sample, about body z, cumulative. c_cb = \
         Rx(roll) Rz(azimuth). Whole counts of 2^-27 rad.",
    ),
    DeclaredVariable::output("gimbal.roll", Real).of(&q::ANGLE).nominal(1.0).described(
        "Encoder angle of the outer gimbal at the sample, about case x, cumulative. Whole counts \
         of 2^-27 rad.",
    ),
    DeclaredVariable::output("imu.valid", Boolean).described(
        "A sample came with the last step. False before the first one, and where a fault has lost \
         it: then the other outputs of the instrument stay those of the last sample.",
    ),
    DeclaredVariable::output("imu.status", Integer).within(0.0, 65535.0).described(
        "Flags of the instrument, added up. 1: a gyro count saturated. 2: an accelerometer count \
         saturated. 4: the gimbal angles are not to be used. 8: the inertial counts are not to be \
         used.",
    ),
    DeclaredVariable::output("imu.sequence", Count).described("Number of the sample, from 1."),
    DeclaredVariable::output("imu.device_time_ns", Count).of(&q::NANOSECONDS).described(
        "Stamp of the sample: end of its interval by the instrument's clock, ns since the start of \
         its first interval.",
    ),
    DeclaredVariable::output("reference.kind", Enumeration(&of::REFERENCE_KIND))
        .described("What comes with this sample as reference, if anything."),
    DeclaredVariable::output("reference.velocity", Real).elements(3).of(&q::VELOCITY).nominal(1.0).described(
        "Velocity over ground by the reference: north, east, down. A fault can make it no number.",
    ),
    DeclaredVariable::output("reference.latitude", Real)
        .of(&q::ANGLE)
        .nominal(1.0)
        .described("Geodetic latitude by the reference. A fault can make it no number."),
    DeclaredVariable::output("reference.longitude", Real)
        .of(&q::ANGLE)
        .nominal(1.0)
        .described("Longitude by the reference. A fault can make it no number."),
    DeclaredVariable::output("reference.height", Real).of(&q::LENGTH).nominal(100.0).described(
        "Height above the ellipsoid by the reference. A fault can make it no number.",
    ),
    DeclaredVariable::output("reference.age_ns", Real).of(&q::NANOSECONDS).nominal(5e6).described(
        "Stamp of the sample less the stamp of the reference, whole ns: 0 where the reference is \
         of this sample, positive where it is older.",
    ),
    DeclaredVariable::output("truth.latitude", Real)
        .of(&q::ANGLE)
        .nominal(1.0)
        .described("True geodetic latitude at the end of the step, of the centre of rotation."),
    DeclaredVariable::output("truth.longitude", Real)
        .of(&q::ANGLE)
        .nominal(1.0)
        .described("True longitude at the end of the step."),
    DeclaredVariable::output("truth.height", Real)
        .of(&q::LENGTH)
        .nominal(100.0)
        .described("True height above the ellipsoid at the end of the step."),
    DeclaredVariable::output("truth.velocity", Real)
        .elements(3)
        .of(&q::VELOCITY)
        .nominal(1.0)
        .described("True velocity over ground at the end of the step: north, east, down."),
    DeclaredVariable::output("truth.attitude", Real).elements(4).nominal(1.0).described(
        "True attitude at the end of the step as the unit quaternion q_nb (w, x, y, z), Hamilton: \
         it takes a vector in body axes into north, east, down.",
    ),
    DeclaredVariable::output("truth.gimbal.azimuth", Real)
        .of(&q::ANGLE)
        .nominal(1.0)
        .described("True angle of the inner gimbal at the end of the step, without encoder error."),
    DeclaredVariable::output("truth.gimbal.roll", Real)
        .of(&q::ANGLE)
        .nominal(1.0)
        .described("True angle of the outer gimbal at the end of the step, without encoder error."),
];

#[cfg(test)]
mod tests {
    use super::*;
    use octant_sample::Status;

    #[test]
    fn flags_are_described_with_their_values() {
        let status = OUTPUTS.iter().find(|output| output.name == "imu.status").unwrap();
        for bit in Status::all().iter() {
            assert!(status.description.contains(&format!(" {}: ", bit.bits())), "{bit:?}");
        }
    }
}
