//! `octant doctor`.

use super::{Failure, print, print_json};
use clap::Args;
use octant_realtime::host::{Finding, Grade, look};
use octant_realtime::latency::{Found, Trial, measure};
use octant_realtime::schedule::Wish;
use octant_requirements::Verdict;
use serde::Serialize;
use std::fmt::Write as _;
use std::time::Duration;

/// Wakings are 5 ms apart: 200 Hz, the rate of the usual run.
const PERIOD_NS: u64 = 5_000_000;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// How long each way of waiting is measured; 0 s leaves the measurement out.
    #[arg(long, value_name = "TIME", default_value = "2 s")]
    latency: String,
    /// Print what was found as JSON, and nothing else.
    #[arg(long)]
    json: bool,
}

/// What the host can do.
#[derive(Debug, Serialize)]
struct Diagnosis {
    findings: Vec<Finding>,
    latency: Vec<Measured>,
}

/// A way of waiting, and how late it was.
#[derive(Debug, Serialize)]
struct Measured {
    way: String,
    #[serde(flatten)]
    found: Found,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let seconds = super::seconds("--latency", &arguments.latency)?;
    if !(0.0..=3600.0).contains(&seconds) {
        let found = &arguments.latency;
        let message = format!("--latency: found {found:?}, expected a time from 0 s to 1 h");
        return Err(Failure::input(message));
    }
    let findings = look();
    let mut latency = Vec::new();
    if seconds > 0.0 {
        let ways = [
            ("asleep, usual scheduling", None, 0),
            ("asleep, SCHED_FIFO", Some(80), 0),
            ("asleep, then spinning for 100 us, SCHED_FIFO", Some(80), 100_000),
        ];
        for (way, priority, spin_ns) in ways {
            let found = measure(Trial {
                period_ns: PERIOD_NS,
                duration: Duration::from_secs_f64(seconds),
                spin_ns,
                wish: Wish { priority, lock_memory: false, cpu: None },
            })
            .map_err(|error| Failure::bench(format!("failed to measure the latency: {error}")))?;
            latency.push(Measured { way: way.to_owned(), found });
        }
    }
    let diagnosis = Diagnosis { findings, latency };
    if arguments.json {
        print_json(&diagnosis)?;
    } else {
        print(&text(&diagnosis))?;
    }
    Ok(Verdict::Pass)
}

fn text(diagnosis: &Diagnosis) -> String {
    let mut out = String::new();
    for finding in &diagnosis.findings {
        let grade = match finding.grade {
            Grade::Good => "good",
            Grade::Advice => "note",
            Grade::Missing => "MISSING",
        };
        let _ = writeln!(out, "{grade:8} {:22} {}", finding.subject, finding.found);
        if let Some(advice) = &finding.advice {
            let _ = writeln!(out, "{:31} {advice}", "");
        }
    }
    if !diagnosis.latency.is_empty() {
        let _ = writeln!(out, "\nwoken too late by, us          median     99 %   99.9 %  largest");
    }
    for Measured { way, found } in &diagnosis.latency {
        let of = &found.report.lateness;
        let _ = writeln!(out, "  {way}");
        let _ = writeln!(
            out,
            "{:28} {:8.1} {:8.1} {:8.1} {:8.1}",
            "", of.p50_us, of.p99_us, of.p999_us, of.max_us
        );
        if let octant_realtime::schedule::Outcome::Refused { .. } = found.granted.scheduling {
            let _ = writeln!(out, "    {}", found.granted.scheduling.text());
        }
    }
    out
}
