//! A run with its evidence: from a request to a folder with recording, summary, report and manifest.

use crate::arguments::read_scenario;
use crate::failure::Failure;
use crate::live::Live;
use crate::progress::with_progress;
use crate::run_folder::{free_name, in_the_way};
use crate::terminal::{note, print, write};
use octant_evidence::{Existing, FmuFacts, Manifest, RunFacts, RunFolder};
use octant_report as report;
use octant_requirements::Verdict;
use octant_requirements::equipment::Day;
use octant_run::assemble::{Choice, assemble_with, parameter_text, text};
use octant_run::findings::broken as what_broke;
use octant_run::method::MethodError;
use octant_run::{Ended, MethodRun, Prepared, PreparedError, Run, raw_counts};
use octant_scenario::{Method, Scenario};
use octant_score::junit::junit;
use octant_source::configure::configurations;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Request for a run of a scenario.
#[derive(Clone, Debug, Default)]
pub(crate) struct Request {
    /// File of the scenario.
    pub(crate) scenario: PathBuf,
    /// Changes of its keys, `KEY=VALUE`.
    pub(crate) set: Vec<String>,
    /// Folder of the run; by default a new one in ./runs.
    pub(crate) out: Option<PathBuf>,
    /// Replaces a run in the folder.
    pub(crate) force: bool,
    /// Seed, instead of the scenario's.
    pub(crate) seed: Option<u64>,
    /// URI of the source, instead of the scenario's.
    pub(crate) source: Option<String>,
    /// URI of the endpoint, instead of the scenario's.
    pub(crate) endpoint: Option<String>,
    /// Faults that are triggered by hand, `ID=TIME`.
    pub(crate) fire: Vec<String>,
    /// Ids of the faults that are injected; `None` for all.
    pub(crate) only_faults: Option<Vec<String>>,
    /// The faults are the ones that a campaign plans for its case: none is left out.
    pub(crate) planned_faults: bool,
    /// Counts a run of which nothing is required as inconclusive.
    pub(crate) require: bool,
    /// Runs by the clock.
    pub(crate) realtime: bool,
    /// Leaves out the twins.
    pub(crate) no_twin: bool,
    /// Address at which the run is served to Foxglove.
    pub(crate) live: Option<String>,
    /// Prints the summary as JSON.
    pub(crate) json: bool,
}

/// Runs a scenario and writes its evidence.
pub(crate) fn run(request: &Request) -> Result<Verdict, Failure> {
    let mut more = Vec::new();
    if let Some(uri) = &request.source {
        more.push(format!("source.uri={}", from_here(uri)?));
    }
    if let Some(uri) = &request.endpoint {
        more.push(format!("endpoint.uri={}", from_here(uri)?));
    }
    if request.realtime {
        more.push("realtime.pace=\"clock\"".to_owned());
    }
    let mut scenario = read_scenario(&request.scenario, &request.set, &more, &request.fire)?;
    let mut left_out = Vec::new();
    if let Some(faults) = &request.only_faults {
        // `--only-faults=` gives one empty name.
        let faults: Vec<String> = faults.iter().filter(|id| !id.is_empty()).cloned().collect();
        if !request.planned_faults {
            let all = scenario.faults.iter().map(|fault| fault.spec.id.clone());
            left_out = all.filter(|id| !faults.contains(id)).collect();
        }
        scenario = scenario.with_only(&faults).map_err(|reason| {
            let file = request.scenario.display();
            Failure::input(format!("{file}: --only-faults: {reason}"))
        })?;
    }
    let seed = request.seed.unwrap_or(scenario.seed);
    // Contradictions, and sources that can't be opened, are reported before anything is written. A
    // real instrument doesn't repeat its measurements, so it has no twin.
    let once = scenario.source.instrument().is_some();
    let twins = !request.no_twin && !once;
    if once && !request.no_twin && !scenario.faults.is_empty() {
        note!("octant: no twin run: a real instrument doesn't repeat its measurements");
    }
    let prepared = prepare(&scenario, seed, twins)?;
    let fmus = fmus(&scenario, prepared.tasks())?;
    let inputs = octant_evidence::inputs(&scenario)
        .map_err(|error| Failure::input(format!("failed to {error}")))?;
    let key = crate::signing::signing_key()?;
    let mut live = request.live.as_deref().map(Live::start).transpose()?;
    let (path, existing) = match &request.out {
        Some(path) if request.force => (path.clone(), Existing::Replace),
        Some(path) => (path.clone(), Existing::Refuse),
        None => (free_name(&request.scenario), Existing::Refuse),
    };
    let folder = RunFolder::create(&path, existing)
        .map_err(|error| Failure::input(format!("failed to {}", in_the_way(&error))))?;
    if let Some(live) = &mut live {
        live.follow(folder.path())?;
    }
    let started = SystemTime::now();
    let (_, _, draws) = configurations(&scenario, Method::Primary, seed)
        .map_err(|e| Failure::input(format!("failed to {e}")))?;
    write(&folder.path().join("scenario.toml"), scenario.to_resolved_toml(seed, &draws))?;

    let runs = execute(&prepared, &scenario, folder.path())?;
    let unfinished = |ended| matches!(ended, Ended::Cancelled | Ended::Broken);
    let interrupted = runs.iter().any(|run| {
        unfinished(run.ended) || run.twin.as_ref().is_some_and(|twin| twin.ended == Ended::Broken)
    });
    let broken = runs.iter().find_map(|run| run.broken.as_ref().map(ToString::to_string));
    // With a full disk, there may be no space for the results either.
    let failed = |failure: Failure| match &broken {
        None => failure,
        Some(reason) => {
            let message = format!("failed to {reason}; and {}", failure.message);
            Failure { message, ..failure }
        }
    };
    let mut runs = runs.into_iter();
    let (Some(primary), baseline) = (runs.next(), runs.next()) else {
        return Err(Failure::bench("failed to run the scenario: no method ran"));
    };
    let tables = [
        ("calibration", primary.table.clone()),
        ("baseline", baseline.as_ref().and_then(|b| b.table.clone())),
    ];
    let reasons = what_broke(&primary, baseline.as_ref());
    let link = primary.link.as_ref().and_then(|link| serde_json::to_value(link).ok());
    let bench = primary.bench.as_ref().and_then(|bench| serde_json::to_value(bench).ok());
    let realtime = primary.kept.as_ref().map(|kept| kept.granted.clone());
    let refused = primary.calibration.as_ref().is_some_and(|c| c.refused.is_some());
    let estimate = primary.watcher.last_parameters.map(|e| e.parameters).filter(|_| !refused);
    // Certificates are compared with the day in the manifest.
    let ended = SystemTime::now();
    let choice = Choice { require: request.require, left_out, day: Some(Day::of(ended)) };
    let run = assemble_with(&scenario, seed, primary, baseline, &choice)
        .map_err(|error| Failure::bench(format!("failed to write the summary: {error}")))?;
    for (name, table) in tables {
        if let Some(table) = table {
            let path = folder.path().join(format!("{name}.octcal"));
            write(&path, table.to_bytes()).map_err(failed)?;
        }
    }
    let facts = RunFacts {
        seed: Some(seed),
        command_line: rerun(request, seed),
        fmus,
        link,
        bench,
        realtime,
        key,
        inputs,
        equipment: scenario.equipment.clone(),
        ..RunFacts::between(started, ended)
    };
    let raw = estimate.map_or(String::new(), |e| raw_counts::text(&scenario.source, &e));
    let (verdict, json) = write_results(folder.path(), run, &facts).map_err(failed)?;
    let place = if interrupted {
        // An unfinished run keeps the name of a partial folder.
        folder.path().to_owned()
    } else {
        folder.finish().map_err(|error| Failure::bench(format!("failed to {error}")))?
    };
    if !reasons.is_empty() {
        // With --json stdout is for programs, and the folder of a failed job may be gone.
        for reason in &reasons {
            note!("octant: {reason}");
        }
        note!("octant: the run broke off; the recorded part is in {}", place.display());
    }
    if request.json {
        print(&json.text)?;
    } else {
        print(&(json.human + &raw))?;
        print(&format!("{}\n", place.join("report.html").display()))?;
    }
    Ok(verdict)
}

/// Prepares the methods of a scenario.
pub(crate) fn prepare(
    scenario: &Scenario,
    seed: u64,
    twins: bool,
) -> Result<Prepared<'_>, Failure> {
    Prepared::of(scenario, seed, twins)
        .map_err(|error| Failure::from(MethodError::from(error)).failed())
}

/// Runs the methods of a scenario, with their progress on the terminal.
pub(crate) fn execute(
    prepared: &Prepared<'_>,
    scenario: &Scenario,
    folder: &Path,
) -> Result<Vec<MethodRun>, Failure> {
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let runs =
        with_progress(prepared.controls(), prepared.epochs(), sample_s, || prepared.run(folder));
    runs.map_err(|error| {
        let failure = match error {
            PreparedError::Method(error) => Failure::from(error),
            PreparedError::Panicked => Failure::bench(error),
        };
        let place = folder.display();
        let message = format!("failed to {}; the recorded part is in {place}", failure.message);
        Failure { message, ..failure }
    })
}

/// Collects the manifest's facts about the FMUs of a run with a number of parallel tasks.
fn fmus(scenario: &Scenario, tasks: usize) -> Result<Vec<FmuFacts>, Failure> {
    let fmus =
        octant_evidence::fmus(scenario).map_err(|e| Failure::input(format!("failed to {e}")))?;
    match fmus.iter().find(|fmu| fmu.only_once && fmu.process == "shared") {
        Some(fmu) if tasks > 1 => Err(Failure::input(format!(
            "failed to run {tasks} instances of {}: a process can hold only one, expected \
             process = \"own\" in {}.fmu",
            fmu.file, fmu.role
        ))),
        _ => Ok(fmus),
    }
}

/// Output of a run, for programs and for readers.
struct Printed {
    text: String,
    human: String,
}

/// Writes summary, JUnit, report and manifest.
fn write_results(
    folder: &Path,
    mut run: Run,
    facts: &RunFacts,
) -> Result<(Verdict, Printed), Failure> {
    let summary = &run.summary;
    let text_json = summary
        .to_json()
        .map_err(|error| Failure::bench(format!("failed to write the summary: {error}")))?;
    write(&folder.join("summary.json"), &text_json)?;
    let xml = junit(summary)
        .map_err(|error| Failure::bench(format!("failed to write junit.xml: {error}")))?;
    write(&folder.join("junit.xml"), xml)?;
    let mut human = text(summary, &run.report.units);
    if run.report.truth.is_none() {
        human += &parameter_text(summary);
    }
    run.report.provenance = crate::report::provenance(&Manifest::of(facts));
    write(&folder.join("report.html"), report::run::render(&run.report))?;
    Manifest::write(folder, facts).map_err(|error| Failure::bench(format!("failed to {error}")))?;
    Ok((summary.verdict, Printed { text: text_json, human }))
}

/// Returns the command line that makes the run again, with the seed that was used.
fn rerun(request: &Request, seed: u64) -> Vec<String> {
    let mut line =
        vec!["octant".to_owned(), "run".to_owned(), request.scenario.display().to_string()];
    for set in &request.set {
        line.extend(["--set".to_owned(), set.clone()]);
    }
    for (name, uri) in [("--source", &request.source), ("--endpoint", &request.endpoint)] {
        if let Some(uri) = uri {
            line.extend([name.to_owned(), uri.clone()]);
        }
    }
    for fire in &request.fire {
        line.extend(["--fire".to_owned(), fire.clone()]);
    }
    if let Some(faults) = &request.only_faults {
        line.push(format!("--only-faults={}", faults.join(",")));
    }
    if request.require {
        line.push("--require".to_owned());
    }
    if request.realtime {
        line.push("--realtime".to_owned());
    }
    if request.no_twin {
        line.push("--no-twin".to_owned());
    }
    line.extend(["--seed".to_owned(), seed.to_string()]);
    line
}

/// Runs a scenario on a recording, by replacing its source with this file.
pub(crate) fn on_recording(
    scenario: &Path,
    recording: &Path,
    set: &[String],
    out: Option<&Path>,
    json: bool,
) -> Result<Verdict, Failure> {
    let kind = match recording.extension().and_then(|e| e.to_str()) {
        Some("mcap") => "replay",
        _ => "text",
    };
    let recording = std::path::absolute(recording).map_err(|error| {
        Failure::input(format!("failed to find {}: {error}", recording.display()))
    })?;
    run(&Request {
        scenario: scenario.to_owned(),
        set: set.to_vec(),
        out: out.map(Path::to_owned),
        source: Some(format!("{kind}:{}", recording.display())),
        json,
        ..Request::default()
    })
}

/// Runs a case of a campaign with all the evidence of a run.
pub(crate) fn case(
    scenario: &Path,
    case: &octant_campaign::plan::Case,
    out: &Path,
) -> Result<Verdict, Failure> {
    run(&Request {
        scenario: scenario.to_owned(),
        set: case.set.clone(),
        out: Some(out.to_owned()),
        seed: Some(case.seed),
        only_faults: case.faults.clone(),
        planned_faults: true,
        require: true,
        ..Request::default()
    })
}

/// Makes the file of a source absolute: a name on the command line is relative to the current
/// folder, one in a scenario to the scenario's.
fn from_here(uri: &str) -> Result<String, Failure> {
    match uri.split_once(':') {
        Some((kind @ ("replay" | "text" | "fmu"), file))
            if !file.is_empty() && !file.starts_with("${") =>
        {
            let file = std::path::absolute(file)
                .map_err(|error| Failure::input(format!("failed to find {file}: {error}")))?;
            Ok(format!("{kind}:{}", file.display()))
        }
        _ => Ok(uri.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_on_the_command_line_starts_at_the_current_folder() {
        let here = std::env::current_dir().unwrap();
        let found = from_here("replay:a/b.mcap").unwrap();
        assert_eq!(found, format!("replay:{}", here.join("a/b.mcap").display()));
        for same in ["plant", "text:/c/d.txt", "text:${OCTANT_RECORDINGS}/e.txt", "replay:"] {
            assert_eq!(from_here(same).unwrap(), same);
        }
    }
}
