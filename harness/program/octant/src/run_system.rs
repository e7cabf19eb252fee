//! `octant run` of a system of FMUs: an `.ssp`, an `.ssd`, or a folder with one.

use super::progress::{watch_interrupts, with_progress};
use crate::failure::Failure;
use crate::fmu::time_limit_of;
use crate::terminal::note;
use crate::terminal::{print, write};
use clap::Args;
use octant_base::control::Control;
use octant_base::failing::Failing;
use octant_cosim::experiment::GivenSettings;
use octant_cosim::order::SteppingOrder;
use octant_cosim::run::{PrepareError, PreparedSystem, ROWS_MAX, Request};
use octant_cosim::summary::{FmuResult, SystemEnded};
use octant_evidence::{FmuFacts, Manifest, RunFacts, RunFolder};
use octant_fmu_host::instance::{OpenOptions, ProcessPlace};
use octant_scenario::quantity::{UnitDimension, parse};
use octant_score::junit::junit_of;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Options for systems of FMUs alone.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options for a system of FMUs (FILE.ssp, FILE.ssd, or a folder)")]
pub(super) struct SystemArguments {
    /// Faults on connections, a TOML file, instead of those in the system.
    #[arg(long, value_name = "FILE")]
    faults: Option<PathBuf>,
    /// Requirements on signals of the system, a TOML file, instead of those in the system.
    #[arg(long, value_name = "FILE")]
    requirements: Option<PathBuf>,
    /// Change a tunable parameter at a time, repeatable: "plant.imu.angle_random_walk=1e-6@30 s".
    #[arg(long, value_name = "FMU.VARIABLE=VALUE@TIME")]
    tune: Vec<String>,
    /// Order of the FMUs: jacobi, or gauss-seidel=plant,calibrator.
    #[arg(long, value_name = "ORDER")]
    order: Option<SteppingOrder>,
    /// Communication step, such as "5 ms".
    #[arg(long, value_name = "TIME")]
    step: Option<String>,
    /// Time at which the run starts.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    start: Option<String>,
    /// Time at which the run ends.
    #[arg(long, value_name = "TIME")]
    stop: Option<String>,
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), help = format!(
        "Record every Nth step; by default N gives {ROWS_MAX} rows"
    ))]
    every: Option<u64>,
    /// Also record into values.csv.
    #[arg(long)]
    csv: bool,
    /// Maximum number of values that aren't numbers (NaN) from outputs into inputs; with more the run ends with an
    /// error. By default any number, with a warning.
    #[arg(long, value_name = "N")]
    nan_limit: Option<u64>,
    #[arg(long, value_name = "SECONDS", conflicts_with = "in_process", help = OpenOptions::limits_help())]
    time_limit: Option<String>,
    /// Run the FMUs in this process: faster, but a crash of an FMU ends this program too.
    #[arg(long)]
    in_process: bool,
    /// Run also FMUs that need the tools that made them.
    #[arg(long)]
    allow_tool: bool,
}

fn time(option: &str, text: Option<&str>) -> Result<Option<f64>, Failure> {
    let Some(text) = text else { return Ok(None) };
    match parse(text) {
        Ok(quantity) if quantity.is(UnitDimension::TIME) => Ok(Some(quantity.si)),
        _ => Err(Failure::input(format!(
            "{option}: found {text:?}, expected a time such as \"10 min\""
        ))),
    }
}

/// Options shared with runs of scenarios.
pub(super) struct SharedOptions<'a> {
    pub(super) path: &'a Path,
    pub(super) set: &'a [String],
    pub(super) fire: &'a [String],
    pub(super) seed: Option<u64>,
    pub(super) require: bool,
    pub(super) json: bool,
}

impl From<PrepareError> for Failure {
    fn from(error: PrepareError) -> Self {
        Self::of_kind(error.kind(), format!("failed to run the system: {error}"))
    }
}

/// Runs the system; `folder` makes the folder of the run.
pub(super) fn command(
    shared: &SharedOptions<'_>,
    arguments: &SystemArguments,
    folder: impl FnOnce() -> Result<RunFolder, Failure>,
) -> Result<Verdict, Failure> {
    let SharedOptions { path, set, fire, seed, require, json } = *shared;
    let SystemArguments {
        faults,
        requirements,
        tune,
        order,
        step,
        start,
        stop,
        every,
        csv,
        nan_limit,
        time_limit,
        in_process,
        allow_tool,
    } = arguments;
    let key = crate::signing::signing_key()?;
    let prepared = PreparedSystem::new(Request {
        path: path.to_owned(),
        said: GivenSettings {
            start_s: time("--start", start.as_deref())?,
            stop_s: time("--stop", stop.as_deref())?,
            step_s: time("--step", step.as_deref())?,
        },
        order: order.clone(),
        seed,
        faults: faults.clone(),
        requirements: requirements.clone(),
        fires: fire.to_vec(),
        set: set.to_vec(),
        tune: tune.clone(),
        place: if *in_process { ProcessPlace::ThisProcess } else { ProcessPlace::OwnProcess },
        allow_tool: *allow_tool,
        every: *every,
        require,
        no_numbers_max: *nan_limit,
        time_limit: time_limit.as_deref().map(time_limit_of).transpose()?,
    })?;
    for warning in prepared.warnings() {
        note!("octant: {warning}");
    }
    let texts =
        prepared.texts().map_err(|error| Failure::bench(format!("failed to read {error}")))?;
    watch_interrupts();
    let folder = folder()?;
    let started = SystemTime::now();
    let (recording, table) =
        (folder.path().join("recording.mcap"), folder.path().join("values.csv"));
    let mut paths: Vec<&Path> = vec![&recording];
    if *csv {
        paths.push(&table);
    }
    let (steps, step_s, seed) = (prepared.steps(), prepared.step_s(), prepared.seed());
    let control = Control::default();
    let ran = with_progress(std::slice::from_ref(&control), Some(steps), step_s, || {
        prepared.run(&paths, &control)
    });
    let results = match ran {
        Ok(results) => results,
        Err(error) => {
            // No step was made, so there is no evidence to keep.
            let path = folder.path().to_owned();
            drop(folder);
            let _ = std::fs::remove_dir_all(path);
            return Err(error.into());
        }
    };
    let summary = &results.summary;
    for (name, text) in texts {
        write(&folder.path().join(name), text)?;
    }
    let summary_json = summary
        .to_json()
        .map_err(|error| Failure::bench(format!("failed to write the summary: {error}")))?;
    write(&folder.path().join("summary.json"), &summary_json)?;
    let told = (summary.verdict, &summary.reasons[..]);
    let xml = junit_of(&summary.system, seed, &summary.requirements, &summary.faults, told, None)
        .map_err(|error| Failure::bench(format!("failed to write junit.xml: {error}")))?;
    write(&folder.path().join("junit.xml"), xml)?;
    if !results.messages.is_empty() {
        let lines = results.messages.iter().map(|(fmu, text)| format!("{fmu} {text}\n"));
        write(&folder.path().join("messages.txt"), lines.collect::<String>())?;
    }
    let facts = RunFacts {
        seed: Some(seed),
        command_line: rerun(shared, arguments, seed),
        fmus: summary.fmus.iter().map(|fmu| facts(fmu, *in_process)).collect(),
        key,
        ..RunFacts::between(started, SystemTime::now())
    };
    Manifest::write(folder.path(), &facts)
        .map_err(|error| Failure::bench(format!("failed to {error}")))?;
    let place = if matches!(summary.ended, SystemEnded::Interrupted { .. }) {
        // An unfinished run keeps the name of a partial folder.
        folder.path().to_owned()
    } else {
        folder.finish().map_err(|error| Failure::bench(format!("failed to {error}")))?
    };
    if let SystemEnded::Failed { reason, .. } = &summary.ended {
        // With --json stdout is for programs, and the folder of a failed job may be gone.
        note!("octant: {reason}");
        note!("octant: the run broke off; the recorded part is in {}", place.display());
    }
    if json {
        print(&summary_json)?;
    } else {
        print(&summary.text())?;
        print(&format!("{}\n", place.display()))?;
    }
    Ok(summary.verdict)
}

/// Collects the manifest's facts about an FMU.
fn facts(fmu: &FmuResult, in_process: bool) -> FmuFacts {
    FmuFacts {
        role: fmu.name.clone(),
        file: fmu.source.clone(),
        sha256: fmu.sha256.clone(),
        model: fmu.model.clone(),
        token: fmu.token.clone(),
        fmi: fmu.fmi.clone(),
        generation_tool: fmu.generation_tool.clone(),
        process: if in_process { "shared" } else { "own" }.to_owned(),
        only_once: false,
    }
}

/// Returns the command line that makes the run again, with the seed that was used.
fn rerun(shared: &SharedOptions<'_>, arguments: &SystemArguments, used_seed: u64) -> Vec<String> {
    // Neither where the summary goes nor a seed that wasn't given makes another run.
    let SharedOptions { path, set, fire, seed: _, require, json: _ } = *shared;
    let SystemArguments {
        faults,
        requirements,
        tune,
        order,
        step,
        start,
        stop,
        every,
        csv,
        nan_limit,
        time_limit,
        in_process,
        allow_tool,
    } = arguments;
    let mut line = vec!["octant".to_owned(), "run".to_owned(), path.display().to_string()];
    let mut add = |option: &str, value: Option<String>| {
        if let Some(value) = value {
            line.extend([option.to_owned(), value]);
        }
    };
    for (option, values) in [("--set", set), ("--tune", tune), ("--fire", fire)] {
        values.iter().for_each(|value| add(option, Some(value.clone())));
    }
    add("--faults", faults.as_ref().map(|path| path.display().to_string()));
    add("--requirements", requirements.as_ref().map(|path| path.display().to_string()));
    add("--order", order.as_ref().map(ToString::to_string));
    add("--step", step.clone());
    add("--start", start.clone());
    add("--stop", stop.clone());
    add("--time-limit", time_limit.clone());
    add("--nan-limit", nan_limit.map(|limit| limit.to_string()));
    add("--every", every.map(|every| every.to_string()));
    add("--seed", Some(used_seed.to_string()));
    for (option, is_given) in [
        ("--require", require),
        ("--csv", *csv),
        ("--in-process", *in_process),
        ("--allow-tool", *allow_tool),
    ] {
        if is_given {
            line.push(option.to_owned());
        }
    }
    line
}
