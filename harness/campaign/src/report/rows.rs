//! Reads each case's result once, and keeps the parts that a report needs.

use super::error::ReportError;
use crate::besides::besides;
use crate::case::CaseResult;
use crate::independence;
use crate::plan::{Case, Plan};
use crate::store::CampaignResults;
use octant_requirements::Verdict;
use octant_score::summary::{NavigationScore, Summary};
use octant_score::verdict::RequirementResult;
use octant_statistics::envelope::resampled;
use std::collections::BTreeMap;

/// Maximum number of points of a drift.
const POINTS_MAX: f64 = 500.0;
/// Distances between points, s.
const STEPS_S: [f64; 14] =
    [0.1, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0, 7200.0, 21_600.0];

/// Case with its result.
#[derive(Clone, Debug)]
pub struct ReportRow<'a> {
    /// The case.
    pub case: &'a Case,
    /// Result; `None` if the case hasn't run.
    pub outcome: Option<RowOutcome>,
}

/// Result of a case.
#[derive(Clone, Debug)]
pub struct RowOutcome {
    /// Worst verdict of all parts.
    pub verdict: Verdict,
    /// Worst verdict of all parts except the requirements.
    pub besides: Verdict,
    /// Reason why there is no summary.
    pub error: Option<String>,
    /// Reasons for the verdict.
    pub reasons: Vec<String>,
    /// Checks of the case.
    pub checks: Vec<RequirementResult>,
    /// Reason why its calibration was refused.
    pub refused: Option<String>,
    /// Faults that never fired.
    pub unfired: Vec<String>,
    /// True if the case has two results.
    pub differs: bool,
    /// Hash of its streams.
    pub stream_hash: Option<String>,
    /// Drift; `None` without a navigation.
    pub drift: Option<CaseDrift>,
}

/// The drift of a case.
#[derive(Clone, Debug)]
pub struct CaseDrift {
    /// Length of the navigation, h.
    pub duration_h: f64,
    /// Radial error at its end, nmi.
    pub final_nmi: f64,
    /// Largest radial error, nmi.
    pub max_nmi: f64,
    /// Time-RMS, nmi.
    pub rms_nmi: f64,
    /// Rate, nmi/h.
    pub rate_nmi_per_h: f64,
    /// Radial error at the marks that it reached, nmi.
    pub marks_nmi: BTreeMap<String, f64>,
    /// Largest errors of attitude and velocity that were scored, by name and unit, such as
    /// "heading, arcmin".
    pub solution: BTreeMap<String, f64>,
    /// Errors over time.
    pub curve: Option<Curve>,
}

/// Errors over time, at whole multiples of a step from the start of the navigation.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The step, s: the same for navigations of the same length.
    pub step_s: f64,
    /// Latitude error, arcmin.
    pub latitude_arcmin: Vec<f64>,
    /// Longitude error, arcmin.
    pub longitude_arcmin: Vec<f64>,
}

/// Reads the rows of a plan up to `end`, and one hash of all results.
///
/// # Errors
/// If an existing result can't be read.
pub fn read<'a>(
    plan: &'a Plan,
    results: &CampaignResults,
    end: usize,
) -> Result<(Vec<ReportRow<'a>>, String), ReportError> {
    let mut hasher = blake3::Hasher::new();
    let mut rows = Vec::with_capacity(end);
    for case in plan.cases.iter().take(end) {
        let read = results.of_plan(plan, case)?;
        let Some((result, hash)) = read else {
            hasher.update(format!("{} -\n", case.id).as_bytes());
            rows.push(ReportRow { case, outcome: None });
            continue;
        };
        hasher.update(format!("{} {hash}\n", case.id).as_bytes());
        let differs = results.differing(&case.id)?.is_some();
        rows.push(ReportRow { case, outcome: Some(RowOutcome::of(result, differs)) });
    }
    Ok((rows, hasher.finalize().to_hex().to_string()))
}

/// Returns the independent draw of each row.
pub(super) fn draws(rows: &[ReportRow<'_>]) -> Vec<usize> {
    let stream =
        |row: &ReportRow<'_>| -> Option<String> { row.outcome.as_ref()?.stream_hash.clone() };
    let streams: Vec<Option<String>> = rows.iter().map(stream).collect();
    let cases = rows.iter().map(|row| row.case).zip(streams.iter().map(Option::as_deref));
    independence::draws(cases)
}

impl RowOutcome {
    fn of(result: CaseResult, differs: bool) -> Self {
        let besides = besides(&result);
        let (verdict, error) = (result.verdict, result.error);
        let mut outcome = Self {
            verdict,
            besides,
            error,
            reasons: Vec::new(),
            checks: Vec::new(),
            refused: None,
            unfired: Vec::new(),
            differs,
            stream_hash: None,
            drift: None,
        };
        let Some(summary) = result.summary else { return outcome };
        let Summary { reasons, requirements, faults, calibration, navigation, stream_hash, .. } =
            summary;
        outcome.reasons = reasons;
        outcome.checks = requirements;
        outcome.refused = calibration.and_then(|calibration| calibration.refused);
        outcome.unfired =
            faults.into_iter().filter(|fault| !fault.fired).map(|fault| fault.id).collect();
        outcome.stream_hash = Some(stream_hash);
        outcome.drift = navigation.as_ref().map(CaseDrift::of);
        outcome
    }

    /// Returns the verdict of a requirement: an error without a summary, inconclusive if it wasn't
    /// checked.
    #[must_use]
    pub fn check(&self, requirement: &str) -> Verdict {
        if self.error.is_some() || self.stream_hash.is_none() {
            return Verdict::Error;
        }
        let mut checks = self.checks.iter();
        let found = checks.find(|check| check.id == requirement);
        found.map_or(Verdict::Inconclusive, |check| check.verdict)
    }
}

impl CaseDrift {
    fn of(navigation: &NavigationScore) -> Self {
        let radial = &navigation.radial_error_nmi;
        let marks = navigation.marks.iter().map(|(name, mark)| (name.clone(), mark.radial_nmi));
        // Latitude and longitude come first.
        let solution = navigation.errors().into_iter().skip(2);
        Self {
            solution: solution
                .filter_map(|(name, unit, score)| Some((format!("{name}, {unit}"), score?.max)))
                .collect(),
            duration_h: navigation.duration_h,
            final_nmi: radial.r#final,
            max_nmi: radial.max,
            rms_nmi: radial.rms,
            rate_nmi_per_h: radial.rate_per_h,
            marks_nmi: marks.collect(),
            curve: Curve::of(&navigation.series_hours),
        }
    }
}

impl Curve {
    /// Interpolates the points of a drift, which differ from case to case, onto a common grid.
    // One copy, so that the self-test checks the one that reports use.
    #[inline(never)]
    pub fn of(series_hours: &[[f64; 3]]) -> Option<Self> {
        let (first, last) = (series_hours.first()?[0], series_hours.last()?[0]);
        // A series may begin with the first sample instead of before it.
        let duration_s = (last - first) * 3600.0;
        let step_s = STEPS_S.into_iter().find(|step| duration_s / step <= POINTS_MAX)?;
        // Times are rounded to a millionth of an hour.
        let points = libm::floor(duration_s / step_s + 0.01);
        let grid: Vec<f64> = (0..=points as u32)
            .map(|k| (first + f64::from(k) * step_s / 3600.0).min(last))
            .collect();
        let column = |column: usize| {
            let points: Vec<[f64; 2]> =
                series_hours.iter().map(|point| [point[0], point[column]]).collect();
            resampled(&points, &grid)
        };
        Some(Self { step_s, latitude_arcmin: column(1)?, longitude_arcmin: column(2)? })
    }
}
