//! Covariance of the navigation solution in the filter.

use super::CalibrationFilter;
use crate::config::ErrorModel;
use crate::covariance::{DR, DV, PHI};
use crate::error_model::computer_frame_error;
use crate::strapdown::Strapdown;
use nalgebra::{Matrix3, Vector3};
use octant_sample::NavigationCovariance;

impl CalibrationFilter {
    /// Covariance of position, velocity and attitude after the last propagation and measurement, of
    /// the φ form whatever the form of the filter.
    #[must_use]
    pub fn navigation_covariance(&self, strapdown: &Strapdown) -> NavigationCovariance {
        let (turn, drag) = match self.model {
            ErrorModel::Phi => (Matrix3::zeros(), Matrix3::zeros()),
            // As in the feedback: φ = ψ + δθ and δv = δv(ψ form) − δθ × v, where δθ is linear in δr.
            ErrorModel::Psi => {
                let unit = |j: usize| Vector3::from_fn(|i, _| if i == j { 1.0 } else { 0.0 });
                let frame = |j: usize| computer_frame_error(&unit(j), strapdown.earth());
                let turn = Matrix3::from_columns(&[frame(0), frame(1), frame(2)]);
                let dragged = |j: usize| -frame(j).cross(strapdown.velocity_mps());
                (turn, Matrix3::from_columns(&[dragged(0), dragged(1), dragged(2)]))
            }
        };
        NavigationCovariance {
            position_m2: upper_triangle(&self.block(DR, DR)),
            velocity_m2ps2: upper_triangle(&self.with_position(DV, &drag)),
            attitude_rad2: upper_triangle(&self.with_position(PHI, &turn)),
        }
    }

    /// Covariance of the states at `rows` with those at `columns`, three each.
    fn block(&self, rows: usize, columns: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| self.covariance.at(rows + i, columns + j))
    }

    /// Covariance of the states at `at` plus a linear function of δr.
    fn with_position(&self, at: usize, of_position: &Matrix3<f64>) -> Matrix3<f64> {
        let cross = of_position * self.block(DR, at);
        self.block(at, at)
            + cross
            + cross.transpose()
            + of_position * self.block(DR, DR) * of_position.transpose()
    }
}

/// Upper triangle of a symmetric matrix, by rows.
fn upper_triangle(matrix: &Matrix3<f64>) -> [f64; 6] {
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| matrix[at])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{AidingMode, Kalman, Noise, Prior, Screening, Site, SwayNoise};
    use crate::strapdown::Vertical;
    use nalgebra::UnitQuaternion;
    use octant_earth::ellipsoid::Ellipsoid;
    use octant_sample::{Parameters, Reference};

    const LATITUDE_RAD: f64 = 0.8;
    /// Prior σ: attitude, velocity, position.
    const SIGMAS: ([f64; 3], f64, f64) = ([1e-4, 2e-4, 3e-3], 0.02, 300.0);
    const VELOCITY_MPS: [f64; 3] = [10.0, -20.0, 0.5];

    fn filter(error_model: ErrorModel) -> (CalibrationFilter, Strapdown) {
        let kalman = Kalman {
            error_model,
            estimated: [true; 7],
            prior: Prior {
                attitude_rad: SIGMAS.0,
                velocity_mps: SIGMAS.1,
                position_m: SIGMAS.2,
                parameters: [1e-6; 7],
            },
            aiding: AidingMode::Velocity { sigma_mps: 0.01 },
            aiding_period_ns: 1_000_000_000,
            sway: SwayNoise::White,
            refuse_above_mean_nis: 9.0,
            further: Default::default(),
            sigma_limits: Default::default(),
        };
        let site = Site { latitude_rad: LATITUDE_RAD, longitude_rad: 0.0, height_m: 0.0 };
        let noise = Noise { angle_random_walk: 0.0, velocity_random_walk: 0.0 };
        let screening = Screening::none();
        let filter = CalibrationFilter::new(
            &kalman,
            &site,
            &noise,
            &screening,
            &Parameters::default(),
            5_000_000,
        );
        let strapdown = Strapdown::new(
            &UnitQuaternion::identity(),
            Vector3::from(VELOCITY_MPS),
            LATITUDE_RAD,
            0.0,
            0.0,
            Vertical::Free,
        );
        (filter, strapdown)
    }

    fn near(found: [f64; 6], wanted: [f64; 6]) {
        let scale = wanted.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((found - wanted).abs() <= 1e-12 * scale, "{found:e} {wanted:e}");
        }
    }

    #[test]
    fn the_prior_is_that_of_the_configuration() {
        let (filter, strapdown) = filter(ErrorModel::Phi);
        let found = filter.navigation_covariance(&strapdown);
        let ([n, e, d], v, r) = SIGMAS;
        near(found.attitude_rad2, [n * n, 0.0, 0.0, e * e, 0.0, d * d]);
        near(found.velocity_m2ps2, [v * v, 0.0, 0.0, v * v, 0.0, v * v]);
        near(found.position_m2, [r * r, 0.0, 0.0, r * r, 0.0, r * r]);
    }

    /// With independent ψ, δv and δr the covariance of φ = ψ + δθ and of δv − δθ × v is written
    /// down: δθ = (δr_e/R_t, −δr_n/R_m, −δr_e tan L/R_t).
    #[test]
    fn a_position_error_turns_the_attitude_of_the_psi_form() {
        let (filter, strapdown) = filter(ErrorModel::Psi);
        let found = filter.navigation_covariance(&strapdown);
        let earth = Ellipsoid::at(LATITUDE_RAD, 0.0);
        let ([n, e, d], v, r) = SIGMAS;
        let (by_east, by_north) = (r / earth.transverse_radius_m, r / earth.meridian_radius_m);
        let tan = earth.sin_latitude / earth.cos_latitude;
        near(
            found.attitude_rad2,
            [
                n * n + by_east * by_east,
                0.0,
                -by_east * by_east * tan,
                e * e + by_north * by_north,
                0.0,
                d * d + by_east * by_east * tan * tan,
            ],
        );
        // −δθ × v of δr = (n, e, d), component by component.
        let [vn, ve, vd] = VELOCITY_MPS;
        let (a, b, c) = (by_east, by_north, by_east * tan);
        // North: −(θe vd − θd ve), east: −(θd vn − θn vd), down: −(θn ve − θe vn).
        let of_east = [-c * ve, c * vn + a * vd, -a * ve];
        let of_north = [b * vd, 0.0, -b * vn];
        let both = |i: usize, j: usize| of_east[i] * of_east[j] + of_north[i] * of_north[j];
        near(
            found.velocity_m2ps2,
            [
                v * v + both(0, 0),
                both(0, 1),
                both(0, 2),
                v * v + both(1, 1),
                both(1, 2),
                v * v + both(2, 2),
            ],
        );
        near(found.position_m2, [r * r, 0.0, 0.0, r * r, 0.0, r * r]);
    }

    #[test]
    fn a_measurement_leaves_the_variance_of_the_weighted_mean() {
        let (mut filter, mut strapdown) = filter(ErrorModel::Phi);
        let measured = filter.measure(
            &Reference::Velocity(VELOCITY_MPS),
            &mut strapdown,
            &mut Parameters::default(),
        );
        assert!(measured.is_some_and(|measured| !measured.rejected));
        let found = filter.navigation_covariance(&strapdown);
        let (prior, r): (f64, f64) = (SIGMAS.1 * SIGMAS.1, 0.01 * 0.01);
        let left = prior * r / (prior + r);
        near(found.velocity_m2ps2, [left, 0.0, 0.0, left, 0.0, left]);
    }
}
