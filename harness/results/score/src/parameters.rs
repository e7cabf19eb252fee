//! Estimated parameters compared with truth: errors, also normalized by the σ that the estimator
//! claims.

use super::summary::ParameterScore;
use nalgebra::{SMatrix, SVector};
use octant_sample::Parameters;
use octant_sample::further::{FURTHER_COUNT, FURTHER_NAMES, FurtherEstimates, FurtherGroup};
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterGroup};
use std::collections::BTreeMap;

/// Scores every parameter, in the units for users. A σ that isn't positive means that the parameter was
/// not estimated.
#[must_use]
pub fn score(
    truth: Option<&Parameters>,
    estimate: &Parameters,
    sigma: &[f64; PARAMETER_COUNT],
) -> BTreeMap<String, ParameterScore> {
    let truth = truth.map(Parameters::to_array);
    let estimate = estimate.to_array();
    (0..PARAMETER_COUNT)
        .map(|i| {
            let group = ParameterGroup::of(i);
            let unit = group.si_per_unit();
            let error_si = truth.map(|t| estimate[i] - t[i]);
            let sigma_si = (sigma[i] > 0.0).then_some(sigma[i]);
            let score = ParameterScore {
                r#true: truth.map(|t| t[i] / unit),
                estimate: estimate[i] / unit,
                sigma: sigma_si.map(|s| s / unit),
                gain: None,
                error: error_si.map(|e| e / unit),
                normalized: error_si.zip(sigma_si).map(|(e, s)| e / s),
                unit: group.unit().to_owned(),
            };
            (NAMES[i].to_owned(), score)
        })
        .collect()
}

/// Sets the gain of every parameter with a σ over its prior, SI.
pub fn set_gains(
    parameters: &mut BTreeMap<String, ParameterScore>,
    prior: &[f64; PARAMETER_COUNT],
) {
    for (i, name) in NAMES.into_iter().enumerate() {
        if let Some(score) = parameters.get_mut(name) {
            let before = prior[i] / ParameterGroup::of(i).si_per_unit();
            score.gain = score.sigma.map(|sigma| before / sigma);
        }
    }
}

/// Least gain of the planned parameters; `None` if none is planned, or if one of them has none.
#[must_use]
pub fn least_gain(parameters: &BTreeMap<String, ParameterScore>, planned: &[&str]) -> Option<f64> {
    let gains = planned.iter().map(|name| parameters.get(*name).and_then(|p| p.gain));
    gains.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::min)
}

/// Scores the further states that the core has, in the units for users; none, if it has none. Those that are considered
/// have an estimate of zero, and their prior as σ.
#[must_use]
pub fn score_further(
    truth: Option<&[Option<f64>; FURTHER_COUNT]>,
    found: Option<&FurtherEstimates>,
) -> BTreeMap<String, ParameterScore> {
    let Some(found) = found else { return BTreeMap::new() };
    let of = |group: FurtherGroup| {
        let unit = group.si_per_unit();
        let score = move |index: usize| {
            let (estimate, sigma) = (found.value[index], found.sigma[index]);
            let truth = truth.and_then(|truth| truth[index]);
            let error = truth.map(|truth| estimate - truth);
            let score = ParameterScore {
                r#true: truth.map(|truth| truth / unit),
                estimate: estimate / unit,
                sigma: Some(sigma / unit),
                gain: None,
                error: error.map(|error| error / unit),
                normalized: error.map(|error| error / sigma),
                unit: group.unit().to_owned(),
            };
            (FURTHER_NAMES[index].to_owned(), score)
        };
        group.range().filter(|index| found.sigma[*index] > 0.0).map(score)
    };
    FurtherGroup::ALL.into_iter().flat_map(of).collect()
}

/// Mean of e²/σ² over the estimated parameters of each group, and over the states of each further group, by the name of
/// the group: near 1 if the claimed σ is right. Correlations are ignored; [`nees_full`] includes them.
#[must_use]
pub fn nees(
    parameters: &BTreeMap<String, ParameterScore>,
    further: &BTreeMap<String, ParameterScore>,
) -> BTreeMap<String, f64> {
    let of = |name: &'static str, members: &[&str], scores: &BTreeMap<String, ParameterScore>| {
        let normalized = members.iter().filter_map(|member| scores.get(*member)?.normalized);
        let squares: Vec<f64> = normalized.map(|n| n * n).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        (!squares.is_empty()).then(|| (name.to_owned(), mean))
    };
    let of_parameters = ParameterGroup::ALL
        .into_iter()
        .map(|group| of(group.name(), &NAMES[group.range()], parameters));
    let of_further = FurtherGroup::ALL
        .into_iter()
        .map(|group| of(group.name(), &FURTHER_NAMES[group.range()], further));
    of_parameters.chain(of_further).flatten().collect()
}

/// Number of parameters of the largest group.
const GROUP_MAX: usize = 9;

/// NEES eᵀP⁻¹e of each group with its own block of the covariance, divided by the size of the group.
///
/// `covariance` is in SI, in the order of [`NAMES`], by rows. Groups whose block is not positive
/// definite (not estimated) are left out.
#[must_use]
pub fn nees_full(
    truth: &Parameters,
    estimate: &Parameters,
    covariance: &[[f64; PARAMETER_COUNT]; PARAMETER_COUNT],
) -> BTreeMap<String, f64> {
    let (truth, estimate) = (truth.to_array(), estimate.to_array());
    let mut groups = BTreeMap::new();
    for group in ParameterGroup::ALL {
        let (first, size) = (group.range().start, group.range().len());
        // Computed in the group's own unit: squared SI values of g-dependent biases would be as small
        // as 1e-20.
        let unit = group.si_per_unit();
        // For smaller groups the matrix is padded with ones on the diagonal, and the errors with zeros.
        let mut block = SMatrix::<f64, GROUP_MAX, GROUP_MAX>::identity();
        let mut error = SVector::<f64, GROUP_MAX>::zeros();
        for i in 0..size {
            error[i] = (estimate[first + i] - truth[first + i]) / unit;
            for j in 0..size {
                block[(i, j)] = covariance[first + i][first + j] / (unit * unit);
            }
        }
        if let Some(factor) = block.cholesky() {
            let whole = error.dot(&factor.solve(&error));
            groups.insert(group.name().to_owned(), whole / size as f64);
        }
    }
    groups
}

/// Names of the parameters whose error is larger than `sigmas` times their σ.
#[must_use]
pub fn beyond(parameters: &BTreeMap<String, ParameterScore>, sigmas: f64) -> Vec<&'static str> {
    NAMES
        .into_iter()
        .filter(|name| {
            parameters.get(*name).and_then(|p| p.normalized).is_some_and(|n| n.abs() > sigmas)
        })
        .collect()
}

/// Largest |error|/σ; `None` if no error is known, or if one of the planned parameters has none: the
/// worst of the others would hide it.
#[must_use]
pub fn worst_normalized_error(
    parameters: &BTreeMap<String, ParameterScore>,
    planned: &[&str],
) -> Option<f64> {
    let known = |name: &&str| parameters.get(*name).is_some_and(|p| p.normalized.is_some());
    if !planned.iter().all(known) {
        return None;
    }
    parameters.values().filter_map(|p| p.normalized).map(f64::abs).reduce(f64::max)
}
