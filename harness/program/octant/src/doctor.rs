//! `octant doctor`.

use crate::failure::Failure;
use crate::terminal::{print, print_json};
use clap::Args;
use octant_realtime::host::{Grade, HostFinding, look};
use octant_realtime::latency::{LatencyResult, Trial, measure};
use octant_realtime::schedule::Wish;
use octant_verdict::Verdict;
use serde::Serialize;
use std::fmt::Write as _;
use std::time::Duration;

/// Period of the wake-ups, ns: 5 ms or 200 Hz, the rate of a usual run.
const PERIOD_NS: u64 = 5_000_000;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Time for which each way of waiting is measured; 0 s skips the measurement.
    #[arg(long, value_name = "TIME", default_value = "2 s")]
    latency: String,
    /// Print the findings as JSON, and nothing else.
    #[arg(long)]
    json: bool,
}

/// Diagnosis of the host.
#[derive(Debug, Serialize)]
struct Diagnosis {
    findings: Vec<HostFinding>,
    latency: Vec<Measured>,
}

/// Way of waiting, with its lateness.
#[derive(Debug, Serialize)]
struct Measured {
    way: String,
    #[serde(flatten)]
    found: LatencyResult,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { latency: given, json } = arguments;
    let seconds = crate::arguments::seconds("--latency", given)?;
    if !(0.0..=3600.0).contains(&seconds) {
        let message = format!("--latency: found {given:?}, expected a time from 0 s to 1 h");
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
    if *json {
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
        let _ = writeln!(out, "\nwake-up lateness, us           median     99 %   99.9 %  largest");
    }
    for Measured { way, found } in &diagnosis.latency {
        let of = &found.report.lateness;
        let _ = writeln!(out, "  {way}");
        let _ = writeln!(
            out,
            "{:28} {:8.1} {:8.1} {:8.1} {:8.1}",
            "", of.p50_us, of.p99_us, of.p999_us, of.max_us
        );
        if let octant_realtime::schedule::RequestOutcome::Refused { .. } = found.granted.scheduling
        {
            let _ = writeln!(out, "    {}", found.granted.scheduling.text());
        }
    }
    out
}
