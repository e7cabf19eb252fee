//! Coarse alignment: attitude from gravity and Earth rate, averaged while the instrument stands.
//!
//! Gravity comes first (TRIAD: M. D. Shuster, S. D. Oh, *Three-axis attitude determination from
//! vector observations*, 1981): down is opposite to the mean specific force, east is down × Earth
//! rate, north completes. Only the direction of the horizontal part of Earth rate is used. Errors,
//! to first order, for errors ∇ and ε in n: `φ_north = ∇_east/g`, `φ_east = −∇_north/g`, `φ_down =
//! ε_east/(Ω cos L) − φ_north tan L`.

use nalgebra::{Matrix3, Vector3};
use octant_earth::UnitQuaternion;
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::frames::quaternion_from_matrix;

use crate::config::Site;

/// Horizontal rate below which north can't be found, rad/s: 1 % of Earth rate, at 89.4° latitude.
const HORIZONTAL_RATE_MIN_RADPS: f64 = 0.01 * EARTH_RATE_RADPS;

/// Computes the attitude `q_nb` of a body at rest from its specific force (m/s²) and angular rate
/// (rad/s), both in b. `None` if the force is zero or the rate has practically no horizontal part.
#[must_use]
pub fn attitude_of(force: &Vector3<f64>, rate: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let down = -force.try_normalize(1e-3)?;
    let east = down.cross(rate).try_normalize(HORIZONTAL_RATE_MIN_RADPS)?;
    let north = east.cross(&down);
    let c_nb = Matrix3::from_rows(&[north.transpose(), east.transpose(), down.transpose()]);
    let good = c_nb.iter().all(|value| value.is_finite());
    good.then(|| quaternion_from_matrix(&c_nb))
}

/// Averages over a standstill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoarseAlignment {
    horizontal_rate_radps: f64,
    delta_theta: Vector3<f64>,
    delta_velocity: Vector3<f64>,
    duration_s: f64,
}

#[cfg(feature = "state")]
octant_state::state! {
    CoarseAlignment {
        values: delta_theta, delta_velocity, duration_s;
        parts: ;
        kept: horizontal_rate_radps
    }
}

impl CoarseAlignment {
    /// Makes an alignment at a site.
    #[must_use]
    pub fn new(site: &Site) -> Self {
        Self {
            horizontal_rate_radps: Ellipsoid::at(site.latitude_rad, site.height_m).earth_rate().x,
            delta_theta: Vector3::zeros(),
            delta_velocity: Vector3::zeros(),
            duration_s: 0.0,
        }
    }

    /// Takes the compensated increments (rad, m/s, in b) of one sample over `dt_s`.
    pub fn step(&mut self, delta_theta: &Vector3<f64>, delta_velocity: &Vector3<f64>, dt_s: f64) {
        self.delta_theta += delta_theta;
        self.delta_velocity += delta_velocity;
        self.duration_s += dt_s;
    }

    /// Computes the attitude `q_nb` of the averages; a body at rest on the Earth has it at the last
    /// sample too.
    ///
    /// `None` near the poles (above 89.4°), and if the horizontal rate of the gyros differs from
    /// that of the Earth by more than a factor of two: they don't resolve it, or the instrument
    /// wasn't at rest.
    #[must_use]
    pub fn finish(&self) -> Option<UnitQuaternion<f64>> {
        if !(self.duration_s > 0.0 && self.horizontal_rate_radps > HORIZONTAL_RATE_MIN_RADPS) {
            return None;
        }
        let force = self.delta_velocity / self.duration_s;
        let rate = self.delta_theta / self.duration_s;
        let down = -force.try_normalize(1e-3)?;
        let horizontal = down.cross(&rate).norm();
        let ratio = horizontal / self.horizontal_rate_radps;
        if !(ratio > 0.5 && ratio < 2.0) {
            return None;
        }
        attitude_of(&force, &rate)
    }
}
