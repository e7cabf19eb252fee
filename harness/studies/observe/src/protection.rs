//! Largest shifts of the published parameters by a jump that the core's drift test doesn't notice.
//!
//! A parameter j jumps by a at the mark m of the test, and back at a later one n or never. With the covariances P of the
//! parameters the estimate has followed it at a mark k by `s(k) = (P(m) − P(k)) P(m)⁻¹ eⱼ a`, and forgets
//! it after n: `s(k) = P(k) P(n)⁻¹ s(n)`. The correction between any two marks has the mean of their difference, and with
//! it each z of the test; z has the variance one, and a limit. So for the z that sees the jump best the size that it misses
//! with a given probability is known, and the shift at the end. (The same ratio, a slope of error against test statistic,
//! is that of integrity monitoring of satellite navigation: Brown, 1992.)
//!
//! Whatever jumps, the shift at n of parameter i over the mean of z is at most √(Pᵢᵢ(m) − Pᵢᵢ(n)), the
//! σ that it still had to lose.

use crate::perfect::{PerfectError, perfect_instrument};
use nalgebra::SMatrix;
use octant_calibration::config::{Estimator, Screening};
use octant_calibration::covariance::{Covariance, PARAMETERS};
use octant_calibration::drift::{DriftTest, DriftWeights, is_tested};
use octant_calibration::filter::prior_sigmas;
use octant_sample::Mode;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_scenario::{Method, Scenario};

type Square = SMatrix<f64, PARAMETER_COUNT, PARAMETER_COUNT>;

/// A jump of a parameter, and what it does to the one that it moves most for the mean of z that it causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnnoticedJump {
    /// The parameter that jumps.
    pub parameter: usize,
    /// Its beginning and its end, s of the filter's time; the end of the calibration for one that stays.
    pub between_s: (f64, f64),
    /// Size of the jump for a mean of z of one, SI.
    pub size: f64,
    /// Shift of the published parameter for a mean of z of one, SI.
    pub shift: f64,
}

/// What a drift test leaves unnoticed.
#[derive(Clone, Debug)]
pub struct Protection {
    /// Limit of the test.
    pub limit_sigmas: f64,
    /// σ of the parameters at the end, SI.
    pub sigma: [f64; PARAMETER_COUNT],
    /// For each parameter the jump with the largest shift; `None` where no jump is tested that moves it.
    pub worst: [Option<UnnoticedJump>; PARAMETER_COUNT],
}

/// Reasons why it can't be told.
#[derive(Debug, thiserror::Error)]
pub enum ProtectionError {
    /// The filter can't be run.
    #[error(transparent)]
    Perfect(#[from] PerfectError),
    /// Nothing is tested.
    #[error(
        "find unnoticed jumps: found no test for drifts, expected estimator = \"kalman\" that estimates all groups, without a \
         rate random walk, and screening.drift other than \"off\""
    )]
    NoTest,
}

/// Covariance of the parameters at a time, in units of the prior.
struct At {
    time_s: f64,
    covariance: Square,
}

/// Finds the largest unnoticed shifts of a method's calibration, by a run of its filter on a perfect instrument.
///
/// # Errors
/// If the filter can't be run, or the scenario has no test for drifts.
pub fn protection(scenario: &Scenario, method: Method) -> Result<Protection, ProtectionError> {
    let (mut plant, mut core, config) =
        perfect_instrument(scenario, method, |screening| Screening {
            base: screening.base,
            drift_sigmas: screening.drift_sigmas,
            ..Screening::none()
        })?;
    let estimator = config.calibration.as_ref().map(|calibration| &calibration.estimator);
    let (Some(Estimator::Kalman(kalman)), Some(limit_sigmas)) =
        (estimator, config.screening.drift_sigmas)
    else {
        return Err(ProtectionError::NoTest);
    };
    let sigmas = prior_sigmas(kalman);
    let prior: [f64; PARAMETER_COUNT] = core::array::from_fn(|i| sigmas[PARAMETERS + i]);
    let (mut all, mut last, mut kept, mut weights) = (Vec::new(), None, Vec::new(), None);
    let mut command = octant_sample::GimbalCommand::default();
    loop {
        let step = plant.step(&command);
        let output = core.step(&step.sample, step.aiding.as_ref());
        command = output.gimbal_command;
        if !matches!(output.mode, Mode::Aligning | Mode::Calibrating) {
            break;
        }
        let Some(filter) = core.filter() else { continue };
        if !output.nis.is_finite() {
            continue;
        }
        let drift: &DriftTest = filter.drift().ok_or(ProtectionError::NoTest)?;
        weights = Some(drift.weights());
        let newest_s = drift.marks_s().last();
        let now = || in_units(filter.covariance(), &prior);
        if newest_s.is_some() && newest_s != all.last().map(|at: &At| at.time_s) {
            all.push(At { time_s: newest_s.unwrap_or_default(), covariance: now() });
            kept = drift.marks_s().collect();
        }
        last = Some(At { time_s: filter.time_s(), covariance: now() });
    }
    if let Some(refusal) = core.refusal() {
        return Err(PerfectError::Refused(refusal.to_string()).into());
    }
    all.retain(|at| kept.contains(&at.time_s));
    all.extend(last);
    let weights = weights.ok_or(ProtectionError::NoTest)?;
    Ok(Protection { limit_sigmas, sigma: *core.sigma(), worst: worst(&all, weights, &prior) })
}

fn in_units(covariance: &Covariance, prior: &[f64; PARAMETER_COUNT]) -> Square {
    Square::from_fn(|i, j| {
        let unit = prior[i] * prior[j];
        if unit > 0.0 { covariance.at(PARAMETERS + i, PARAMETERS + j) / unit } else { 0.0 }
    })
}

/// Makes z of each parameter of a correction between two marks; zero for one that isn't tested.
fn statistics(before: &At, weights: &Square, after: &At) -> Square {
    let response = (before.covariance - after.covariance) * weights;
    let mut rows = Square::zeros();
    for i in 0..PARAMETER_COUNT {
        let variance = weights.column(i).dot(&response.column(i));
        if is_tested(before.covariance[(i, i)], after.covariance[(i, i)]) && variance > 0.0 {
            rows.set_row(i, &(weights.column(i) / variance.sqrt()).transpose());
        }
    }
    rows
}

/// The worst jumps between any two of these times; the last one is the end.
fn worst(
    all: &[At],
    weights: DriftWeights,
    prior: &[f64; PARAMETER_COUNT],
) -> [Option<UnnoticedJump>; PARAMETER_COUNT] {
    let mut worst = [None::<UnnoticedJump>; PARAMETER_COUNT];
    let inverses: Option<Vec<Square>> =
        all.iter().map(|at| Some(at.covariance.cholesky()?.inverse())).collect();
    let Some(inverses) = inverses else { return worst };
    let pairs: Vec<(usize, usize)> =
        (0..all.len()).flat_map(|n| (0..n).map(move |m| (m, n))).collect();
    let test = |&(a, b): &(usize, usize)| {
        let weights = match weights {
            DriftWeights::Likelihood => inverses[a],
            DriftWeights::Own => Square::identity(),
        };
        statistics(&all[a], &weights, &all[b])
    };
    let tests: Vec<Square> = pairs.iter().map(test).collect();
    for &(m, n) in &pairs {
        // Columns: shift of the estimate at each mark by a jump of each parameter.
        let shifts: Vec<Square> = (0..all.len())
            .map(|k| {
                let until = |k: usize| (all[m].covariance - all[k].covariance) * inverses[m];
                match k {
                    _ if k <= m => Square::zeros(),
                    _ if k <= n => until(k),
                    _ => all[k].covariance * inverses[n] * until(n),
                }
            })
            .collect();
        let mut largest = [0.0_f64; PARAMETER_COUNT];
        for (&(a, b), test) in pairs.iter().zip(&tests).filter(|((_, b), _)| *b > m) {
            let z = test * (shifts[b] - shifts[a]);
            for (largest, column) in largest.iter_mut().zip(z.column_iter()) {
                *largest = column.iter().fold(*largest, |largest, z| largest.max(z.abs()));
            }
        }
        let Some(end) = shifts.last() else { continue };
        for (j, z) in largest.into_iter().enumerate() {
            // What no test between marks sees well, none of them tests: the parameter isn't known yet.
            if !is_tested(all[m].covariance[(j, j)], all[n].covariance[(j, j)]) || !(z > 0.0) {
                continue;
            }
            for (i, worst) in worst.iter_mut().enumerate() {
                let shift = prior[i] * (end[(i, j)] / z).abs();
                if worst.is_none_or(|worst| shift > worst.shift) {
                    let between_s = (all[m].time_s, all[n].time_s);
                    *worst =
                        Some(UnnoticedJump { parameter: j, between_s, size: prior[j] / z, shift });
                }
            }
        }
    }
    worst
}
