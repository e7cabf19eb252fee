//! Errors of the cases of an ensemble: of each result only those that are compared.

use crate::case::ResultError;
use crate::plan::Case;
use crate::store::CampaignResults;
use crate::stream_key::StreamKey;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use octant_scenario::Method;
use octant_score::summary::{CalibrationScore, NavigationScore, Summary};
use std::collections::HashSet;

/// Number of scored errors of attitude and velocity.
const SOLUTION: usize = 5;

/// One error of all runs.
#[derive(Clone, Debug, Default)]
pub(super) struct ErrorColumn {
    values: Vec<f64>,
    /// True if a run doesn't have it.
    is_missing: bool,
}

/// Errors of the runs of a method with a published calibration.
#[derive(Clone, Debug)]
pub(super) struct MethodSample {
    method: Method,
    /// Times at which the drift is compared, h.
    hours: Vec<f64>,
    /// Number of runs.
    pub(super) runs: usize,
    /// Errors of the parameters, in the order of [`NAMES`].
    parameters: [ErrorColumn; PARAMETER_COUNT],
    /// Latitude and longitude errors at each of the times, arcmin.
    drift: [Vec<ErrorColumn>; 2],
    /// Final errors of attitude and velocity.
    finals: [ErrorColumn; SOLUTION],
    /// Names and units of the final errors; `None` before the first navigation.
    final_names: Option<[(&'static str, &'static str); SOLUTION]>,
    /// True if a run has no navigation.
    is_without_navigation: bool,
}

/// Final errors of all runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct FinalErrors<'a> {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) values: &'a [f64],
}

/// Number of cases by what they have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SampleCounts {
    /// Cases with a summary, each stream once.
    pub(super) summaries: usize,
    /// Cases without a result.
    pub(super) open: usize,
    /// Cases without a summary.
    pub(super) broken: usize,
    /// Cases with the stream of another one.
    pub(super) repeated: usize,
}

/// Reads the results of cases one after another, and collects their errors for each of the methods.
pub(super) fn read(
    results: &CampaignResults,
    cases: &[&Case],
    methods: &mut [MethodSample],
) -> Result<SampleCounts, ResultError> {
    let mut counts = SampleCounts::default();
    let mut streams = HashSet::new();
    for case in cases {
        let Some((result, _)) = results.result(&case.id)? else {
            counts.open += 1;
            continue;
        };
        match result.summary {
            Some(summary) if !streams.insert(StreamKey::from(summary.stream_hash.as_str())) => {
                counts.repeated += 1
            }
            Some(summary) => {
                counts.summaries += 1;
                methods.iter_mut().for_each(|method| method.push(&summary));
            }
            None => counts.broken += 1,
        }
    }
    Ok(counts)
}

impl ErrorColumn {
    fn push(&mut self, value: Option<f64>) {
        match value {
            Some(value) => self.values.push(value),
            None => self.is_missing = true,
        }
    }

    /// Returns the errors of all runs; `None` if one doesn't have it.
    pub(super) fn all(&self) -> Option<&[f64]> {
        (!self.is_missing).then_some(&self.values)
    }
}

impl MethodSample {
    /// Makes a sample without runs, whose drift is read at some times, h.
    pub(super) fn new(method: Method, hours: Vec<f64>) -> Self {
        let column = || vec![ErrorColumn::default(); hours.len()];
        Self {
            method,
            runs: 0,
            parameters: std::array::from_fn(|_| ErrorColumn::default()),
            drift: [column(), column()],
            finals: std::array::from_fn(|_| ErrorColumn::default()),
            final_names: None,
            is_without_navigation: false,
            hours,
        }
    }

    /// Adds a run, if its calibration was published.
    fn push(&mut self, summary: &Summary) {
        let Some((calibration, navigation)) = of(summary, self.method) else { return };
        self.runs += 1;
        for (column, name) in self.parameters.iter_mut().zip(NAMES) {
            column.push(calibration.parameters.get(name).and_then(|found| found.error));
        }
        for (index, hours) in self.hours.iter().enumerate() {
            let found = navigation.and_then(|navigation| at(navigation, *hours));
            for (axis, columns) in self.drift.iter_mut().enumerate() {
                columns[index].push(found.map(|found| found[axis]));
            }
        }
        let Some(navigation) = navigation else {
            self.is_without_navigation = true;
            return;
        };
        // Latitude and longitude come first.
        let [_, _, solution @ ..] = navigation.errors();
        self.final_names.get_or_insert_with(|| solution.map(|(name, unit, _)| (name, unit)));
        for (column, (_, _, score)) in self.finals.iter_mut().zip(solution) {
            column.push(score.map(|score| score.r#final));
        }
    }

    /// Returns the errors of a parameter, by its place in [`NAMES`].
    pub(super) fn parameter(&self, index: usize) -> Option<&[f64]> {
        self.parameters.get(index)?.all()
    }

    /// Returns the errors of an axis, 0 latitude and 1 longitude, at a time by its place, arcmin.
    pub(super) fn drift(&self, axis: usize, time: usize) -> Option<&[f64]> {
        self.drift.get(axis)?.get(time)?.all()
    }

    /// Returns the final errors of attitude and velocity in their order. `None` where
    /// a run doesn't have it: results from before they were scored have none.
    pub(super) fn finals(&self) -> impl Iterator<Item = Option<FinalErrors<'_>>> {
        let names = self.final_names.filter(|_| !self.is_without_navigation);
        let columns = names.into_iter().flat_map(|names| names.into_iter().zip(&self.finals));
        columns
            .map(|((name, unit), column)| Some(FinalErrors { name, unit, values: column.all()? }))
    }
}

/// Returns the published calibration of a method, with the navigation after it.
fn of(summary: &Summary, method: Method) -> Option<(&CalibrationScore, Option<&NavigationScore>)> {
    let (calibration, navigation) = match method {
        Method::Primary => (&summary.calibration, &summary.navigation),
        Method::Baseline => {
            let baseline = summary.baseline.as_ref()?;
            (&baseline.calibration, &baseline.navigation)
        }
    };
    let calibration = calibration.as_ref().filter(|score| score.refused.is_none())?;
    Some((calibration, navigation.as_ref()))
}

/// Interpolates latitude and longitude error at a time between two points of a series.
fn at(navigation: &NavigationScore, hours: f64) -> Option<[f64; 2]> {
    let series = &navigation.series_hours;
    let after = series.partition_point(|point| point[0] < hours);
    let [to_h, to @ ..] = *series.get(after).or(series.last().filter(|p| p[0] >= hours - 1e-3))?;
    let [from_h, from @ ..] = *series.get(after.checked_sub(1)?)?;
    let part = if to_h > from_h { ((hours - from_h) / (to_h - from_h)).min(1.0) } else { 1.0 };
    Some([0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis])))
}
