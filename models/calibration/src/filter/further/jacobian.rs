//! The columns of the further states against a numerical Jacobian of the strapdown: the increments
//! of a known motion are perturbed by each error in closed form, and the difference of the two
//! navigations has to agree with the column.

use super::tests::{all_on, kalman};
use super::*;
use crate::config::ErrorModel;
use crate::covariance::{DR, DV, PHI};
use crate::error_model::computer_frame_error;
use crate::further::compensation::FurtherCompensation;
use crate::strapdown::{Strapdown, Vertical};
use nalgebra::{Quaternion, UnitQuaternion};
use octant_earth::frames::phi_of;

const DT: f64 = 0.005;
/// Samples in a sub-step of the filter, 50 ms.
const SUB_STEP: usize = 10;
const SAMPLES: usize = 800;
const LATITUDE_RAD: f64 = 0.7;
/// Correlation times of the Gauss-Markov biases, s: short, so that their decay shows.
const GYRO_S: f64 = 3.0;
const ACCEL_S: f64 = 5.0;

/// T − T₀ at a time, K.
fn warmth_k(t: f64) -> f64 {
    1.5 + libm::sin(0.8 * t)
}

/// Rate of the body, its derivative, and specific force, in b.
fn motion(t: f64) -> [Vector3<f64>; 3] {
    let (s, c) = libm::sincos(0.9 * t);
    let rate = Vector3::new(0.3, -0.25 + 0.2 * s, 0.2 * libm::cos(0.5 * t));
    let acceleration = Vector3::new(0.0, 0.18 * c, -0.1 * libm::sin(0.5 * t));
    let force =
        Vector3::new(1.2 * libm::sin(0.7 * t), -0.8 + 0.2 * t, -9.7 + 0.5 * libm::cos(1.1 * t));
    [rate, acceleration, force]
}

fn start() -> Strapdown {
    let q_nb = UnitQuaternion::from_euler_angles(0.4, -0.2, 1.1);
    let velocity = Vector3::new(12.0, -7.0, 0.5);
    Strapdown::new(&q_nb, velocity, LATITUDE_RAD, 0.3, 50.0, Vertical::Free)
}

/// Error of rate and specific force at a time by one unit of a further state.
fn effect(state: usize, t: f64, strapdown: &Strapdown) -> [Vector3<f64>; 2] {
    let [w, a, f] = motion(t);
    let unit = |axis: usize| Vector3::from_fn(|i, _| if i == axis { 1.0 } else { 0.0 });
    let zero = Vector3::zeros();
    let group = FurtherGroup::ALL.into_iter().find(|group| group.range().contains(&state)).unwrap();
    let axis = state - group.start();
    // At the middle of the sample the body has turned by half of its turn.
    let c_bn = (Matrix3::identity() - octant_earth::rotation::skew(&(w * (0.5 * DT))))
        * strapdown.c_nb().transpose();
    match group {
        FurtherGroup::AccelLever => {
            let arm = unit(axis % 3);
            let felt = a.cross(&arm) + w.cross(&w.cross(&arm));
            [zero, unit(axis / 3) * felt[axis / 3]]
        }
        FurtherGroup::GyroAsymmetry => [unit(axis) * w[axis].abs(), zero],
        FurtherGroup::AccelAsymmetry => [zero, unit(axis) * f[axis].abs()],
        FurtherGroup::AccelQuadratic => [zero, unit(axis) * (f[axis] * f[axis])],
        FurtherGroup::GyroGaussMarkov => [unit(axis) * libm::exp(-t / GYRO_S), zero],
        FurtherGroup::AccelGaussMarkov => [zero, unit(axis) * libm::exp(-t / ACCEL_S)],
        // Navigation lacks a pull to the south of g for each unit of ξ: as a force to the north.
        FurtherGroup::Deflection => [zero, c_bn * unit(axis) * strapdown.earth().gravity_mps2],
        FurtherGroup::GravityAnomaly => [zero, -c_bn * unit(2)],
        FurtherGroup::GyroBiasTemperature => [unit(axis) * warmth_k(t), zero],
        FurtherGroup::GyroScaleTemperature => [unit(axis) * (warmth_k(t) * w[axis]), zero],
        FurtherGroup::AccelBiasTemperature => [zero, unit(axis) * warmth_k(t)],
        FurtherGroup::AccelScaleTemperature => [zero, unit(axis) * (warmth_k(t) * f[axis])],
        FurtherGroup::GimbalMounting
        | FurtherGroup::GimbalNonOrthogonality
        | FurtherGroup::EncoderEccentricity => unreachable!("they drive nothing"),
    }
}

/// Increments of a sample with an error, by the rule of Simpson for the motion.
fn increments(
    k: usize,
    perturbed: Option<(usize, f64)>,
    strapdown: &Strapdown,
) -> (Vector3<f64>, Vector3<f64>) {
    let at = |share: f64| motion((k as f64 + share) * DT);
    let ([w0, _, f0], [w1, _, f1], [w2, _, f2]) = (at(0.0), at(0.5), at(1.0));
    let mut theta = (w0 + w1 * 4.0 + w2) * (DT / 6.0);
    let mut velocity = (f0 + f1 * 4.0 + f2) * (DT / 6.0);
    if let Some((state, size)) = perturbed {
        let [rate, force] = effect(state, (k as f64 + 0.5) * DT, strapdown);
        theta += rate * (size * DT);
        velocity += force * (size * DT);
    }
    (theta, velocity)
}

fn run(perturbed: Option<(usize, f64)>) -> Strapdown {
    let mut strapdown = start();
    for k in 0..SAMPLES {
        let (dtheta, dv) = increments(k, perturbed, &strapdown);
        strapdown.step(&dtheta, &dv, DT);
    }
    strapdown
}

/// The nine errors, computed − true.
fn error(computed: &Strapdown, truth: &Strapdown) -> [f64; MOVING] {
    let (c, t) = (computed.navigation(), truth.navigation());
    let earth = Ellipsoid::at(t.latitude_rad, t.height_m);
    let q = |[w, i, j, k]: [f64; 4]| UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
    let phi = phi_of(&q(c.q_nb), &q(t.q_nb));
    let dv = Vector3::from(c.velocity_mps) - Vector3::from(t.velocity_mps);
    let north = (c.latitude_rad - t.latitude_rad) * earth.meridian_radius_m;
    let east = (c.longitude_rad - t.longitude_rad) * earth.transverse_radius_m * earth.cos_latitude;
    [phi.x, phi.y, phi.z, dv.x, dv.y, dv.z, north, east, t.height_m - c.height_m]
}

fn columns(model: ErrorModel) -> [FurtherRow; MOVING] {
    let mut further = all_on(1.0);
    (further.gyro_correlation_time_s, further.accel_correlation_time_s) = (GYRO_S, ACCEL_S);
    let mut states = FurtherStates::new(&kalman(further), false).unwrap();
    let mut strapdown = start();
    for first in (0..SAMPLES).step_by(SUB_STEP) {
        let mut interval = MotionInterval {
            interval_s: SUB_STEP as f64 * DT,
            c_nb: strapdown.c_nb(),
            delta_theta: Vector3::zeros(),
            delta_velocity: Vector3::zeros(),
            delta_velocity_n: Vector3::zeros(),
            velocity_mps: Vector3::zeros(),
        };
        for k in 0..SUB_STEP {
            let (dtheta, dv) = increments(first + k, None, &strapdown);
            strapdown.step(&dtheta, &dv, DT);
            states.feel(warmth_k(((first + k) as f64 + 0.5) * DT));
            states.accumulate(&dtheta, &dv, DT);
            interval.delta_theta += dtheta;
            interval.delta_velocity += dv;
            interval.delta_velocity_n += strapdown.delta_velocity_n();
            if 2 * (k + 1) == SUB_STEP {
                interval.c_nb = strapdown.c_nb();
                interval.velocity_mps = *strapdown.velocity_mps();
            }
        }
        states.advance(model, &interval, strapdown.earth(), [true; 3], true);
    }
    states.columns
}

/// Size of a perturbation: large against rounding, small against the second order.
fn size(group: FurtherGroup) -> f64 {
    match group {
        FurtherGroup::AccelLever => 1e-3,
        FurtherGroup::GyroGaussMarkov | FurtherGroup::GyroBiasTemperature => 1e-6,
        FurtherGroup::AccelGaussMarkov
        | FurtherGroup::GravityAnomaly
        | FurtherGroup::AccelBiasTemperature => 1e-3,
        _ => 1e-5,
    }
}

#[test]
fn the_columns_are_the_jacobian_of_the_strapdown() {
    let (phi, psi) = (columns(ErrorModel::Phi), columns(ErrorModel::Psi));
    let truth = run(None);
    let mut failures = Vec::new();
    for group in FurtherGroup::ALL.into_iter().filter(|group| !group.is_of_gimbals()) {
        let h = size(group);
        let numerical: Vec<[f64; MOVING]> = group
            .range()
            .map(|state| {
                let ahead = error(&run(Some((state, h))), &truth);
                let back = error(&run(Some((state, -h))), &truth);
                core::array::from_fn(|row| (ahead[row] - back[row]) / (2.0 * h))
            })
            .collect();
        for (k, expected) in group.range().zip(&numerical) {
            let of_psi: [f64; MOVING] = core::array::from_fn(|row| psi[row][k]);
            // φ = ψ + δθ(δr), δv(φ form) = δv(ψ form) − δθ × v.
            let at = |i: usize| Vector3::new(of_psi[i], of_psi[i + 1], of_psi[i + 2]);
            let turn = computer_frame_error(&at(DR), truth.earth());
            let (attitude, dv) = (at(PHI) + turn, at(DV) - turn.cross(truth.velocity_mps()));
            for row in 0..MOVING {
                let rows = row / 3 * 3..row / 3 * 3 + 3;
                let scale = numerical
                    .iter()
                    .flat_map(|column| column[rows.clone()].iter())
                    .fold(0.0f64, |largest, value| largest.max(value.abs()));
                let by_psi = [attitude, dv, at(DR)][row / 3][row % 3];
                // Transport rate by a velocity that an accelerometer's error lets grow lags by a
                // sub-step. Sub-steps turn by 1°, in which the arms' own force turns too.
                let share = if row < 3 && scale < 1e-4 { 0.02 } else { 5e-3 };
                for found in [phi[row][k], by_psi] {
                    let off = (found - expected[row]).abs();
                    if !(off <= share * scale + 1e-10) {
                        failures.push(format!(
                            "{}, row {row}: {found:e} and {:e}, scale {scale:e}",
                            crate::further::FURTHER_NAMES[k],
                            expected[row]
                        ));
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Errors that are compensated leave a hundredth of themselves, with all sensors perturbed at once.
#[test]
fn compensation_takes_away_the_errors() {
    let mut further = all_on(1.0);
    (further.gyro_correlation_time_s, further.accel_correlation_time_s) = (GYRO_S, ACCEL_S);
    let mut value = [0.0; crate::further::FURTHER_COUNT];
    for (k, value) in value[..DRIVING_COUNT].iter_mut().enumerate() {
        let group = FurtherGroup::ALL.into_iter().find(|group| group.range().contains(&k)).unwrap();
        *value = size(group) * (1.0 + 0.1 * k as f64);
    }
    let truth = run(None);
    let mut sizes = [0.0; 2];
    for (compensated, size) in [false, true].into_iter().zip(&mut sizes) {
        let mut compensation = FurtherCompensation::new(&further, DT).unwrap();
        let mut strapdown = start();
        compensation.set(&value);
        // The first temperature is the reference.
        compensation.feel(20.0);
        for k in 0..SAMPLES {
            compensation.feel(20.0 + warmth_k((k as f64 + 0.5) * DT));
            let (mut dtheta, mut dv) = increments(k, None, &strapdown);
            for (state, value) in value[..DRIVING_COUNT].iter().enumerate() {
                let [rate, force] = effect(state, (k as f64 + 0.5) * DT, &strapdown);
                dtheta += rate * (value * DT);
                dv += force * (value * DT);
            }
            if compensated {
                let before = compensation.clone();
                let (theta, v) = compensation.apply(&strapdown, &dtheta, &dv, DT);
                // The inverse, as for samples whose motion is known.
                let again = before.distort(&strapdown, &theta, &v, DT);
                assert!((again.0 - dtheta).norm() < 1e-6 * DT, "{k}");
                assert!((again.1 - dv).norm() < 1e-4 * DT, "{k}");
                (dtheta, dv) = (theta, v);
            }
            strapdown.step(&dtheta, &dv, DT);
        }
        let error = error(&strapdown, &truth);
        *size = Vector3::new(error[3], error[4], error[5]).norm();
    }
    let [with, without] = [sizes[1], sizes[0]];
    assert!(without > 1e-2 && with < 1e-2 * without, "{with:e} of {without:e}");
}

#[test]
fn bridged_channels_have_no_columns() {
    let further = all_on(1.0);
    let mut states = FurtherStates::new(&kalman(further), false).unwrap();
    let strapdown = start();
    let [w, _, f] = motion(0.0);
    states.feel(warmth_k(0.0));
    states.accumulate(&(w * DT), &(f * DT), DT);
    let interval = MotionInterval {
        interval_s: DT,
        c_nb: strapdown.c_nb(),
        delta_theta: w * DT,
        delta_velocity: f * DT,
        delta_velocity_n: strapdown.c_nb() * f * DT,
        velocity_mps: *strapdown.velocity_mps(),
    };
    let earth = strapdown.earth();
    states.advance(ErrorModel::Phi, &interval, earth, [false, true, false], false);
    let on = |k: usize| (0..MOVING).any(|row| states.columns[row][k] != 0.0);
    for k in 0..DRIVING_COUNT {
        // Gyro y alone isn't bridged: only its states have a column.
        let is_y = [10, 19, 28, 31].contains(&k);
        assert_eq!(on(k), is_y, "{}", crate::further::FURTHER_NAMES[k]);
    }
}
