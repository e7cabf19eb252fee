//! Path of the encoders through a block of samples.
//!
//! The mean attitude of the body in a block and, if both gimbals turn, the turn that they cause
//! depend on the path of the gimbals and not only on their final angles.

use nalgebra::{Matrix3, Vector3};
use octant_sample::GimbalAngles;
use octant_sample::counts::GIMBAL_LSB_RAD;

/// Turns of both gimbals from which the path matters, counts of an encoder: 1″.
const FOLLOWED_COUNTS: u32 = (5e-6 / GIMBAL_LSB_RAD) as u32;

/// Path from the start of a block to the last sample.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Way {
    start: GimbalAngles,
    /// Turn of the body so far, in b, rad, and the angles up to which it is summed.
    swept: Vector3<f64>,
    swept_to: GimbalAngles,
    /// Sums of azimuth and roll beyond the start, counts, and the number of samples.
    beyond: [i64; 2],
    samples: u32,
}

/// Result of a complete path.
pub(super) struct Swept {
    /// Turn of the body in b, rad.
    pub(super) turn: Vector3<f64>,
    /// `c_cb` at the mean of azimuth and roll.
    pub(super) c_cb: Matrix3<f64>,
}

impl Way {
    pub(super) fn from(start: GimbalAngles) -> Self {
        Self { start, swept_to: start, ..Self::default() }
    }

    pub(super) fn start(&self) -> GimbalAngles {
        self.start
    }

    /// Takes the encoders of a sample.
    #[inline]
    pub(super) fn follow(&mut self, gimbal: GimbalAngles) {
        let further =
            |sum: i64, now: i32, then: i32| sum.saturating_add(i64::from(now) - i64::from(then));
        self.beyond = [
            further(self.beyond[0], gimbal.azimuth, self.start.azimuth),
            further(self.beyond[1], gimbal.roll, self.start.roll),
        ];
        self.samples = self.samples.saturating_add(1);
        let apart = |now: i32, then: i32| now.abs_diff(then) > FOLLOWED_COUNTS;
        if apart(gimbal.azimuth, self.swept_to.azimuth) && apart(gimbal.roll, self.swept_to.roll) {
            self.sweep(gimbal);
        }
    }

    fn sweep(&mut self, gimbal: GimbalAngles) {
        self.swept += gimbal_turn(self.swept_to, gimbal);
        self.swept_to = gimbal;
    }

    /// Completes the path at `end`, with the mean angles by the trapezoids between its samples. A
    /// path out and back comes from wrong encoders and counts as none.
    pub(super) fn until(mut self, end: GimbalAngles) -> Swept {
        if end == self.start {
            let c_cb = c_cb(end.azimuth_rad(), end.roll_rad());
            return Swept { turn: Vector3::zeros(), c_cb };
        }
        self.sweep(end);
        let samples = f64::from(self.samples.max(1));
        let mean = |start_rad: f64, end_rad: f64, beyond: i64| {
            start_rad + (beyond as f64 * GIMBAL_LSB_RAD - 0.5 * (end_rad - start_rad)) / samples
        };
        let c_cb = c_cb(
            mean(self.start.azimuth_rad(), end.azimuth_rad(), self.beyond[0]),
            mean(self.start.roll_rad(), end.roll_rad(), self.beyond[1]),
        );
        Swept { turn: self.swept, c_cb }
    }
}

/// Rotation of the body in its own axes when the gimbals turn from one reading to another.
pub(crate) fn gimbal_turn(from: GimbalAngles, to: GimbalAngles) -> Vector3<f64> {
    let azimuth = to.azimuth_rad() - from.azimuth_rad();
    let roll = to.roll_rad() - from.roll_rad();
    turned_at(0.5 * (from.azimuth_rad() + to.azimuth_rad()), azimuth, roll)
}

/// Part of [`gimbal_turn`] between two shares of a path with both gimbals at constant rates. Exact
/// for one gimbal; if both turn, to the third order of the part's angle.
pub(crate) fn share_of_turn(
    from: GimbalAngles,
    to: GimbalAngles,
    start: f64,
    end: f64,
) -> Vector3<f64> {
    let azimuth = to.azimuth_rad() - from.azimuth_rad();
    let roll = to.roll_rad() - from.roll_rad();
    let middle = from.azimuth_rad() + 0.5 * (start + end) * azimuth;
    turned_at(middle, azimuth * (end - start), roll * (end - start))
}

/// Small turns of both gimbals, in the body's axes at this azimuth.
fn turned_at(middle_rad: f64, azimuth_rad: f64, roll_rad: f64) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(middle_rad);
    Vector3::new(roll_rad * cos, -roll_rad * sin, azimuth_rad)
}

/// `Rx(roll) · Rz(azimuth)`.
pub(crate) fn c_cb(azimuth_rad: f64, roll_rad: f64) -> Matrix3<f64> {
    let ((sa, ca), (sr, cr)) = (libm::sincos(azimuth_rad), libm::sincos(roll_rad));
    Matrix3::new(ca, -sa, 0.0, cr * sa, cr * ca, -sr, sr * sa, sr * ca, cr)
}
