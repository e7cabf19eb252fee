//! `octant nightly`: runs the fault suite and campaigns, and compares them with the accepted
//! baseline.

use super::campaign::run::{in_rounds, show};
use super::progress::watch_interrupts;
use crate::case_progress::CaseBar;
use crate::failure::Failure;
use crate::terminal::note;
use crate::terminal::{print, write};
use clap::{Args, Subcommand};
use octant_base::control::Control;
use octant_base::display::UnitChoice;
use octant_base::interrupt;
use octant_campaign::execute::selection::CaseSelection;
use octant_campaign::execute::{ExecuteOptions, ExecutionEvent, Shard, execute};
use octant_campaign::judge::status;
use octant_campaign::merge;
use octant_campaign::merge::results;
use octant_campaign::plan::Plan;
use octant_campaign::store::CampaignResults;
use octant_evidence::manifest::{Machine, operator, shell_path};
use octant_nightly::accept::{self, Baseline, accept as accept_night};
use octant_nightly::compare::{Side, Thresholds, compare};
use octant_nightly::history::History;
use octant_nightly::night::{self, CampaignNight, Night, Program, SCHEMA, free_name};
use octant_nightly::render::NightReport;
use octant_nightly::suite::{self, SharedCase, SharedCases, SuiteOptions, SuiteResult};
use octant_nightly::trend;
use octant_nightly::units::TrendUnits;
use octant_run::many::judge_many;
use octant_scenario::Scenario;
use octant_scenario::suite::Suite;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Campaigns, TOML files.
    #[arg(value_name = "CAMPAIGN")]
    campaigns: Vec<PathBuf>,
    /// Suite of scenarios with their expected outcomes, a TOML file.
    #[arg(long, value_name = "SUITE")]
    suite: Option<PathBuf>,
    /// Folder of the nights, their history and the baseline.
    #[arg(long, value_name = "DIR", required = true)]
    history: Option<PathBuf>,
    /// Start a history: this night is compared with no baseline, and becomes the baseline if it
    /// passes. Without this option, a night without a baseline is inconclusive.
    #[arg(long)]
    first: bool,
    /// Make this night the baseline, whatever its verdict.
    #[arg(long)]
    accept: bool,
    /// Folder for copies of nightly.md, nightly.json and trend.html.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of parallel cases; by default the number of processors.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Probability of a false alarm: of reporting any change where there is none, over all measures.
    #[arg(long, value_name = "P", default_value = "0.05", value_parser = fraction, conflicts_with = "first")]
    alpha: f64,
    /// Smallest change of a mean that counts, as a fraction of the baseline's root mean square.
    #[arg(long, value_name = "PART", default_value = "0.01", value_parser = fraction, conflicts_with = "first")]
    least: f64,
    /// Units of errors in trend.html, instead of the scenarios': of attitude (arcmin, deg, arcsec, mrad) and
    /// velocity (m/s, kn, cm/s), such as deg,kn. Position errors stay in arcmin.
    #[arg(long, value_name = "UNIT,UNIT")]
    units: Option<UnitChoice>,
    /// Print nightly.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run cases of a suite that share their beginning; octant nightly starts this.
    #[command(hide = true)]
    Cases,
    /// Make a finished night the baseline.
    Accept {
        /// Id of the night; by default the last finished one.
        #[arg(value_name = "NIGHT")]
        night: Option<String>,
        /// Folder of the history.
        #[arg(long, value_name = "DIR")]
        history: PathBuf,
        /// Units of errors in trend.html, as for the night.
        #[arg(long, value_name = "UNIT,UNIT")]
        units: Option<UnitChoice>,
    },
}

fn fraction(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| (0.0..1.0).contains(number));
    number.ok_or_else(|| format!("found {text:?}, expected a number of 0 or more and below 1"))
}

/// Inputs of a night.
struct Inputs {
    suite: Option<Suite>,
    suite_blake3: Option<String>,
    plans: Vec<(String, Plan)>,
    program: PathBuf,
    jobs: usize,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments {
        command,
        campaigns,
        suite,
        history,
        first,
        accept,
        out,
        jobs,
        alpha,
        least,
        units,
        json: as_json,
    } = arguments;
    match command {
        Some(Command::Accept { night, history, units }) => {
            return accepted(history, night.as_deref(), chosen(*units)?);
        }
        Some(Command::Cases) => return cases(),
        None => {}
    }
    let Some(history) = history else {
        return Err(Failure::input("--history is missing"));
    };
    if campaigns.is_empty() && suite.is_none() {
        return Err(Failure::input("found neither a campaign nor --suite, expected one or both"));
    }
    let units = chosen(*units)?;
    watch_interrupts();
    // Inputs that can't be compared or stored are reported before anything runs.
    let mut all = History::read(history).map_err(|error| Failure::input(error).failed())?;
    let baseline = accept::read(history).map_err(Failure::input)?;
    if let (true, Some(baseline)) = (*first, &baseline) {
        return Err(Failure::input(format!(
            "found a baseline, night {}, in {}: --first is for a history without one, --accept replaces it",
            baseline.accepted.night,
            history.display()
        )));
    }
    let inputs = inputs(campaigns, suite.as_deref(), *jobs)?;
    let mut night = begin(history, &inputs, &all)?;
    let folder = night::nights(history).join(&night.id);
    if !run_all(&inputs, &mut night, &folder, interrupt::flag())? {
        print(&format!("night {} was interrupted: the same command resumes it\n", night.id))?;
        return Ok(Verdict::Inconclusive);
    }
    night.ended = Some(octant_base::utc::seconds(SystemTime::now()));
    let rows = accept::rows(&folder, &night).map_err(Failure::bench)?;
    let limits = Thresholds { alpha: *alpha, least: *least };
    let rerun = |campaign: &str, case: &str| {
        format!("octant campaign case {} {case}", shell_path(&folder.join(campaign)))
    };
    let against = |baseline: &Baseline| {
        let before = Side { night: &baseline.night, rows: &baseline.rows };
        compare(before, Side { night: &night, rows: &rows }, limits, &rerun)
    };
    let comparison = baseline.as_ref().map(against);
    let before = baseline.as_ref().map(|b| &b.night);
    let report = NightReport::new(&night, before, comparison, *first);
    all.put(&night, report.verdict.name(), &rows, report.comparison.as_ref());
    all.write(history).map_err(|error| Failure::bench(error).failed())?;
    let json = report.to_json().map_err(|error| Failure::bench(error).failed())?;
    write(&folder.join("nightly.json"), &json)?;
    write(&folder.join("nightly.md"), report.markdown())?;
    // From here on the night has ended; one that was aborted before is resumed.
    night.write(&folder).map_err(Failure::bench)?;
    let mut name = baseline.map(|baseline| baseline.accepted.night);
    // A first night that fails by itself doesn't become the baseline.
    let accepts = *accept || (*first && report.verdict == Verdict::Pass);
    if accepts {
        accept_night(history, &night.id, operator()).map_err(Failure::bench)?;
        name = Some(night.id.clone());
    }
    let page = trend::render(&all, name.as_deref(), &TrendUnits::read(history, &all, units));
    write(&history.join("trend.html"), &page)?;
    if let Some(out) = out {
        std::fs::create_dir_all(out).map_err(|error| {
            Failure::bench(format!("failed to create {}: {error}", out.display()))
        })?;
        write(&out.join("nightly.json"), &json)?;
        write(&out.join("nightly.md"), report.markdown())?;
        write(&out.join("trend.html"), &page)?;
    }
    let mut text = format!("night {}: {}\n", night.id, report.verdict.name());
    report.reasons.iter().for_each(|reason| text += &format!("  {reason}\n"));
    if accepts {
        text += "this night is the baseline now\n";
    } else if name.is_none() {
        text += &format!(
            "octant nightly accept --history {} makes this night the baseline\n",
            shell_path(history)
        );
    }
    text += &format!(
        "{}\n{}\n",
        folder.join("nightly.md").display(),
        history.join("trend.html").display()
    );
    print(if *as_json { &json } else { &text })?;
    Ok(report.verdict)
}

/// Checks the units that are chosen for the trend page.
fn chosen(units: Option<UnitChoice>) -> Result<UnitChoice, Failure> {
    let units = units.unwrap_or_default();
    TrendUnits::check(units).map_err(|error| Failure::input(format!("--units: {error}")))?;
    Ok(units)
}

fn accepted(history: &Path, night: Option<&str>, units: UnitChoice) -> Result<Verdict, Failure> {
    let nights = night::all(history).map_err(Failure::input)?;
    let ended = nights.iter().rev().find(|night| night.ended.is_some());
    let id = match (night, ended) {
        (Some(id), _) if nights.iter().any(|night| night.id == id) => id.to_owned(),
        (Some(id), _) => {
            let known = nights.iter().map(|night| night.id.as_str());
            let near = octant_base::names::suggestion(id, known, "nights");
            return Err(Failure::input(format!("unknown night {id:?}, {near}")));
        }
        (None, Some(night)) => night.id.clone(),
        (None, None) => {
            let message = format!("found no finished night in {}", history.display());
            return Err(Failure::input(message));
        }
    };
    let accepted = accept_night(history, &id, operator()).map_err(Failure::input)?;
    if let Ok(all) = History::read(history) {
        let units = TrendUnits::read(history, &all, units);
        write(&history.join("trend.html"), trend::render(&all, Some(&accepted.night), &units))?;
    }
    print(&format!("night {} is the baseline\n", accepted.night))?;
    Ok(Verdict::Pass)
}

fn inputs(
    campaigns: &[PathBuf],
    suite: Option<&Path>,
    jobs: Option<u16>,
) -> Result<Inputs, Failure> {
    let mut plans: Vec<(String, Plan)> = Vec::new();
    for path in campaigns {
        let plan = Plan::of(path)?;
        let stem = path.file_stem().map_or("campaign".into(), |stem| stem.to_string_lossy());
        if plans.iter().any(|(name, _)| *name == stem) || stem == "suite" {
            let message = format!(
                "{}: found the campaign name {stem:?}, which is taken, expected another file name",
                path.display()
            );
            return Err(Failure::input(message));
        }
        plans.push((stem.into_owned(), plan));
    }
    let suite = suite.map(Suite::load).transpose().map_err(Failure::input)?;
    let suite_blake3 = suite.as_ref().map(suite::hash).transpose().map_err(Failure::input)?;
    let program = std::env::current_exe()
        .map_err(|error| Failure::bench(format!("failed to find this program: {error}")))?;
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = jobs.map_or_else(processors, usize::from);
    Ok(Inputs { suite, suite_blake3, plans, program, jobs })
}

/// Returns the night that was aborted, if it was begun by this program with these inputs; else a
/// new one.
fn begin(history: &Path, inputs: &Inputs, all: &History) -> Result<Night, Failure> {
    let program = Program::of(&inputs.program).map_err(Failure::bench)?;
    let ids: Vec<(&str, &str)> =
        inputs.plans.iter().map(|(name, plan)| (name.as_str(), plan.id.as_str())).collect();
    let nights = night::all(history).map_err(Failure::input)?;
    let open = nights.into_iter().rev().find(|night| {
        night.ended.is_none()
            && night.program.sha256 == program.sha256
            && night.suite_blake3 == inputs.suite_blake3
            && night.campaigns.len() == ids.len()
            && night
                .campaigns
                .iter()
                .zip(&ids)
                .all(|(c, (name, plan))| c.name == *name && c.plan == *plan)
    });
    if let Some(night) = open {
        note!("octant: resuming night {}", night.id);
        return Ok(night);
    }
    let now = SystemTime::now();
    let known: Vec<String> =
        all.nights().iter().filter_map(|night| night.get("night").cloned()).collect();
    let campaigns = inputs.plans.iter().map(|(name, plan)| CampaignNight {
        name: name.clone(),
        title: plan.title.clone(),
        plan: plan.id.clone(),
        verdict: None,
        requirements: Default::default(),
        differing: Vec::new(),
    });
    let night = Night {
        schema: SCHEMA,
        id: free_name(history, now, &known),
        started: octant_base::utc::seconds(now),
        ended: None,
        program,
        host: Machine::this(),
        suite_blake3: inputs.suite_blake3.clone(),
        suite: Vec::new(),
        campaigns: campaigns.collect(),
    };
    // The folder appears with its complete content.
    let folder = night::nights(history).join(&night.id);
    let new = night::nights(history).join(format!(".{}.new", night.id));
    let failed = |action: &str, path: &Path, error: std::io::Error| {
        Failure::bench(format!("failed to {action} {}: {error}", path.display()))
    };
    remove_begun(history)?;
    std::fs::create_dir_all(&new).map_err(|error| failed("create", &new, error))?;
    for (name, plan) in &inputs.plans {
        plan.write(&new.join(name), false)?;
    }
    night.write(&new).map_err(Failure::bench)?;
    std::fs::rename(&new, &folder).map_err(|error| failed("create", &folder, error))?;
    Ok(night)
}

/// Removes a folder that a kill may have left.
fn remove(folder: &Path) -> Result<(), Failure> {
    match std::fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(Failure::bench(format!("failed to remove {}: {error}", folder.display())))
        }
        _ => Ok(()),
    }
}

/// Removes the folders of nights that were killed before they got their names.
fn remove_begun(history: &Path) -> Result<(), Failure> {
    let entries = std::fs::read_dir(night::nights(history)).into_iter().flatten().flatten();
    let names =
        entries.map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path()));
    names
        .filter(|(name, _)| name.starts_with('.') && name.ends_with(".new"))
        .try_for_each(|(_, path)| remove(&path))
}

/// Number of the day of a time in RFC 3339; 0 for one that isn't.
fn day_of(time: &str) -> u64 {
    let since = octant_base::utc::parse(time).ok().and_then(|t| t.duration_since(UNIX_EPOCH).ok());
    since.map_or(0, |since| since.as_secs() / 86_400)
}

/// Runs cases of a suite together, for the process that began this one.
fn cases() -> Result<Verdict, Failure> {
    let job: SharedCases = serde_json::from_reader(std::io::stdin().lock()).map_err(|error| {
        Failure::input(format!(
            "failed to read cases on standard input: {error} (octant nightly starts this)"
        ))
    })?;
    // A case that can't be read has its own words when it runs alone.
    let (places, scenarios): (Vec<usize>, Vec<Scenario>) = (job.scenarios.iter().enumerate())
        .filter_map(|(index, path)| Some((index, Scenario::load(path, &[]).ok()?)))
        .unzip();
    let wrong = Mutex::new(None);
    judge_many(&scenarios, job.jobs, &Control::default(), &|place, run| {
        let Ok(run) = run else { return };
        let line = SharedCase { index: places[place], summary: run.summary };
        if let Err(failure) = print_line(&line) {
            wrong.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
        }
    });
    wrong.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(Verdict::Pass), Err)
}

fn print_line(case: &SharedCase) -> Result<(), Failure> {
    let text = serde_json::to_string(case).map_err(Failure::bench)?;
    print(&(text + "\n"))
}

/// Runs everything without a result; returns whether all have one now.
fn run_all(
    inputs: &Inputs,
    night: &mut Night,
    folder: &Path,
    cancel: &AtomicBool,
) -> Result<bool, Failure> {
    if let Some(suite) = &inputs.suite {
        let bar = CaseBar::new("suite", suite.cases.len(), inputs.jobs, false);
        let tell = |result: &SuiteResult| {
            bar.ended(None, result.problem.is_some());
            if let Some(problem) = &result.problem {
                bar.note(&format!("suite: {}: {problem}", result.name));
            }
        };
        let into = folder.join("suite");
        let found = bar.during(&|_| String::new(), || {
            let options = SuiteOptions {
                folder: &into,
                program: &inputs.program,
                jobs: inputs.jobs,
                night: day_of(&night.started),
                cancel,
            };
            suite::run(suite, &options, &tell)
        });
        let Some(found) = found.map_err(Failure::bench)? else { return Ok(false) };
        night.suite = found;
    }
    for (name, plan) in &inputs.plans {
        let into = folder.join(name);
        let bar = CaseBar::new(name, plan.cases.len(), inputs.jobs, plan.stop.is_some());
        let tell = |event: &ExecutionEvent| show(&bar, plan, event);
        let mut options = ExecuteOptions {
            folder: &into,
            program: &inputs.program,
            jobs: inputs.jobs,
            shard: Shard::WHOLE,
            end: plan.cases.len(),
            again: false,
            selection: CaseSelection::default(),
            together: true,
            cancel,
        };
        let id = |index: usize| plan.cases[index].id.to_string();
        let outcome = bar.during(&id, || in_rounds(plan, &mut options, &tell))?;
        if outcome.left > 0 || cancel.load(Ordering::Relaxed) {
            return Ok(false);
        }
        let found = conclude(plan, &into, &inputs.program, cancel)?;
        if let Some(campaign) = night.campaigns.iter_mut().find(|c| c.name == *name) {
            campaign.verdict = Some(found.verdict());
            campaign.requirements =
                found.requirements.iter().map(|(id, r)| (id.clone(), r.verdict)).collect();
            campaign.differing = found.differing;
        }
    }
    Ok(!cancel.load(Ordering::Relaxed))
}

/// Writes the tables of a campaign, and runs its first case a second time: non-determinism is
/// detected in the night in which it begins.
fn conclude(
    plan: &Plan,
    folder: &Path,
    program: &Path,
    cancel: &AtomicBool,
) -> Result<status::CampaignStatus, Failure> {
    let failed = |error: octant_campaign::table::TableError| Failure::bench(error).failed();
    let end = match &plan.stop {
        Some(rule) => {
            status::decide(plan, folder, rule).map_err(Failure::bench)?.end(plan.cases.len())
        }
        None => plan.cases.len(),
    };
    results::tables(plan, folder, 0..end, |table| merge::part(folder, Shard::WHOLE, table))
        .map_err(failed)?;
    merge::merge(plan, &[folder.to_owned()], folder, end)?;
    let mut found = status::of(plan, folder, Shard::WHOLE).map_err(Failure::bench)?;
    // In the folder of the nights, so that the remains of a kill are found.
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    let again = folder.with_file_name(format!(".{name}.again"));
    remove(&again)?;
    let options = ExecuteOptions {
        folder: &again,
        program,
        jobs: 1,
        shard: Shard::WHOLE,
        end: 1,
        again: false,
        selection: CaseSelection::default(),
        together: true,
        cancel,
    };
    execute(plan, &options, &|_| {})?;
    if let Some(first) = plan.cases.first() {
        let read = |folder: &Path| CampaignResults::open(folder).ok()?.bytes(&first.id).ok()?;
        let read = |folder: &Path| read(folder).map(|stored| stored.bytes);
        let (once, twice) = (read(folder), read(&again));
        if twice.is_some()
            && once != twice
            && !found.differing.iter().any(|id| first.id == id.as_str())
        {
            found.differing.push(first.id.to_string());
        }
    }
    remove(&again)?;
    Ok(found)
}
