//! `octant campaign`: many cases of scenarios, planned, run anywhere, merged.

mod bundle;
mod countersign;
mod emit;
mod merge;
mod planned;
mod report;
pub(super) mod run;

use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::place::{CampaignPlace, Needs};
use crate::progress_bar::ProgressBar;
use crate::terminal::{print, print_json, write};
use clap::{Args, Subcommand};
use octant_base::number::counted;
use octant_campaign::execute::{ExecuteError, Shard};
use octant_campaign::journal::{Journal, JournalError, JournalEvent};
use octant_campaign::judge::shown::note_look;
use octant_campaign::judge::status;
use octant_campaign::judge::trace::{requirements_of, take_verdicts, with_those_of_scenarios};
use octant_campaign::plan::looks::LookWay;
use octant_campaign::plan::progress::PlanStage;
use octant_campaign::plan::{Case, FILE_NAME, Plan, PlanError, PlanWritten};
use octant_campaign::store::CampaignResults;
use octant_verdict::Verdict;
use octant_verdict::trace::{TraceRow, UnknownRequirement};
use planned::read;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Plan the cases of a campaign, and check them.
    Plan {
        /// The campaign, a TOML file.
        #[arg(value_name = "CAMPAIGN")]
        campaign: PathBuf,
        /// Folder for the plan and the results; by default in runs/, named after the file.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Replace the plan in the folder by one that contains all of its cases; the results stay.
        #[arg(long)]
        extend: bool,
    },
    /// Run the cases that have no result yet, in processes of their own.
    Run(run::Arguments),
    /// Print the progress of a campaign, and its failures.
    Status {
        /// Folder of the campaign, or its address on object storage.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
    /// Merge the parts of all shards into cases.parquet, checks.parquet and drift.parquet.
    Merge {
        /// Folder of the campaign, or its address on object storage.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Further folders with parts of the same plan, from other hosts.
        #[arg(value_name = "OTHER")]
        others: Vec<PathBuf>,
    },
    /// Trace the requirements of the campaign and of its scenarios to cases and results, and back.
    Trace {
        /// Folder of the campaign, or its address on object storage.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// New folder for a StrictDoc project.
        #[arg(long, value_name = "DIR")]
        strictdoc: Option<PathBuf>,
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
    /// Write the report, statistics, discrepancies and JUnit of the results, and the manifest of the folder.
    Report(report::Arguments),
    /// Sign the dispositions of a reported campaign as the second person, with the key of OCTANT_SIGNING_KEY.
    Countersign {
        /// Folder of the campaign, or its address on object storage.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Run one case again, with all the evidence of a run.
    Case {
        /// Folder of the campaign, or its address on object storage.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Id of the case.
        #[arg(value_name = "CASE")]
        case: String,
        /// Folder of the run; by default in runs/, named after the case.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Write the plan of a campaign, with every file that its cases need, as one file.
    Bundle {
        /// Folder of the campaign, or its address on object storage.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// The bundle, a new file; or an address on object storage for the campaign, s3://BUCKET/PREFIX.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Make the folder of a campaign from a bundle, and check every file.
    Unbundle {
        /// The bundle; or the address of a campaign on object storage, whose results, tables and report come too.
        #[arg(value_name = "FILE")]
        bundle: PathBuf,
        /// New folder of the campaign.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Print the job file with which a scheduler runs a campaign; nothing is submitted.
    Emit(emit::Arguments),
    /// Print the stored result of one case: the JSON object of its verdict and summary.
    Result {
        /// Folder of the campaign, or its address on object storage.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Id of the case.
        #[arg(value_name = "CASE")]
        case: String,
    },
    /// Process that runs cases, started by `run`: reads a case on each line of standard input.
    #[command(hide = true)]
    Work,
}

pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let Arguments { command } = arguments;
    match command {
        Command::Plan { campaign, out, extend } => plan(campaign, out.as_deref(), *extend),
        Command::Run(arguments) => run::command(arguments, given),
        Command::Status { folder, json } => {
            let place = CampaignPlace::of(folder, Needs::Results)?;
            let folder = place.folder();
            let (plan, found) = status::of_folder(folder, || read(folder))?;
            let status = found.map_err(Failure::bench)?;
            if plan.has_claims() && status.looks.is_due {
                note_look(&plan, folder, &status, "octant campaign status")?;
            }
            let status = status.shown();
            if *json {
                print_json(&status)?
            } else {
                print(&status.text())?
            }
            Ok(status.verdict())
        }
        Command::Merge { folder, others } => merge::command(folder, others),
        Command::Trace { folder, strictdoc, json } => trace(folder, strictdoc.as_deref(), *json),
        Command::Report(arguments) => report::command(arguments),
        Command::Countersign { folder } => countersign::command(folder),
        Command::Case { folder, case, out } => again(folder, case, out.as_deref()),
        Command::Bundle { folder, out } => bundle::bundle(folder, out),
        Command::Unbundle { bundle, folder } => bundle::unbundle(bundle, folder),
        Command::Emit(arguments) => emit::command(arguments, given),
        Command::Result { folder, case } => result(folder, case),
        Command::Work => work(),
    }
}

impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        let failure = Self::of(&error);
        match error {
            // The place comes first.
            PlanError::File(_) | PlanError::Requirements(_) => failure,
            PlanError::Journal(error) => error.into(),
            PlanError::System { .. } | PlanError::Contradiction { .. } | PlanError::Form { .. } => {
                failure.failed()
            }
        }
    }
}

impl From<JournalError> for Failure {
    fn from(error: JournalError) -> Self {
        Self::of(&error).failed()
    }
}

impl From<ExecuteError> for Failure {
    fn from(error: ExecuteError) -> Self {
        let failure = Self::of(&error);
        match error {
            ExecuteError::Plan(error) => error.into(),
            ExecuteError::NotKept(_) | ExecuteError::Result(_) => failure,
            ExecuteError::Journal(error) => error.into(),
            ExecuteError::Foreign { .. }
            | ExecuteError::Running { .. }
            | ExecuteError::Ended { .. }
            | ExecuteError::System { .. }
            | ExecuteError::Part(_) => failure.failed(),
        }
    }
}

fn plan(campaign: &Path, out: Option<&Path>, extend: bool) -> Result<Verdict, Failure> {
    let bar = ProgressBar::new(None, |progress| progress.message.clone());
    let tell = |stage: PlanStage, done: usize, total: usize| {
        bar.update(|progress| {
            (progress.done, progress.total) = (done as u64, Some(total as u64));
            progress.message = format!("{done} of {total}, {}", stage.words());
        });
    };
    let plan = Plan::of_told(campaign, &tell);
    bar.finish();
    let plan = plan?;
    let stem = campaign.file_stem().map_or("campaign".into(), |stem| stem.to_string_lossy());
    let folder = out.map_or_else(|| Path::new("runs").join(stem.as_ref()), Path::to_owned);
    bar.update(|progress| {
        progress.total = None;
        progress.message = format!("writing {}", folder.join(FILE_NAME).display());
    });
    let written = plan.write(&folder, extend);
    bar.finish();
    let written = written?;
    let what = match written {
        PlanWritten::New => String::new(),
        PlanWritten::There => ", in a plan that exists already".to_owned(),
        PlanWritten::Extended(new) => format!(", {new} of them new"),
    };
    print(&format!(
        "{}{what}\n{}{}\n",
        counted(plan.cases.len(), "case", "cases"),
        said_of_looks(&plan, &folder)?,
        folder.join(FILE_NAME).display()
    ))?;
    Ok(Verdict::Pass)
}

/// Describes the seed of a plan, and the looks at its results with their price.
fn said_of_looks(plan: &Plan, folder: &Path) -> Result<String, Failure> {
    let mut text = plan.seed_in_words() + "\n";
    if !plan.has_claims() {
        return Ok(text);
    }
    text += &plan.looks_in_words();
    let first = Journal::read(folder)?.cases_at_first_look();
    let is_fixed = plan.look_way(plan.cases.len()) != LookWay::Open;
    if let Some(first) = first.filter(|first| *first < plan.cases.len() && is_fixed) {
        text += &format!(
            "the first look was at {first} cases: the {} further ones are nominal, no part of a claim\n",
            plan.cases.len() - first
        );
    }
    Ok(text)
}

fn trace(folder: &Path, strictdoc: Option<&Path>, json: bool) -> Result<Verdict, Failure> {
    let place = CampaignPlace::of(folder, Needs::Results)?;
    let folder = place.folder();
    let plan = read(folder)?;
    let requirements = with_those_of_scenarios(&plan, &requirements_of(&plan)?);
    // The campaign's verdict is computed in one place: a case may fail in parts that no requirement
    // checks.
    let status = status::of(&plan, folder, Shard::WHOLE).map_err(Failure::bench)?;
    if plan.has_claims() {
        note_look(&plan, folder, &status, "octant campaign trace")?;
    }
    let mut trace =
        octant_campaign::judge::trace::trace(&plan, &requirements, folder, status.cases)
            .map_err(|reason| Failure::bench(format!("failed to {reason}")))?;
    take_verdicts(&mut trace, &status);
    if let Some(out) = strictdoc {
        if out.exists() {
            let message = format!("failed to write {}: the folder exists already", out.display());
            return Err(Failure::input(message));
        }
        let files = octant_requirements::strictdoc::folder(&requirements, &trace, &plan.title)
            .map_err(Failure::input)?;
        for (path, text) in files {
            let path = out.join(path);
            let parent = path.parent().unwrap_or(out);
            std::fs::create_dir_all(parent).map_err(|error| {
                Failure::bench(format!("failed to create {}: {error}", parent.display()))
            })?;
            write(&path, text)?;
        }
    }
    let verdict = status.verdict();
    if json {
        print_json(&Traced {
            verdict,
            besides: status.besides,
            open: status.open,
            requirements: &trace.requirements,
            without_case: &trace.without_case,
            without_requirement: &trace.without_requirement,
            unknown: &trace.unknown,
            doubts: &trace.doubts,
        })?;
    } else {
        let mut text = format!("{}: {}\n", plan.title, verdict.name());
        if status.besides != Verdict::Pass {
            text += &format!("apart from requirements: {}\n", status.besides.name());
        }
        for doubt in &trace.doubts {
            text += &format!("requirements may be missing: {doubt}\n");
        }
        if status.open > 0 {
            text += &format!(
                "{} of {} without a result yet\n",
                status.open,
                counted(status.cases, "case", "cases")
            );
        }
        for row in &trace.requirements {
            let verdict = row.verdict.map_or("not by a run", |verdict| verdict.name());
            let cases = counted(row.cases.len(), "case", "cases");
            text += &format!("{}: {verdict}, {cases}: {}\n", row.id, row.reason);
        }
        for (what, ids) in [
            ("requirements without a case", &trace.without_case),
            ("cases without a requirement", &trace.without_requirement),
        ] {
            if !ids.is_empty() {
                let named = ids.iter().take(10).cloned().collect::<Vec<_>>().join(", ");
                let more = if ids.len() > 10 {
                    format!(" and {} more", ids.len() - 10)
                } else {
                    String::new()
                };
                text += &format!("{what}: {named}{more}\n");
            }
        }
        print(&text)?;
    }
    Ok(verdict)
}

/// Output of `octant campaign trace --json`.
#[derive(serde::Serialize)]
struct Traced<'a> {
    /// Verdict of the campaign, as in its report.
    verdict: Verdict,
    /// Worst verdict of its cases except for their requirements.
    besides: Verdict,
    /// Cases without a result.
    open: usize,
    requirements: &'a [TraceRow],
    without_case: &'a [String],
    without_requirement: &'a [String],
    unknown: &'a [UnknownRequirement],
    /// Reasons why requirements may be missing.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    doubts: &'a [String],
}

/// Finds a case of a plan.
fn case_of<'a>(plan: &'a Plan, id: &str, action: &str) -> Result<&'a Case, Failure> {
    plan.case(id).ok_or_else(|| {
        let ids = plan.cases.iter().map(|case| case.id.as_str());
        let near: Vec<&str> = ids.filter(|other| other.starts_with(id)).take(5).collect();
        let known = if near.is_empty() {
            String::new()
        } else {
            format!(", expected one such as {}", near.join(", "))
        };
        Failure::input(format!(
            "failed to {action} case {id}: found no such case in the plan{known}"
        ))
    })
}

/// Runs one case as `octant run` does.
fn again(folder: &Path, id: &str, out: Option<&Path>) -> Result<Verdict, Failure> {
    let place = CampaignPlace::of(folder, Needs::Plan)?;
    let plan = read(place.folder())?;
    let case = case_of(&plan, id, "run")?;
    let planned = plan.planned(case)?;
    // Checks that the scenario is the planned one.
    planned.scenario(case)?;
    note_opened(&plan, place.folder(), id, "octant campaign case")?;
    let out = out.map_or_else(|| Path::new("runs").join(format!("case-{id}")), Path::to_owned);
    let words = ["octant", "campaign", "case", &place.shown(place.folder()), id];
    let line = words.map(str::to_owned).to_vec();
    crate::evidenced::case(line, planned, case, &out)
}

/// Prints the stored result of a case as it is.
fn result(folder: &Path, id: &str) -> Result<Verdict, Failure> {
    let place = CampaignPlace::of(folder, Needs::Results)?;
    let plan = read(place.folder())?;
    let case = case_of(&plan, id, "print the result of")?;
    let results =
        CampaignResults::open(place.folder()).map_err(|error| Failure::bench(error).failed())?;
    let stored = results.bytes(&case.id).map_err(|error| Failure::bench(error).failed())?;
    let Some(stored) = stored else {
        return Err(Failure::input(format!(
            "failed to print the result of case {id}: found none in {}, expected a case that has run: octant \
             campaign run {} --only {id}",
            folder.display(),
            folder.display()
        )));
    };
    note_opened(&plan, place.folder(), id, "octant campaign result")?;
    print(&String::from_utf8_lossy(&stored.bytes))?;
    Ok(Verdict::Pass)
}

/// Notes in the journal that the outcome of a case is shown before the look.
fn note_opened(plan: &Plan, folder: &Path, case: &str, by: &str) -> Result<(), Failure> {
    if !plan.has_claims() {
        return Ok(());
    }
    let status = status::of(plan, folder, Shard::WHOLE).map_err(Failure::bench)?;
    if !status.looks.is_due {
        let (case, by) = (case.to_owned(), by.to_owned());
        Journal::append(folder, JournalEvent::Opened { case, by })?;
    }
    Ok(())
}

/// Runs the cases that standard input names.
fn work() -> Result<Verdict, Failure> {
    let (input, output) = (std::io::stdin().lock(), std::io::stdout().lock());
    octant_campaign::execute::work::work(input, output, std::io::stderr())
        .map_err(|error| Failure::bench(error).failed())?;
    Ok(Verdict::Pass)
}
