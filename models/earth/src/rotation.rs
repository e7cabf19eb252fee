//! Rotations: exponentials, axis rotations, quaternion products without hidden normalisation.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Cross-product matrix `[a×]`.
#[must_use]
#[inline]
pub fn skew(a: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}

/// Rotation about x by `angle_rad`: takes a vector in the rotated frame into the base frame.
#[must_use]
pub fn rx(angle_rad: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle_rad);
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

/// Rotation about y by `angle_rad`.
#[must_use]
pub fn ry(angle_rad: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle_rad);
    Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
}

/// Rotation about z by `angle_rad`.
#[must_use]
pub fn rz(angle_rad: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle_rad);
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// Quaternion of a rotation vector `phi` (rad): `q_ab` if b is reached from a by turning `phi`.
///
/// Below 0.1 rad, where every 200 Hz sample lies, sine and cosine are power series that are exact
/// to the last bit or two; above it they are libm's.
#[must_use]
#[inline]
pub fn quaternion_of(phi: &Vector3<f64>) -> Quaternion<f64> {
    let angle2 = phi.norm_squared();
    // cos(x/2) and sin(x/2)/x in y = x²/4, in pairs of terms that don't wait for each other.
    let (c, s) = if angle2 < 0.01 {
        let y = 0.25 * angle2;
        let y2 = y * y;
        (
            (1.0 - y * (1.0 / 2.0))
                + y2 * ((1.0 / 24.0 - y * (1.0 / 720.0)) + y2 * (1.0 / 40_320.0)),
            (1.0 / 2.0 - y * (1.0 / 12.0))
                + y2 * ((1.0 / 240.0 - y * (1.0 / 10_080.0)) + y2 * (1.0 / 725_760.0)),
        )
    } else {
        let angle = libm::sqrt(angle2);
        let (s, c) = libm::sincos(0.5 * angle);
        (c, s / angle)
    };
    Quaternion::new(c, s * phi.x, s * phi.y, s * phi.z)
}

/// Unit quaternion of a rotation vector (rad).
#[must_use]
pub fn exp(phi: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(quaternion_of(phi))
}

/// Rotation vector (rad, shortest) of a unit quaternion.
#[must_use]
pub fn log(q: &UnitQuaternion<f64>) -> Vector3<f64> {
    let (w, v) = if q.w < 0.0 { (-q.w, -q.imag()) } else { (q.w, q.imag()) };
    let sin_half = v.norm();
    if sin_half < 1e-9 {
        return v * 2.0;
    }
    v * (2.0 * libm::atan2(sin_half, w) / sin_half)
}

/// Brings a quaternion to unit length by one Newton step: enough for errors of rounding size.
#[must_use]
#[inline]
pub fn renormalize(q: Quaternion<f64>) -> Quaternion<f64> {
    q * (1.5 - 0.5 * q.norm_squared())
}
