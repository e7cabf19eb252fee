//! Errors of the cases of an ensemble: of each result only those that are compared.
//!
//! Mean and deviation take two passes. The first reads the results, and keeps the errors of each run in a temporary
//! file, as a campaign can have millions of them; the second reads that file.

use crate::execute::case::ResultError;
use crate::plan::Case;
use crate::store::CampaignResults;
use crate::store::in_plan_order::{RESULTS_AT_ONCE, read_in_order};
use crate::store::stream_key::StreamKey;
use octant_sample::further::{FURTHER_COUNT, FURTHER_NAMES};
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use octant_scenario::Method;
use octant_score::summary::{CalibrationScore, NavigationScore, Summary};
use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};

/// Number of columns of parameters and of further states.
const STATES: usize = PARAMETER_COUNT + FURTHER_COUNT;
/// Number of scored errors of attitude and velocity.
const SOLUTION: usize = 5;

/// Figures of one error over all runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ErrorFigures {
    /// Number of runs.
    pub(super) runs: usize,
    /// Mean; `None` without a run.
    pub(super) mean: Option<f64>,
    /// Standard deviation; `None` with less than two runs.
    pub(super) deviation: Option<f64>,
}

/// One error of all runs.
#[derive(Clone, Copy, Debug)]
struct ErrorColumn {
    sum: f64,
    /// Sum of the squared distances from the mean.
    squares: f64,
    /// True if a run doesn't have it.
    is_missing: bool,
}

/// Errors of the runs of a method with a published calibration.
///
/// The columns are those of the parameters, in the order of [`NAMES`], of the further states, in the order of
/// [`FURTHER_NAMES`], of latitude and of longitude at each of the
/// times, and the final ones of attitude and velocity.
#[derive(Debug)]
pub(super) struct MethodSample {
    method: Method,
    /// Times at which the drift is compared, h.
    hours: Vec<f64>,
    /// Number of runs.
    pub(super) runs: usize,
    columns: Vec<ErrorColumn>,
    /// Errors of each run, without a name; `None` before the first run.
    file: Option<BufWriter<File>>,
    /// Names and units of the final errors; `None` before the first navigation.
    final_names: Option<[(&'static str, &'static str); SOLUTION]>,
    /// True if a run has no navigation.
    is_without_navigation: bool,
}

/// Final errors of all runs.
#[derive(Clone, Copy, Debug)]
pub(super) struct FinalErrors {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) figures: ErrorFigures,
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

/// Errors of a run by a method.
#[derive(Debug)]
struct RunErrors {
    columns: Vec<Option<f64>>,
    final_names: Option<[(&'static str, &'static str); SOLUTION]>,
}

/// Contribution of a case to a sample.
enum CaseErrors {
    Open,
    Broken,
    /// Stream, and the errors by each of the methods; `None` without a published calibration.
    Run(StreamKey, Vec<Option<RunErrors>>),
}

/// Reads the results of cases one after another, and collects their errors for each of the methods.
pub(super) fn read<'p>(
    results: &CampaignResults,
    cases: &[u32],
    case: impl Fn(u32) -> Option<&'p Case> + Sync,
    methods: &mut [MethodSample],
) -> Result<SampleCounts, SampleError> {
    let mut counts = SampleCounts::default();
    let mut streams = HashSet::new();
    let forms: Vec<(Method, Vec<f64>)> =
        methods.iter().map(|method| (method.method, method.hours.clone())).collect();
    let read = |index: usize| -> Result<Option<CaseErrors>, SampleError> {
        let Some(case) = cases.get(index).and_then(|place| case(*place)) else { return Ok(None) };
        let Some((result, _)) = results.result(&case.id)? else {
            return Ok(Some(CaseErrors::Open));
        };
        let Some(summary) = &result.summary else { return Ok(Some(CaseErrors::Broken)) };
        let errors = forms.iter().map(|(method, hours)| RunErrors::of(summary, *method, hours));
        Ok(Some(CaseErrors::Run(summary.stream_hash.as_str().into(), errors.collect())))
    };
    read_in_order(cases.len(), RESULTS_AT_ONCE, read, |_, found| {
        match found {
            CaseErrors::Open => counts.open += 1,
            CaseErrors::Broken => counts.broken += 1,
            CaseErrors::Run(stream, _) if !streams.insert(stream) => counts.repeated += 1,
            CaseErrors::Run(_, errors) => {
                counts.summaries += 1;
                for (method, errors) in methods.iter_mut().zip(errors) {
                    if let Some(errors) = errors {
                        method.push(&errors).map_err(SampleError::Kept)?;
                    }
                }
            }
        }
        Ok(())
    })?;
    for method in methods {
        method.finish().map_err(SampleError::Kept)?;
    }
    Ok(counts)
}

/// Reasons why the errors of an ensemble can't be collected.
#[derive(Debug, thiserror::Error)]
pub(super) enum SampleError {
    /// A result can't be read.
    #[error(transparent)]
    Result(#[from] ResultError),
    /// The temporary file can't be written or read.
    #[error("keep the errors of an ensemble in a temporary file: {0}")]
    Kept(io::Error),
}

impl ErrorColumn {
    fn new() -> Self {
        // The sum of nothing, as the standard library has it.
        let nothing: f64 = std::iter::empty::<f64>().sum();
        Self { sum: nothing, squares: nothing, is_missing: false }
    }
}

impl RunErrors {
    /// Collects the errors of a run; `None` if its calibration was not published.
    fn of(summary: &Summary, method: Method, hours: &[f64]) -> Option<Self> {
        let (calibration, navigation) = of(summary, method)?;
        let parameter = |name: &&str| calibration.parameters.get(*name)?.error;
        let further = |name: &&str| calibration.further.get(*name)?.error;
        let mut columns: Vec<Option<f64>> =
            NAMES.iter().map(parameter).chain(FURTHER_NAMES.iter().map(further)).collect();
        let at_hours: Vec<Option<[f64; 2]>> =
            hours.iter().map(|hours| at(navigation?, *hours)).collect();
        for axis in 0..2 {
            columns.extend(at_hours.iter().map(|found| found.map(|found| found[axis])));
        }
        // Latitude and longitude come first.
        let solution = navigation.map(|navigation| {
            let [_, _, solution @ ..] = navigation.errors();
            solution
        });
        let r#final = |place: usize| Some(solution.as_ref()?.get(place)?.2?.r#final);
        columns.extend((0..SOLUTION).map(r#final));
        let final_names = solution.map(|solution| solution.map(|(name, unit, _)| (name, unit)));
        Some(Self { columns, final_names })
    }
}

impl MethodSample {
    /// Makes a sample without runs, whose drift is read at some times, h.
    pub(super) fn new(method: Method, hours: Vec<f64>) -> Self {
        let columns = vec![ErrorColumn::new(); STATES + 2 * hours.len() + SOLUTION];
        Self {
            method,
            hours,
            runs: 0,
            columns,
            file: None,
            final_names: None,
            is_without_navigation: false,
        }
    }

    /// Adds a run.
    fn push(&mut self, errors: &RunErrors) -> io::Result<()> {
        self.runs += 1;
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(BufWriter::new(tempfile::tempfile()?)),
        };
        for (column, value) in self.columns.iter_mut().zip(&errors.columns) {
            match value {
                Some(value) => column.sum += value,
                None => column.is_missing = true,
            }
            file.write_all(&value.unwrap_or(f64::NAN).to_le_bytes())?;
        }
        match errors.final_names {
            None => self.is_without_navigation = true,
            Some(names) => _ = self.final_names.get_or_insert(names),
        }
        Ok(())
    }

    /// Sums the squared distances from the means, after the last run.
    fn finish(&mut self) -> io::Result<()> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let mut file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.seek(SeekFrom::Start(0))?;
        let mut file = BufReader::new(file);
        let runs = self.runs as f64;
        for _ in 0..self.runs {
            for column in &mut self.columns {
                let mut value = [0; 8];
                file.read_exact(&mut value)?;
                let distance = f64::from_le_bytes(value) - column.sum / runs;
                column.squares += distance * distance;
            }
        }
        Ok(())
    }

    /// Returns the figures of a column; `None` if a run doesn't have it.
    fn figures(&self, column: usize) -> Option<ErrorFigures> {
        let column = self.columns.get(column).filter(|column| !column.is_missing)?;
        let runs = self.runs;
        Some(ErrorFigures {
            runs,
            mean: (runs > 0).then(|| column.sum / runs as f64),
            deviation: (runs > 1).then(|| libm::sqrt(column.squares / (runs - 1) as f64)),
        })
    }

    /// Returns the errors of a parameter, by its place in [`NAMES`], or of a further state after those, by its place in
    /// [`FURTHER_NAMES`].
    pub(super) fn state(&self, index: usize) -> Option<ErrorFigures> {
        self.figures(Some(index).filter(|index| *index < STATES)?)
    }

    /// Returns the errors of an axis, 0 latitude and 1 longitude, at a time by its place, arcmin.
    pub(super) fn drift(&self, axis: usize, time: usize) -> Option<ErrorFigures> {
        let time = Some(time).filter(|time| *time < self.hours.len())?;
        self.figures(STATES + axis * self.hours.len() + time)
    }

    /// Returns the final errors of attitude and velocity in their order. `None` where
    /// a run doesn't have it: results from before they were scored have none.
    pub(super) fn finals(&self) -> impl Iterator<Item = Option<FinalErrors>> {
        let names = self.final_names.filter(|_| !self.is_without_navigation);
        let first = STATES + 2 * self.hours.len();
        let all = names.into_iter().flatten().enumerate();
        all.map(move |(place, (name, unit))| {
            Some(FinalErrors { name, unit, figures: self.figures(first + place)? })
        })
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
