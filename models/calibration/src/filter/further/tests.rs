//! The border against a textbook filter with all states in one matrix.

use super::border::share_of_noise;
use super::*;
use crate::config::{
    AidingMode, AngleMeasurements, ErrorModel, Prior, SwayNoise, TemperatureErrors,
};
use nalgebra::{SMatrix, SVector};

pub(super) const ALL: usize = STATE_COUNT + BORDER_COUNT;
pub(super) type Full = SMatrix<f64, ALL, ALL>;

const ELAPSED_S: f64 = 1.5;

/// Numbers without a pattern, the same on every run.
fn scatter(i: usize, j: usize) -> f64 {
    let n = (i * 7919 + j * 104_729 + 13) % 1009;
    n as f64 / 1009.0 - 0.5
}

/// Every other group is considered, the others are estimated.
fn is_estimated(group: FurtherGroup) -> bool {
    (group as usize).is_multiple_of(2)
}

/// Angles as measurements, with all groups off.
fn angles() -> AngleMeasurements {
    AngleMeasurements { sigma_rad: 0.5, curve_sigma_rad: 0.4, groups: [FurtherUse::Off; 3] }
}

/// Errors that follow the temperature, with all groups off.
fn temperature() -> TemperatureErrors {
    TemperatureErrors { groups: [FurtherUse::Off; 4], reference_c: None }
}

/// With the two kinds of states that share a room: those of the gimbals, and those that follow the temperature.
fn both() -> [Further; 2] {
    let further = Further {
        gyro_correlation_time_s: 2.0,
        accel_correlation_time_s: 300.0,
        ..Further::default()
    };
    [
        all_groups(Further { angles: Some(angles()), ..further }),
        all_groups(Further { temperature: Some(temperature()), ..further }),
    ]
}

/// Groups of a filter, with the places of their states.
fn groups_of(further: &Further) -> impl Iterator<Item = (FurtherGroup, core::ops::Range<usize>)> {
    let is_there = |group: &FurtherGroup| further.of(*group) != FurtherUse::Off;
    FurtherGroup::ALL.into_iter().filter(is_there).map(|group| (group, places(group)))
}

fn all_groups(mut further: Further) -> Further {
    for group in FurtherGroup::ALL {
        let sigma = 0.3;
        let treatment = if is_estimated(group) {
            FurtherUse::Estimated { sigma }
        } else {
            FurtherUse::Considered { sigma }
        };
        further = further.with(group, treatment);
    }
    further
}

/// All groups estimated.
pub(super) fn all_on(sigma: f64) -> Further {
    Further {
        groups: [FurtherUse::Estimated { sigma }; 8],
        gyro_correlation_time_s: 300.0,
        accel_correlation_time_s: 300.0,
        gyro_rate_random_walk: 0.0,
        temperature: Some(TemperatureErrors {
            groups: [FurtherUse::Estimated { sigma }; 4],
            ..temperature()
        }),
        angles: None,
        rest: None,
    }
}

pub(super) fn kalman(further: Further) -> Kalman {
    Kalman {
        error_model: ErrorModel::Phi,
        estimated: [true; 7],
        prior: Prior {
            attitude_rad: [1e-4; 3],
            velocity_mps: 0.02,
            position_m: 1.0,
            parameters: [1e-6; 7],
        },
        aiding: AidingMode::Velocity { sigma_mps: 1e-3 },
        aiding_period_ns: 1_000_000_000,
        sway: SwayNoise::White,
        refuse_above_mean_nis: 9.0,
        sigma_limits: Default::default(),
        further,
    }
}

/// A filter with the states of the gimbals and a full covariance of all states, the further ones last, and the same as
/// one matrix.
pub(super) fn example() -> (FurtherStates, Covariance, Full) {
    let [with_gimbals, _] = both();
    example_of(&with_gimbals)
}

fn example_of(further: &Further) -> (FurtherStates, Covariance, Full) {
    let mut states = FurtherStates::new(&kalman(*further), true).unwrap();
    // A place without a state stays zero.
    let end = STATE_COUNT + states.border.count;
    let a = Full::from_fn(|i, j| if i < end && j < end { scatter(i, j) } else { 0.0 });
    let full = a * a.transpose() + Full::from_fn(|i, j| f64::from(u8::from(i == j && i < end)));
    let mut errors = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
    for i in 0..STATE_COUNT {
        for j in i..STATE_COUNT {
            errors.add(i, j, full[(i, j)]);
        }
    }
    let has_case = further.angles.is_some();
    for k in 0..states.border.count {
        // The attitude of the case has no estimate.
        let is_case = has_case && (CASE..CASE + 3).contains(&k);
        states.border.value[k] = if is_case { 0.0 } else { scatter(k, 3) };
        for j in 0..STATE_COUNT {
            states.border.cross[k][j] = full[(STATE_COUNT + k, j)];
        }
        for l in 0..BORDER_COUNT {
            states.border.own[k][l] = full[(STATE_COUNT + k, STATE_COUNT + l)];
        }
    }
    (states, errors, full)
}

pub(super) fn assert_equal(states: &FurtherStates, errors: &Covariance, full: &Full) {
    for i in 0..ALL {
        for j in 0..ALL {
            let found = match (i.checked_sub(STATE_COUNT), j.checked_sub(STATE_COUNT)) {
                (None, None) => errors.at(i, j),
                (Some(k), None) => states.border.cross[k][j],
                (None, Some(k)) => states.border.cross[k][i],
                (Some(k), Some(l)) => states.border.own[k][l],
            };
            assert!((found - full[(i, j)]).abs() < 1e-9, "element {i}, {j}: {found}");
        }
    }
    for i in 0..BORDER_COUNT {
        assert_eq!(states.border.cross[i][STATE_COUNT], 0.0, "the padding is zero");
    }
}

#[test]
fn propagation_is_that_of_one_filter_with_all_states() {
    both().iter().for_each(propagates_as_one_filter);
}

fn propagates_as_one_filter(further: &Further) {
    let (mut states, mut errors, full) = example_of(further);
    let driving = if further.angles.is_some() { TEMPERATURE_START } else { DRIVING_COUNT };
    let mut transition = Transition::identity();
    let mut phi = Full::identity();
    for i in 0..MOVING {
        for j in 0..ALL {
            let value = scatter(j + 3, i) + f64::from(u8::from(i == j));
            match j.checked_sub(STATE_COUNT) {
                None => transition.rows[i][j] = value,
                Some(k) if k < driving => states.columns[i][k] = value,
                // Errors of the gimbals drive nothing.
                Some(_) => continue,
            }
            phi[(i, j)] = value;
        }
    }
    let value = states.border.value;
    let columns = states.columns;
    let mut expected = value;
    let mut noise = Full::zeros();
    for process in processes(further).iter().flatten() {
        let tau = process.correlation_time_s;
        let decay = (-ELAPSED_S / tau).exp();
        let variance = process.sigma * process.sigma;
        for k in process.group.range() {
            let z = STATE_COUNT + k;
            phi[(z, z)] = decay;
            expected[k] *= decay;
            // White noise in 1000 short pieces, each of which drives what is left of the time. The
            // factor of the effect is that of the column.
            let pieces = 1000;
            let h = ELAPSED_S / f64::from(pieces);
            let q = variance * 2.0 * h / tau;
            for piece in 0..pieces {
                let left = h * (f64::from(piece) + 0.5);
                let part = (1.0 - (-left / tau).exp()) / (1.0 - decay);
                let mut effect = SVector::<f64, ALL>::zeros();
                for i in 0..MOVING {
                    effect[i] = columns[i][k] * part;
                }
                effect[z] = (-left / tau).exp();
                noise += q * effect * effect.transpose();
            }
        }
    }
    errors.propagate(&transition);
    states.propagate(&transition, ELAPSED_S, &mut errors);
    let full = phi * full * phi.transpose() + noise;
    for k in 0..BORDER_COUNT {
        assert!((states.border.value[k] - expected[k]).abs() < 1e-14);
    }
    // The pieces' own error is of second order in their length, 1e-7.
    for i in 0..ALL {
        for j in 0..ALL {
            let found = match (i.checked_sub(STATE_COUNT), j.checked_sub(STATE_COUNT)) {
                (None, None) => errors.at(i, j),
                (Some(k), None) => states.border.cross[k][j],
                (None, Some(k)) => states.border.cross[k][i],
                (Some(k), Some(l)) => states.border.own[k][l],
            };
            assert!((found - full[(i, j)]).abs() < 1e-7, "{i}, {j}: {found} {}", full[(i, j)]);
        }
    }
    assert_eq!(states.columns, [[0.0; FURTHER_ROW]; MOVING]);
}

#[test]
fn an_update_is_that_of_one_filter_with_all_states() {
    both().iter().for_each(updates_as_one_filter);
}

fn updates_as_one_filter(further: &Further) {
    for held in [false, true] {
        let (mut states, mut errors, mut full) = example_of(further);
        let mut x = [0.0; STATE_COUNT];
        let mut state = SVector::<f64, ALL>::zeros();
        for k in 0..BORDER_COUNT {
            state[STATE_COUNT + k] = states.border.value[k];
        }
        for (axis, error) in [0.3, -0.2, 0.7].into_iter().enumerate() {
            let (s, r) = (3 + axis, 0.3);
            let mut gain = full.column(s) / (full[(s, s)] + r);
            if held {
                gain.rows_mut(MOVING, ALL - MOVING).fill(0.0);
            }
            for (_, places) in groups_of(further).filter(|(group, _)| !is_estimated(*group)) {
                gain.rows_mut(STATE_COUNT + places.start, places.len()).fill(0.0);
            }
            let innovation = error - state[s];
            state += gain * innovation;
            let mut left = Full::identity();
            left.column_mut(s).axpy(-1.0, &gain, 1.0);
            full = left * full * left.transpose() + gain * gain.transpose() * r;

            let innovation = error - x[s];
            states.update(&errors, s, r, innovation, held);
            if held {
                errors.update_moving(s, r, innovation, &mut x);
            } else {
                errors.update(s, r, innovation, &mut x);
            }
            assert_equal(&states, &errors, &full);
        }
        for i in 0..ALL {
            let found = if i < STATE_COUNT { x[i] } else { states.border.value[i - STATE_COUNT] };
            let case = STATE_COUNT + CASE;
            if further.angles.is_some() && (case..case + 3).contains(&i) {
                assert_eq!(found, 0.0, "it is in the reference");
                continue;
            }
            assert!((found - state[i]).abs() < 1e-10, "state {i}");
        }
    }
}

#[test]
fn the_way_back_restores_what_was_and_ages_what_wanders() {
    both().iter().for_each(goes_back);
}

fn goes_back(further: &Further) {
    let (mut states, mut errors, full) = example_of(further);
    states.remember();
    states.remember();
    let kept = states.border.clone();
    states.border.time_s += 60.0;
    states.border.value = [9.0; BORDER_COUNT];
    states.border.cross = [[1.0; 40]; BORDER_COUNT];
    states.border.own = [[2.0; BORDER_COUNT]; BORDER_COUNT];
    states.go_back(&mut errors);
    for (group, places) in groups_of(further) {
        let tau = match group {
            FurtherGroup::GyroGaussMarkov => 2.0,
            FurtherGroup::AccelGaussMarkov => 300.0,
            _ => f64::INFINITY,
        };
        let decay: f64 = (-60.0 / tau).exp();
        for k in places {
            assert!((states.border.value[k] - decay * kept.value[k]).abs() < 1e-15);
            let variance = 0.09 * (1.0 - decay * decay) + kept.own[k][k] * decay * decay;
            assert!((states.border.own[k][k] - variance).abs() < 1e-12);
            assert!((states.border.cross[k][20] - decay * kept.cross[k][20]).abs() < 1e-12);
        }
    }
    assert_eq!(states.border.time_s, 60.0);
    assert!((0..STATE_COUNT).all(|i| errors.at(i, i) == full[(i, i)]));
    states.reopen();
    assert!(states.border.cross.iter().all(|row| row[..MOVING] == [0.0; MOVING]));
    let there = &states.border.cross[..states.border.count];
    assert!(there.iter().all(|row| row[MOVING..STATE_COUNT] != [0.0; 30]));
}

#[test]
fn the_series_meets_the_closed_form() {
    let at = |ratio: f64| share_of_noise(ratio, -(-ratio).exp_m1());
    let (below, above): (f64, f64) = (at(0.010_05), at(0.010_051));
    assert!((below - above).abs() < 1e-6 && (below - 2.0 * 0.01 / 3.0).abs() < 1e-4);
    // Long against the correlation time the integral's noise grows with time.
    assert!((at(100.0) - 2.0 * (100.0 - 1.5)).abs() < 1e-9);
}
