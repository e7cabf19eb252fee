//! `octant campaign run`: the cases that have no result yet, with progress and live failures.

use super::planned::read;
use crate::failure::Failure;
use crate::progress::watch_interrupts;
use crate::terminal::note;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use octant_base::interrupt;
use octant_base::number::counted;
use octant_campaign::execute::{
    CaseDone, ExecuteError, ExecuteOptions, ExecutionEvent, ExecutionSummary, Shard, execute,
};
use octant_campaign::plan::Plan;
use octant_campaign::stop::StopDecision;
use octant_campaign::{merge, results, status};
use octant_requirements::Verdict;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the campaign.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Run part K of N of the plan; by default the part that Slurm or Kubernetes names in the
    /// environment of an array or an indexed job, and otherwise the whole plan.
    #[arg(long, value_name = "K/N", value_parser = Shard::parse)]
    shard: Option<Shard>,
    /// Number of parallel cases; by default the number of processors.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Run cases again that ended as errors.
    #[arg(long)]
    again: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    watch_interrupts();
    let plan = read(&arguments.folder)?;
    let shard = match arguments.shard {
        Some(shard) => shard,
        None => Shard::of_scheduler(|name| std::env::var(name).ok()).map_err(Failure::input)?,
    };
    let program = std::env::current_exe()
        .map_err(|error| Failure::bench(format!("failed to find this program: {error}")))?;
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let mut options = ExecuteOptions {
        folder: &arguments.folder,
        program: &program,
        jobs: arguments.jobs.map_or_else(processors, usize::from),
        shard,
        end: plan.cases.len(),
        again: arguments.again,
        cancel: interrupt::flag(),
    };
    let mine = (0..plan.cases.len()).filter(|index| shard.has(*index)).count();
    let bar =
        ProgressBar::with_draw_target(Some(mine as u64), ProgressDrawTarget::stderr_with_hz(5));
    let style = "{wide_bar} {pos} of {len} cases, {per_sec}, {eta} left{msg}";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    let told = |line: String| {
        // Above the bar on a terminal, as a plain line elsewhere.
        if bar.is_hidden() { note!("{line}") } else { bar.println(line) }
    };
    let tell = |event: &ExecutionEvent| match event {
        ExecutionEvent::There(count) => bar.inc(*count as u64),
        ExecutionEvent::Done(done) => {
            bar.inc(1);
            if let Some(line) = failure(&plan.cases[done.index].id, done) {
                told(line);
            }
        }
    };
    let outcome = in_rounds(&plan, &mut options, &tell);
    bar.finish_and_clear();
    let outcome = outcome?;
    conclude(arguments, &plan, shard, &outcome)
}

/// Runs the cases up to the end that the plan's stopping rule allows. A shard doesn't know the
/// results of the others: it runs all of its cases, and merging leaves out the ones that weren't
/// needed.
pub(crate) fn in_rounds(
    plan: &Plan,
    options: &mut ExecuteOptions<'_>,
    tell: &(dyn Fn(&ExecutionEvent) + Sync),
) -> Result<ExecutionSummary, ExecuteError> {
    let Some(rule) = plan.stop.as_ref().filter(|_| options.shard == Shard::WHOLE) else {
        return execute(plan, options, tell);
    };
    let mut all = ExecutionSummary::default();
    let mut told = 0;
    let decide = || status::decide(plan, options.folder, rule).map_err(ExecuteError::Result);
    while let StopDecision::Open { next } = decide()? {
        options.end = next;
        let outcome = execute(plan, options, &|event| match event {
            // Cases of earlier rounds were reported already.
            ExecutionEvent::There(count) => {
                tell(&ExecutionEvent::There(count.saturating_sub(told)))
            }
            ExecutionEvent::Done(_) => tell(event),
        })?;
        // A case that ends as an error again isn't run a third time.
        options.again = false;
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

/// Describes a case as it ends; `None` if it passes.
fn failure(id: &str, done: &CaseDone) -> Option<String> {
    let differs = done.differs.as_ref().map(|path| {
        format!(
            "case {id}: found another result than the stored one, kept beside it in {}",
            path.display()
        )
    });
    let reason = done.reason.as_deref().unwrap_or("");
    let bad = done.verdict > Verdict::Inconclusive;
    differs.or_else(|| bad.then(|| format!("case {id}: {}: {reason}", done.verdict.name())))
}

fn conclude(
    arguments: &Arguments,
    plan: &Plan,
    shard: Shard,
    outcome: &ExecutionSummary,
) -> Result<Verdict, Failure> {
    let mut text = format!(
        "{} run, {} with a result already",
        counted(outcome.run, "case", "cases"),
        outcome.skipped
    );
    if outcome.left > 0 {
        text += &format!(", {} not started or interrupted: the same command resumes", outcome.left);
        crate::terminal::print(&(text + "\n"))?;
        return Ok(Verdict::Inconclusive);
    }
    crate::terminal::print(&(text + "\n"))?;
    let end = match &plan.stop {
        Some(rule) if shard == Shard::WHOLE => {
            let decision = status::decide(plan, &arguments.folder, rule);
            decision.map_err(Failure::bench)?.end(plan.cases.len())
        }
        _ => plan.cases.len(),
    };
    let cases = (0..end).filter(|index| shard.has(*index));
    results::tables(plan, &arguments.folder, cases, |table| {
        merge::part(&arguments.folder, shard, table)
    })
    .map_err(|error| Failure::bench(error).failed())?;
    let status = status::of(plan, &arguments.folder, shard).map_err(Failure::bench)?;
    crate::terminal::print(&status.text())?;
    Ok(status.verdict())
}
