//! Widening of the filter's covariance by a turn that the gyros show and the base at rest didn't make.

use super::bridge::Bench;
use super::numbers::{Found, input};
use octant_calibration::config::Noise;
use octant_sample::counts::DELTA_THETA_LSB_RAD;

/// Samples before the turn, of 20 ms: the core has begun its first standstill, and the turn ends
/// well before the next measurement, at a whole second.
const BEFORE: u32 = 1510;
/// Samples of the turn, and those in which it has been found and followed.
const TURNING: u32 = 10;
const FOLLOWED: u32 = 20;
/// Axis of the turn, skew to all axes of the body and of the Earth.
const ABOUT: [f64; 3] = [0.6, 0.64, 0.48];

pub(super) fn found() -> Result<Found, String> {
    let mut bench = Bench::with(|core| {
        // Gyros so loud that a sample of the turn is no jump.
        core.noise = Noise { angle_random_walk: 3e-5, velocity_random_walk: 2e-7 };
    })?;
    for _ in 0..BEFORE {
        bench.step();
    }
    let angle = input("angle of the disturbance, rad").ok_or("find the disturbance")?;
    for n in 0..FOLLOWED {
        bench.step_with(|sample| {
            if n >= TURNING {
                return;
            }
            for axis in 0..3 {
                let part = angle / f64::from(TURNING) * ABOUT[axis];
                sample.delta_theta[axis] += libm::round(part / DELTA_THETA_LSB_RAD) as i32;
            }
        });
    }
    // Variances along the turn, of attitude and of velocity: what the core accounts for itself isn't
    // exposed otherwise.
    let text = format!("{:?}", bench.core);
    let opened = super::core::of_field(&text, "opened")?;
    let [attitude, _, velocity] = [0, 9, 18].map(|at| opened.iter().skip(at).step_by(4).take(3));
    let [attitude, velocity] = [attitude, velocity].map(|part| libm::sqrt(part.sum()));
    let mut all = Found::new();
    all.insert("attitude opened by a disturbance".to_owned(), attitude);
    all.insert("velocity opened by a disturbance, per attitude".to_owned(), velocity / attitude);
    Ok(all)
}
