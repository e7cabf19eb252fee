//! Compares a predicted ensemble with the cases of a campaign.
//!
//! Cases that differ only in the seed are a sample of one ensemble. For every error the sample's σ
//! has a confidence interval (χ²) and its mean another (Student), so wide that together they hold
//! the truth with probability [`CONFIDENCE`] (Bonferroni). The prediction agrees where it is
//! inside.

mod comparison;
mod sample;
mod words;

pub use comparison::{Detects, EnsembleComparison, ErrorRow, RUNS_MIN};

use crate::execute::case::ResultError;
use crate::plan::{Case, Plan, PlanError};
use crate::store::CampaignResults;
use octant_base::display::DisplayUnits;
use octant_observe::ensemble::{DriftBand, Ensemble, EnsembleError, ErrorBand, ensemble};
use octant_sample::further::FURTHER_NAMES;
use octant_sample::parameters::NAMES;
use octant_statistics::sample::deviation_factors;
use octant_statistics::sample::{ConfidenceInterval, mean};
use octant_statistics::{paired, power};
use sample::{ErrorFigures, FinalErrors, MethodSample, SampleCounts, SampleError};
use serde::{Deserialize, Serialize};
use std::path::Path;
use words::conclude;

/// Version of the form of a comparison.
pub const SCHEMA: u32 = 1;
/// Probability that all intervals of a comparison hold the truth.
pub const CONFIDENCE: f64 = 0.95;
/// Maximum number of times at which a drift is compared.
const DRIFT_TIMES: usize = 12;

/// Ensembles of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Against {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Every ensemble that could be compared.
    pub compared: Vec<EnsembleComparison>,
    /// Ensembles that couldn't be compared, with the reason.
    pub left_out: Vec<String>,
}

impl Default for Against {
    /// Creates a comparison without ensembles.
    fn default() -> Self {
        Self { schema: SCHEMA, compared: Vec::new(), left_out: Vec::new() }
    }
}

/// Selection of the ensembles to compare; `None` selects any.
#[derive(Clone, Copy, Debug, Default)]
pub struct Selection<'a> {
    /// BLAKE3 of the scenario's file, hexadecimal.
    pub blake3: Option<&'a str>,
    /// Keys that are set.
    pub set: Option<&'a [String]>,
}

/// Reasons why ensembles can't be compared with a campaign. The text fits after "failed to".
#[derive(Debug, thiserror::Error)]
pub enum AgainstError {
    /// A scenario isn't the planned one.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A result can't be read.
    #[error(transparent)]
    Result(#[from] ResultError),
    /// A scenario can't be set up.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// No case was selected.
    #[error("compare: the campaign has no such case")]
    NoCase,
    /// The errors of the runs can't be kept.
    #[error("keep the errors of an ensemble in a temporary file: {0}")]
    Kept(std::io::Error),
}

impl From<SampleError> for AgainstError {
    fn from(error: SampleError) -> Self {
        match error {
            SampleError::Result(error) => Self::Result(error),
            SampleError::Kept(error) => Self::Kept(error),
        }
    }
}

/// Compares predicted ensembles with the results in the folder of a campaign.
///
/// # Errors
/// If a scenario isn't the planned one, a result can't be read, or nothing was
/// selected.
pub fn against(
    plan: &Plan,
    folder: &Path,
    selection: &Selection<'_>,
) -> Result<Against, AgainstError> {
    against_by(plan, &CampaignResults::open(folder)?, selection)
}

/// Compares as [`against`] does, with results that are open.
///
/// # Errors
/// If a scenario isn't the planned one, a result can't be read, or nothing was
/// selected.
pub fn against_by(
    plan: &Plan,
    results: &CampaignResults,
    selection: &Selection<'_>,
) -> Result<Against, AgainstError> {
    // A plan has at most ten million cases. Sorted lists: a map of millions of settings, as those of drawn factors
    // are, would take several times the memory.
    let mut chosen: Vec<u32> = Vec::new();
    for (place, case) in (0..).zip(&plan.cases) {
        let planned = plan.planned(case)?;
        if selection.blake3.is_none_or(|blake3| blake3 == planned.blake3)
            && selection.set.is_none_or(|set| *case.set == *set)
        {
            chosen.push(place);
        }
    }
    if chosen.is_empty() {
        return Err(AgainstError::NoCase);
    }
    let case = |place: u32| plan.cases.get(place as usize);
    let settings = |place: u32| case(place).map(|case| (&case.scenario, &case.set, &case.faults));
    chosen.sort_unstable_by_key(|place| (settings(*place), *place));
    let mut found = Against::default();
    let mut single = 0;
    let mut groups: Vec<&[u32]> = Vec::new();
    for group in chosen.chunk_by(|a, b| settings(*a) == settings(*b)) {
        if group.len() > 1 { groups.push(group) } else { single += 1 }
    }
    groups.sort_unstable();
    for group in groups {
        let Some(first) = group.first().and_then(|place| case(*place)) else { continue };
        let planned = plan.planned(first)?;
        let scenario = planned.scenario(first)?;
        let name = named(first);
        if !scenario.faults.is_empty() {
            let faults: Vec<&str> =
                scenario.faults.iter().map(|fault| fault.spec.id.as_str()).collect();
            found.left_out.push(format!(
                "{name}: {} cases have faults, which no ensemble predicts: {}",
                group.len(),
                faults.join(", ")
            ));
            continue;
        }
        let (mut ensembles, mut samples) = (Vec::new(), Vec::new());
        for method in scenario.methods() {
            match ensemble(&scenario, method) {
                Ok(ensemble) => {
                    let hours = times(&ensemble).map(|time| time.hours).collect();
                    samples.push(MethodSample::new(method, hours));
                    ensembles.push(ensemble);
                }
                Err(error @ EnsembleError::Setup(_)) => return Err(error.into()),
                Err(error) => found.left_out.push(format!("{name}: {error}")),
            }
        }
        if samples.is_empty() {
            continue;
        }
        let counts = sample::read(results, group, case, &mut samples)?;
        for (ensemble, sample) in ensembles.iter().zip(&samples) {
            match compare(first, ensemble, sample, counts) {
                Ok(comparison) => found.compared.push(comparison),
                Err(reason) => found.left_out.push(format!("{name}: {reason}")),
            }
        }
    }
    if single > 0 {
        found.left_out.push(format!(
            "{single} cases are alone with what is set in them: an ensemble differs by seeds only"
        ));
    }
    Ok(found)
}

fn named(case: &Case) -> String {
    if case.set.is_empty() {
        case.scenario.to_string()
    } else {
        format!("{} with {}", case.scenario, case.set.to_strings().join(", "))
    }
}

/// Times at which a drift is compared.
fn times(ensemble: &Ensemble) -> impl Iterator<Item = &DriftBand> {
    let every = ensemble.drift.len().div_ceil(DRIFT_TIMES).max(1);
    ensemble.drift.iter().skip(every - 1).step_by(every)
}

/// Attitude or velocity error at the end of the navigation, predicted and in each run.
struct Final {
    name: String,
    unit: &'static str,
    hours: f64,
    band: ErrorBand,
    figures: ErrorFigures,
}

/// Lists the final errors of attitude and velocity that the prediction and all runs have.
fn finals(ensemble: &Ensemble, sample: &MethodSample) -> Vec<Final> {
    let Some(last) = ensemble.drift.last() else { return Vec::new() };
    let Some(solution) = &last.solution else { return Vec::new() };
    let both = solution.all().into_iter().zip(sample.finals());
    let one = |(band, found): (ErrorBand, Option<FinalErrors>)| {
        let FinalErrors { name, unit, figures } = found?;
        let name = format!("{name} at {:.1} h", last.hours);
        Some(Final { name, unit, hours: last.hours, band, figures })
    };
    both.filter_map(one).collect()
}

fn compare(
    first: &Case,
    ensemble: &Ensemble,
    sample: &MethodSample,
    counts: SampleCounts,
) -> Result<EnsembleComparison, String> {
    let count = sample.runs;
    if count < 2 {
        return Err(match counts.repeated {
            0 => format!("{count} of its cases have a calibration to compare"),
            repeated => format!(
                "{count} of its cases have a calibration to compare: {repeated} more are the same runs \
                 again, by their streams"
            ),
        });
    }
    let times: Vec<_> = times(ensemble).collect();
    let finals = finals(ensemble, sample);
    let names = || NAMES.into_iter().chain(FURTHER_NAMES).enumerate();
    let state_of = |name: &str| ensemble.states.iter().find(|state| state.name == name);
    let predicted = names().filter(|(_, name)| state_of(name).is_some()).count();
    let rows = predicted + 2 * times.len() + finals.len();
    // Each row has two intervals.
    let each = 1.0 - (1.0 - CONFIDENCE) / (2 * rows) as f64;
    let (low, high) = deviation_factors(count as u64 - 1, each)
        .ok_or_else(|| format!("{count} runs know no σ"))?;
    let student =
        paired::student(count - 1, each).ok_or_else(|| format!("{count} runs know no σ"))?;

    let mut states = Vec::with_capacity(predicted);
    for (index, name) in names() {
        let Some(state) = state_of(name) else { continue };
        let figures = sample.state(index);
        let figures = figures.ok_or_else(|| format!("{name} has no error in one of its cases"))?;
        let predicted = (state.mean, state.sigma);
        states.push(row(
            name.to_owned(),
            &state.unit,
            None,
            predicted,
            figures,
            (low, high),
            student,
        ));
    }
    let mut drift = Vec::with_capacity(2 * times.len());
    for (axis, what) in ["latitude", "longitude"].into_iter().enumerate() {
        for (index, time) in times.iter().enumerate() {
            let figures = sample.drift(axis, index);
            let figures = figures
                .ok_or_else(|| format!("one of its cases has no drift at {:.1} h", time.hours))?;
            let band = if axis == 0 { time.latitude_arcmin } else { time.longitude_arcmin };
            let name = format!("{what} at {:.1} h", time.hours);
            let predicted = (band.mean, band.sigma);
            drift.push(row(
                name,
                "arcmin",
                Some(time.hours),
                predicted,
                figures,
                (low, high),
                student,
            ));
        }
    }
    for Final { name, unit, hours, band, figures } in finals {
        let predicted = (band.mean, band.sigma);
        drift.push(row(name, unit, Some(hours), predicted, figures, (low, high), student));
    }
    let ratios: Vec<f64> = states.iter().filter_map(|row| row.ratio).collect();
    let mut comparison = EnsembleComparison {
        scenario: first.scenario.to_string(),
        set: first.set.to_strings(),
        method: ensemble.method.clone(),
        runs: count,
        open: counts.open,
        without: counts.broken + counts.summaries - count,
        repeated: counts.repeated,
        confidence: CONFIDENCE,
        known_to: 0.5 * (high - low),
        detects: detects(count as u64, each),
        states,
        drift,
        mean_ratio: mean(&ratios),
        stands: None,
        words: Vec::new(),
        not_modelled: ensemble.not_modelled.clone(),
    };
    conclude(&mut comparison, &DisplayUnits::default());
    Ok(comparison)
}

fn row(
    name: String,
    unit: &str,
    hours: Option<f64>,
    (predicted_mean, predicted_sigma): (f64, f64),
    figures: ErrorFigures,
    (low, high): (f64, f64),
    student: f64,
) -> ErrorRow {
    let value = figures.deviation.unwrap_or(f64::NAN);
    let simulated_sigma = ConfidenceInterval { value, low: value * low, high: value * high };
    let middle = figures.mean.unwrap_or(f64::NAN);
    let error = student * value / libm::sqrt(figures.runs as f64);
    let simulated_mean =
        ConfidenceInterval { value: middle, low: middle - error, high: middle + error };
    // Without random parts, both are exact to rounding.
    let rounding = 1e-9 * (predicted_mean.abs() + predicted_sigma);
    let within = |predicted: f64, interval: &ConfidenceInterval| {
        interval.low - rounding <= predicted && predicted <= interval.high + rounding
    };
    ErrorRow {
        agrees: within(predicted_sigma, &simulated_sigma)
            && within(predicted_mean, &simulated_mean),
        ratio: (value > 0.0).then(|| predicted_sigma / value),
        unit: unit.to_owned(),
        name,
        hours,
        predicted_mean,
        predicted_sigma,
        simulated_mean,
        simulated_sigma,
    }
}

fn detects(runs: u64, each: f64) -> Option<Detects> {
    let (ratio_below, ratio_above) = power::sigma_ratios(runs, each, power::POWER)?;
    let mean_sigma = power::mean_shift(runs, each, power::POWER)?;
    Some(Detects { ratio_below, ratio_above, mean_sigma })
}
