//! Strapdown mechanization in the local-level frame (north, east, down).
//!
//! Increments are exact integrals over the interval. Attitude has the two-sample coning term,
//! velocity the rotation and sculling terms (Savage, *Strapdown Analytics*, 7.1 and 7.2) with the
//! rotation carried to third order: at 10 °/s and 200 Hz the second-order form alone would leave
//! 1e-7 of gravity in every move.

use crate::config::Site;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::rotation::{quaternion_of, renormalize};
use octant_sample::Navigation;

/// Samples between two evaluations of radii, gravity and Earth rate: 50 ms at 200 Hz, in which a
/// ship at 10 m/s moves 0.5 m, 1e-7 of the Earth's radius.
const EARTH_UPDATE_SAMPLES: u32 = 10;

/// Mode of the vertical channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum Vertical {
    /// Integrated like the others: needs aiding, without it the channel diverges.
    Free,
    /// Height and vertical velocity keep their values.
    Held,
}

/// Navigation state and the memory of its integration.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Strapdown {
    q_nb: Quaternion<f64>,
    velocity_mps: Vector3<f64>,
    latitude_rad: f64,
    longitude_rad: f64,
    height_m: f64,
    vertical: Vertical,
    earth: Ellipsoid,
    /// ω_ie in n at the last evaluation.
    earth_rate: Vector3<f64>,
    tan_latitude: f64,
    /// 1/(R_M + h), 1/(R_N + h) and 1/((R_N + h) cos L), 1/m: division is slow for every sample.
    per_meridian: f64,
    per_transverse: f64,
    per_parallel: f64,
    until_earth_update: u32,
    previous: Option<(Vector3<f64>, Vector3<f64>)>,
    /// Velocity change by specific force in n during the last interval.
    delta_velocity_n: Vector3<f64>,
    /// Half the change of velocity over the last interval, m/s.
    half_change_mps: Vector3<f64>,
    sound: bool,
}

impl Strapdown {
    /// Starts from an attitude, velocity (n, m/s) and position.
    #[must_use]
    pub fn new(
        q_nb: &UnitQuaternion<f64>,
        velocity_mps: Vector3<f64>,
        latitude_rad: f64,
        longitude_rad: f64,
        height_m: f64,
        vertical: Vertical,
    ) -> Self {
        let mut strapdown = Self {
            q_nb: *q_nb.quaternion(),
            velocity_mps,
            latitude_rad,
            longitude_rad,
            height_m,
            vertical,
            earth: Ellipsoid::at(latitude_rad, height_m),
            earth_rate: Vector3::zeros(),
            tan_latitude: 0.0,
            per_meridian: 0.0,
            per_transverse: 0.0,
            per_parallel: 0.0,
            until_earth_update: 0,
            previous: None,
            delta_velocity_n: Vector3::zeros(),
            half_change_mps: Vector3::zeros(),
            sound: true,
        };
        strapdown.update_earth(0.0);
        strapdown
    }

    /// Evaluates radii, gravity and Earth rate at the latitude that is reached `ahead_s` from now.
    fn update_earth(&mut self, ahead_s: f64) {
        let ahead_rad = self.velocity_mps.x * self.per_meridian * ahead_s;
        self.earth = Ellipsoid::at(self.latitude_rad + ahead_rad, self.height_m);
        self.earth_rate = self.earth.earth_rate();
        self.tan_latitude = self.earth.sin_latitude / self.earth.cos_latitude;
        self.per_meridian = 1.0 / self.earth.meridian_radius_m;
        self.per_transverse = 1.0 / self.earth.transverse_radius_m;
        self.per_parallel = self.per_transverse / self.earth.cos_latitude;
    }

    /// Integrates one interval: compensated increments of ω_ib and f in b over `interval_s`.
    #[inline(always)]
    pub fn step(&mut self, dtheta: &Vector3<f64>, dv: &Vector3<f64>, interval_s: f64) {
        if self.until_earth_update == 0 {
            // For the middle of the intervals that use it: an Earth rate that lags the latitude
            // couples the two horizontal channels.
            self.update_earth(0.5 * f64::from(EARTH_UPDATE_SAMPLES) * interval_s);
            self.until_earth_update = EARTH_UPDATE_SAMPLES;
        }
        self.until_earth_update -= 1;

        let (dtheta0, dv0) = match &mut self.previous {
            Some((theta, velocity)) => {
                (core::mem::replace(theta, *dtheta), core::mem::replace(velocity, *dv))
            }
            None => *self.previous.insert((*dtheta, *dv)),
        };

        // The part that depends on the state alone comes first, so that it doesn't wait for the
        // sample: the transport rate is that of the velocity at the middle of the interval,
        // extrapolated over half of it. With the velocity at the start every Schuler oscillation
        // would grow by ω² t h/4, 1 % in 72 h at 10 Hz. The navigation frame turns under the body
        // by zeta, which is below 1e-6 rad: its quaternion to second order, closed by the
        // renormalization.
        let v = &self.velocity_mps;
        let v_ahead = v + self.half_change_mps;
        let east = v_ahead.y * self.per_transverse;
        let transport_rate =
            Vector3::new(east, -v_ahead.x * self.per_meridian, -east * self.tan_latitude);
        let half_zeta = (self.earth_rate + transport_rate) * (0.5 * interval_s);
        let coriolis_angle = (self.earth_rate * 2.0 + transport_rate) * interval_s;
        let frame = Quaternion::new(1.0, -half_zeta.x, -half_zeta.y, -half_zeta.z);
        let q_turned = renormalize(frame * self.q_nb);
        let c_nb = self.c_nb();

        // Coning, rotation and sculling in the body frame at the start of the interval; terms with
        // dtheta as their first factor are combined.
        let rotation = dtheta + dtheta0.cross(dtheta) * (1.0 / 12.0);
        let turned = dtheta.cross(dv);
        let dv_body = dv
            + dtheta.cross(&(dv * 0.5 + turned * (1.0 / 6.0) - dv0 * (1.0 / 12.0)))
            + dtheta0.cross(dv) * (1.0 / 12.0);
        let q_new = q_turned * quaternion_of(&rotation);

        let mut dv_n = c_nb * dv_body;
        dv_n -= half_zeta.cross(&dv_n);
        self.delta_velocity_n = dv_n;

        // Coriolis with the velocity at the middle of the interval, as far as it is known.
        let gravity_dv = self.earth.gravity_mps2 * interval_s;
        let v_middle = v + Vector3::new(dv_n.x, dv_n.y, dv_n.z + gravity_dv) * 0.5;
        let mut v_new = v + dv_n - coriolis_angle.cross(&v_middle);
        v_new.z += gravity_dv;
        if self.vertical == Vertical::Held {
            v_new.z = 0.0;
        }

        if !finite(&q_new, &v_new) {
            self.sound = false;
            return;
        }
        let mean = (v + v_new) * 0.5;
        self.latitude_rad += mean.x * self.per_meridian * interval_s;
        self.longitude_rad += mean.y * self.per_parallel * interval_s;
        self.height_m -= mean.z * interval_s;
        self.half_change_mps = (v_new - v) * 0.5;
        self.velocity_mps = v_new;
        self.q_nb = q_new;
    }

    /// Subtracts estimated errors: φ (rad, n), δv (m/s, n) and δr (m; north, east, down).
    pub fn correct(&mut self, phi: &Vector3<f64>, dv: &Vector3<f64>, dr: &Vector3<f64>) {
        // computed = (I − [φ×]) true, so true = exp(φ) computed.
        let q_new = renormalize(quaternion_of(phi) * self.q_nb);
        let v_new = self.velocity_mps - dv;
        if !finite(&q_new, &v_new) || !(dr.x + dr.y + dr.z).is_finite() {
            self.sound = false;
            return;
        }
        self.q_nb = q_new;
        self.velocity_mps = v_new;
        self.latitude_rad -= dr.x / self.earth.meridian_radius_m;
        self.longitude_rad -= dr.y / (self.earth.transverse_radius_m * self.earth.cos_latitude);
        self.height_m += dr.z;
    }

    /// Sets the position, keeping attitude and velocity.
    pub fn move_to(&mut self, site: &Site) {
        (self.latitude_rad, self.longitude_rad, self.height_m) =
            (site.latitude_rad, site.longitude_rad, site.height_m);
        self.update_earth(0.0);
        self.until_earth_update = 0;
    }

    /// Sets position and vertical channel for free navigation, keeping attitude and velocity.
    pub fn start_free(&mut self, site: &Site) {
        self.vertical = Vertical::Held;
        self.velocity_mps.z = 0.0;
        self.move_to(site);
    }

    /// Returns whether all input so far was finite. Other input was kept out of the solution.
    #[must_use]
    #[inline]
    pub fn is_sound(&self) -> bool {
        self.sound
    }

    /// Attitude as a matrix `c_nb`.
    #[must_use]
    pub fn c_nb(&self) -> Matrix3<f64> {
        *UnitQuaternion::new_unchecked(self.q_nb).to_rotation_matrix().matrix()
    }

    /// Velocity over ground in n, m/s.
    #[must_use]
    pub fn velocity_mps(&self) -> &Vector3<f64> {
        &self.velocity_mps
    }

    /// Velocity change by specific force in n during the last interval, m/s.
    #[must_use]
    #[inline]
    pub fn delta_velocity_n(&self) -> &Vector3<f64> {
        &self.delta_velocity_n
    }

    /// Earth model at the instrument's position, of the last evaluation.
    #[must_use]
    pub fn earth(&self) -> &Ellipsoid {
        &self.earth
    }

    /// The navigation solution.
    #[must_use]
    #[inline]
    pub fn navigation(&self) -> Navigation {
        let q = &self.q_nb;
        Navigation {
            latitude_rad: self.latitude_rad,
            longitude_rad: self.longitude_rad,
            height_m: self.height_m,
            velocity_mps: [self.velocity_mps.x, self.velocity_mps.y, self.velocity_mps.z],
            q_nb: [q.w, q.i, q.j, q.k],
        }
    }
}

/// A value that isn't finite remains so in a sum; a sum that overflows is useless too.
#[inline]
fn finite(q: &Quaternion<f64>, v: &Vector3<f64>) -> bool {
    ((q.w + q.i) + (q.j + q.k) + (v.x + v.y + v.z)).is_finite()
}
