//! Process noise.

use crate::covariance::{Covariance, DV, MOVING, PARAMETERS, PHI, Transition};
use nalgebra::Vector3;

/// Adds the process noise of white gyro and accelerometer noise over `elapsed_s`, in which the
/// specific force in n integrates to `force_sum` (m/s).
pub fn add_process_noise(
    covariance: &mut Covariance,
    noise: (f64, f64),
    elapsed_s: f64,
    force_sum: &Vector3<f64>,
) {
    let (gyro, accel) = (noise.0 * elapsed_s, noise.1 * elapsed_s);
    // δv̇ = f × φ: with a constant f the velocity receives half of f T times the noise of φ, and a
    // third of its square.
    let f = octant_earth::rotation::skew(force_sum);
    let cross = f * (0.5 * gyro);
    let square = f * f.transpose() * (gyro / 3.0);
    for i in 0..3 {
        covariance.add(PHI + i, PHI + i, gyro);
        covariance.add(DV + i, DV + i, accel);
        for j in 0..3 {
            covariance.add(DV + i, PHI + j, cross[(i, j)]);
            if j >= i {
                covariance.add(DV + i, DV + j, square[(i, j)]);
            }
        }
    }
}

/// Adds the noise of gyro biases that walked by this variance, (rad/s)², evenly over the time of a
/// transition. The moving states receive half of the biases' effect in it times that, and a third of
/// its square.
pub fn add_bias_walk(covariance: &mut Covariance, variance: f64, transition: &Transition) {
    for bias in PARAMETERS..PARAMETERS + 3 {
        covariance.add(bias, bias, variance);
        for i in 0..MOVING {
            let effect = transition.rows[i][bias];
            covariance.add(i, bias, 0.5 * variance * effect);
            for j in i..MOVING {
                covariance.add(i, j, variance / 3.0 * effect * transition.rows[j][bias]);
            }
        }
    }
}
