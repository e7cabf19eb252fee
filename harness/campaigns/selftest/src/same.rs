//! Cases that must give the same bytes when run twice, on one processor and on several, whole and
//! in parts.

use super::bench::CaseBench;
use super::case::{Case, STARTED_LIMIT};
use super::error::CaseSetupError;
use super::judge::{CaseOutcome, Expectation};
use super::scenarios::{ALWAYS, SHORT, campaign};

pub(super) fn cases() -> Vec<Case> {
    let case = |id, about, run| Case {
        id,
        about,
        expectation: Expectation::Same,
        limit: STARTED_LIMIT,
        run,
    };
    vec![
        case("run-twice", "A run with a fault and its twin, made twice.", run_twice),
        case("sweep-jobs", "A sweep of a fault, a cell at a time and four at a time.", sweep),
        case("campaign-shards", "A campaign on one processor, on two, and in three parts.", shards),
    ]
}

fn run_twice(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    bench.write("scenario.toml", SHORT)?;
    let mut outcome = CaseOutcome::default();
    for name in ["once", "again"] {
        let said = bench.octant(&["run", "scenario.toml", "--out", name])?;
        let mut bytes = Vec::new();
        for file in ["summary.json", "calibration.octcal", "scenario.toml"] {
            bytes.extend(bench.read(&format!("{name}/{file}"))?);
        }
        bytes.extend(without_times(&bench.read(&format!("{name}/junit.xml"))?));
        let made = std::mem::take(&mut outcome.made);
        outcome = CaseOutcome { made, ..said.into() };
        outcome.made.push((name.to_owned(), bytes));
    }
    Ok(outcome)
}

/// A file of results without when they were made and how long that took.
fn without_times(junit: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(junit).into_owned();
    let mut kept = String::new();
    for (k, part) in text.split('"').enumerate() {
        // Every second part is the value of an attribute, after its name.
        let is_time = k % 2 == 1 && (kept.ends_with(" time=") || kept.ends_with(" timestamp="));
        kept += if is_time { "" } else { part };
    }
    kept.into_bytes()
}

fn sweep(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    bench.write("scenario.toml", SHORT)?;
    let mut outcome = CaseOutcome::default();
    for jobs in ["1", "4"] {
        let said = bench.octant(&[
            "faults",
            "sweep",
            "scenario.toml",
            "--over",
            "amplitude=10 deg/h, 100 deg/h, 1000 deg/h, 10000 deg/h",
            "--jobs",
            jobs,
            "--json",
        ])?;
        let bytes = said.out.clone().into_bytes();
        let made = std::mem::take(&mut outcome.made);
        outcome = CaseOutcome { made, ..said.into() };
        outcome.made.push((format!("--jobs {jobs}"), bytes));
    }
    Ok(outcome)
}

fn shards(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let mut outcome = CaseOutcome::default();
    campaign(bench, 4, ALWAYS, "")?;
    tables(bench, "one processor", &mut outcome)?;
    let (several, parts): (&[&str], &[&str]) = (&["1/1"], &["2/3", "1/3", "3/3"]);
    for (how, shards) in [("two processors", several), ("three parts", parts)] {
        for old in ["campaign/results", "campaign/parts"] {
            let path = bench.at(old);
            std::fs::remove_dir_all(&path)
                .map_err(|error| format!("remove {}: {error}", path.display()))?;
        }
        for shard in shards {
            bench.octant(&["campaign", "run", "campaign", "--jobs", "2", "--shard", shard])?;
        }
        tables(bench, how, &mut outcome)?;
    }
    Ok(outcome)
}

/// Merges a campaign, and keeps the bytes of its tables.
fn tables(
    bench: &CaseBench<'_>,
    how: &str,
    outcome: &mut CaseOutcome,
) -> Result<(), CaseSetupError> {
    let said = bench.octant(&["campaign", "merge", "campaign"])?;
    let mut bytes = Vec::new();
    for table in ["cases", "checks", "drift"] {
        bytes.extend(bench.read(&format!("campaign/{table}.parquet"))?);
    }
    let mut made = std::mem::take(&mut outcome.made);
    made.push((how.to_owned(), bytes));
    *outcome = CaseOutcome { made, ..said.into() };
    Ok(())
}
