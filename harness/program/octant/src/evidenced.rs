//! A run with its evidence: from a request to a folder with recording, summary, report and manifest.

use crate::asked::{Answers, Asked, Evidence, execute, prepare, without_fmus};
use crate::attendant::Attendant;
use crate::failure::Failure;
use crate::live::Live;
use crate::progress::Follower;
use crate::run_request::RunRequest;
use crate::terminal::{note, print};
use octant_fmu_bind::OpenedFmus;
use octant_run::prepared;
use octant_scenario::{Scenario, SourceSpec};
use octant_trajectory::TrajectoryReader;
use octant_verdict::Verdict;
use std::path::Path;

/// Runs a scenario, writes its evidence, and prints the results.
pub(crate) fn run(request: &RunRequest) -> Result<Verdict, Failure> {
    let evidence = evidence(request, &Follower::Terminal)?;
    if !evidence.broken.is_empty() {
        // With --json stdout is for programs, and the folder of a failed job may be gone.
        for reason in &evidence.broken {
            note!("octant: {reason}");
        }
        note!("octant: the run broke off; the recorded part is in {}", evidence.folder.display());
    }
    if request.json {
        print(&evidence.summary)?;
    } else {
        print(&evidence.text)?;
        print(&format!("{}\n", evidence.folder.join("report.html").display()))?;
    }
    Ok(evidence.verdict)
}

/// Runs a scenario and writes its evidence.
pub(crate) fn evidence(request: &RunRequest, follower: &Follower<'_>) -> Result<Evidence, Failure> {
    let asked = Asked::of(request)?;
    if asked.scenario.solution_line().is_some() {
        return crate::line_solution::evidence(request, asked, follower);
    }
    let (scenario, seed) = (&asked.scenario, asked.seed);
    // Contradictions, and sources that can't be opened, are reported before anything is written. A
    // real instrument doesn't repeat its measurements, so it has no twin.
    let once = scenario.source.instrument().is_some();
    let twins = !request.no_twin && !once;
    if once && !request.no_twin && !scenario.faults.is_empty() {
        note!("octant: no twin run: a real instrument doesn't repeat its measurements");
    }
    let opened = OpenedFmus::default();
    let tasks = prepared::tasks(scenario, twins);
    let fmus = octant_evidence::fmus(scenario, tasks, &opened).map_err(without_fmus)?;
    let prepared = prepare(scenario, seed, twins, &opened)?;
    tell_choices(scenario)?;
    if request.stop_when_lost {
        prepared.stop_when_lost().map_err(Failure::input)?;
    }
    let plan = request.operator.plan(scenario)?;
    let mut live = request.live.as_deref().map(Live::start).transpose()?;
    follower.watch_interrupts();
    let begun = asked.begin(request, fmus)?;
    let folder = begun.folder.path();
    let attendant = plan.map(|plan| Attendant::open(plan, scenario, folder)).transpose()?;
    if let Some(live) = &mut live {
        live.follow(begun.folder.path())?;
    }
    let run = || execute(&prepared, scenario, begun.folder.path(), follower);
    let (runs, answers) = match attendant {
        None => (run()?, Answers::default()),
        Some(attendant) => {
            prepared.attend(&attendant.desk().attendance());
            let runs = attendant.during(prepared.controls(), run);
            let reasons = attendant.desk().close();
            (runs?, Answers { records: attendant.desk().records_from(0), reasons })
        }
    };
    asked.conclude(request, begun, runs, answers)
}

/// Tells what was chosen in reading the files of a solution.
fn tell_choices(scenario: &Scenario) -> Result<(), Failure> {
    let SourceSpec::Solution(spec) = &scenario.source else { return Ok(()) };
    for trajectory in std::iter::once(&spec.solution).chain(spec.reference.file()) {
        let path = trajectory.file.path(&scenario.folder).map_err(Failure::input)?;
        let reader = TrajectoryReader::open(&path, &trajectory.format).map_err(Failure::input)?;
        for choice in reader.choices() {
            note!("octant: {}: {choice}", path.display());
        }
    }
    Ok(())
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
    run(&RunRequest {
        scenario: scenario.to_owned(),
        set: set.to_vec(),
        out: out.map(Path::to_owned),
        source: Some(format!("{kind}:{}", recording.display())),
        json,
        ..RunRequest::default()
    })
}

/// Runs a case of a campaign with all the evidence of a run: also the requirements of the campaign. `line` runs it again.
pub(crate) fn case(
    line: Vec<String>,
    planned: &octant_campaign::plan::PlannedScenario,
    case: &octant_campaign::plan::Case,
    out: &Path,
) -> Result<Verdict, Failure> {
    run(&RunRequest {
        scenario: planned.file.clone(),
        places: planned.places(),
        requirements: planned.required(),
        call: Some(line),
        set: case.set.to_strings(),
        out: Some(out.to_owned()),
        seed: Some(case.seed),
        only_faults: case.faults.as_ref().map(|faults| faults.to_strings()),
        planned_faults: true,
        require: true,
        ..RunRequest::default()
    })
}
