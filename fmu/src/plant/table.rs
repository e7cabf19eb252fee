//! The table of the Plant: every variable with its name, meaning, unit and range.

mod enumerations;
mod faults;
mod instrument;
mod ports;
mod world;

pub(crate) use enumerations::acts_in_plant;
pub use enumerations::{AIDING, FAULT_KIND, MOTION, REFERENCE_KIND};
pub use faults::{FAULT_NUMBERS, FAULT_SLOTS};
pub use world::SINUSOIDS_MAX;

use crate::table::{Model, Variable, concatenated};

const PARTS: &[&[Variable]] = &[
    &ports::INPUTS,
    &faults::INPUTS,
    &ports::OUTPUTS,
    &faults::OUTPUTS,
    &world::PARAMETERS,
    &instrument::PARAMETERS,
    &faults::PARAMETERS,
];

const COUNT: usize = count(PARTS);

const fn count(parts: &[&[Variable]]) -> usize {
    let (mut count, mut part) = (0, 0);
    while part < parts.len() {
        count += parts[part].len();
        part += 1;
    }
    count
}

static VARIABLES: [Variable; COUNT] = concatenated(PARTS);

/// The Plant.
pub static MODEL: Model = Model {
    name: "Plant",
    stem: "plant",
    description: "The truth of a dual-axis rotational inertial navigation system: motion of the \
                  case, two-axis turntable, gyros and accelerometers with their errors, the \
                  reference of a calibration, and faults in all of them.",
    variables: &VARIABLES,
    periods_per_step: (1, 1),
};

/// The first slot of each variable. Of what comes several times alike, of the first one.
pub(crate) mod slot {
    use super::MODEL;

    macro_rules! slots {
        ($($constant:ident $name:literal;)*) => {
            $(pub(crate) const $constant: usize = MODEL.slot($name);)*
        };
    }

    slots! {
        COMMAND_AZIMUTH "gimbal_command.azimuth";
        COMMAND_ROLL "gimbal_command.roll";
        FAULT_FIRE "fault[1].fire";

        GYRO "gyro.delta_theta";
        ACCELEROMETER "accelerometer.delta_velocity";
        GIMBAL_AZIMUTH "gimbal.azimuth";
        GIMBAL_ROLL "gimbal.roll";
        IMU_VALID "imu.valid";
        IMU_STATUS "imu.status";
        IMU_SEQUENCE "imu.sequence";
        IMU_DEVICE_TIME "imu.device_time_ns";
        REFERENCE_KIND "reference.kind";
        REFERENCE_VELOCITY "reference.velocity";
        REFERENCE_LATITUDE "reference.latitude";
        REFERENCE_LONGITUDE "reference.longitude";
        REFERENCE_HEIGHT "reference.height";
        REFERENCE_AGE "reference.age_ns";
        TRUTH_LATITUDE "truth.latitude";
        TRUTH_LONGITUDE "truth.longitude";
        TRUTH_HEIGHT "truth.height";
        TRUTH_VELOCITY "truth.velocity";
        TRUTH_ATTITUDE "truth.attitude";
        TRUTH_GIMBAL_AZIMUTH "truth.gimbal.azimuth";
        TRUTH_GIMBAL_ROLL "truth.gimbal.roll";
        FAULT_ARMED "fault[1].armed";
        FAULT_ACTIVE "fault[1].active";
        FAULT_FIRED "fault[1].fired";
        FAULT_ALTERED "fault[1].samples_altered";
        NEXT_FAULT_ARMED "fault[2].armed";

        SEED "random.seed";
        SEED_HIGH "random.seed_high";
        CALIBRATION_ENDLESS "random.calibration.endless";
        CALIBRATION_SAMPLES "random.calibration.samples";
        SITE_LATITUDE "site.latitude";
        SITE_LONGITUDE "site.longitude";
        SITE_HEIGHT "site.height";
        MOTION "motion.kind";
        MEAN_HEADING "motion.mean.heading";
        MEAN_PITCH "motion.mean.pitch";
        MEAN_ROLL "motion.mean.roll";
        MOORING_OFFSET "motion.mooring_offset";
        ROLL_COUNT "motion.roll.count";
        PITCH_COUNT "motion.pitch.count";
        TURNTABLE_RATE "turntable.rate";
        TURNTABLE_ACCELERATION "turntable.acceleration";
        ENCODER_SIGMA "turntable.encoder_sigma";
        NON_ORTHOGONALITY "turntable.non_orthogonality";
        BACKLASH "turntable.backlash";
        AIDING_REFERENCE "aiding.reference";
        AIDING_VELOCITY_SIGMA "aiding.velocity_sigma";
        AIDING_POSITION_SIGMA "aiding.position_sigma";
        AIDING_PERIOD "aiding.period_ns";
        TRUTH_ENABLED "truth.enabled";

        PERIOD "imu.period_ns";
        PARAMETERS "imu.parameters.gyro_bias";
        ANGLE_RANDOM_WALK "imu.angle_random_walk";
        VELOCITY_RANDOM_WALK "imu.velocity_random_walk";
        GYRO_GAUSS_MARKOV "imu.gyro_gauss_markov.enabled";
        ACCEL_GAUSS_MARKOV "imu.accel_gauss_markov.enabled";
        RATE_RANDOM_WALK "imu.gyro_rate_random_walk";
        GYRO_QUANTIZATION "imu.gyro_quantization";
        ACCEL_QUANTIZATION "imu.accel_quantization";
        GYRO_RANGE "imu.gyro_range";
        ACCEL_RANGE "imu.accel_range";
        TEMPERATURE "imu.temperature.enabled";
        TEMPERATURE_RAMP "imu.temperature.ramp";
        TEMPERATURE_PLATEAU "imu.temperature.plateau";
        TEMPERATURE_GYRO_BIAS "imu.temperature.gyro_bias";
        TEMPERATURE_ACCEL_BIAS "imu.temperature.accel_bias";
        TEMPERATURE_GYRO_SCALE "imu.temperature.gyro_scale";
        TEMPERATURE_ACCEL_SCALE "imu.temperature.accel_scale";
        VIBRATION "imu.vibration.enabled";
        VIBRATION_FREQUENCY "imu.vibration.frequency";
        VIBRATION_DISPLACEMENT "imu.vibration.displacement";
        VIBRATION_ANGLE "imu.vibration.angle";
        VIBRATION_PHASE "imu.vibration.phase";
        LEVER_ARM "imu.lever_arm";
        TIME_SKEW "imu.time_skew";

        FAULT_KIND "fault[1].kind";
        FAULT_BY_HAND "fault[1].by_hand";
        FAULT_START "fault[1].start";
        FAULT_DURATION "fault[1].duration";
        FAULT_RECOVERY "fault[1].recovery";
        FAULT_VALUES "fault[1].values";
        NEXT_FAULT_KIND "fault[2].kind";
    }

    /// From one fault's parameters to the next one's.
    pub(crate) const FAULT_STRIDE: usize = NEXT_FAULT_KIND - FAULT_KIND;
    /// From one fault's outputs to the next one's.
    pub(crate) const RECEIPT_STRIDE: usize = NEXT_FAULT_ARMED - FAULT_ARMED;
    /// From the sinusoids of one motion to those of the next.
    pub(crate) const MOTION_STRIDE: usize = PITCH_COUNT - ROLL_COUNT;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Causality, Kind};
    use std::collections::BTreeSet;

    #[test]
    fn every_variable_is_described_once_and_starts_within_its_range() {
        let mut names = BTreeSet::new();
        for variable in MODEL.variables {
            let name = variable.name;
            assert!(names.insert(name), "{name} twice");
            assert!(variable.description.ends_with('.'), "{name}");
            let has_start = matches!(variable.causality, Causality::Parameter | Causality::Input);
            assert_eq!(variable.start.is_empty(), !has_start, "{name}");
            assert!(
                variable.start.len() <= 1 || variable.start.len() == variable.slots(),
                "{name}"
            );
            for start in variable.start {
                assert!(variable.min.is_none_or(|min| *start >= min), "{name}: {start}");
                assert!(variable.max.is_none_or(|max| *start <= max), "{name}: {start}");
                if let Kind::Enumeration(of) = variable.kind {
                    assert!(of.items.iter().any(|item| f64::from(item.0) == *start), "{name}");
                }
            }
            assert_eq!(MODEL.find(name).unwrap().0, MODEL.slot(name));
        }
        // No name is a part of another's.
        for name in &names {
            let inner = format!("{name}.");
            assert!(!names.iter().any(|other| other.starts_with(&inner)), "{name}");
        }
    }

    /// A tool wires both models by name: what the core takes, the plant gives, of the same type.
    #[test]
    fn outputs_are_the_inputs_of_the_calibrator_and_its_command_is_the_input() {
        let of = |model: &'static Model, causality| {
            model.variables.iter().filter(move |variable| variable.causality == causality)
        };
        let calibrator = &crate::calibrator::table::MODEL;
        for input in of(calibrator, Causality::Input) {
            let (_, output) = MODEL.find(input.name).unwrap();
            assert_eq!(output.causality, Causality::Output, "{}", input.name);
            assert_eq!(
                (output.kind, output.elements, output.quantity),
                (input.kind, input.elements, input.quantity),
                "{}",
                input.name
            );
        }
        for input in of(&MODEL, Causality::Input).filter(|input| !input.name.starts_with("fault")) {
            let (_, output) = calibrator.find(input.name).unwrap();
            assert_eq!((output.kind, output.elements), (input.kind, input.elements));
            assert_eq!(output.quantity, input.quantity);
        }
    }

    #[test]
    fn what_comes_several_times_has_equal_strides() {
        for fault in 1..=FAULT_SLOTS {
            let at = |name: &str| MODEL.slot(&format!("fault[{fault}].{name}"));
            let behind = fault - 1;
            assert_eq!(at("kind"), slot::FAULT_KIND + behind * slot::FAULT_STRIDE);
            assert_eq!(at("values"), slot::FAULT_VALUES + behind * slot::FAULT_STRIDE);
            assert_eq!(at("armed"), slot::FAULT_ARMED + behind * slot::RECEIPT_STRIDE);
            assert_eq!(at("samples_altered"), slot::FAULT_ALTERED + behind * slot::RECEIPT_STRIDE);
            assert_eq!(at("fire"), slot::FAULT_FIRE + behind);
        }
        for (index, motion) in
            ["roll", "pitch", "yaw", "surge", "sway", "heave"].into_iter().enumerate()
        {
            let count = MODEL.slot(&format!("motion.{motion}.count"));
            assert_eq!(count, slot::ROLL_COUNT + index * slot::MOTION_STRIDE);
            for (place, part) in ["amplitude", "period", "phase"].into_iter().enumerate() {
                let slot = MODEL.slot(&format!("motion.{motion}.{part}"));
                assert_eq!(slot, count + 1 + place * SINUSOIDS_MAX);
            }
        }
    }
}
