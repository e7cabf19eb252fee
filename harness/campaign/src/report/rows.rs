//! Reads each case's result once, and keeps the parts that a report needs.

pub use super::curves::Curve;

use super::curves::{CurveFile, CurveWriter, StoredCurve};
use super::error::ReportError;
use crate::besides::besides;
use crate::case::CaseResult;
use crate::independence;
use crate::plan::{Case, Plan};
use crate::store::CampaignResults;
use octant_requirements::Verdict;
use octant_score::summary::{NavigationScore, Summary};
use octant_score::verdict::RequirementResult;
use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;

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
    /// Largest errors of attitude and velocity that were scored, with name and unit.
    pub solution: Box<[(&'static str, &'static str, f64)]>,
    /// Errors over time.
    pub curve: Option<StoredCurve>,
}

/// Rows of a plan.
#[derive(Debug)]
pub struct ReportRows<'a> {
    /// The rows.
    pub rows: Vec<ReportRow<'a>>,
    /// One hash of all results.
    pub results_blake3: String,
    /// The file of the drifts.
    pub(super) curves: Arc<CurveFile>,
}

/// Hashes all results of a plan up to `end`, without keeping any.
///
/// # Errors
/// If an existing result can't be read.
pub fn hash(plan: &Plan, results: &CampaignResults, end: usize) -> Result<String, ReportError> {
    let mut hasher = blake3::Hasher::new();
    for case in plan.cases.iter().take(end) {
        let hash = results.of_plan(plan, case)?.map_or_else(|| "-".to_owned(), |(_, hash)| hash);
        hasher.update(format!("{} {hash}\n", case.id).as_bytes());
    }
    Ok(hasher.finalize().to_hex().to_string())
}

/// Reads the rows of a plan up to `end`, and one hash of all results.
///
/// # Errors
/// If an existing result can't be read.
pub fn read<'a>(
    plan: &'a Plan,
    results: &CampaignResults,
    end: usize,
) -> Result<ReportRows<'a>, ReportError> {
    let mut hasher = blake3::Hasher::new();
    let mut rows = Vec::with_capacity(end);
    let mut curves = CurveWriter::new();
    let wrong = |source| ReportError::System {
        action: "keep the drifts of cases in",
        path: std::env::temp_dir(),
        source,
    };
    for case in plan.cases.iter().take(end) {
        let read = results.of_plan(plan, case)?;
        let Some((result, hash)) = read else {
            hasher.update(format!("{} -\n", case.id).as_bytes());
            rows.push(ReportRow { case, outcome: None });
            continue;
        };
        hasher.update(format!("{} {hash}\n", case.id).as_bytes());
        let differs = results.differing(&case.id)?.is_some();
        let outcome = RowOutcome::of(result, differs, &mut curves).map_err(wrong)?;
        rows.push(ReportRow { case, outcome: Some(outcome) });
    }
    curves.flush().map_err(wrong)?;
    let results_blake3 = hasher.finalize().to_hex().to_string();
    Ok(ReportRows { rows, results_blake3, curves: curves.file() })
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
    fn of(result: CaseResult, differs: bool, curves: &mut CurveWriter) -> io::Result<Self> {
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
        let Some(summary) = result.summary else { return Ok(outcome) };
        let Summary { reasons, requirements, faults, calibration, navigation, stream_hash, .. } =
            summary;
        outcome.reasons = reasons;
        outcome.checks = requirements;
        outcome.refused = calibration.and_then(|calibration| calibration.refused);
        outcome.unfired =
            faults.into_iter().filter(|fault| !fault.fired).map(|fault| fault.id).collect();
        outcome.stream_hash = Some(stream_hash);
        let drift = |navigation: &NavigationScore| CaseDrift::of(navigation, curves);
        outcome.drift = navigation.as_ref().map(drift).transpose()?;
        Ok(outcome)
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
    fn of(navigation: &NavigationScore, curves: &mut CurveWriter) -> io::Result<Self> {
        let radial = &navigation.radial_error_nmi;
        let marks = navigation.marks.iter().map(|(name, mark)| (name.clone(), mark.radial_nmi));
        // Latitude and longitude come first.
        let solution = navigation.errors().into_iter().skip(2);
        let curve = Curve::of(&navigation.series_hours);
        Ok(Self {
            solution: solution
                .filter_map(|(name, unit, score)| Some((name, unit, score?.max)))
                .collect(),
            duration_h: navigation.duration_h,
            final_nmi: radial.r#final,
            max_nmi: radial.max,
            rms_nmi: radial.rms,
            rate_nmi_per_h: radial.rate_per_h,
            marks_nmi: marks.collect(),
            curve: curve.map(|curve| curves.push(&curve)).transpose()?,
        })
    }
}
