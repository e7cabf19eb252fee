//! What the filter is opened by for a turn of the gyros that the base at rest didn't make.

use super::bridge::Bench;
use super::numbers::{Found, input};
use octant_calibration::config::Noise;
use octant_calibration::covariance::DV;
use octant_sample::counts::DELTA_THETA_LSB_RAD;

/// Samples before the turn, of 20 ms: the core has begun its first standstill, and the turn ends
/// well before the next measurement, at a whole second.
const BEFORE: u32 = 1510;
/// Samples of the turn, and those in which it has been found and followed.
const TURNING: u32 = 10;
const FOLLOWED: u32 = 20;

pub(super) fn found() -> Result<Found, String> {
    let mut bench = Bench::with(|core| {
        // Gyros so loud that a sample of the turn is no jump, accelerometers that add next to no
        // variance of velocity.
        core.noise = Noise { angle_random_walk: 3e-5, velocity_random_walk: 2e-7 };
    })?;
    for _ in 0..BEFORE {
        bench.step();
    }
    let down = |bench: &Bench| {
        let filter = bench.core.filter().ok_or("find the filter")?;
        Ok::<f64, String>(filter.covariance().at(DV + 2, DV + 2))
    };
    let before = down(&bench)?;
    let angle = input("angle of the disturbance, rad").ok_or("find the disturbance")?;
    for n in 0..FOLLOWED {
        bench.step_with(|sample| {
            if n >= TURNING {
                return;
            }
            // About the vertical: up is where the force comes from, and it stays where it is.
            let up = sample.delta_velocity.map(f64::from);
            let norm = libm::sqrt(up.iter().map(|part| part * part).sum());
            for axis in 0..3 {
                let part = angle / f64::from(TURNING) * up[axis] / norm;
                sample.delta_theta[axis] += libm::round(part / DELTA_THETA_LSB_RAD) as i32;
            }
        });
    }
    let mut all = Found::new();
    let opened = down(&bench)? - before;
    all.insert("velocity opened by a turn of a second's disturbance".to_owned(), libm::sqrt(opened));
    Ok(all)
}
