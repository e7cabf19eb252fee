//! `octant run`.

use super::live::Live;
use super::progress::with_progress;
use super::{Failure, ScenarioArguments, load_fired, print, write};
use crate::endpoint::LiveEndpoint;
use crate::evidence::{self, Existing, FmuFacts, FolderError, Manifest, RunFacts, RunFolder};
use crate::report;
use crate::run::assemble::{Choice, assemble_with, parameter_text, text};
use crate::run::findings::broken as what_broke;
use crate::run::method::{MethodError, SetupError, configurations, run_as_far_as_it_goes};
use crate::run::raw_counts;
use crate::run::{Control, Ended, MethodRun, Recording, Run};
use crate::source::LiveSource;
use clap::Args;
use octant_requirements::Verdict;
use octant_requirements::equipment::Day;
use octant_scenario::{Endpoint, Method, Scenario, Source};
use octant_score::junit::junit;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Folder of the run; by default a new one in ./runs.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the folder if it holds a run already.
    #[arg(long, requires = "out")]
    force: bool,
    /// Seed of everything that is drawn, instead of the scenario's.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Where samples come from, instead of the scenario's source.uri.
    #[arg(long, value_name = "URI")]
    source: Option<String>,
    /// Where the core is, instead of the scenario's endpoint.
    #[arg(long, value_name = "URI")]
    endpoint: Option<String>,
    /// Fire a fault whose trigger is manual, such as spike-1="5050 s".
    #[arg(long, value_name = "ID=TIME")]
    fire: Vec<String>,
    /// Inject these of the scenario's faults alone; --only-faults= none of them.
    #[arg(long, value_name = "ID,ID", value_delimiter = ',', require_equals = true, num_args = 0..)]
    only_faults: Option<Vec<String>>,
    /// The faults are those that a campaign plans for its case: none is left out.
    #[arg(skip)]
    planned_faults: bool,
    /// Count it as inconclusive where the scenario requires nothing: for pipelines, which mustn't stay
    /// green after somebody emptied the list.
    #[arg(long)]
    require: bool,
    /// Go by the clock: a sample leaves when its time has come, as with realtime.pace = "clock".
    #[arg(long)]
    realtime: bool,
    /// Leave out the twin without faults, which a run with faults is compared with.
    #[arg(long)]
    no_twin: bool,
    /// Serve the run to Foxglove while it goes on; by default to this host alone.
    #[arg(
        long,
        value_name = "ADDRESS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = super::live::DEFAULT_ADDRESS
    )]
    live: Option<String>,
    /// Print summary.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    system: super::run_system::SystemArguments,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    if crate::fmu::master::ssp::package::is_system(&arguments.scenario.scenario) {
        return system(arguments);
    }
    if let Some(option) = arguments.system.first_given() {
        return Err(Failure::input(format!(
            "{option} is for systems of FMUs, and {} is a scenario",
            arguments.scenario.scenario.display()
        )));
    }
    let mut more = Vec::new();
    if let Some(uri) = &arguments.source {
        more.push(format!("source.uri={}", from_here(uri)?));
    }
    if let Some(uri) = &arguments.endpoint {
        more.push(format!("endpoint.uri={}", from_here(uri)?));
    }
    if arguments.realtime {
        more.push("realtime.pace=\"clock\"".to_owned());
    }
    let mut scenario = load_fired(&arguments.scenario, &more, &arguments.fire)?;
    let mut left_out = Vec::new();
    if let Some(faults) = &arguments.only_faults {
        // `--only-faults=` comes as one empty name.
        let faults: Vec<String> = faults.iter().filter(|id| !id.is_empty()).cloned().collect();
        if !arguments.planned_faults {
            let all = scenario.faults.iter().map(|fault| fault.spec.id.clone());
            left_out = all.filter(|id| !faults.contains(id)).collect();
        }
        scenario = scenario.with_only(&faults).map_err(|reason| {
            let file = arguments.scenario.scenario.display();
            Failure::input(format!("{file}: --only-faults: {reason}"))
        })?;
    }
    let seed = arguments.seed.unwrap_or(scenario.seed);
    // What contradicts itself, or can't be opened, is said before anything is written.
    // A real instrument doesn't measure the same a second time.
    let once = matches!(scenario.source, Source::Live(_));
    let twins = !arguments.no_twin && !once;
    if once && !arguments.no_twin && !scenario.faults.is_empty() {
        note!("octant: no twin without faults: a real instrument doesn't measure the same again");
    }
    let tasks = tasks(&scenario, twins);
    for method in methods(&scenario) {
        set_up(&scenario, method, seed)?;
    }
    let fmus = fmus(&scenario, tasks)?;
    let inputs = evidence::inputs(&scenario)
        .map_err(|error| Failure::input(format!("failed to {error}")))?;
    let key = super::verify::signing_key()?;
    let mut live = arguments.live.as_deref().map(Live::start).transpose()?;
    let (path, existing) = match &arguments.out {
        Some(path) if arguments.force => (path.clone(), Existing::Replace),
        Some(path) => (path.clone(), Existing::Refuse),
        None => (free_name(&arguments.scenario.scenario), Existing::Refuse),
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

    let runs = execute(&scenario, seed, twins, folder.path())?;
    let unfinished = |ended| matches!(ended, Ended::Cancelled | Ended::Broken);
    let interrupted = runs.iter().any(|run| {
        unfinished(run.ended) || run.twin.as_ref().is_some_and(|twin| twin.ended == Ended::Broken)
    });
    let broken = runs.iter().find_map(|run| run.broken.as_ref().map(ToString::to_string));
    // Where the disk is full, there may be no room for the results either.
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
    let (link, bench) = (primary.link.clone(), primary.bench.clone());
    let realtime = primary.kept.as_ref().map(|kept| kept.granted.clone());
    let refused = primary.calibration.as_ref().is_some_and(|c| c.refused.is_some());
    let estimate = primary.watcher.last_parameters.map(|e| e.parameters).filter(|_| !refused);
    // Certificates are held against the day that stands in the manifest.
    let ended = SystemTime::now();
    let choice = Choice { require: arguments.require, left_out, day: Some(Day::of(ended)) };
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
        command_line: rerun(arguments, seed),
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
        // An unfinished run keeps the name of one.
        folder.path().to_owned()
    } else {
        folder.finish().map_err(|error| Failure::bench(format!("failed to {error}")))?
    };
    if !reasons.is_empty() {
        // With --json stdout is for programs, and the folder of a job that failed may be gone.
        for reason in &reasons {
            note!("octant: {reason}");
        }
        note!("octant: the run broke off; what was recorded is in {}", place.display());
    }
    if arguments.json {
        print(&json.text)?;
    } else {
        print(&(json.human + &raw))?;
        print(&format!("{}\n", place.join("report.html").display()))?;
    }
    Ok(verdict)
}

/// Sets up a method as a run does, and leaves it again.
fn set_up(scenario: &Scenario, method: Method, seed: u64) -> Result<(), Failure> {
    let failure = |error: SetupError| Failure::from(MethodError::from(error)).failed();
    let (plant, core, _) = configurations(scenario, method, seed).map_err(failure)?;
    octant_calibration::Core::new(&core).map_err(|error| failure(error.into()))?;
    // An instrument's port is opened once too: what it sends meanwhile would be lost.
    if let Source::Live(instrument) = &scenario.source {
        LiveSource::check(scenario, instrument).map_err(|error| failure(error.into()))?;
    } else {
        crate::source::open(scenario, &plant).map_err(|error| failure(error.into()))?;
    }
    // A device is greeted once, when the run begins: some restart when their port is opened.
    match &scenario.endpoint {
        Endpoint::Live(live) => LiveEndpoint::check(scenario, live),
        _ => crate::endpoint::open(scenario, &core).map(|_| ()),
    }
    .map_err(|error| failure(error.into()))?;
    Ok(())
}

/// Runs that go on at the same time: methods, and their twins.
fn tasks(scenario: &Scenario, twins: bool) -> usize {
    let twins = twins && !scenario.faults.is_empty();
    methods(scenario).len() * if twins { 2 } else { 1 }
}

/// What the manifest says about the FMUs of a run of so many tasks.
fn fmus(scenario: &Scenario, tasks: usize) -> Result<Vec<FmuFacts>, Failure> {
    let fmus = evidence::fmus(scenario).map_err(|e| Failure::input(format!("failed to {e}")))?;
    match fmus.iter().find(|fmu| fmu.only_once && fmu.process == "shared") {
        Some(fmu) if tasks > 1 => Err(Failure::input(format!(
            "failed to run {tasks} instances of {}: it can be there once in a process, expected \
             process = \"own\" in {}.fmu",
            fmu.file, fmu.role
        ))),
        _ => Ok(fmus),
    }
}

/// Runs a system of FMUs.
fn system(arguments: &Arguments) -> Result<Verdict, Failure> {
    let path = &arguments.scenario.scenario;
    let given = [
        ("--source", arguments.source.is_some()),
        ("--endpoint", arguments.endpoint.is_some()),
        ("--realtime", arguments.realtime),
        ("--no-twin", arguments.no_twin),
        ("--only-faults", arguments.only_faults.is_some()),
        ("--live", arguments.live.is_some()),
    ];
    if let Some((option, _)) = given.into_iter().find(|(_, given)| *given) {
        return Err(Failure::input(format!(
            "{option} is for scenarios, and {} is a system of FMUs",
            path.display()
        )));
    }
    let out = arguments.out.clone().unwrap_or_else(|| free_name(path));
    let existing = if arguments.force { Existing::Replace } else { Existing::Refuse };
    super::run_system::command(
        &super::run_system::Shared {
            path,
            set: &arguments.scenario.set,
            fire: &arguments.fire,
            seed: arguments.seed,
            json: arguments.json,
        },
        &arguments.system,
        || {
            RunFolder::create(&out, existing)
                .map_err(|error| Failure::input(format!("failed to {}", in_the_way(&error))))
        },
    )
}

/// A source with its file made absolute: a name on the command line starts at the current folder,
/// one in a scenario at the scenario's.
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

/// Why the folder can't be made, with the option that replaces what is there.
fn in_the_way(error: &FolderError) -> String {
    match error {
        FolderError::Finished { .. } | FolderError::Unfinished { .. } => {
            format!("{error}; --out DIR --force replaces it")
        }
        _ => error.to_string(),
    }
}

/// What is printed of a run, by who reads it.
struct Printed {
    text: String,
    human: String,
}

/// The methods of a scenario.
fn methods(scenario: &Scenario) -> Vec<Method> {
    let baseline = scenario.baseline.as_ref().map(|_| Method::Baseline);
    std::iter::once(Method::Primary).chain(baseline).collect()
}

/// Runs the methods of a scenario, and their twins without faults, each on a thread of its own; by
/// the clock one method after the other, so that none makes another one late.
pub(super) fn execute(
    scenario: &Scenario,
    seed: u64,
    twins: bool,
    folder: &Path,
) -> Result<Vec<MethodRun>, Failure> {
    let clean = (twins && !scenario.faults.is_empty()).then(|| {
        // What is computed doesn't depend on the clock: a twin needs no second day.
        let mut clean = scenario.without_faults();
        clean.realtime.by_clock = false;
        clean
    });
    let tasks: Vec<(Method, Option<&Scenario>)> = methods(scenario)
        .into_iter()
        .flat_map(|method| {
            let twin = clean.as_ref().map(|clean| (method, Some(clean)));
            std::iter::once((method, None)).chain(twin)
        })
        .collect();
    let controls: Vec<Control> = tasks.iter().map(|_| Control::default()).collect();
    let epochs = scenario.samples().map(|samples| samples * tasks.len() as u64);
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let results = with_progress(&controls, epochs, sample_s, || {
        let one = |(method, clean): &(Method, Option<&Scenario>), control: &Control| {
            let path = folder.join(match method {
                Method::Primary => "recording.mcap",
                Method::Baseline => "baseline.mcap",
            });
            let (scenario, recording) = match clean {
                None => (scenario, Recording::File(&path)),
                Some(clean) => (*clean, Recording::Hash),
            };
            run_as_far_as_it_goes(scenario, *method, seed, recording, control)
        };
        // A device does one thing after the other.
        let alone = scenario.realtime.by_clock || matches!(scenario.endpoint, Endpoint::Live(_));
        let at_once = if alone { 1 } else { tasks.len() };
        let mut results = Vec::with_capacity(tasks.len());
        for (tasks, controls) in tasks.chunks(at_once).zip(controls.chunks(at_once)) {
            std::thread::scope(|scope| {
                let one = &one;
                let threads: Vec<_> = (tasks.iter().zip(controls))
                    .map(|(task, control)| scope.spawn(move || one(task, control)))
                    .collect();
                results.extend(threads.into_iter().map(|thread| match thread.join() {
                    Ok(result) => result.map_err(Failure::from),
                    Err(_) => Err(Failure::bench("failed to run a method: its thread panicked")),
                }));
            });
        }
        results
    });
    let runs: Vec<MethodRun> =
        results.into_iter().collect::<Result<_, _>>().map_err(|failure: Failure| Failure {
            status: failure.status,
            message: format!(
                "failed to {}; what was recorded is in {}",
                failure.message,
                folder.display()
            ),
        })?;
    let mut paired: Vec<MethodRun> = Vec::with_capacity(runs.len());
    for (run, (_, clean)) in runs.into_iter().zip(&tasks) {
        match (clean, paired.last_mut()) {
            (Some(_), Some(faulted)) => faulted.twin = Some(Arc::new(run)),
            _ => paired.push(run),
        }
    }
    Ok(paired)
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
    let mut human = text(summary);
    if run.report.truth.is_none() {
        human += &parameter_text(summary);
    }
    run.report.provenance = super::report::provenance(&Manifest::of(facts));
    write(&folder.join("report.html"), report::run::render(&run.report))?;
    Manifest::write(folder, facts).map_err(|error| Failure::bench(format!("failed to {error}")))?;
    Ok((summary.verdict, Printed { text: text_json, human }))
}

/// The command line that makes the run again, with the seed that was used.
fn rerun(arguments: &Arguments, seed: u64) -> Vec<String> {
    let mut line = vec![
        "octant".to_owned(),
        "run".to_owned(),
        arguments.scenario.scenario.display().to_string(),
    ];
    for set in &arguments.scenario.set {
        line.extend(["--set".to_owned(), set.clone()]);
    }
    for (name, uri) in [("--source", &arguments.source), ("--endpoint", &arguments.endpoint)] {
        if let Some(uri) = uri {
            line.extend([name.to_owned(), uri.clone()]);
        }
    }
    for fire in &arguments.fire {
        line.extend(["--fire".to_owned(), fire.clone()]);
    }
    if let Some(faults) = &arguments.only_faults {
        line.push(format!("--only-faults={}", faults.join(",")));
    }
    if arguments.require {
        line.push("--require".to_owned());
    }
    if arguments.realtime {
        line.push("--realtime".to_owned());
    }
    if arguments.no_twin {
        line.push("--no-twin".to_owned());
    }
    line.extend(["--seed".to_owned(), seed.to_string()]);
    line
}

/// A folder in ./runs that isn't taken.
fn free_name(scenario: &Path) -> PathBuf {
    let stem = scenario.file_stem().map_or("run".into(), |stem| stem.to_string_lossy());
    let name = |n: u32| {
        Path::new("runs").join(if n == 1 { stem.to_string() } else { format!("{stem}-{n}") })
    };
    let taken = |path: &PathBuf| {
        let mut partial = path.clone().into_os_string();
        partial.push(".partial");
        path.exists() || Path::new(&partial).exists()
    };
    (1..).map(name).find(|path| !taken(path)).unwrap_or_else(|| name(1))
}

/// Runs a scenario on a recording: its source section with this file.
pub(super) fn on_recording(
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
    command(&Arguments {
        scenario: ScenarioArguments { scenario: scenario.to_owned(), set: set.to_vec() },
        out: out.map(Path::to_owned),
        force: false,
        seed: None,
        source: Some(format!("{kind}:{}", recording.display())),
        endpoint: None,
        fire: Vec::new(),
        only_faults: None,
        planned_faults: false,
        require: false,
        realtime: false,
        no_twin: false,
        live: None,
        json,
        system: super::run_system::SystemArguments::default(),
    })
}

/// Runs a case of a campaign with all the evidence of a run.
pub(super) fn case(
    scenario: &Path,
    case: &crate::campaign::plan::Case,
    out: &Path,
) -> Result<Verdict, Failure> {
    command(&Arguments {
        scenario: ScenarioArguments { scenario: scenario.to_owned(), set: case.set.clone() },
        out: Some(out.to_owned()),
        force: false,
        seed: Some(case.seed),
        source: None,
        endpoint: None,
        fire: Vec::new(),
        only_faults: case.faults.clone(),
        planned_faults: true,
        require: true,
        realtime: false,
        no_twin: false,
        live: None,
        json: false,
        system: super::run_system::SystemArguments::default(),
    })
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
