//! Estimates against truth.

use octant_sample::Parameters;
use octant_sample::further::{FURTHER_COUNT, FurtherEstimates, FurtherGroup};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};
use octant_score::parameters::{
    beyond, nees, nees_full, score, score_further, worst_normalized_error,
};
use std::collections::BTreeMap;

fn bias_error(error: [f64; 3]) -> (Parameters, Parameters) {
    let truth = Parameters { gyro_bias: [1e-8, -2e-8, 3e-8], ..Parameters::default() };
    let mut estimate = truth;
    for i in 0..3 {
        estimate.gyro_bias[i] += error[i];
    }
    (truth, estimate)
}

#[test]
fn errors_are_in_users_units_and_normalized_by_sigma() {
    let unit = ParameterGroup::GyroBias.si_per_unit();
    let (truth, estimate) = bias_error([0.001 * unit, -0.002 * unit, 0.0]);
    let mut sigma = [0.0; PARAMETER_COUNT];
    sigma[..3].fill(0.0005 * unit);
    let scores = score(Some(&truth), &estimate, &sigma);
    let y = &scores["gyro_bias_y"];
    assert_eq!(y.unit, "deg/h");
    assert!((y.error.unwrap() + 0.002).abs() < 1e-12);
    assert!((y.sigma.unwrap() - 0.0005).abs() < 1e-15);
    assert!((y.normalized.unwrap() + 4.0).abs() < 1e-9);
    assert_eq!(scores["g_zz"].sigma, None, "g_zz was not estimated");
    // Expected: (2² + 4² + 0²) / 3
    let nees = nees(&scores, &BTreeMap::new());
    assert!((nees["gyro_bias"] - 20.0 / 3.0).abs() < 1e-8);
    assert_eq!(nees.len(), 1, "only the gyro biases were estimated");
    assert_eq!(worst_normalized_error(&scores, &["gyro_bias_x", "g_zz"]), None);
    assert_eq!(beyond(&scores, 3.0), ["gyro_bias_y"]);
    assert!((worst_normalized_error(&scores, &["gyro_bias_x"]).unwrap() - 4.0).abs() < 1e-9);
}

/// Errors of 1 σ and 3 σ: the mean of the squares is 5. A process has no truth, and a group that is off isn't there.
#[test]
fn further_groups_have_their_mean_squares() {
    let mut found = FurtherEstimates { value: [0.0; FURTHER_COUNT], sigma: [0.0; FURTHER_COUNT] };
    let mut truth = [Some(0.0); FURTHER_COUNT];
    let deflection = FurtherGroup::Deflection.range();
    found.value[deflection.start] = 1e-5;
    found.value[deflection.start + 1] = -3e-5;
    for group in [FurtherGroup::Deflection, FurtherGroup::GyroGaussMarkov] {
        found.sigma[group.range()].fill(1e-5);
    }
    truth[FurtherGroup::GyroGaussMarkov.range()].fill(None);
    let scores = score_further(Some(&truth), Some(&found));
    assert_eq!(scores.len(), 5);
    let nees = nees(&BTreeMap::new(), &scores);
    assert_eq!(nees.keys().collect::<Vec<_>>(), ["deflection"]);
    assert!((nees["deflection"] - 5.0).abs() < 1e-12);
    assert!(score_further(Some(&truth), None).is_empty());
}

#[test]
fn without_truth_there_is_no_error() {
    let scores = score(None, &Parameters::default(), &[1.0; PARAMETER_COUNT]);
    assert_eq!(scores.len(), PARAMETER_COUNT);
    assert!(scores.values().all(|p| p.error.is_none() && p.r#true.is_none()));
    assert!(nees(&scores, &BTreeMap::new()).is_empty());
    assert_eq!(worst_normalized_error(&scores, &[]), None);
}

#[test]
fn correlation_enters_the_full_form_alone() {
    // Two errors of one σ each, in the direction that a correlation of 0.8 favours:
    // eᵀP⁻¹e = 2/(1 + 0.8); and against it: 2/(1 − 0.8).
    let unit = ParameterGroup::GyroBias.si_per_unit();
    let s = 0.001 * unit;
    let mut covariance = [[0.0; PARAMETER_COUNT]; PARAMETER_COUNT];
    for i in 0..3 {
        covariance[i][i] = s * s;
    }
    covariance[0][1] = 0.8 * s * s;
    covariance[1][0] = 0.8 * s * s;
    let (truth, with) = bias_error([s, s, 0.0]);
    let (_, against) = bias_error([s, -s, 0.0]);
    let with = nees_full(&truth, &with, &covariance);
    let against = nees_full(&truth, &against, &covariance);
    assert!((with["gyro_bias"] - 2.0 / 1.8 / 3.0).abs() < 1e-6, "{with:?}");
    assert!((against["gyro_bias"] - 2.0 / 0.2 / 3.0).abs() < 1e-6, "{against:?}");
    assert_eq!(with.len(), 1);
}
