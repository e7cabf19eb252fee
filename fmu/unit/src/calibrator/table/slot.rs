//! The first slot of each variable.

use super::MODEL;

macro_rules! slots {
    ($($constant:ident $name:literal;)*) => {
        $(pub const $constant: usize = MODEL.slot($name);)*
    };
}

slots! {
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

    COMMAND_AZIMUTH "gimbal_command.azimuth";
    COMMAND_ROLL "gimbal_command.roll";
    MODE "mode";
    STOP "stop";
    MOVING "moving";
    LATITUDE "navigation.latitude";
    LONGITUDE "navigation.longitude";
    HEIGHT "navigation.height";
    VELOCITY "navigation.velocity";
    ATTITUDE "navigation.attitude";
    NIS "filter.nis";
    MEASURED "filter.measured";
    HEALTH "health";
    ANSWER_SEQUENCE "answer.sequence";
    ANSWER_DEVICE_TIME "answer.device_time_ns";
    REVISION "parameters.revision";
    PARAMETERS "parameters.gyro_bias";
    SIGMA "sigma.gyro_bias";

    PERIOD "imu.period_ns";
    EXTERNAL_STAMPS "imu.external_stamps";
    ANGLE_RANDOM_WALK "imu.angle_random_walk";
    VELOCITY_RANDOM_WALK "imu.velocity_random_walk";
    SITE_LATITUDE "site.latitude";
    SITE_LONGITUDE "site.longitude";
    SITE_HEIGHT "site.height";
    TURNTABLE_RATE "turntable.rate";
    TURNTABLE_ACCELERATION "turntable.acceleration";
    ALIGNMENT_METHOD "procedure.alignment.method";
    ALIGNMENT_DURATION "procedure.alignment.duration";
    ALIGNMENT_ATTITUDE "procedure.alignment.attitude";
    ALIGNMENT_VELOCITY "procedure.alignment.velocity";
    CALIBRATION "procedure.calibration.enabled";
    POSITIONS "procedure.calibration.positions";
    STOPS_COUNT "procedure.calibration.stops.count";
    STOPS_AZIMUTH "procedure.calibration.stops.azimuth";
    STOPS_ROLL "procedure.calibration.stops.roll";
    STOPS_WEIGHT "procedure.calibration.stops.weight";
    PASSES "procedure.calibration.passes";
    CALIBRATION_DURATION "procedure.calibration.duration";
    ESTIMATOR "procedure.calibration.estimator";
    ERROR_MODEL "procedure.calibration.error_model";
    ESTIMATED "procedure.calibration.estimated.gyro_bias";
    PRIOR_ATTITUDE "procedure.calibration.prior.attitude";
    PRIOR_VELOCITY "procedure.calibration.prior.velocity";
    PRIOR_POSITION "procedure.calibration.prior.position";
    PRIOR_PARAMETERS "procedure.calibration.prior.gyro_bias";
    REFUSE_ABOVE "procedure.calibration.refuse_above_mean_nis";
    AIDING_REFERENCE "procedure.calibration.aiding.reference";
    AIDING_VELOCITY_SIGMA "procedure.calibration.aiding.velocity_sigma";
    AIDING_POSITION_SIGMA "procedure.calibration.aiding.position_sigma";
    AIDING_PERIOD "procedure.calibration.aiding.period_ns";
    AIDING_SWAY "procedure.calibration.aiding.sway";
    GRAVITY_GIVEN "procedure.calibration.least_squares.gravity_given";
    GRAVITY "procedure.calibration.least_squares.gravity";
    GYRO_REFERENCE "procedure.calibration.least_squares.gyro";
    INTERVALS "procedure.calibration.least_squares.intervals";
    INTERVALS_INITIAL "procedure.calibration.least_squares.initial";
    INTERVALS_WINDOW "procedure.calibration.least_squares.window";
    INTERVALS_THRESHOLD "procedure.calibration.least_squares.threshold";
    INTERVALS_SHORTEST "procedure.calibration.least_squares.shortest";
    EXTERNAL_ATTITUDE "procedure.calibration.external_turntable.attitude";
    EXTERNAL_SIGMA "procedure.calibration.external_turntable.encoder_sigma";
    NAVIGATION "procedure.navigation.enabled";
    NAVIGATION_ENDLESS "procedure.navigation.endless";
    NAVIGATION_DURATION "procedure.navigation.duration";
    ROTATION "procedure.navigation.rotation";
    ROTATION_COUNT "procedure.navigation.stops.count";
    ROTATION_AZIMUTH "procedure.navigation.stops.azimuth";
    ROTATION_ROLL "procedure.navigation.stops.roll";
    ROTATION_WEIGHT "procedure.navigation.stops.weight";
    ROTATION_PASSES "procedure.navigation.passes";
    NAVIGATION_DWELL "procedure.navigation.dwell";
    INITIAL_PARAMETERS "initial_parameters.gyro_bias";
    GATE "screening.gate.enabled";
    GATE_NIS "screening.gate.nis";
    GATE_REJECTIONS "screening.gate.rejections";
    GATE_RECOVERY "screening.gate.recovery";
    RESET_ATTITUDE "screening.gate.reset_attitude";
    RESET_VELOCITY "screening.gate.reset_velocity";
    RESET_POSITION "screening.gate.reset_position";
    STUCK "screening.stuck.enabled";
    STUCK_SAMPLES "screening.stuck.samples";
    JUMPS "screening.jumps";
    BRIDGING "screening.bridging";
    GIMBALS "screening.gimbals";
    DRIFT "screening.drift.enabled";
    DRIFT_SIGMAS "screening.drift.sigmas";
    CHECKPOINTS "screening.checkpoints";
    AIDING_STAMPS "screening.aiding_stamps";
    BASE "screening.base.kind";
    BASE_ANGLE "screening.base.angle";
    BASE_RATE "screening.base.rate";
    BASE_ACCELERATION "screening.base.acceleration";
    BASE_FORCE "screening.base.force";
    BASE_JERK "screening.base.jerk";
    ENCODER_SIGMA "screening.encoder_sigma";
    RESOLUTION_GYRO "screening.resolution.delta_theta";
    RESOLUTION_ACCELEROMETER "screening.resolution.delta_velocity";
    VIBRATION_GYRO "screening.vibration.delta_theta";
    VIBRATION_ACCELEROMETER "screening.vibration.delta_velocity";
}
