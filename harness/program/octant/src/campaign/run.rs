//! `octant campaign run`: the cases that have no result yet, with progress and live failures.

use super::bundle::check_origin;
use super::planned::read;
use crate::case_progress::CaseBar;
use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::place;
use crate::progress::watch_interrupts;
use clap::Args;
use octant_base::interrupt;
use octant_base::number::counted;
use octant_campaign::execute::selection::CaseSelection;
use octant_campaign::execute::{
    CaseDone, ExecuteError, ExecuteOptions, ExecutionEvent, ExecutionSummary, Shard, execute,
};
use octant_campaign::judge::shown::note_look;
use octant_campaign::judge::status;
use octant_campaign::judge::stop::StopDecision;
use octant_campaign::merge;
use octant_campaign::merge::results;
use octant_campaign::plan::Plan;
use octant_campaign::plan::looks::LookWay;
use octant_campaign::store::CampaignResults;
use octant_evidence::manifest::shell_path;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Longest time for which a result waits until it is uploaded.
const UPLOAD_EVERY: Duration = Duration::from_secs(20);

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the campaign, or its address on object storage: s3://BUCKET/PREFIX.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Run part K of N of the plan; by default the part that Slurm or Kubernetes names in the
    /// environment of an array or an indexed job, and otherwise the whole plan.
    #[arg(long, value_name = "K/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    #[command(flatten)]
    part: PartArguments,
    #[command(flatten)]
    stored: StorageArguments,
}

/// Cases of a part, and how they are run.
#[derive(Debug, Args)]
struct PartArguments {
    /// Number of parallel cases; by default the number of processors.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Run cases again that ended as errors.
    #[arg(long)]
    again: bool,
    /// Run only the cases that match: PATTERN is an id, a scenario or FACTOR=VALUE, with * and ?.
    /// Given several times, all have to match.
    #[arg(long, value_name = "PATTERN")]
    only: Vec<String>,
    /// Run the cases that have failed, ended as errors or have no result. A failed case has to come
    /// to the same result again.
    #[arg(long)]
    failed: bool,
    /// Run every case from its beginning. By default cases of one scenario and seed that differ by their
    /// faults alone share what comes before the first fault; the results are the same.
    #[arg(long)]
    undivided: bool,
    /// Exit with status 0 if every case of the part has a result, whatever the verdicts: for schedulers that take
    /// any other status for a lost part.
    #[arg(long)]
    any_verdict: bool,
}

/// Options for a campaign on object storage alone.
#[derive(Debug, Args)]
struct StorageArguments {
    /// Working folder of a campaign on object storage, new or of an earlier run of it; by default a temporary one.
    #[arg(long, value_name = "FOLDER")]
    work: Option<PathBuf>,
    #[arg(long, value_name = "SECONDS", value_parser = upload_every, help = format!(
        "Longest time for which a result waits until it is uploaded to object storage, s; by default {}",
        UPLOAD_EVERY.as_secs()
    ))]
    upload_every: Option<Duration>,
}

/// Parses the longest time for which a result waits.
fn upload_every(text: &str) -> Result<Duration, String> {
    let seconds = text.trim().parse().ok().filter(|seconds| (0.1..=3600.0).contains(seconds));
    let every = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    every.ok_or_else(|| "expected a number of seconds from 0.1 to 3600".to_owned())
}

pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let Arguments { folder, shard, part, stored } = arguments;
    watch_interrupts();
    let shard = match shard {
        Some(shard) => *shard,
        None => Shard::of_scheduler(|name| std::env::var(name).ok()).map_err(Failure::input)?,
    };
    if let Some(text) = place::address(folder) {
        let StorageArguments { work, upload_every } = stored;
        let every = upload_every.unwrap_or(UPLOAD_EVERY);
        return place::run_part(text, work.as_deref(), shard, every, |made| {
            run(part, (made, folder), shard)
        });
    }
    given.refuse::<StorageArguments>(format!(
        "found the folder {}, expected a campaign on object storage, s3://BUCKET/PREFIX",
        folder.display()
    ))?;
    run(part, (folder, folder), shard)
}

/// Runs a part of the campaign in a folder, which the user gave under the second name.
fn run(
    arguments: &PartArguments,
    (folder, named): (&Path, &Path),
    shard: Shard,
) -> Result<Verdict, Failure> {
    let PartArguments { jobs, again, only, failed, undivided, any_verdict } = arguments;
    let plan = read(folder)?;
    check_origin(&plan, folder)?;
    let program = std::env::current_exe()
        .map_err(|error| Failure::bench(format!("failed to find this program: {error}")))?;
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let mut selection = CaseSelection::of(&plan, only).map_err(Failure::input)?;
    if *failed {
        let repeating = selection.repeating_failed(&plan, folder);
        selection = repeating.map_err(|error| Failure::bench(error).failed())?;
    }
    let cases = 0..plan.cases.len();
    let mine = cases.filter(|index| shard.has(*index) && selection.picks(*index)).count();
    let may_stop = plan.stop.is_some() && shard == Shard::WHOLE && !selection.is_restricted();
    let mut options = ExecuteOptions {
        folder,
        program: &program,
        jobs: jobs.map_or_else(processors, usize::from),
        shard,
        end: plan.cases.len(),
        again: *again || *failed,
        selection,
        together: !undivided,
        cancel: interrupt::flag(),
    };
    let bar = CaseBar::new("", mine, options.jobs, may_stop);
    let tell = |event: &ExecutionEvent| show(&bar, &plan, event);
    let name = |index: usize| plan.cases[index].id.to_string();
    let outcome = bar.during(&name, || in_rounds(&plan, &mut options, &tell))?;
    let Some(status) = conclude(&plan, (folder, named), shard, !only.is_empty(), &outcome)? else {
        return Ok(Verdict::Inconclusive);
    };
    // A case with two results is more than a verdict.
    let is_complete = status.open == 0 && status.differing.is_empty();
    // Before a look nothing is said of a part, and its end says nothing either.
    let is_unseen = shard != Shard::WHOLE && !status.looks.is_due;
    Ok(match status.verdict() {
        _ if *any_verdict && is_complete => Verdict::Pass,
        Verdict::Inconclusive if is_complete && is_unseen => Verdict::None,
        verdict => verdict,
    })
}

/// Shows an event of an execution on the bar, and failures above it.
pub(crate) fn show(bar: &CaseBar, plan: &Plan, event: &ExecutionEvent) {
    match event {
        ExecutionEvent::There(count) => bar.there(*count),
        ExecutionEvent::Begun(index) => bar.begun(*index),
        ExecutionEvent::Done(done) => {
            // Before a look no outcome is shown; an error is one of the bench.
            let hides = plan.has_claims() && plan.look_way(plan.cases.len()) != LookWay::Open;
            let least = if hides { Verdict::Fail } else { Verdict::Inconclusive };
            bar.ended(Some(done.index), done.verdict > least);
            let id = plan.cases.get(done.index).map_or("", |case| case.id.as_str());
            if let Some(line) = failure(id, done, least) {
                bar.note(&line);
            }
        }
    }
}

/// Runs the cases up to the end that the plan's stopping rule allows. A shard doesn't know the
/// results of the others: it runs all of its cases, and merging leaves out the ones that weren't
/// needed.
pub(crate) fn in_rounds(
    plan: &Plan,
    options: &mut ExecuteOptions<'_>,
    tell: &(dyn Fn(&ExecutionEvent) + Sync),
) -> Result<ExecutionSummary, ExecuteError> {
    let in_parts = options.shard != Shard::WHOLE || options.selection.is_restricted();
    let Some(rule) = plan.stop.as_ref().filter(|_| !in_parts) else {
        return execute(plan, options, tell);
    };
    let mut all = ExecutionSummary::default();
    let mut told = 0;
    let decide = || status::decide(plan, options.folder, rule).map_err(ExecuteError::Result);
    loop {
        // Cases are repeated although enough is known.
        let next = match decide()? {
            StopDecision::Open { next } => next,
            decision if options.selection.has_repeated() => decision.end(plan.cases.len()),
            _ => break,
        };
        options.end = next;
        let outcome = execute(plan, options, &|event| match event {
            // Cases of earlier rounds were reported already.
            ExecutionEvent::There(count) => {
                tell(&ExecutionEvent::There(count.saturating_sub(told)))
            }
            ExecutionEvent::Begun(_) | ExecutionEvent::Done(_) => tell(event),
        })?;
        // A case that ends as an error again isn't run a third time.
        options.again = false;
        options.selection.repetitions_done();
        all.run += outcome.run;
        all.skipped += outcome.skipped.saturating_sub(told);
        all.left = outcome.left;
        all.differing = outcome.differing;
        told = outcome.run + outcome.skipped;
        if outcome.left > 0 || next == plan.cases.len() {
            break;
        }
    }
    Ok(all)
}

/// Describes a case as it ends; `None` if its verdict isn't worse than `least`.
fn failure(id: &str, done: &CaseDone, least: Verdict) -> Option<String> {
    let differs = done.differs.as_ref().map(|place| {
        format!("case {id}: found another result than the stored one, kept beside it in {place}")
    });
    let reason = done.reason.as_deref().unwrap_or("");
    let bad = done.verdict > least;
    differs.or_else(|| bad.then(|| format!("case {id}: {}: {reason}", done.verdict.name())))
}

/// Writes the tables of the part, and prints its status; `None` if cases are left.
fn conclude(
    plan: &Plan,
    (folder, named): (&Path, &Path),
    shard: Shard,
    is_selected: bool,
    outcome: &ExecutionSummary,
) -> Result<Option<status::CampaignStatus>, Failure> {
    let mut text = format!(
        "{} run, {} with a result already",
        counted(outcome.run, "case", "cases"),
        outcome.skipped
    );
    if outcome.left > 0 {
        text += &format!(", {} not started or interrupted: the same command resumes", outcome.left);
        crate::terminal::print(&(text + "\n"))?;
        return Ok(None);
    }
    crate::terminal::print(&(text + "\n"))?;
    let end = match &plan.stop {
        Some(rule) if shard == Shard::WHOLE && !is_selected => {
            let decision = status::decide(plan, folder, rule);
            decision.map_err(Failure::bench)?.end(plan.cases.len())
        }
        _ => plan.cases.len(),
    };
    // With --only, cases that weren't selected may have no result: merging reports them as missing.
    let stored = CampaignResults::open(folder).map_err(|error| Failure::bench(error).failed())?;
    let is_there = |index: &usize| {
        let id = plan.cases.get(*index).map_or("", |case| case.id.as_str());
        !is_selected || stored.has(id)
    };
    let cases = (0..end).filter(|index| shard.has(*index)).filter(is_there);
    results::tables(plan, folder, cases, |table| merge::part(folder, shard, table))
        .map_err(|error| Failure::bench(error).failed())?;
    let status = status::of(plan, folder, shard).map_err(Failure::bench)?;
    if plan.has_claims() && status.looks.is_due && shard == Shard::WHOLE {
        note_look(plan, folder, &status, "octant campaign run")?;
    }
    let status = status.shown();
    crate::terminal::print(&(status.text() + &next(named, is_selected, &status)))?;
    Ok(Some(status))
}

/// Lists the commands that come next.
fn next(folder: &Path, is_selected: bool, status: &status::CampaignStatus) -> String {
    let folder = shell_path(folder);
    let mut text = String::new();
    if let Some(bad) = status.bad.first() {
        text += &format!(
            "next: octant campaign case {folder} {}   (one failure again, with its evidence)\n",
            bad.case
        );
    }
    if status.open > 0 && is_selected {
        let open = counted(status.open, "case", "cases");
        return text + &format!("next: octant campaign run {folder}   ({open} without a result)\n");
    }
    text + &format!("next: octant campaign merge {folder}\nnext: octant campaign report {folder}\n")
}
