//! Attitude of the case in a row.

use nalgebra::{Matrix3, UnitQuaternion};
use octant_earth::rotation::{rx, rz};
use octant_sample::GimbalAngles;

/// Roll, pitch and heading of the case, rad: rotations about z, then y, then x take n into c.
///
/// The gimbals stand between case and body: `c_nc = c_nb · c_cbᵀ` with `c_cb = Rx(roll) · Rz(azimuth)`. Heading is
/// in 0 to 2π; pitch is in ±π/2, and there roll and heading aren't unique.
pub(crate) fn of_case(q_nb: &UnitQuaternion<f64>, gimbal: GimbalAngles) -> [f64; 3] {
    let c_nb: Matrix3<f64> = *q_nb.to_rotation_matrix().matrix();
    let c_cb = rx(gimbal.roll_rad()) * rz(gimbal.azimuth_rad());
    let c_nc = c_nb * c_cb.transpose();
    let heading = libm::atan2(c_nc[(1, 0)], c_nc[(0, 0)]);
    [
        libm::atan2(c_nc[(2, 1)], c_nc[(2, 2)]),
        -libm::asin(c_nc[(2, 0)].clamp(-1.0, 1.0)),
        if heading < 0.0 { heading + core::f64::consts::TAU } else { heading },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_earth::rotation::ry;

    #[test]
    fn the_case_keeps_its_attitude_while_the_gimbals_turn() {
        let wanted: [f64; 3] = [0.02, -0.03, 4.0];
        let c_nc = rz(wanted[2]) * ry(wanted[1]) * rx(wanted[0]);
        for (azimuth, roll) in [(0.0, 0.0), (1.2, 0.0), (-2.0, 3.0), (0.5, -0.7)] {
            let gimbal = GimbalAngles::from_rad(azimuth, roll);
            let c_nb = c_nc * rx(gimbal.roll_rad()) * rz(gimbal.azimuth_rad());
            let q_nb = UnitQuaternion::from_matrix(&c_nb);
            let found = of_case(&q_nb, gimbal);
            for (found, wanted) in found.iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
            }
        }
    }
}
