//! Channels between the harness and an FMU, with dimension and number of elements.
//!
//! Channels have the names of the variables of Octant's own FMUs; a scenario maps them to the variables
//! of others.

use crate::quantity::UnitDimension;

/// Class of a channel's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// A quantity of a dimension; transmitted in SI.
    Quantity(UnitDimension),
    /// A real number without unit.
    Number,
    /// A whole number: counters, flags in bits.
    Whole,
    /// A whole number of nanoseconds; a variable in another unit of time is converted.
    Nanoseconds,
    /// True or false.
    Flag,
    /// One of some named values, distinguished by their numbers.
    Code,
}

/// A channel.
#[derive(Debug, PartialEq, Eq)]
pub struct Channel {
    /// Name, as in `gyro.rate`.
    pub name: &'static str,
    /// Class of the elements.
    pub class: Class,
    /// Number of elements.
    pub elements: usize,
    /// Meaning, in one sentence.
    pub doc: &'static str,
}

const fn quantity(
    name: &'static str,
    dimension: UnitDimension,
    elements: usize,
    doc: &'static str,
) -> Channel {
    Channel { name, class: Class::Quantity(dimension), elements, doc }
}

const fn of(name: &'static str, class: Class, elements: usize, doc: &'static str) -> Channel {
    Channel { name, class, elements, doc }
}

/// Channels of samples and references: outputs of a source, and inputs of a core.
pub mod sample {
    use super::{Channel, Class, UnitDimension, of, quantity};

    /// Angular rate.
    pub static RATE: Channel = quantity(
        "gyro.rate",
        UnitDimension::ANGULAR_RATE,
        3,
        "Angular rate of the body, x y z, taken as constant over the sample's interval.",
    );
    /// Angle increments.
    pub static DELTA_THETA: Channel = quantity(
        "gyro.delta_theta",
        UnitDimension::ANGLE,
        3,
        "Angle increments over the sample's interval, x y z.",
    );
    /// Specific force.
    pub static SPECIFIC_FORCE: Channel = quantity(
        "accelerometer.specific_force",
        UnitDimension::ACCELERATION,
        3,
        "Specific force, x y z (at rest it points up), taken as constant over the sample's interval.",
    );
    /// Velocity increments.
    pub static DELTA_VELOCITY: Channel = quantity(
        "accelerometer.delta_velocity",
        UnitDimension::VELOCITY,
        3,
        "Velocity increments over the sample's interval, x y z.",
    );
    /// Inner gimbal.
    pub static AZIMUTH: Channel = quantity(
        "gimbal.azimuth",
        UnitDimension::ANGLE,
        1,
        "Angle of the inner gimbal at the stamp, cumulative.",
    );
    /// Outer gimbal.
    pub static ROLL: Channel = quantity(
        "gimbal.roll",
        UnitDimension::ANGLE,
        1,
        "Angle of the outer gimbal at the stamp, cumulative.",
    );
    /// Validity of the sample.
    pub static VALID: Channel = of(
        "imu.valid",
        Class::Flag,
        1,
        "Whether there is a sample; without one none is delivered.",
    );
    /// Flags of the instrument.
    pub static STATUS: Channel = of(
        "imu.status",
        Class::Whole,
        1,
        "Flags of the sample: 1 gyro saturated, 2 accelerometer saturated, 4 gimbal angles invalid, 8 inertial counts invalid.",
    );
    /// Number of the sample.
    pub static SEQUENCE: Channel =
        of("imu.sequence", Class::Whole, 1, "Number of the sample, from 1.");
    /// Stamp.
    pub static DEVICE_TIME: Channel = of(
        "imu.device_time_ns",
        Class::Nanoseconds,
        1,
        "Stamp of the sample, ns since the start of the first interval.",
    );
    /// Kind of the reference.
    pub static REFERENCE_KIND: Channel = of(
        "reference.kind",
        Class::Code,
        1,
        "Whether a reference goes with the sample: 0 none, 1 velocity, 2 position.",
    );
    /// Validity of the reference.
    pub static REFERENCE_VALID: Channel =
        of("reference.valid", Class::Flag, 1, "Whether a reference goes with the sample.");
    /// Velocity of the reference.
    pub static REFERENCE_VELOCITY: Channel = quantity(
        "reference.velocity",
        UnitDimension::VELOCITY,
        3,
        "Velocity over ground that the reference measured: north, east, down.",
    );
    /// Latitude of the reference.
    pub static REFERENCE_LATITUDE: Channel = quantity(
        "reference.latitude",
        UnitDimension::ANGLE,
        1,
        "Geodetic latitude that the reference measured.",
    );
    /// Longitude of the reference.
    pub static REFERENCE_LONGITUDE: Channel = quantity(
        "reference.longitude",
        UnitDimension::ANGLE,
        1,
        "Longitude that the reference measured.",
    );
    /// Height of the reference.
    pub static REFERENCE_HEIGHT: Channel = quantity(
        "reference.height",
        UnitDimension::LENGTH,
        1,
        "Height above the ellipsoid that the reference measured.",
    );
    /// Age of the reference.
    pub static REFERENCE_AGE: Channel = of(
        "reference.age_ns",
        Class::Nanoseconds,
        1,
        "Stamp of the sample minus that of its reference, ns.",
    );
    /// Set point of the inner gimbal.
    pub static COMMAND_AZIMUTH: Channel = quantity(
        "gimbal_command.azimuth",
        UnitDimension::ANGLE,
        1,
        "Set point of the inner gimbal, cumulative.",
    );
    /// Set point of the outer gimbal.
    pub static COMMAND_ROLL: Channel = quantity(
        "gimbal_command.roll",
        UnitDimension::ANGLE,
        1,
        "Set point of the outer gimbal, cumulative.",
    );
}

/// Channels of truth.
pub mod truth {
    use super::{Channel, Class, UnitDimension, of, quantity};

    /// True latitude.
    pub static LATITUDE: Channel =
        quantity("truth.latitude", UnitDimension::ANGLE, 1, "True geodetic latitude at the stamp.");
    /// True longitude.
    pub static LONGITUDE: Channel =
        quantity("truth.longitude", UnitDimension::ANGLE, 1, "True longitude at the stamp.");
    /// True height.
    pub static HEIGHT: Channel =
        quantity("truth.height", UnitDimension::LENGTH, 1, "True height above the ellipsoid.");
    /// True velocity.
    pub static VELOCITY: Channel = quantity(
        "truth.velocity",
        UnitDimension::VELOCITY,
        3,
        "True velocity over ground: north, east, down.",
    );
    /// True attitude.
    pub static ATTITUDE: Channel = of(
        "truth.attitude",
        Class::Number,
        4,
        "True attitude of the body as a quaternion w x y z that takes a vector in body into north, east, down.",
    );
    /// True gimbal angle.
    pub static AZIMUTH: Channel = quantity(
        "truth.gimbal.azimuth",
        UnitDimension::ANGLE,
        1,
        "True angle of the inner gimbal, without encoder error.",
    );
    /// True gimbal angle.
    pub static ROLL: Channel = quantity(
        "truth.gimbal.roll",
        UnitDimension::ANGLE,
        1,
        "True angle of the outer gimbal, without encoder error.",
    );
}

/// Channels of the motion of the case: of a ship, or of a turntable's base.
pub mod case {
    use super::{Channel, UnitDimension, quantity};

    /// Heading.
    pub static HEADING: Channel = quantity(
        "case.heading",
        UnitDimension::ANGLE,
        1,
        "Heading of the case, from north over east.",
    );
    /// Pitch.
    pub static PITCH: Channel =
        quantity("case.pitch", UnitDimension::ANGLE, 1, "Pitch of the case, bow up positive.");
    /// Roll.
    pub static ROLL: Channel = quantity(
        "case.roll",
        UnitDimension::ANGLE,
        1,
        "Roll of the case, starboard down positive.",
    );
    /// Distance north of the site.
    pub static NORTH: Channel =
        quantity("case.north", UnitDimension::LENGTH, 1, "Distance of the case north of the site.");
    /// Distance east of the site.
    pub static EAST: Channel =
        quantity("case.east", UnitDimension::LENGTH, 1, "Distance of the case east of the site.");
    /// Distance below the site.
    pub static DOWN: Channel =
        quantity("case.down", UnitDimension::LENGTH, 1, "Distance of the case below the site.");
    /// Latitude.
    pub static LATITUDE: Channel = quantity(
        "case.latitude",
        UnitDimension::ANGLE,
        1,
        "Geodetic latitude of the case, instead of north.",
    );
    /// Longitude.
    pub static LONGITUDE: Channel = quantity(
        "case.longitude",
        UnitDimension::ANGLE,
        1,
        "Longitude of the case, instead of east.",
    );
    /// Height.
    pub static HEIGHT: Channel = quantity(
        "case.height",
        UnitDimension::LENGTH,
        1,
        "Height of the case above the ellipsoid, instead of down.",
    );
}

/// Channels of a core's outputs, beside its gimbal command.
pub mod answer {
    use super::{Channel, Class, UnitDimension, of, quantity};
    use octant_sample::parameters::ParameterGroup;

    /// Mode.
    pub static MODE: Channel = of(
        "mode",
        Class::Code,
        1,
        "Mode of the core: 0 aligning, 1 calibrating, 2 refused, 3 navigating, 4 done, or as the codes of modes say.",
    );
    /// Number of the stop.
    pub static STOP: Channel =
        of("stop", Class::Whole, 1, "Stop that the gimbals are at or move to, from 0.");
    /// True while the gimbals move.
    pub static MOVING: Channel =
        of("moving", Class::Flag, 1, "Whether the gimbals are on their way.");
    /// Latitude.
    pub static LATITUDE: Channel = quantity(
        "navigation.latitude",
        UnitDimension::ANGLE,
        1,
        "Geodetic latitude of the navigation solution.",
    );
    /// Longitude.
    pub static LONGITUDE: Channel = quantity(
        "navigation.longitude",
        UnitDimension::ANGLE,
        1,
        "Longitude of the navigation solution.",
    );
    /// Height.
    pub static HEIGHT: Channel = quantity(
        "navigation.height",
        UnitDimension::LENGTH,
        1,
        "Height of the navigation solution above the ellipsoid.",
    );
    /// Velocity.
    pub static VELOCITY: Channel = quantity(
        "navigation.velocity",
        UnitDimension::VELOCITY,
        3,
        "Velocity over ground of the navigation solution: north, east, down.",
    );
    /// Attitude.
    pub static ATTITUDE: Channel = of(
        "navigation.attitude",
        Class::Number,
        4,
        "Attitude of the navigation solution as a quaternion w x y z that takes a vector in body into north, east, down.",
    );
    /// NIS.
    pub static NIS: Channel = of(
        "filter.nis",
        Class::Number,
        1,
        "Normalized innovation squared of the measurement (three axes).",
    );
    /// True if there is a measurement.
    pub static MEASURED: Channel =
        of("filter.measured", Class::Flag, 1, "Whether there is a measurement with this sample.");
    /// Health.
    pub static HEALTH: Channel =
        of("health", Class::Whole, 1, "Health flags in bits, as docs/recording.md numbers them.");
    /// Sequence number of the answer.
    pub static SEQUENCE: Channel =
        of("answer.sequence", Class::Whole, 1, "Number of the sample that is answered.");
    /// Stamp of the answer.
    pub static DEVICE_TIME: Channel = of(
        "answer.device_time_ns",
        Class::Nanoseconds,
        1,
        "Stamp of the sample that is answered, ns.",
    );
    /// Revision of the parameters.
    pub static REVISION: Channel = of(
        "parameters.revision",
        Class::Whole,
        1,
        "Number of times that the estimated parameters have changed; left out, they are looked at with every sample.",
    );

    /// Estimates, in the order of [`ParameterGroup::ALL`].
    pub static PARAMETERS: [Channel; 7] = [
        quantity("parameters.gyro_bias", UnitDimension::GYRO_BIAS, 3, "Estimated gyro biases."),
        of("parameters.gyro_scale", Class::Number, 3, "Estimated gyro scale factor errors."),
        quantity(
            "parameters.gyro_misalignment",
            UnitDimension::SMALL_ANGLE,
            6,
            "Estimated gyro misalignments: xy, xz, yx, yz, zx, zy.",
        ),
        quantity(
            "parameters.g_dependent",
            UnitDimension::G_DEPENDENT,
            9,
            "Estimated g-dependent gyro biases by rows.",
        ),
        quantity(
            "parameters.accel_bias",
            UnitDimension::ACCEL_BIAS,
            3,
            "Estimated accelerometer biases.",
        ),
        of(
            "parameters.accel_scale",
            Class::Number,
            3,
            "Estimated accelerometer scale factor errors.",
        ),
        quantity(
            "parameters.accel_misalignment",
            UnitDimension::SMALL_ANGLE,
            3,
            "Estimated accelerometer misalignments: yx, zx, zy.",
        ),
    ];

    /// Standard deviations of the estimates, in the order of [`ParameterGroup::ALL`].
    pub static SIGMA: [Channel; 7] = [
        quantity("sigma.gyro_bias", UnitDimension::GYRO_BIAS, 3, "1σ of the gyro biases."),
        of("sigma.gyro_scale", Class::Number, 3, "1σ of the gyro scale factor errors."),
        quantity(
            "sigma.gyro_misalignment",
            UnitDimension::SMALL_ANGLE,
            6,
            "1σ of the gyro misalignments.",
        ),
        quantity(
            "sigma.g_dependent",
            UnitDimension::G_DEPENDENT,
            9,
            "1σ of the g-dependent gyro biases.",
        ),
        quantity(
            "sigma.accel_bias",
            UnitDimension::ACCEL_BIAS,
            3,
            "1σ of the accelerometer biases.",
        ),
        of("sigma.accel_scale", Class::Number, 3, "1σ of the accelerometer scale factor errors."),
        quantity(
            "sigma.accel_misalignment",
            UnitDimension::SMALL_ANGLE,
            3,
            "1σ of the accelerometer misalignments.",
        ),
    ];

    /// Estimates of a group, with their standard deviations.
    #[must_use]
    pub fn group(group: ParameterGroup) -> (&'static Channel, &'static Channel) {
        (&PARAMETERS[group as usize], &SIGMA[group as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_sample::parameters::ParameterGroup;

    #[test]
    fn the_channels_of_parameters_are_those_of_the_groups() {
        for of in ParameterGroup::ALL {
            let (estimate, sigma) = answer::group(of);
            assert_eq!(estimate.name, format!("parameters.{}", of.name()));
            assert_eq!(sigma.name, format!("sigma.{}", of.name()));
            assert_eq!((estimate.elements, sigma.elements), (of.range().len(), of.range().len()));
            assert_eq!(estimate.class, sigma.class);
        }
    }
}
