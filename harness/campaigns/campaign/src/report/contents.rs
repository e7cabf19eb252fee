//! Contents of a report: numbers, discrepancies and texts, from the plan of a campaign and its
//! results.

use super::combination::Combination;
use super::envelope::ShownEnvelope;
use super::error::ReportError;
use super::figures::{CombinationFigures, OutlierFigures, ScenarioFigures};
use super::requirement::RequirementFigures;
use super::rows::ReportRows;
use super::selftest::SelfTest;
use super::units::CampaignUnits;
use super::{about, discrepancy, figures, makers, requirement, rows, selftest, tables};
use crate::against::{Against, Selection, against_by};
use crate::execute::{Shard, refuse_foreign};
use crate::journal::{Journal, JournalEntry};
use crate::judge::looks::LookState;
use crate::judge::status::{self, CampaignStatus, JointStatement, StatusError};
use crate::judge::trace::{first_by, take_verdicts};
use crate::plan::Plan;
use crate::store::CampaignResults;
use octant_account::Account;
use octant_base::display::UnitChoice;
use octant_evidence::discrepancy::Discrepancy;
use octant_evidence::disposition::{self, Dispositions};
use octant_evidence::maker::MadeBy;
use octant_evidence::manifest::shell_line;
use octant_verdict::Verdict;
use octant_verdict::requirement::Requirements;
use octant_verdict::trace::CampaignTrace;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::SystemTime;

/// Version of `statistics.json`.
pub const SCHEMA: u32 = 1;
/// Maximum number of reasons listed.
const REASONS_MAX: usize = 12;
/// Maximum number of rows of a table on the page, and of traced cases of a requirement; the rest is in
/// separate files.
pub const ROWS_MAX: usize = 2000;

/// Counting rule of cases: the same here, in `[stop]`, in comparisons and in nights.
pub const POLICY: &str = "The unit is the independent draw, an instrument with its noise: all cases of a \
    seed are one draw, and so are cases with the same stream. A draw passes a requirement if all of its \
    checks pass. A calibration that was refused, a check that came to nothing and an error count as not \
    passed; in percentiles such a case is beyond every number, and a figure that falls on one is not \
    defined. Cases that have not run are told and count as nothing.";

/// Numbers over the cases: `statistics.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statistics {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Name of the campaign.
    pub title: String,
    /// Plan.
    pub plan: String,
    /// Overall verdict.
    pub verdict: Verdict,
    /// BLAKE3 over all results, in the order of the plan.
    pub results_blake3: String,
    /// Cases that count.
    pub cases: usize,
    /// Independent draws among them, on which every bound is based.
    pub draws: usize,
    /// Counting rule of cases, as text.
    pub policy: &'static str,
    /// Cases without a result.
    pub open: usize,
    /// Cases by verdict.
    pub verdicts: BTreeMap<&'static str, usize>,
    /// Confidence of all intervals, two-sided.
    pub confidence: f64,
    /// Requirements that runs verify.
    pub requirements: Vec<RequirementFigures>,
    /// The scenarios.
    pub scenarios: Vec<ScenarioFigures>,
    /// Combinations with the factors of the grid.
    pub combinations: Vec<CombinationFigures>,
    /// Statement on all requirements together; null where none asks for a probability.
    pub joint: Option<JointStatement>,
    /// Seed, and where it comes from.
    pub seed: String,
    /// Looks at the results.
    pub looks: LookState,
    /// Cases that stand out from their combination.
    pub outliers: Vec<OutlierFigures>,
    /// Discrepancies with their dispositions.
    pub discrepancies: Vec<Discrepancy>,
    /// Accounts of what came in: the results of the cases, whichever host they came from.
    pub inputs: Vec<Account>,
}

/// Predicts the ensembles by linear theory, and compares them with the cases. This needs the files
/// of the scenarios, which a folder copied from elsewhere lacks.
fn predicted(plan: &Plan, results: &CampaignResults) -> Against {
    if plan.cases.is_empty() {
        return Against::default();
    }
    against_by(plan, results, &Selection::default())
        .unwrap_or_else(|error| Against { left_out: vec![error.to_string()], ..Against::default() })
}

/// Content of a report.
#[derive(Debug)]
pub struct CampaignReport<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// Name of the folder: command lines are relative to the one above it.
    pub name: String,
    /// Progress of the campaign.
    pub status: CampaignStatus,
    /// Numbers over the cases.
    pub statistics: Statistics,
    /// Predicted ensembles, compared with the cases.
    pub prediction: Against,
    /// The cases.
    pub rows: ReportRows<'a>,
    /// Combinations of the cases, as in the statistics.
    pub combinations: Vec<Combination>,
    /// Dispositions of the discrepancies.
    pub dispositions: Dispositions,
    /// Texts of the requirements.
    pub about: Requirements,
    /// Trace from requirements to their first cases and back.
    pub trace: CampaignTrace,
    /// Makers of the results.
    pub made_by: Vec<MadeBy>,
    /// The self-test of the program.
    pub selftest: Option<SelfTest>,
    /// Notes about missing parts.
    pub notes: Vec<String>,
    /// Merged tables with their BLAKE3.
    pub tables: Vec<(String, String)>,
    /// Units of errors on the page.
    pub units: CampaignUnits,
    /// Times at which the first and the last result were stored.
    pub run_between: [Option<SystemTime>; 2],
    /// Events of the campaign: plans, looks, repetitions, restrictions.
    pub journal: Vec<JournalEntry>,
    /// Key that will sign the manifest.
    pub signature: Option<String>,
    /// Independent draw of each case.
    draws: Vec<u32>,
}

/// Describes what the journal has that a claim has to be read with, and where it contradicts the folder.
fn journal_findings(
    plan: &Plan,
    journal: &Journal,
    taken_back: u64,
    (results, first_result): (usize, Option<SystemTime>),
) -> Vec<String> {
    let mut found = match journal.is_there {
        true => journal.contradictions(&plan.id, taken_back, first_result),
        false => Vec::new(),
    };
    if plan.has_claims() {
        found.extend(journal.doubts(results));
    }
    found
}

/// Checks that the rows and their drifts could be read.
fn check(rows: &ReportRows<'_>) -> Result<(), ReportError> {
    let path = std::env::temp_dir();
    let wrong =
        |source| ReportError::System { action: "read the results of cases from", path, source };
    rows.error().map_or(Ok(()), |source| Err(wrong(source)))
}

/// Returns the times at which the first and the last result were stored.
fn run_between(rows: &ReportRows<'_>, results: &CampaignResults) -> [Option<SystemTime>; 2] {
    let cases = (0..rows.len()).filter(|place| rows.has_run(*place));
    let times = cases.filter_map(|place| results.time(&rows.case(place)?.id));
    let (mut first, mut last): (Option<SystemTime>, Option<SystemTime>) = (None, None);
    for time in times {
        first = Some(first.map_or(time, |first| first.min(time)));
        last = last.max(Some(time));
    }
    [first, last]
}

impl<'a> CampaignReport<'a> {
    /// Builds the report of a campaign, from its plan and the results in its folder.
    ///
    /// # Errors
    /// If something in the folder can't be read, or isn't of the plan.
    pub fn of(plan: &'a Plan, folder: &Path) -> Result<Self, ReportError> {
        let results = CampaignResults::open(folder)?;
        refuse_foreign(plan, folder, &results)?;
        let dispositions = Dispositions::read(&folder.join(disposition::FILE_NAME))?;
        let result = |StatusError(error)| ReportError::Result(error);
        let status = status::of_results(plan, &results, Shard::WHOLE).map_err(result)?;
        let end = match &plan.stop {
            Some(rule) => {
                status::decide_by(plan, &results, rule).map_err(result)?.end(plan.cases.len())
            }
            None => plan.cases.len(),
        };
        let (rows, results_blake3) = rows::read(plan, &results, end)?;
        let draws = rows::draws(&rows);
        let (combinations, grid) = figures::combinations(plan, end);
        let (about, notes) = about::requirements(plan);
        let mut trace = first_by(plan, &about, &results, &draws, ROWS_MAX)?;
        take_verdicts(&mut trace, &status);
        let run = (0..rows.len()).filter(|place| rows.has_run(*place)).count();
        let (tables, mut wrong) = tables::look(plan, folder, &results, run)?;
        let run_between = run_between(&rows, &results);
        let prediction = predicted(plan, &results);
        let inputs = vec![results.account(plan, end)?];
        let made_by = results.made_by(plan, end);
        let (journal, taken_back) = (results.journal.clone(), results.taken_back());
        // The figures need the rows alone, and most of the memory.
        drop(results);
        let selftest = selftest::read(folder).unwrap_or_else(|reason| {
            wrong.push(reason);
            None
        });
        if let Some(test) = selftest.as_ref().filter(|test| test.verdict != Verdict::Pass) {
            wrong.push(format!("the self-test of the program came to {}", test.verdict.name()));
        }
        wrong.extend(makers::wrong(&made_by, selftest.as_ref()));
        wrong.extend(journal_findings(plan, &journal, taken_back, (run, run_between[0])));
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
            requirements: requirement::of(plan, &status, &about, &combinations, &rows, &draws),
            scenarios: (plan.scenarios.iter())
                .map(|scenario| ScenarioFigures::of(&scenario.id, &grid, &combinations, &rows))
                .collect(),
            combinations: of_combinations,
            joint: status.joint.clone(),
            seed: plan.seed_in_words(),
            looks: status.looks.clone(),
            outliers: figures::standing_out(&combinations, &rows),
            discrepancies: discrepancy::find(plan, &status, &combinations, &rows, &wrong),
            inputs,
        };
        check(&rows)?;
        let absolute = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        let name = absolute.file_name().map_or(".".into(), |name| name.to_string_lossy());
        let name = name.into_owned();
        Ok(Self {
            plan,
            name,
            status,
            statistics,
            prediction,
            rows,
            combinations,
            dispositions,
            about,
            trace,
            made_by,
            selftest,
            notes,
            tables,
            units: CampaignUnits::of(plan, folder),
            run_between,
            journal: journal.entries,
            signature: None,
            draws,
        })
    }

    /// Checks that the rows of all cases, and their drifts, could be read each time.
    ///
    /// # Errors
    /// If the temporary files that hold them could not be read.
    pub fn check(&self) -> Result<(), ReportError> {
        check(&self.rows)
    }

    /// Reads the journal of the folder again, after a look was noted.
    ///
    /// # Errors
    /// If it can't be read.
    pub fn reread_journal(&mut self, folder: &Path) -> Result<(), ReportError> {
        let journal = Journal::read(folder).map_err(crate::execute::case::ResultError::from)?;
        self.journal = journal.entries;
        Ok(())
    }

    /// Chooses units of errors on the page, in place of the scenarios'. Files for machines keep theirs.
    ///
    /// # Errors
    /// If positions are to be distances, and the sites of the cases aren't known.
    pub fn show_in(&mut self, choice: UnitChoice) -> Result<(), ReportError> {
        self.units.choose(choice)
    }

    /// Percentiles of the errors over time of a combination, by its place, in units of the page.
    #[must_use]
    pub fn envelope(&self, combination: usize) -> Option<ShownEnvelope> {
        if !self.units.shown().position.is_distance() {
            let figures = self.statistics.combinations.get(combination)?;
            return figures.envelope.as_ref().map(ShownEnvelope::from);
        }
        let combination = self.combinations.get(combination)?;
        figures::envelope_in(combination, &self.rows, &self.draws, |case| {
            let units = self.units.at(case);
            [units.latitude().factor, units.longitude().factor]
        })
    }

    /// Returns the number of discrepancies without a disposition.
    #[must_use]
    pub fn open(&self) -> usize {
        self.dispositions.open(&self.statistics.discrepancies).count()
    }

    /// Lists the entries whose discrepancy doesn't occur any more.
    #[must_use]
    pub fn gone(&self) -> Vec<&disposition::DispositionEntry> {
        self.dispositions.gone(&self.statistics.discrepancies)
    }

    /// Returns the reasons for the verdict.
    #[must_use]
    pub fn reasons(&self) -> Vec<String> {
        if self.statistics.verdict == Verdict::Pass {
            let count = self.statistics.requirements.len();
            return vec![format!("{count} of {count} requirements are shown by their cases")];
        }
        // A failed check is part of its requirement's reason.
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

    /// Returns the command lines that make the campaign again, in the folder above its own.
    #[must_use]
    pub fn again(&self) -> Vec<Vec<String>> {
        let line = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        let campaign = self.plan.campaign.display().to_string();
        let name = self.name.as_str();
        let mut report = line(&["octant", "campaign", "report", name]);
        if let Some(chosen) = self.units.chosen() {
            report.extend(["--units".to_owned(), chosen.to_string()]);
        }
        let first = match self.plan.bundled {
            Some(_) => line(&["octant", "campaign", "unbundle", "BUNDLE", name]),
            None => line(&["octant", "campaign", "plan", &campaign, "--out", name]),
        };
        vec![
            first,
            line(&["octant", "campaign", "run", name]),
            line(&["octant", "campaign", "merge", name]),
            report,
        ]
    }

    /// Returns the command line that runs a case again, with all the evidence of a run.
    #[must_use]
    pub fn case_again(&self, case: &str) -> String {
        let words = ["octant", "campaign", "case", &self.name, case];
        shell_line(&words.map(str::to_owned))
    }

    /// Returns the bytes of `statistics.json`.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn statistics_json(&self) -> Result<String, ReportError> {
        json("statistics.json", &self.statistics)
    }

    /// Returns the bytes of `prediction.json`.
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

/// Returns the command line that makes the campaign again.
pub fn again(report: &CampaignReport<'_>) -> String {
    let lines: Vec<String> = report.again().iter().map(|words| shell_line(words)).collect();
    lines.join(" && ")
}
