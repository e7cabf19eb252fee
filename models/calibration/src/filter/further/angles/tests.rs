//! Gimbal angles as measurements: rows against finite differences, update against a textbook filter, and what the
//! angles can't tell apart.

use super::super::tests::{ALL, Full, assert_equal, example, kalman};
use super::super::*;
use super::{BorderRow, CURVE};
use crate::config::{AngleMeasurements, ErrorModel};
use crate::covariance::{DR, PHI};
use crate::error_model::computer_frame_error;
use crate::positions::EIGHT;
use crate::strapdown::{Strapdown, Vertical};
use nalgebra::{SMatrix, SVector, UnitQuaternion};
use octant_earth::frames::{c_nc, quaternion_from_matrix};
use octant_earth::rotation::{exp, log};
use octant_sample::GimbalAngles;
use octant_sample::counts::GIMBAL_LSB_RAD;

const MOUNTING: usize = places(FurtherGroup::GimbalMounting).start;
const LEANT: usize = places(FurtherGroup::GimbalNonOrthogonality).start;
const ECCENTRIC: usize = places(FurtherGroup::EncoderEccentricity).start;

fn q_case() -> UnitQuaternion<f64> {
    quaternion_from_matrix(&c_nc(0.8, 0.05, -0.03))
}

/// `q_cb` by rotations about single axes, and the angles that encoders with these errors read there. The errors are
/// functions of the true angles.
fn gimballed(true_angles: [f64; 2], value: &BorderRow) -> (UnitQuaternion<f64>, GimbalAngles) {
    let about = |axis: usize, angle: f64| {
        exp(&Vector3::from_fn(|i, _| if i == axis { angle } else { 0.0 }))
    };
    let [azimuth, roll] = true_angles;
    let q_cb = about(0, roll)
        * about(1, value[LEANT])
        * about(2, azimuth)
        * exp(&Vector3::new(value[MOUNTING], value[MOUNTING + 1], value[MOUNTING + 2]));
    let read = |axis: usize, angle: f64| {
        let at = ECCENTRIC + 2 * axis;
        angle + value[at] * angle.cos() + value[at + 1] * angle.sin() + value[CURVE + axis]
    };
    (q_cb, GimbalAngles::from_rad(read(0, azimuth), read(1, roll)))
}

fn strapdown(q_nb: &UnitQuaternion<f64>) -> Strapdown {
    Strapdown::new(q_nb, Vector3::zeros(), 0.6, 0.3, 40.0, Vertical::Free)
}

fn angles(sigma_rad: f64) -> AngleMeasurements {
    let sigma = FurtherUse::Estimated { sigma: 1e-4 };
    AngleMeasurements { sigma_rad, curve_sigma_rad: 1e-5, groups: [sigma; 3] }
}

fn states(sigma_rad: f64) -> FurtherStates {
    let further = Further { angles: Some(angles(sigma_rad)), ..Further::default() };
    FurtherStates::new(&kalman(further), false).unwrap()
}

/// z where the estimates are `estimate`, the truth is `truth`, the case `q_nc` and the attitude error φ.
fn z(
    estimate: &BorderRow,
    truth: &BorderRow,
    true_angles: [f64; 2],
    phi: Vector3<f64>,
) -> (Vector3<f64>, AngleRows) {
    let (q_cb, read) = gimballed(true_angles, truth);
    let psi = Vector3::new(truth[CASE], truth[CASE + 1], truth[CASE + 2]);
    // computed = (I − [φ×]) true.
    let q_nb = exp(&-phi) * exp(&psi) * q_case() * q_cb;
    super::residual(&q_nb, &q_case(), [read.azimuth_rad(), read.roll_rad()], estimate)
}

/// Central differences of a nonlinear model that is written down apart, about estimates of some arc seconds.
#[test]
fn the_rows_are_the_jacobian_of_the_measurement() {
    let mut estimate = [0.0; BORDER_COUNT];
    for k in (MOUNTING..CASE).chain(CURVE..BORDER_COUNT) {
        estimate[k] = 1e-4 * (1.0 + (k % 5) as f64) * if k % 2 == 0 { 1.0 } else { -1.0 };
    }
    // Large against the counts of 7.5e-9 rad, small against second order.
    const H: f64 = 1e-3;
    for true_angles in [[0.3, -0.7], [1.9, 2.6], [-2.2, 0.1]] {
        let (at_zero, rows) = z(&estimate, &estimate, true_angles, Vector3::zeros());
        // The errors of a reading are computed from the reading: 4e-4 of 4e-4 rad, twice.
        assert!(at_zero.norm() < 5e-7, "{at_zero}");
        for k in (MOUNTING..CASE).chain(CASE..BORDER_COUNT) {
            let at = |h: f64| {
                let mut truth = estimate;
                truth[k] += h;
                z(&estimate, &truth, true_angles, Vector3::zeros()).0
            };
            let difference = (at(H) - at(-H)) / (2.0 * H);
            for i in 0..3 {
                let off = (rows[i][k] - difference[i]).abs();
                assert!(off < 1e-3, "state {k}, axis {i}: {} {}", rows[i][k], difference[i]);
            }
        }
        for axis in 0..3 {
            let unit = Vector3::from_fn(|i, _| if i == axis { H } else { 0.0 });
            let found = z(&estimate, &estimate, true_angles, unit).0 - at_zero;
            assert!((found + unit).norm() < 1e-3 * H);
        }
    }
    // The psi form: φ = ψ + δθ(δr).
    let earth = *strapdown(&q_case()).earth();
    let rows = super::rows_of_errors(ErrorModel::Psi, &earth);
    let dr = Vector3::new(3.0, -7.0, 2.0);
    let of_dr = Vector3::from_fn(|i, _| (0..3).map(|j| rows[i][DR + j] * dr[j]).sum::<f64>());
    assert!((of_dr + computer_frame_error(&dr, &earth)).norm() < 1e-18);
    assert!((0..3).all(|i| rows[i][PHI + i] == -1.0));
    let of_phi = super::rows_of_errors(ErrorModel::Phi, &earth);
    assert!(of_phi.iter().flat_map(|row| &row[3..]).all(|h| *h == 0.0));
}

/// Three scalar updates of one filter with all states in one matrix, with a gain of zero for those that are considered.
#[test]
fn an_update_by_angles_is_that_of_one_filter_with_all_states() {
    let (mut states, mut errors, mut full) = example();
    states.border.value = [0.0; BORDER_COUNT];
    let true_angles = [0.9, -0.4];
    let (q_cb, read) = gimballed(true_angles, &[0.0; BORDER_COUNT]);
    let angles_rad = [read.azimuth_rad(), read.roll_rad()];
    states.border.reference.q_nc = Some(q_case());
    states.border.reference.at = Some(angles_rad);
    let q_nb = exp(&Vector3::new(0.02, -0.05, 0.03)) * q_case() * q_cb;
    let (z, of_border) = super::residual(&q_nb, &q_case(), angles_rad, &states.border.value);
    let strapdown = strapdown(&q_nb);
    let of_errors = super::rows_of_errors(ErrorModel::Phi, strapdown.earth());
    let r = 0.25;

    let mut state = SVector::<f64, ALL>::zeros();
    let h = |axis: usize| {
        SVector::<f64, ALL>::from_fn(|i, _| {
            i.checked_sub(STATE_COUNT).map_or_else(|| of_errors[axis][i], |k| of_border[axis][k])
        })
    };
    let rows = SMatrix::<f64, 3, ALL>::from_fn(|axis, i| h(axis)[i]);
    let s = rows * full * rows.transpose() + Matrix3::from_diagonal_element(r);
    let expected_nis = z.dot(&(s.try_inverse().unwrap() * z));
    for axis in 0..3 {
        let h = h(axis);
        let with = full * h;
        let mut gain = with / (h.dot(&with) + r);
        for (k, is_estimated) in states.estimated.iter().enumerate() {
            if !is_estimated {
                gain[STATE_COUNT + k] = 0.0;
            }
        }
        state += gain * (z[axis] - h.dot(&state));
        let left = Full::identity() - gain * h.transpose();
        full = left * full * left.transpose() + gain * gain.transpose() * r;
    }

    let mut x = [0.0; STATE_COUNT];
    let result =
        states.measure_angles(read, &strapdown, ErrorModel::Phi, &mut errors, &mut x).unwrap();
    assert!(!result.rejected && (result.nis - expected_nis).abs() < 1e-9 * expected_nis);
    assert_equal(&states, &errors, &full);
    for i in 0..STATE_COUNT {
        assert!((x[i] - state[i]).abs() < 1e-10, "state {i}");
    }
    let psi = Vector3::from_fn(|i, _| state[STATE_COUNT + CASE + i]);
    let turned = log(&(states.border.reference.q_nc.unwrap() * q_case().inverse()));
    assert!((turned - psi).norm() < 1e-12);
    for k in (0..CASE).chain(CURVE..BORDER_COUNT) {
        assert!((states.border.value[k] - state[STATE_COUNT + k]).abs() < 1e-10, "further {k}");
    }
}

/// Of thirteen errors (case 3, mounting 3, η, eccentricity 4, zeros 2) eleven are seen over the eight positions: the
/// zeros are a turn of the case about its x and a mounting about z.
#[test]
fn zero_errors_of_the_encoders_are_no_states_of_their_own() {
    const N: usize = 13;
    let c = *q_case().to_rotation_matrix().matrix();
    let mut normal = SMatrix::<f64, N, N>::zeros();
    for (azimuth, roll, _) in EIGHT {
        let angles_rad = [azimuth.to_radians(), roll.to_radians()];
        let rows = angle_rows(&c, angles_rad);
        let h = SMatrix::<f64, 3, N>::from_fn(|i, k| match k {
            0..3 => rows[i][CASE + k],
            3..11 => rows[i][MOUNTING + k - 3],
            // A constant error reads as the curve does.
            _ => rows[i][CURVE + k - 11],
        });
        for i in 0..3 {
            let about_x: f64 = (0..3).map(|j| h[(i, j)] * c[(j, 0)]).sum();
            assert!((h[(i, 12)] + about_x).abs() < 1e-15, "roll's zero is minus the case's turn");
            assert!((h[(i, 11)] + h[(i, 5)]).abs() < 1e-15, "azimuth's zero is minus mounting z");
        }
        normal += h.transpose() * h;
    }
    let mut values: Vec<f64> = normal.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    assert!(values[1] < 1e-12 && values[2] > 0.1, "{values:?}");
}

/// The first angles make the reference and tell nothing of the attitude; later ones that disagree are rejected, and
/// after five the angles are done with.
#[test]
fn angles_that_jump_are_rejected_and_then_no_longer_believed() {
    let mut states = states(5e-6);
    let mut errors = Covariance::from_sigmas(&[1e-5; STATE_COUNT]);
    let before = errors.clone();
    let (q_cb, read) = gimballed([0.4, 0.2], &[0.0; BORDER_COUNT]);
    let navigated = strapdown(&(q_case() * q_cb));
    let mut measure = |read: GimbalAngles, errors: &mut Covariance| {
        let mut x = [0.0; STATE_COUNT];
        states.measure_angles(read, &navigated, ErrorModel::Phi, errors, &mut x)
    };
    for _ in 0..50 {
        let result = measure(read, &mut errors).unwrap();
        assert!(!result.rejected && result.nis < 1e-6, "{result:?}");
    }
    for i in 0..3 {
        assert!((errors.sigma(PHI + i) / before.sigma(PHI + i) - 1.0).abs() < 1e-6);
    }
    // 0.05° of roll.
    let counts = (0.05f64.to_radians() / GIMBAL_LSB_RAD) as i32;
    let slipped = GimbalAngles { roll: read.roll + counts, ..read };
    let kept = errors.clone();
    for _ in 0..5 {
        assert!(measure(slipped, &mut errors).unwrap().rejected);
    }
    assert_eq!(errors, kept);
    assert_eq!(measure(read, &mut errors), None);
    let tally = states.angle_tally().unwrap();
    assert!(tally.slipped && tally.rejected == 5 && tally.used == 50, "{tally:?}");
}

/// Some arc seconds of noise make no other stop; a move of one gimbal draws the rest of its own curve anew, without
/// correlation, and leaves the other's.
#[test]
fn the_rest_of_a_curve_is_another_one_after_a_move_of_its_gimbal() {
    let (mut states, _, full) = example();
    let border = &mut states.border;
    border.reference.at = Some([0.3, 0.7]);
    border.stop_at([0.3 + 5e-5, 0.7 - 5e-5], 0.4);
    let at = |k: usize, l: usize| full[(STATE_COUNT + k, STATE_COUNT + l)];
    assert!((0..BORDER_COUNT).all(|k| border.own[CURVE][k] == at(CURVE, k)));
    border.stop_at([0.3, 2.3], 0.4);
    assert!((0..BORDER_COUNT - 1).all(|k| border.own[CURVE][k] == at(CURVE, k)));
    assert_eq!((border.value[CURVE + 1], border.cross[CURVE + 1]), (0.0, [0.0; 40]));
    for k in 0..BORDER_COUNT {
        let expected = if k == CURVE + 1 { 0.4 * 0.4 } else { 0.0 };
        assert_eq!((border.own[CURVE + 1][k], border.own[k][CURVE + 1]), (expected, expected));
    }
}
