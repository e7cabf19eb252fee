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

/// Declares channels; the text of a channel is its documentation too.
macro_rules! channels {
    ($($item:ident = $name:literal, $class:expr, $elements:literal, $doc:literal;)+) => { $(
        #[doc = $doc]
        pub static $item: Channel =
            Channel { name: $name, class: $class, elements: $elements, doc: $doc };
    )+ };
}

/// Channels of samples and references: outputs of a source, and inputs of a core.
pub mod sample {
    use super::{Channel, Class, UnitDimension};

    channels! {
        RATE = "gyro.rate", Class::Quantity(UnitDimension::ANGULAR_RATE), 3,
            "Angular rate of the body, x y z, taken as constant over the sample's interval.";
        DELTA_THETA = "gyro.delta_theta", Class::Quantity(UnitDimension::ANGLE), 3,
            "Angle increments over the sample's interval, x y z.";
        SPECIFIC_FORCE = "accelerometer.specific_force", Class::Quantity(UnitDimension::ACCELERATION), 3,
            "Specific force, x y z (at rest it points up), taken as constant over the sample's interval.";
        DELTA_VELOCITY = "accelerometer.delta_velocity", Class::Quantity(UnitDimension::VELOCITY), 3,
            "Velocity increments over the sample's interval, x y z.";
        AZIMUTH = "gimbal.azimuth", Class::Quantity(UnitDimension::ANGLE), 1,
            "Angle of the inner gimbal at the stamp, cumulative.";
        ROLL = "gimbal.roll", Class::Quantity(UnitDimension::ANGLE), 1,
            "Angle of the outer gimbal at the stamp, cumulative.";
        VALID = "imu.valid", Class::Flag, 1,
            "Whether there is a sample; without one none is delivered.";
        STATUS = "imu.status", Class::Whole, 1,
            "Flags of the sample: 1 gyro saturated, 2 accelerometer saturated, 4 gimbal angles invalid, 8 inertial counts invalid.";
        SEQUENCE = "imu.sequence", Class::Whole, 1,
            "Number of the sample, from 1.";
        DEVICE_TIME = "imu.device_time_ns", Class::Nanoseconds, 1,
            "Stamp of the sample, ns since the start of the first interval.";
        REFERENCE_KIND = "reference.kind", Class::Code, 1,
            "Whether a reference goes with the sample: 0 none, 1 velocity, 2 position.";
        REFERENCE_VALID = "reference.valid", Class::Flag, 1,
            "Whether a reference goes with the sample.";
        REFERENCE_VELOCITY = "reference.velocity", Class::Quantity(UnitDimension::VELOCITY), 3,
            "Velocity over ground that the reference measured: north, east, down.";
        REFERENCE_LATITUDE = "reference.latitude", Class::Quantity(UnitDimension::ANGLE), 1,
            "Geodetic latitude that the reference measured.";
        REFERENCE_LONGITUDE = "reference.longitude", Class::Quantity(UnitDimension::ANGLE), 1,
            "Longitude that the reference measured.";
        REFERENCE_HEIGHT = "reference.height", Class::Quantity(UnitDimension::LENGTH), 1,
            "Height above the ellipsoid that the reference measured.";
        REFERENCE_AGE = "reference.age_ns", Class::Nanoseconds, 1,
            "Stamp of the sample minus that of its reference, ns.";
        COMMAND_AZIMUTH = "gimbal_command.azimuth", Class::Quantity(UnitDimension::ANGLE), 1,
            "Set point of the inner gimbal, cumulative.";
        COMMAND_ROLL = "gimbal_command.roll", Class::Quantity(UnitDimension::ANGLE), 1,
            "Set point of the outer gimbal, cumulative.";
    }
}

/// Channels of truth.
pub mod truth {
    use super::{Channel, Class, UnitDimension};

    channels! {
        LATITUDE = "truth.latitude", Class::Quantity(UnitDimension::ANGLE), 1,
            "True geodetic latitude at the stamp.";
        LONGITUDE = "truth.longitude", Class::Quantity(UnitDimension::ANGLE), 1,
            "True longitude at the stamp.";
        HEIGHT = "truth.height", Class::Quantity(UnitDimension::LENGTH), 1,
            "True height above the ellipsoid.";
        VELOCITY = "truth.velocity", Class::Quantity(UnitDimension::VELOCITY), 3,
            "True velocity over ground: north, east, down.";
        ATTITUDE = "truth.attitude", Class::Number, 4,
            "True attitude of the body as a quaternion w x y z that takes a vector in body into north, east, down.";
        AZIMUTH = "truth.gimbal.azimuth", Class::Quantity(UnitDimension::ANGLE), 1,
            "True angle of the inner gimbal, without encoder error.";
        ROLL = "truth.gimbal.roll", Class::Quantity(UnitDimension::ANGLE), 1,
            "True angle of the outer gimbal, without encoder error.";
    }
}

/// Channels of the motion of the case: of a ship, or of a turntable's base.
pub mod case {
    use super::{Channel, Class, UnitDimension};

    channels! {
        HEADING = "case.heading", Class::Quantity(UnitDimension::ANGLE), 1,
            "Heading of the case, from north over east.";
        PITCH = "case.pitch", Class::Quantity(UnitDimension::ANGLE), 1,
            "Pitch of the case, bow up positive.";
        ROLL = "case.roll", Class::Quantity(UnitDimension::ANGLE), 1,
            "Roll of the case, starboard down positive.";
        NORTH = "case.north", Class::Quantity(UnitDimension::LENGTH), 1,
            "Distance of the case north of the site.";
        EAST = "case.east", Class::Quantity(UnitDimension::LENGTH), 1,
            "Distance of the case east of the site.";
        DOWN = "case.down", Class::Quantity(UnitDimension::LENGTH), 1,
            "Distance of the case below the site.";
        LATITUDE = "case.latitude", Class::Quantity(UnitDimension::ANGLE), 1,
            "Geodetic latitude of the case, instead of north.";
        LONGITUDE = "case.longitude", Class::Quantity(UnitDimension::ANGLE), 1,
            "Longitude of the case, instead of east.";
        HEIGHT = "case.height", Class::Quantity(UnitDimension::LENGTH), 1,
            "Height of the case above the ellipsoid, instead of down.";
    }
}

/// Channels of a core's outputs, beside its gimbal command.
pub mod answer {
    use super::{Channel, Class, UnitDimension};
    use octant_sample::parameters::ParameterGroup;

    channels! {
        MODE = "mode", Class::Code, 1,
            "Mode of the core: 0 aligning, 1 calibrating, 2 refused, 3 navigating, 4 done, or as the codes of modes say.";
        STOP = "stop", Class::Whole, 1,
            "Stop that the gimbals are at or move to, from 0.";
        MOVING = "moving", Class::Flag, 1,
            "Whether the gimbals are on their way.";
        LATITUDE = "navigation.latitude", Class::Quantity(UnitDimension::ANGLE), 1,
            "Geodetic latitude of the navigation solution.";
        LONGITUDE = "navigation.longitude", Class::Quantity(UnitDimension::ANGLE), 1,
            "Longitude of the navigation solution.";
        HEIGHT = "navigation.height", Class::Quantity(UnitDimension::LENGTH), 1,
            "Height of the navigation solution above the ellipsoid.";
        VELOCITY = "navigation.velocity", Class::Quantity(UnitDimension::VELOCITY), 3,
            "Velocity over ground of the navigation solution: north, east, down.";
        ATTITUDE = "navigation.attitude", Class::Number, 4,
            "Attitude of the navigation solution as a quaternion w x y z that takes a vector in body into north, east, down.";
        NIS = "filter.nis", Class::Number, 1,
            "Normalized innovation squared of the measurement (three axes).";
        MEASURED = "filter.measured", Class::Flag, 1,
            "Whether there is a measurement with this sample.";
        HEALTH = "health", Class::Whole, 1,
            "Health flags in bits, as docs/recording.md numbers them.";
        SEQUENCE = "answer.sequence", Class::Whole, 1,
            "Number of the sample that is answered.";
        DEVICE_TIME = "answer.device_time_ns", Class::Nanoseconds, 1,
            "Stamp of the sample that is answered, ns.";
        REVISION = "parameters.revision", Class::Whole, 1,
            "Number of times that the estimated parameters have changed; left out, they are looked at with every sample.";
    }

    /// Declares the channels of the groups of parameters: name, class, elements, meaning, order of the elements.
    macro_rules! groups {
        ($($name:literal, $class:expr, $elements:literal, $doc:literal, $order:literal;)+) => {
            /// Estimates, in the order of [`ParameterGroup::ALL`].
            pub static PARAMETERS: [Channel; 7] = [$(Channel {
                name: concat!("parameters.", $name),
                class: $class,
                elements: $elements,
                doc: concat!("Estimated ", $doc, $order, "."),
            }),+];

            /// Standard deviations of the estimates, in the order of [`ParameterGroup::ALL`].
            pub static SIGMA: [Channel; 7] = [$(Channel {
                name: concat!("sigma.", $name),
                class: $class,
                elements: $elements,
                doc: concat!("1σ of the ", $doc, "."),
            }),+];
        };
    }

    groups! {
        "gyro_bias", Class::Quantity(UnitDimension::GYRO_BIAS), 3, "gyro biases", "";
        "gyro_scale", Class::Number, 3, "gyro scale factor errors", "";
        "gyro_misalignment", Class::Quantity(UnitDimension::SMALL_ANGLE), 6, "gyro misalignments",
            ": xy, xz, yx, yz, zx, zy";
        "g_dependent", Class::Quantity(UnitDimension::G_DEPENDENT), 9, "g-dependent gyro biases", " by rows";
        "accel_bias", Class::Quantity(UnitDimension::ACCEL_BIAS), 3, "accelerometer biases", "";
        "accel_scale", Class::Number, 3, "accelerometer scale factor errors", "";
        "accel_misalignment", Class::Quantity(UnitDimension::SMALL_ANGLE), 3, "accelerometer misalignments",
            ": yx, zx, zy";
    }

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
