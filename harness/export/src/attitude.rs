//! Attitudes of a row: of the case, and the error of an estimate.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use octant_earth::rotation::{log, rx, rz};
use octant_sample::GimbalAngles;

/// Attitude as a unit quaternion; `None` for one that isn't: a core that hasn't aligned yet has zeros.
pub(crate) fn unit(q_wxyz: &[f64; 4]) -> Option<UnitQuaternion<f64>> {
    let [w, x, y, z] = *q_wxyz;
    let q = Quaternion::new(w, x, y, z);
    let norm = q.norm();
    ((norm - 1.0).abs() < 1e-3).then(|| UnitQuaternion::new_normalize(q))
}

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

/// Rotation vector in n, rad, that turns the true attitude into the estimated one.
pub(crate) fn error(
    estimated_nb: &UnitQuaternion<f64>,
    true_nb: &UnitQuaternion<f64>,
) -> Vector3<f64> {
    log(&(estimated_nb * true_nb.inverse()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_earth::rotation::{exp, ry};

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

    #[test]
    fn an_error_is_told_about_the_axis_it_is_made_about() {
        let truth = exp(&Vector3::new(0.3, -1.0, 0.4));
        let phi = Vector3::new(1e-4, -2e-4, 3e-4);
        let found = error(&(exp(&phi) * truth), &truth);
        assert!((found - phi).norm() < 1e-12, "{found}");
    }

    #[test]
    fn zeros_are_no_attitude() {
        assert_eq!(unit(&[0.0; 4]), None);
        assert!(unit(&[1.0, 0.0, 0.0, 0.0]).is_some());
        assert_eq!(unit(&[f64::NAN, 0.0, 0.0, 0.0]), None);
    }
}
