//! The error model against a numerical Jacobian of the strapdown: each state is perturbed, the
//! perturbed and the unperturbed navigation process the same increments, and their difference has
//! to agree with the transition.

use nalgebra::{UnitQuaternion, Vector3};
use octant_calibration::compensation::Compensation;
use octant_calibration::config::ErrorModel;
use octant_calibration::covariance::{DR, DV, MOVING, PARAMETERS, PHI, STATE_COUNT, Transition};
use octant_calibration::error_model::{MotionInterval, computer_frame_error};
use octant_calibration::strapdown::{Strapdown, Vertical};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::phi_of;
use octant_sample::Parameters;

const DT: f64 = 0.005;
/// Samples in a sub-step of the filter, 50 ms.
const SUB_STEP: usize = 10;
const SECONDS: usize = 4;
const LATITUDE_RAD: f64 = 0.7;
const LONGITUDE_RAD: f64 = 0.3;
const HEIGHT_M: f64 = 50.0;

/// Increments of a body that turns and accelerates on a moving base.
fn increments(k: usize) -> (Vector3<f64>, Vector3<f64>) {
    let t = (k as f64 + 0.5) * DT;
    let rate = Vector3::new(0.08, -0.05 + 0.03 * libm::sin(0.9 * t), 0.06 * libm::cos(0.5 * t));
    let force =
        Vector3::new(1.2 * libm::sin(0.7 * t), -0.8 + 0.2 * t, -9.7 + 0.5 * libm::cos(1.1 * t));
    (rate * DT, force * DT)
}

fn start() -> Strapdown {
    let q_nb = UnitQuaternion::from_euler_angles(0.4, -0.2, 1.1);
    let velocity = Vector3::new(12.0, -7.0, 0.5);
    Strapdown::new(&q_nb, velocity, LATITUDE_RAD, LONGITUDE_RAD, HEIGHT_M, Vertical::Free)
}

fn attitude(strapdown: &Strapdown) -> UnitQuaternion<f64> {
    let [w, i, j, k] = strapdown.navigation().q_nb;
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, i, j, k))
}

/// The nine errors, computed − true.
fn error(computed: &Strapdown, truth: &Strapdown) -> [f64; MOVING] {
    let (c, t) = (computed.navigation(), truth.navigation());
    let earth = Ellipsoid::at(t.latitude_rad, t.height_m);
    let phi = phi_of(&attitude(computed), &attitude(truth));
    let dv = Vector3::from(c.velocity_mps) - Vector3::from(t.velocity_mps);
    [
        phi.x,
        phi.y,
        phi.z,
        dv.x,
        dv.y,
        dv.z,
        (c.latitude_rad - t.latitude_rad) * earth.meridian_radius_m,
        (c.longitude_rad - t.longitude_rad) * earth.transverse_radius_m * earth.cos_latitude,
        t.height_m - c.height_m,
    ]
}

/// Size of the perturbation of a state: large against rounding, small against the second order.
fn size(state: usize) -> f64 {
    match state {
        0..3 => 1e-5,
        3..6 => 1e-2,
        6..9 => 10.0,
        9..12 => 1e-6,
        12..21 => 1e-5,
        21..30 => 1e-6,
        30..33 => 1e-3,
        _ => 1e-4,
    }
}

/// Runs the strapdown with a perturbed state; unperturbed for `None`.
fn run(perturbed: Option<(usize, f64)>) -> Strapdown {
    let mut strapdown = start();
    let mut parameters = [0.0; 30];
    if let Some((state, size)) = perturbed {
        if state < PARAMETERS {
            let mut x = [0.0; MOVING];
            x[state] = -size;
            let at = |i: usize| Vector3::new(x[i], x[i + 1], x[i + 2]);
            strapdown.correct(&at(PHI), &at(DV), &at(DR));
        } else {
            // The sensors have the error, and nothing compensates it: the same as a compensation of
            // −error.
            parameters[state - PARAMETERS] = -size;
        }
    }
    let compensation = Compensation::new(&Parameters::from_array(&parameters));
    for k in 0..SECONDS * 200 {
        let (dtheta, dv) = increments(k);
        let (dtheta, dv) = compensation.apply(&dtheta, &dv, DT);
        strapdown.step(&dtheta, &dv, DT);
    }
    strapdown
}

fn transition(model: ErrorModel) -> Transition {
    let mut strapdown = start();
    let mut transition = Transition::identity();
    for first in (0..SECONDS * 200).step_by(SUB_STEP) {
        let mut interval = MotionInterval {
            interval_s: SUB_STEP as f64 * DT,
            c_nb: strapdown.c_nb(),
            delta_theta: Vector3::zeros(),
            delta_velocity: Vector3::zeros(),
            delta_velocity_n: Vector3::zeros(),
            velocity_mps: Vector3::zeros(),
        };
        for k in 0..SUB_STEP {
            let (dtheta, dv) = increments(first + k);
            strapdown.step(&dtheta, &dv, DT);
            interval.delta_theta += dtheta;
            interval.delta_velocity += dv;
            interval.delta_velocity_n += strapdown.delta_velocity_n();
            if 2 * (k + 1) == SUB_STEP {
                interval.c_nb = strapdown.c_nb();
                interval.velocity_mps = *strapdown.velocity_mps();
            }
        }
        transition.advance(model, &interval, strapdown.earth());
    }
    transition
}

/// Effects of all states on the nine errors at the end, by central differences.
fn jacobian() -> Vec<[f64; MOVING]> {
    let truth = run(None);
    (0..STATE_COUNT)
        .map(|state| {
            let h = size(state);
            let ahead = error(&run(Some((state, h))), &truth);
            let back = error(&run(Some((state, -h))), &truth);
            core::array::from_fn(|row| (ahead[row] - back[row]) / (2.0 * h))
        })
        .collect()
}

/// Largest element of each kind of error over the states of a kind: the scale for comparison.
fn scale(jacobian: &[[f64; MOVING]], state: usize, row: usize) -> f64 {
    let group = match state {
        0..9 => state / 3 * 3..state / 3 * 3 + 3,
        9..12 => 9..12,
        12..21 => 12..21,
        21..30 => 21..30,
        30..33 => 30..33,
        _ => 33..39,
    };
    let rows = row / 3 * 3..row / 3 * 3 + 3;
    jacobian[group]
        .iter()
        .flat_map(|column| column[rows.clone()].iter())
        .fold(0.0f64, |largest, value| largest.max(value.abs()))
}

/// Tolerance of the model, relative to the scale.
fn tolerance(row: usize, state: usize) -> f64 {
    match (row, state) {
        // The transport rate by a velocity error that grows from zero lags by a sub-step: 50 ms in
        // 4 s. The effect is 1e-6 rad per m/s².
        (0..3, 30..39) => 0.02,
        // The strapdown evaluates gravity every 50 ms, so that a correction takes effect up to 50
        // ms in 4 s late. And the model neglects gravity's change with latitude: (dg/dL)/R is 8e-9,
        // 2g/R is 3.1e-6 1/s².
        (5, 6..9) => 0.015,
        // Sub-steps of 0.3° are of second order, 1e-5; the rest is h/T in small cross terms.
        _ => 1e-3,
    }
}

#[test]
fn the_phi_angle_transition_is_the_jacobian_of_the_strapdown() {
    let (model, numerical) = (transition(ErrorModel::Phi), jacobian());
    let mut failures = Vec::new();
    for state in 0..STATE_COUNT {
        for row in 0..MOVING {
            let scale = scale(&numerical, state, row);
            let off = (model.rows[row][state] - numerical[state][row]).abs();
            if !(off <= tolerance(row, state) * scale + 1e-12) {
                failures.push(format!(
                    "row {row}, state {state}: {:e} and {:e}, scale {scale:e}",
                    model.rows[row][state], numerical[state][row]
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn the_psi_angle_transition_is_the_phi_angle_one_in_other_variables() {
    let (phi, psi) = (transition(ErrorModel::Phi), transition(ErrorModel::Psi));
    // φ = ψ + δθ(δr), δv(φ form) = δv(ψ form) − δθ × v.
    let to_phi = |psi: &[f64; MOVING], earth: &Ellipsoid, velocity: &Vector3<f64>| {
        let at = |i: usize| Vector3::new(psi[i], psi[i + 1], psi[i + 2]);
        let turn = computer_frame_error(&at(DR), earth);
        let (phi, dv) = (at(PHI) + turn, at(DV) - turn.cross(velocity));
        [phi.x, phi.y, phi.z, dv.x, dv.y, dv.z, psi[6], psi[7], psi[8]]
    };
    let (first, last) = (start(), run(None));
    let numerical = jacobian();
    let mut failures = Vec::new();
    for state in 0..STATE_COUNT {
        // A unit error in psi variables, as phi variables, through the phi transition.
        let mut unit = [0.0; STATE_COUNT];
        unit[state] = 1.0;
        let moving: [f64; MOVING] = core::array::from_fn(|i| unit[i]);
        unit[..MOVING].copy_from_slice(&to_phi(&moving, first.earth(), first.velocity_mps()));
        let by_phi: [f64; MOVING] =
            core::array::from_fn(|row| (0..STATE_COUNT).map(|j| phi.rows[row][j] * unit[j]).sum());
        // The same error through the psi transition.
        let end: [f64; MOVING] = core::array::from_fn(|row| psi.rows[row][state]);
        let by_psi = to_phi(&end, last.earth(), last.velocity_mps());
        for row in 0..MOVING {
            let scale = scale(&numerical, state, row);
            if !((by_phi[row] - by_psi[row]).abs() <= tolerance(row, state) * scale + 1e-10) {
                failures.push(format!(
                    "row {row}, state {state}: {:e} and {:e}, scale {scale:e}",
                    by_phi[row], by_psi[row]
                ));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_correction_takes_away_the_error_that_it_is_given() {
    let truth = start();
    let mut computed = start();
    let (phi, dv, dr) = (
        Vector3::new(1e-5, -2e-5, 3e-5),
        Vector3::new(0.1, -0.2, 0.3),
        Vector3::new(5.0, -6.0, 7.0),
    );
    computed.correct(&-phi, &-dv, &-dr);
    let found = error(&computed, &truth);
    let expected = [phi, dv, dr];
    for i in 0..MOVING {
        // Radii at either end of 7 m of height.
        assert!((found[i] - expected[i / 3][i % 3]).abs() < 1e-5 * expected[i / 3].norm(), "{i}");
    }
    computed.correct(&phi, &dv, &dr);
    assert!(error(&computed, &truth).iter().all(|left| left.abs() < 1e-9));
}
