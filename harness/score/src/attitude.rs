//! Attitude error of the case: heading, pitch, roll.
//!
//! The navigation solution has the attitude of the sensor block, which the gimbals turn. A vessel needs
//! heading, pitch and roll of the case. Both attitudes, computed and true, are turned back by the true
//! gimbal angles, so that the score is that of the navigation solution alone: errors of the encoders
//! aren't in it.

use nalgebra::Quaternion;
use serde::{Deserialize, Serialize};

/// Heading, pitch and roll of the case, or their errors (computed minus true), rad.
///
/// With a level case at heading 0 the errors are `(−φ_D, −φ_E, −φ_N)` of the misalignment φ in
/// `c_nb(computed) = (I − [φ×]) c_nb(true)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseAngles {
    /// Heading, positive clockwise as seen from above.
    pub heading_rad: f64,
    /// Pitch, positive bow up.
    pub pitch_rad: f64,
    /// Roll, positive starboard down.
    pub roll_rad: f64,
}

/// Elements of `c_nc` from which heading, pitch and roll follow, as pairs of sine and cosine with a
/// common factor.
#[derive(Clone, Copy)]
struct Pairs {
    heading: [f64; 2],
    pitch: [f64; 2],
    roll: [f64; 2],
}

impl Pairs {
    /// Pairs of a body's attitude `q_nb` with `q_bc`, the gimbals' turn from case to body.
    fn of(q_nb: [f64; 4], q_bc: &Quaternion<f64>) -> Self {
        let [w, x, y, z] = q_nb;
        let q = Quaternion::new(w, x, y, z) * q_bc;
        let (w, x, y, z) = (q.w, q.i, q.j, q.k);
        let c00 = (w * w + x * x) - (y * y + z * z);
        let c10 = 2.0 * (x * y + w * z);
        let c20 = 2.0 * (x * z - w * y);
        let c21 = 2.0 * (y * z + w * x);
        let c22 = (w * w + z * z) - (x * x + y * y);
        Self {
            heading: [c10, c00],
            pitch: [-c20, libm::sqrt(c00 * c00 + c10 * c10)],
            roll: [c21, c22],
        }
    }
}

/// Difference of two angles within ±π, from their pairs: exact for tiny differences of large angles.
fn difference(computed: [f64; 2], truth: [f64; 2]) -> f64 {
    libm::atan2(
        computed[0] * truth[1] - computed[1] * truth[0],
        computed[1] * truth[1] + computed[0] * truth[0],
    )
}

/// Quaternion of `c_bc`: the inverse of `c_cb = Rx(roll) · Rz(azimuth)`.
fn case_in_body([azimuth_rad, roll_rad]: [f64; 2]) -> Quaternion<f64> {
    let (sa, ca) = libm::sincos(0.5 * azimuth_rad);
    let (sr, cr) = libm::sincos(0.5 * roll_rad);
    Quaternion::new(cr * ca, -sr * ca, sr * sa, -cr * sa)
}

impl CaseAngles {
    /// Attitude of the case from that of the body, `q_nb` (w, x, y, z), with gimbal angles (azimuth,
    /// roll), rad. Heading and roll are within ±π, pitch within ±π/2.
    #[must_use]
    pub fn of(q_nb: [f64; 4], gimbal_rad: [f64; 2]) -> Self {
        let pairs = Pairs::of(q_nb, &case_in_body(gimbal_rad));
        let angle = |[s, c]: [f64; 2]| libm::atan2(s, c);
        Self {
            heading_rad: angle(pairs.heading),
            pitch_rad: angle(pairs.pitch),
            roll_rad: angle(pairs.roll),
        }
    }

    /// Error of a computed attitude: computed minus true, each within ±π. Both are attitudes `q_nb` (w,
    /// x, y, z) of the body; `gimbal_rad` are the true gimbal angles (azimuth, roll).
    #[must_use]
    pub fn error(computed: [f64; 4], truth: [f64; 4], gimbal_rad: [f64; 2]) -> Self {
        let q_bc = case_in_body(gimbal_rad);
        let (computed, truth) = (Pairs::of(computed, &q_bc), Pairs::of(truth, &q_bc));
        Self {
            heading_rad: difference(computed.heading, truth.heading),
            pitch_rad: difference(computed.pitch, truth.pitch),
            roll_rad: difference(computed.roll, truth.roll),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_earth::frames::{c_cb, c_nc, quaternion_from_matrix};
    use octant_earth::rotation::exp;
    use octant_earth::units::{ARCMIN, DEG};
    use octant_earth::{UnitQuaternion, Vector3};

    fn near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected}");
    }

    fn numbers(q: &UnitQuaternion<f64>) -> [f64; 4] {
        [q.w, q.i, q.j, q.k]
    }

    #[test]
    fn errors_of_the_case_are_differences_of_its_angles_at_any_place_of_the_gimbals() {
        let (truth, computed) = ([3.13, 0.08, -0.3], [-3.12, 0.05, -0.27]);
        for gimbal in [[0.0, 0.0], [1.2, -0.7], [core::f64::consts::PI, 1.6], [20.0, 9.4]] {
            let body = |[heading, pitch, roll]: [f64; 3]| {
                let c = c_nc(heading, pitch, roll) * c_cb(gimbal[0], gimbal[1]);
                numbers(&quaternion_from_matrix(&c))
            };
            let error = CaseAngles::error(body(computed), body(truth), gimbal);
            near(error.heading_rad, computed[0] - truth[0] + 2.0 * core::f64::consts::PI, 1e-14);
            near(error.pitch_rad, -0.03, 1e-14);
            near(error.roll_rad, 0.03, 1e-14);
            let attitude = CaseAngles::of(body(truth), gimbal);
            near(attitude.heading_rad, truth[0], 1e-14);
            near(attitude.pitch_rad, truth[1], 1e-14);
            near(attitude.roll_rad, truth[2], 1e-14);
        }
    }

    #[test]
    fn a_misalignment_shows_with_its_sign() {
        // c_nb(computed) = (I − [φ×]) c_nb(true): the computed frame is turned by −φ in n.
        let phi = Vector3::new(0.4 * ARCMIN, -0.7 * ARCMIN, 3.0 * ARCMIN);
        let truth = quaternion_from_matrix(&c_cb(0.4, 2.0));
        let computed = exp(&-phi) * truth;
        let error = CaseAngles::error(numbers(&computed), numbers(&truth), [0.4, 2.0]);
        near(error.heading_rad, -phi.z, 1e-3 * ARCMIN);
        near(error.pitch_rad, -phi.y, 4e-3 * ARCMIN);
        near(error.roll_rad, -phi.x, 4e-3 * ARCMIN);
        // At heading 90° the bow points east: pitch is about −x of n, roll about y of n.
        let east = quaternion_from_matrix(&c_nc(90.0 * DEG, 0.0, 0.0));
        let error = CaseAngles::error(numbers(&(exp(&-phi) * east)), numbers(&east), [0.0; 2]);
        near(error.pitch_rad, phi.x, 4e-3 * ARCMIN);
        near(error.roll_rad, -phi.y, 4e-3 * ARCMIN);
    }

    #[test]
    fn tiny_errors_of_large_angles_keep_their_digits() {
        let truth = quaternion_from_matrix(&c_nc(-3.0, 0.1, 0.2));
        let computed = quaternion_from_matrix(&c_nc(-3.0 + 1e-12, 0.1, 0.2));
        let error = CaseAngles::error(numbers(&computed), numbers(&truth), [0.0; 2]);
        near(error.heading_rad, 1e-12, 2e-15);
    }
}
