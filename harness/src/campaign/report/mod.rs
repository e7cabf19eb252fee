//! What the cases of a campaign show together: numbers, discrepancies, and the evidence of both.
//!
//! [`rows`] reads the results, [`combination`] sorts them, [`figures`] and [`requirement`] are their
//! statistics, [`discrepancy`] what isn't a pass, [`disposition`] what people say of that. [`evidence`]
//! writes all of it into the folder of the campaign. The page is [`crate::report::campaign`].

mod about;
pub mod combination;
pub mod discrepancy;
pub mod evidence;
pub mod figures;
pub mod junit;
pub mod requirement;
pub mod rows;
pub mod selftest;
mod tables;

use super::execute::{ExecuteError, Shard, refuse_foreign};
use super::plan::{Plan, PlanError};
use super::status::{self, Status};
use super::trace::trace;
use crate::evidence::ManifestError;
use crate::evidence::discrepancy::Discrepancy;
use crate::evidence::disposition::{self, DispositionError, Dispositions};
use crate::observe::against::{Against, Selection, against};
use combination::Combination;
use figures::{CombinationFigures, OutlierFigures, ScenarioFigures};
use octant_requirements::Verdict;
use octant_requirements::requirement::Requirements;
use octant_requirements::trace::Trace;
use requirement::RequirementFigures;
use rows::Row;
use selftest::SelfTest;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Version of `statistics.json`.
pub const SCHEMA: u32 = 1;
/// Reasons that are told at most.
const REASONS_MAX: usize = 12;

/// How cases are counted: the same here, in `[stop]`, in comparisons and in nights.
pub const POLICY: &str = "The unit is the independent draw, an instrument with its noise: all cases of a \
    seed are one draw, and so are cases with the same stream. A draw passes a requirement if all of its \
    checks pass. A calibration that was refused, a check that came to nothing and an error count as not \
    passed; in percentiles such a case is beyond every number, and a figure that falls on one is not \
    defined. Cases that have not run are told and count as nothing.";

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The plan isn't right.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The folder has results of another plan.
    #[error(transparent)]
    Foreign(#[from] ExecuteError),
    /// A result can't be read.
    #[error("{0}")]
    Result(String),
    /// A file can't be read or written.
    #[error("{action} {path}: {source}")]
    System {
        /// What was tried.
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file isn't what it should be.
    #[error("read {path}: {reason}")]
    Form {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The results can't be written in a format.
    #[error("write {what}: {reason}")]
    Format {
        /// What was to be written.
        what: &'static str,
        /// Why it can't be.
        reason: String,
    },
    /// What people say of the discrepancies can't be read.
    #[error(transparent)]
    Dispositions(#[from] DispositionError),
    /// The manifest can't be written.
    #[error(transparent)]
    Manifest(#[from] ManifestError),
}

/// What the cases show, as numbers: `statistics.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statistics {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Name of the campaign.
    pub title: String,
    /// Its plan.
    pub plan: String,
    /// What it comes to.
    pub verdict: Verdict,
    /// BLAKE3 over all results, in the order of the plan.
    pub results_blake3: String,
    /// Cases that count.
    pub cases: usize,
    /// Independent draws among them: what every bound rests on.
    pub draws: usize,
    /// How cases are counted, in words.
    pub policy: &'static str,
    /// Those without a result.
    pub open: usize,
    /// Cases by verdict.
    pub verdicts: BTreeMap<&'static str, usize>,
    /// Confidence of all intervals, two-sided.
    pub confidence: f64,
    /// Requirements that runs verify.
    pub requirements: Vec<RequirementFigures>,
    /// The scenarios.
    pub scenarios: Vec<ScenarioFigures>,
    /// Their combinations with the factors of the grid.
    pub combinations: Vec<CombinationFigures>,
    /// Cases that stand out from their combination.
    pub outliers: Vec<OutlierFigures>,
    /// Discrepancies, and what became of them.
    pub discrepancies: Vec<Discrepancy>,
}

/// The ensembles that linear theory predicts, held against the cases. It takes the files of the scenarios,
/// which a folder that was brought from elsewhere hasn't.
fn predicted(plan: &Plan, folder: &Path) -> Against {
    if plan.cases.is_empty() {
        return Against::default();
    }
    against(plan, folder, &Selection::default())
        .unwrap_or_else(|reason| Against { left_out: vec![reason], ..Against::default() })
}

/// Everything that a report shows.
#[derive(Clone, Debug)]
pub struct Report<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// Name of the folder: the lines that run something again are for the one above it.
    pub name: String,
    /// How far it is.
    pub status: Status,
    /// What the cases show.
    pub statistics: Statistics,
    /// The ensembles that linear theory predicts, held against the cases.
    pub prediction: Against,
    /// The cases.
    pub rows: Vec<Row<'a>>,
    /// Their combinations, as in the statistics.
    pub combinations: Vec<Combination>,
    /// What is said of the discrepancies.
    pub dispositions: Dispositions,
    /// What the requirements say.
    pub about: Requirements,
    /// From requirements to cases and back.
    pub trace: Trace,
    /// The self-test of the program.
    pub selftest: Option<SelfTest>,
    /// What isn't there that would be good to have.
    pub notes: Vec<String>,
    /// Merged tables with their BLAKE3.
    pub tables: Vec<(String, String)>,
}

impl<'a> Report<'a> {
    /// The report of a campaign, from its plan and the results in its folder.
    ///
    /// # Errors
    /// If something in the folder can't be read, or isn't of the plan.
    pub fn of(plan: &'a Plan, folder: &Path) -> Result<Self, ReportError> {
        refuse_foreign(plan, folder)?;
        let dispositions = Dispositions::read(&folder.join(disposition::FILE_NAME))?;
        // Its message begins with "failed to".
        let words = |reason: String| {
            let reason = reason.strip_prefix("failed to ").unwrap_or(&reason);
            ReportError::Result(reason.to_owned())
        };
        let status = status::of(plan, folder, Shard::WHOLE).map_err(words)?;
        let end = match &plan.stop {
            Some(rule) => status::decide(plan, folder, rule).map_err(words)?.end(plan.cases.len()),
            None => plan.cases.len(),
        };
        let (rows, results_blake3) = rows::read(plan, folder, end)?;
        let (combinations, grid) = figures::combinations(plan, end);
        let (about, notes) = about::requirements(plan);
        let trace = trace(plan, &about, folder, end).map_err(words)?;
        let run = rows.iter().filter(|row| row.outcome.is_some()).count();
        let (tables, mut wrong) = tables::look(plan, folder, run)?;
        let selftest = selftest::read(folder).unwrap_or_else(|reason| {
            wrong.push(reason);
            None
        });
        if let Some(test) = selftest.as_ref().filter(|test| test.verdict != Verdict::Pass) {
            wrong.push(format!("the self-test of the program came to {}", test.verdict.name()));
        }
        let draws = rows::draws(&rows);
        let mut of_combinations: Vec<CombinationFigures> = combinations
            .iter()
            .map(|combination| CombinationFigures::of(plan, &grid, combination, &rows, &draws))
            .collect();
        figures::mark(&mut of_combinations);
        let statistics = Statistics {
            schema: SCHEMA,
            title: plan.title.clone(),
            plan: plan.id.clone(),
            verdict: status.verdict(),
            results_blake3,
            cases: status.cases,
            draws: status.draws,
            policy: POLICY,
            open: status.open,
            verdicts: status.verdicts.clone(),
            confidence: figures::CONFIDENCE,
            requirements: requirement::of(plan, &status, &about, &combinations, &rows),
            scenarios: (plan.scenarios.iter())
                .map(|scenario| ScenarioFigures::of(&scenario.id, &grid, &combinations, &rows))
                .collect(),
            combinations: of_combinations,
            outliers: figures::standing_out(&combinations, &rows),
            discrepancies: discrepancy::find(plan, &status, &combinations, &rows, &wrong),
        };
        let absolute = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        let name = absolute.file_name().map_or(".".into(), |name| name.to_string_lossy());
        let name = name.into_owned();
        Ok(Self {
            plan,
            name,
            status,
            statistics,
            prediction: predicted(plan, folder),
            rows,
            combinations,
            dispositions,
            about,
            trace,
            selftest,
            notes,
            tables,
        })
    }

    /// Discrepancies of which nothing is said yet.
    #[must_use]
    pub fn open(&self) -> usize {
        self.dispositions.open(&self.statistics.discrepancies).count()
    }

    /// Entries whose discrepancy doesn't occur any more.
    #[must_use]
    pub fn gone(&self) -> Vec<&disposition::Entry> {
        self.dispositions.gone(&self.statistics.discrepancies)
    }

    /// Why the verdict is what it is.
    #[must_use]
    pub fn reasons(&self) -> Vec<String> {
        if self.statistics.verdict == Verdict::Pass {
            let count = self.statistics.requirements.len();
            return vec![format!("{count} of {count} requirements are shown by their cases")];
        }
        // A check that failed counts in its requirement.
        let mut all: Vec<String> = (self.statistics.discrepancies.iter())
            .filter(|found| !["check", "evidence"].contains(&found.kind))
            .map(|found| found.what.clone())
            .collect();
        let more = all.len().saturating_sub(REASONS_MAX);
        all.truncate(REASONS_MAX);
        if more > 0 {
            all.push(format!("and {more} more discrepancies"));
        }
        all
    }

    /// The lines that make the campaign again, in the folder above its own.
    #[must_use]
    pub fn again(&self) -> Vec<Vec<String>> {
        let line = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
        let campaign = self.plan.campaign.display().to_string();
        let name = self.name.as_str();
        vec![
            line(&["octant", "campaign", "plan", &campaign, "--out", name]),
            line(&["octant", "campaign", "run", name]),
            line(&["octant", "campaign", "merge", name]),
            line(&["octant", "campaign", "report", name]),
        ]
    }

    /// The line that runs a case again, with all the evidence of a run.
    #[must_use]
    pub fn case_again(&self, case: &str) -> String {
        let words = ["octant", "campaign", "case", &self.name, case];
        crate::evidence::manifest::shell_line(&words.map(str::to_owned))
    }

    /// The bytes of `statistics.json`.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn statistics_json(&self) -> Result<String, ReportError> {
        json("statistics.json", &self.statistics)
    }

    /// The bytes of `prediction.json`.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn prediction_json(&self) -> Result<String, ReportError> {
        json("prediction.json", &self.prediction)
    }
}

fn json(what: &'static str, value: &impl Serialize) -> Result<String, ReportError> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| ReportError::Format { what, reason: error.to_string() })?;
    Ok(octant_score::summary::rows_on_one_line(&text) + "\n")
}
