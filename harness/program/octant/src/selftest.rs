//! `octant selftest`: runs known-answer tests through this program itself.

use super::progress::watch_interrupts;
use crate::failure::Failure;
use crate::progress_bar::ProgressBar;
use crate::terminal::print;
use clap::Args;
use octant_base::interrupt;
use octant_campaign::plan;
use octant_selftest::judge::CaseVerdict;
use octant_selftest::record::{CaseRecord, FILE_NAME, Record, write};
use octant_selftest::{answers, cases, run};
use octant_verdict::Verdict;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::SystemTime;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Write selftest.json to this file.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write selftest.json into the folder of this campaign, as a part of its evidence.
    #[arg(long = "for", value_name = "DIR")]
    campaign: Option<PathBuf>,
    /// Run only the known answers: the numbers of every part against independent arithmetic.
    #[arg(long)]
    answers: bool,
    /// Number of parallel cases; by default the number of processors.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// End with the first case that doesn't pass
    #[arg(long)]
    fail_fast: bool,
    /// Print selftest.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { out, campaign, answers: answers_alone, jobs, fail_fast, json: as_json } =
        arguments;
    let of_campaign = match campaign {
        Some(folder) if folder.join(plan::FILE_NAME).exists() => Some(folder.join(FILE_NAME)),
        Some(folder) => {
            return Err(Failure::input(format!(
                "--for: found no {} in {}, expected the folder of a campaign",
                plan::FILE_NAME,
                folder.display()
            )));
        }
        None => None,
    };
    let program = std::env::current_exe()
        .map_err(|error| Failure::bench(format!("failed to find this program: {error}")))?;
    let started = SystemTime::now();
    let cases = if *answers_alone { answers::with_runs() } else { cases() };
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = jobs.map_or_else(processors, usize::from);
    let bar = ProgressBar::new(Some(cases.len() as u64), |progress| {
        let (done, total) = (progress.done, progress.total.unwrap_or_default());
        format!("{done} of {total} cases, {}", progress.message)
    });
    watch_interrupts();
    let tell = |case: &CaseRecord| {
        bar.update(|progress| {
            progress.done += 1;
            progress.message = case.id.to_string();
        });
        if *fail_fast && case.verdict != CaseVerdict::Pass {
            // Cases that have begun are ended as by an interrupt.
            interrupt::flag().store(true, Ordering::Relaxed);
        }
        if case.verdict == CaseVerdict::Alarm {
            bar.note(&format!("ALARM: {}: {}", case.id, case.found));
        }
    };
    let done = run(&program, &cases, jobs, interrupt::flag(), &tell);
    bar.finish();
    let failed = |reason: &dyn std::fmt::Display| Failure::bench(reason).failed();
    let record = Record::new(&program, started, cases.len(), done.map_err(|error| failed(&error))?);
    let record = record.map_err(|error| failed(&error))?;
    let json = record.to_json().map_err(|error| failed(&format!("write the result: {error}")))?;
    for path in out.iter().chain(&of_campaign) {
        write(path, &json).map_err(|error| failed(&error))?;
    }
    print(&if *as_json { json } else { record.text() })?;
    conclude(&record)
}

/// Returns the verdict of the exit status; a status that isn't a verdict's becomes a failure with a
/// message.
fn conclude(record: &Record) -> Result<Verdict, Failure> {
    let verdict = Verdict::ALL.into_iter().find(|v| v.exit_code() == record.exit_code());
    verdict.ok_or_else(|| Failure {
        status: record.exit_code(),
        message:
            "ALARM: a case that must not pass has passed: a pass of this program can't be trusted"
                .to_owned(),
    })
}
