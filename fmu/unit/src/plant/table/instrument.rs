//! The sensors. Start values: the noise of Table 1 of the paper and nothing else.

use crate::groups::groups;
use crate::quantities as q;
use crate::table::ElementType::{Boolean, Count, Real};
use crate::table::{DeclaredVariable, concatenated, count, variables};
use octant_earth::units::{DEG, DEG_PER_HOUR, DEG_PER_SQRT_HOUR, MICRO_G, PPM};

const PERIOD: [DeclaredVariable; 1] = variables! {
    parameter("imu.period_ns", Count) of(&q::NANOSECONDS) within(10_000.0, 1e9) start(&[5e6]):
        "Sample period, ns: the communication step.";
};

const TRUE_PARAMETERS: [DeclaredVariable; 7] = groups!(
    tunable_parameter,
    "imu.parameters",
    "True coefficients of the error model (measured less true): ",
    ""
);

const NOISE: [DeclaredVariable; 2] = variables! {
    tunable_parameter("imu.angle_random_walk", Real) of(&q::ANGLE_RANDOM_WALK) min(0.0)
        nominal(0.0007 * DEG_PER_SQRT_HOUR) start(&[0.0007 * DEG_PER_SQRT_HOUR]):
        "Angle random walk of the gyros.";
    tunable_parameter("imu.velocity_random_walk", Real) of(&q::VELOCITY_RANDOM_WALK) min(0.0)
        nominal(50.0 * MICRO_G) start(&[50.0 * MICRO_G]): "Noise density of the accelerometers.";
};

/// A first-order Gauss-Markov process.
macro_rules! gauss_markov {
    ($name:literal, $quantity:ident, $nominal:expr, $what:literal) => {
        variables! {
            parameter(concat!("imu.", $name, ".enabled"), Boolean):
                concat!("The ", $what, " wander as a first-order Gauss-Markov process, which the \
filter doesn't model.");
            parameter(concat!("imu.", $name, ".sigma"), Real) of(&q::$quantity) min(0.0)
                nominal($nominal) start(&[$nominal]):
                concat!("Standard deviation of the wandering ", $what, ".");
            parameter(concat!("imu.", $name, ".correlation_time"), Real) of(&q::TIME) min(0.0)
                nominal(3600.0) start(&[3600.0]):
                concat!("Correlation time of the wandering ", $what, ", above 0.");
        }
    };
}

const WANDERING: [DeclaredVariable; 6] = concatenated(&[
    &gauss_markov!("gyro_gauss_markov", GYRO_BIAS, 0.001 * DEG_PER_HOUR, "gyro biases"),
    &gauss_markov!("accel_gauss_markov", ACCEL_BIAS, 10.0 * MICRO_G, "accelerometer biases"),
]);

const LIMITS: [DeclaredVariable; 7] = variables! {
    parameter("imu.gyro_rate_random_walk", Real) of(&q::RATE_RANDOM_WALK) min(0.0) nominal(1e-9):
        "Rate random walk of the gyros; 0: none.";
    parameter("imu.gyro_bias_instability", Real) of(&q::GYRO_BIAS) min(0.0)
        nominal(0.001 * DEG_PER_HOUR):
        "Bias instability of the gyros, coefficient B of IEEE Std 952; 0: none.";
    parameter("imu.accel_bias_instability", Real) of(&q::ACCEL_BIAS) min(0.0)
        nominal(10.0 * MICRO_G):
        "Bias instability of the accelerometers, coefficient B of IEEE Std 952; 0: none.";
    parameter("imu.gyro_quantization", Real) of(&q::ANGLE_INCREMENT) min(0.0) nominal(1e-6):
        "Quantum of the gyros, coarser than that of the counts; 0: none.";
    parameter("imu.accel_quantization", Real) of(&q::VELOCITY_INCREMENT) min(0.0) nominal(1e-5):
        "Quantum of the accelerometers, coarser than that of the counts; 0: none.";
    tunable_parameter("imu.gyro_range", Real) of(&q::TURN_RATE) min(0.0) nominal(300.0 * DEG):
        "Range of the gyros; 0: that of the counts.";
    tunable_parameter("imu.accel_range", Real) of(&q::ACCELERATION) min(0.0) nominal(400.0):
        "Range of the accelerometers; 0: that of the counts.";
};

const TEMPERATURE: [DeclaredVariable; 7] = variables! {
    parameter("imu.temperature.enabled", Boolean):
        "Temperature departs along a ramp, and biases and scale factors with it.";
    parameter("imu.temperature.ramp", Real) of(&q::TEMPERATURE_RATE) nominal(1e-3):
        "Temperature: rate of change.";
    parameter("imu.temperature.plateau", Real) of(&q::TEMPERATURE) nominal(10.0):
        "Temperature: change at which the ramp ends, of the ramp's sign.";
    parameter("imu.temperature.gyro_bias", Real) elements(3) of(&q::GYRO_BIAS_PER_K)
        nominal(1e-4 * DEG_PER_HOUR): "Temperature: sensitivity of the gyro biases, x, y, z.";
    parameter("imu.temperature.accel_bias", Real) elements(3) of(&q::ACCEL_BIAS_PER_K)
        nominal(MICRO_G): "Temperature: sensitivity of the accelerometer biases, x, y, z.";
    parameter("imu.temperature.gyro_scale", Real) elements(3) of(&q::SCALE_PER_K) nominal(PPM):
        "Temperature: sensitivity of the gyro scale factors, x, y, z.";
    parameter("imu.temperature.accel_scale", Real) elements(3) of(&q::SCALE_PER_K) nominal(PPM):
        "Temperature: sensitivity of the accelerometer scale factors, x, y, z.";
};

const VIBRATION: [DeclaredVariable; 5] = variables! {
    parameter("imu.vibration.enabled", Boolean):
        "The sensor block vibrates sinusoidally against the gimballed body.";
    parameter("imu.vibration.frequency", Real) of(&q::FREQUENCY) min(0.0) nominal(50.0)
        start(&[50.0]): "Vibration: frequency, above 0, at most 100 periods in a sample.";
    parameter("imu.vibration.displacement", Real) elements(3) of(&q::LENGTH) within(-1.0, 1.0)
        nominal(1e-5): "Vibration: amplitude of the displacement, body axes x, y, z.";
    parameter("imu.vibration.angle", Real) elements(3) of(&q::ANGLE) within(-0.1, 0.1)
        nominal(1e-5): "Vibration: amplitude of the rotation, body axes x, y, z.";
    parameter("imu.vibration.phase", Real) of(&q::ANGLE) nominal(1.0):
        "Vibration: phase of the rotation against the displacement.";
};

const PLACE: [DeclaredVariable; 2] = variables! {
    parameter("imu.lever_arm", Real) elements(9) of(&q::LENGTH) within(-10.0, 10.0) nominal(0.03):
        "Position of each accelerometer's proof mass from the centre of rotation, in body axes: \
         that of the x accelerometer (x, y, z), then of the y and the z accelerometer.";
    parameter("imu.time_skew", Real) of(&q::TIME) within(0.0, 1.0) nominal(1e-3):
        "Stamp less true time of validity of gyros and accelerometers: they lag the gimbal angles.";
};

const PARTS: &[&[DeclaredVariable]] =
    &[&PERIOD, &TRUE_PARAMETERS, &NOISE, &WANDERING, &LIMITS, &TEMPERATURE, &VIBRATION, &PLACE];

pub(super) const PARAMETERS: [DeclaredVariable; count(PARTS)] = concatenated(PARTS);
