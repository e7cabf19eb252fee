//! The smoother against a batch solution: all states at all times at once, by normal equations.

use crate::linear::{FIRST, Linear, VARIANCE};
use octant_calibration::covariance::{MOVING, PARAMETERS, STATE_COUNT};
use octant_smoother::StateVector;
use octant_smoother::backward::smooth;

/// Inverse of a symmetric positive definite matrix, by Cholesky.
fn inverse(a: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = a.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            l[i][j] = if i == j { (a[i][i] - sum).sqrt() } else { (a[i][j] - sum) / l[j][j] };
        }
    }
    let solve = |column: usize| {
        let mut x = vec![0.0; n];
        for i in 0..n {
            let sum: f64 = (0..i).map(|k| l[i][k] * x[k]).sum();
            x[i] = (f64::from(u8::from(i == column)) - sum) / l[i][i];
        }
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|k| l[k][i] * x[k]).sum();
            x[i] = (x[i] - sum) / l[i][i];
        }
        x
    };
    (0..n).map(solve).collect()
}

/// Unknown are the first state and the process noise of each step: 39 + 10 · 60 numbers. A state is a linear form of them.
#[test]
fn estimates_and_covariances_are_those_of_the_batch_solution() {
    const COUNT: usize = 60;
    let system = Linear::new(0.05);
    let driven: Vec<usize> = (0..=PARAMETERS).collect();
    let unknowns = STATE_COUNT + driven.len() * COUNT;
    // Rows of the state in the unknowns, and the normal equations with the priors.
    let mut state: Vec<Vec<f64>> = (0..STATE_COUNT)
        .map(|i| {
            let mut row = vec![0.0; unknowns];
            row[i] = 1.0;
            row
        })
        .collect();
    let mut normal = vec![vec![0.0; unknowns]; unknowns];
    for (i, prior) in system.prior.iter().enumerate() {
        normal[i][i] = 1.0 / (prior * prior);
    }
    let mut states = Vec::new();
    for k in 0..COUNT {
        let transition = system.transition(k + 1);
        state = (0..STATE_COUNT)
            .map(|i| {
                let mut row = vec![0.0; unknowns];
                for (j, from) in state.iter().enumerate() {
                    let factor = transition[(i, j)];
                    if factor != 0.0 {
                        row.iter_mut().zip(from).for_each(|(out, value)| *out += factor * value);
                    }
                }
                row
            })
            .collect();
        for (place, i) in driven.iter().enumerate() {
            let unknown = STATE_COUNT + k * driven.len() + place;
            state[*i][unknown] = 1.0;
            normal[unknown][unknown] = 1.0 / (system.noise[*i] * system.noise[*i]);
        }
        for axis in 0..3 {
            let row = &state[FIRST + axis];
            for i in 0..unknowns {
                for j in 0..unknowns {
                    normal[i][j] += row[i] * row[j] / VARIANCE;
                }
            }
        }
        states.push(state.clone());
    }
    let covariance = inverse(&normal);
    let (mut store, _) = system.run(3, COUNT, 1, |_, _| {});
    let smoothed = smooth(&mut store).unwrap();
    assert_eq!(smoothed.nodes.len(), COUNT);
    for (k, node) in smoothed.nodes.iter().enumerate() {
        let found = node.covariance();
        for i in 0..STATE_COUNT {
            let row = &states[k][i];
            let product: Vec<f64> = covariance
                .iter()
                .map(|line| line.iter().zip(row).map(|(a, b)| a * b).sum())
                .collect();
            let expected: f64 = product.iter().zip(row).map(|(a, b)| a * b).sum();
            let ratio = found[(i, i)] / expected;
            assert!((ratio - 1.0).abs() < 1e-8, "state {i} at {k}: {ratio}");
        }
    }
}

/// Squares of the errors that are left, by their covariance, over all states and many seeds.
#[test]
fn what_is_left_has_the_covariance_that_it_should() {
    let system = Linear::new(0.05);
    let (mut filtered, mut smoothed_square) = (0.0, [0.0; 3]);
    let seeds = 200;
    for seed in 0..seeds {
        let (mut store, errors) = system.run(seed, 120, 40, |_, _| {});
        let smoothed = smooth(&mut store).unwrap();
        for (place, node) in smoothed.nodes.iter().enumerate() {
            let truth = errors[40 * (place + 1) - 1];
            let left: StateVector = truth - node.errors();
            let square = |errors: &StateVector, covariance: octant_smoother::States| {
                errors.dot(&(covariance.try_inverse().unwrap() * errors)) / STATE_COUNT as f64
            };
            smoothed_square[place] += square(&left, node.covariance()) / seeds as f64;
            if place == 0 {
                filtered += square(&truth, node.filtered_covariance()) / seeds as f64;
            }
        }
    }
    // 200 · 39 squares: σ of the mean is 0.016.
    for found in smoothed_square.iter().chain([&filtered]) {
        assert!((found - 1.0).abs() < 0.07, "{smoothed_square:?}, {filtered}");
    }
}

/// Nothing comes after the end, and a constant is known there as well as it ever will be.
#[test]
fn constants_gain_nothing_at_the_end_and_are_known_everywhere_as_well_as_there() {
    let system = Linear::new(0.0);
    let (mut store, _) = system.run(5, 100, 20, |_, _| {});
    let smoothed = smooth(&mut store).unwrap();
    let last = smoothed.nodes.last().unwrap();
    assert_eq!(last.errors(), StateVector::zeros());
    for node in &smoothed.nodes {
        let (errors, covariance) = (node.errors(), node.covariance());
        for i in PARAMETERS..STATE_COUNT {
            let at_end = last.node.covariance[i][i];
            assert!((covariance[(i, i)] / at_end - 1.0).abs() < 1e-7);
            let value = node.node.parameters[i - PARAMETERS] + errors[i];
            let expected = last.node.parameters[i - PARAMETERS];
            assert!(
                (value - expected).abs() < 1e-7 * at_end.sqrt(),
                "{value}, expected {expected}"
            );
        }
        assert!(
            (0..MOVING).all(|i| covariance[(i, i)] <= node.node.covariance[i][i] * (1.0 + 1e-9))
        );
    }
}

#[test]
fn too_little_is_refused_in_words() {
    let (mut store, _) = Linear::new(0.0).run(1, 59, 1, |_, _| {});
    let refused = smooth(&mut store).unwrap_err().to_string();
    assert_eq!(
        refused,
        "smooth: found 59 measurements after the last recovery, expected at least 60"
    );
}
