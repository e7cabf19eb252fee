//! Frames of the instrument: navigation, case, body.

use crate::rotation::{rx, ry, rz};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

/// `c_nc = Rz(heading) · Ry(pitch) · Rx(roll)`: case to navigation, angles in rad.
#[must_use]
pub fn c_nc(heading_rad: f64, pitch_rad: f64, roll_rad: f64) -> Matrix3<f64> {
    rz(heading_rad) * ry(pitch_rad) * rx(roll_rad)
}

/// `c_cb = Rx(roll) · Rz(azimuth)`: body to case, gimbal angles in rad.
///
/// Down in body is then `(sin r sin a, sin r cos a, cos r)`.
#[must_use]
pub fn c_cb(azimuth_rad: f64, roll_rad: f64) -> Matrix3<f64> {
    rx(roll_rad) * rz(azimuth_rad)
}

/// Unit quaternion of a rotation matrix.
#[must_use]
pub fn quaternion_from_matrix(c: &Matrix3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*c))
}

/// Heading, pitch and roll (rad) of a rotation matrix `c_nc`; pitch within ±90°.
#[must_use]
pub fn euler_of(c: &Matrix3<f64>) -> (f64, f64, f64) {
    (
        libm::atan2(c[(1, 0)], c[(0, 0)]),
        -libm::asin(c[(2, 0)].clamp(-1.0, 1.0)),
        libm::atan2(c[(2, 1)], c[(2, 2)]),
    )
}

/// Matrix that takes a small misalignment φ (rad, in n) of a computed attitude into the errors (computed
/// minus true) of heading, pitch and roll of the case, at this heading and pitch (rad).
///
/// The computed frame is turned by −φ: `δheading = −φ_D − tan p·a`, `δpitch = −b`, `δroll = −a/cos p`,
/// where a and b are the horizontal parts of φ along the bow and to starboard of it.
#[must_use]
pub fn case_of_phi(heading_rad: f64, pitch_rad: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(heading_rad);
    let (sin_pitch, cos_pitch) = libm::sincos(pitch_rad);
    let tan_pitch = sin_pitch / cos_pitch;
    Matrix3::new(
        -tan_pitch * c,
        -tan_pitch * s,
        -1.0,
        s,
        -c,
        0.0,
        -c / cos_pitch,
        -s / cos_pitch,
        0.0,
    )
}

/// Attitude error φ (rad, in n) of a computed attitude against the true one:
/// `c_nb(computed) = (I − [φ×]) c_nb(true)`.
#[must_use]
pub fn phi_of(
    computed: &UnitQuaternion<f64>,
    truth: &UnitQuaternion<f64>,
) -> nalgebra::Vector3<f64> {
    -crate::rotation::log(&(computed * truth.inverse()))
}
