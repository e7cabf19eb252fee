//! First slot of each variable; for repeated groups, of the first group.

use super::MODEL;

macro_rules! slots {
    ($($constant:ident $name:literal;)*) => {
        $(pub const $constant: usize = MODEL.slot($name);)*
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
    GYRO_BIAS_INSTABILITY "imu.gyro_bias_instability";
    ACCEL_BIAS_INSTABILITY "imu.accel_bias_instability";
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

/// Distance from one fault's parameters to the next one's.
pub const FAULT_STRIDE: usize = NEXT_FAULT_KIND - FAULT_KIND;
/// Distance from one fault's outputs to the next one's.
pub const RECEIPT_STRIDE: usize = NEXT_FAULT_ARMED - FAULT_ARMED;
/// Distance from the sinusoids of one motion to those of the next.
pub const MOTION_STRIDE: usize = PITCH_COUNT - ROLL_COUNT;
