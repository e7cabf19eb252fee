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
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// True attitude of the case, with which many computed ones are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CaseReference {
    q_bc: Quaternion<f64>,
    truth: Pairs,
}

impl CaseReference {
    /// Makes the reference of a true attitude of the body, with true gimbal angles, rad.
    pub(crate) fn new(truth: [f64; 4], gimbal_rad: [f64; 2]) -> Self {
        let q_bc = case_in_body(gimbal_rad);
        Self { truth: Pairs::of(truth, &q_bc), q_bc }
    }

    /// Returns whether another reference is the same, or both aren't known.
    pub(crate) fn is(&self, other: &Self) -> bool {
        let unknown = |of: &Self| of.truth.heading[0].is_nan();
        self.q_bc == other.q_bc && (self.truth == other.truth || (unknown(self) && unknown(other)))
    }

    /// Errors in heading, pitch and roll of a computed attitude, rad: those of [`CaseAngles::error`].
    pub(crate) fn errors(&self, computed: [f64; 4]) -> [f64; 3] {
        let (computed, truth) = (Pairs::of(computed, &self.q_bc), &self.truth);
        [
            difference(computed.heading, truth.heading),
            difference(computed.pitch, truth.pitch),
            difference(computed.roll, truth.roll),
        ]
    }
}

/// Quaternion of `c_bc`: the inverse of `c_cb = Rx(roll) · Rz(azimuth)`.
fn case_in_body([azimuth_rad, roll_rad]: [f64; 2]) -> Quaternion<f64> {
    let (sa, ca) = libm::sincos(0.5 * azimuth_rad);
    let (sr, cr) = libm::sincos(0.5 * roll_rad);
    Quaternion::new(cr * ca, -sr * ca, sr * sa, -cr * sa)
}

impl CaseAngles {
    /// A heading, or its error, without roll and pitch, which are NaN.
    #[must_use]
    pub const fn of_heading(heading_rad: f64) -> Self {
        Self { heading_rad, pitch_rad: f64::NAN, roll_rad: f64::NAN }
    }

    /// Returns whether roll and pitch are known.
    #[must_use]
    pub const fn has_tilt(self) -> bool {
        !(self.pitch_rad.is_nan() && self.roll_rad.is_nan())
    }

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
        let [heading_rad, pitch_rad, roll_rad] =
            CaseReference::new(truth, gimbal_rad).errors(computed);
        Self { heading_rad, pitch_rad, roll_rad }
    }
}
