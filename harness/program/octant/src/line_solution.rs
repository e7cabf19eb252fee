//! A run whose solution comes from a port: it is taken while the bench procedure goes, and scored at the end as the file that
//! it has become.

use crate::asked::{Answers, Asked, Evidence, execute, prepare};
use crate::attendant::Attendant;
use crate::failure::Failure;
use crate::progress::Follower;
use crate::run_request::RunRequest;
use crate::solution_keys::keys_of_solution;
use crate::terminal::{note, write};
use octant_base::control::Control;
use octant_base::number::counted;
use octant_base::utc;
use octant_fmu_bind::OpenedFmus;
use octant_run::Ended;
use octant_run::acquired::{Acquired, AcquiredEnd, acquire};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::trajectory::{NmeaChoice, NmeaPoints, OF_RUN, TrajectoryFormat};
use octant_scenario::{Scenario, SourceSpec};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;

/// Takes the solution of a scenario from its port, scores it, and writes the evidence.
pub(crate) fn evidence(
    request: &RunRequest,
    asked: Asked,
    follower: &Follower<'_>,
) -> Result<Evidence, Failure> {
    for (option, is_given) in
        [("--live", request.live.is_some()), ("--stop-when-lost", request.stop_when_lost)]
    {
        if is_given {
            return Err(Failure::input(format!(
                "{option}: found with a solution from a port, expected none: nothing is recorded before it has ended"
            )));
        }
    }
    let plan = request.operator.plan(&asked.scenario)?;
    follower.watch_interrupts();
    let mut begun = asked.begin(request, Vec::new())?;
    let folder = begun.folder.path().to_owned();
    let attendant = plan.map(|plan| Attendant::open(plan, &asked.scenario, &folder)).transpose()?;
    let control = Control::default();
    let take = || take(&asked.scenario, &folder, &control, follower);
    let (acquired, mut answers) = match attendant {
        None => (take()?, Answers::default()),
        Some(attendant) => {
            let _ = control.attendance.set(attendant.desk().attendance());
            let acquired = attendant.during(std::slice::from_ref(&control), take);
            let reasons = attendant.desk().close();
            (acquired?, Answers { records: attendant.desk().records_from(0), reasons })
        }
    };
    answers.reasons.extend(acquired.clock_set_s.map(|off_s| {
        format!("the clock of this host was set by {off_s:.1} s while the solution was taken: the times of its readings are in doubt")
    }));
    tell(&acquired);
    let unscored = |failure: Failure| {
        let (bytes, place) = (acquired.counts.bytes, folder.display());
        let message = format!(
            "failed to score what came, {} in {place}/{OF_RUN}: {}",
            counted(bytes, "byte", "bytes"),
            failure.message
        );
        Failure { message, ..Failure::bench(String::new()) }
    };
    let scenario = scored(&asked.scenario, &folder, &acquired.switched_on).map_err(unscored)?;
    let mut asked = asked;
    asked.scenario = scenario;
    begun.inputs = octant_evidence::inputs(&asked.scenario)
        .map_err(|error| Failure::bench(format!("failed to {error}")))?;
    for input in begun.inputs.iter_mut().filter(|input| input.file.ends_with(OF_RUN)) {
        // The folder has another name when the run has ended.
        OF_RUN.clone_into(&mut input.file);
    }
    begun.bench = Some(bench(&acquired));
    let draws = DrawnValues::of(&asked.scenario, &Seeded(asked.seed));
    write(&folder.join("scenario.toml"), asked.scenario.to_resolved_toml(asked.seed, &draws))?;
    // An interrupt ended the taking, and not the scoring of what came.
    let quiet = Follower::Host(&|_, _| {});
    let fmus = OpenedFmus::default();
    let prepared = prepare(&asked.scenario, asked.seed, false, &fmus).map_err(unscored)?;
    let mut runs = execute(&prepared, &asked.scenario, &folder, &quiet)?;
    drop(prepared);
    for run in &mut runs {
        run.bench.power = acquired.power.clone().map(Box::new);
        if acquired.end == AcquiredEnd::Interrupted {
            run.ended = Ended::Cancelled;
        }
    }
    asked.conclude(request, begun, runs, answers)
}

/// Takes the solution from its port into the folder of the run.
fn take(
    scenario: &Scenario,
    folder: &Path,
    control: &Control,
    follower: &Follower<'_>,
) -> Result<Acquired, Failure> {
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let epochs = scenario.line_s().map(|line_s| (line_s / sample_s) as u64);
    let failed = AtomicBool::new(false);
    // A kill leaves a folder whose scenario says when the unit was switched on.
    let begun = |times: &[SystemTime]| {
        let number = times.len();
        let at = times.last().map_or(String::new(), |time| utc::millis(*time));
        match scenario.heading_test {
            Some(_) => note!("octant: run-up {number}: switched on at {at}"),
            None => note!("octant: the first bytes came at {at}"),
        }
        let text = with_file(scenario, times, &[]);
        let written = text.and_then(|text| write(&folder.join("scenario.toml"), text));
        if let Err(failure) = written
            && !failed.swap(true, std::sync::atomic::Ordering::Relaxed)
        {
            note!("octant: {}", failure.message);
        }
    };
    if let Some(line) = scenario.solution_line() {
        note!("octant: the solution comes from {}", line.uri);
    }
    let acquired = follower.follow(std::slice::from_ref(control), epochs, sample_s, || {
        acquire(scenario, &folder.join(OF_RUN), control, begun)
    });
    acquired.map_err(|error| {
        let place = folder.display();
        Failure::bench(format!("failed to {error}; what came is in {place}/{OF_RUN}"))
    })
}

/// The scenario of a solution that has come, as text: its source is the file. `more` are further changes.
fn with_file(
    scenario: &Scenario,
    switched_on: &[SystemTime],
    more: &[String],
) -> Result<String, Failure> {
    let mut changes = vec![format!("source.uri=solution:{OF_RUN}")];
    if let SourceSpec::Solution(spec) = &scenario.source
        && let TrajectoryFormat::Nmea(NmeaChoice {
            points: Some(NmeaPoints::Headings),
            heading_time: None,
            ..
        }) = &spec.solution.format
    {
        let by = if spec.rehearsal { "tag" } else { "stamp" };
        changes.push(format!("source.solution.heading_time={by}"));
    }
    if scenario.heading_test.is_some() {
        let times: Vec<String> =
            switched_on.iter().map(|time| format!("{:?}", utc::nanos(*time))).collect();
        changes.push(format!("source.solution.switched_on=[{}]", times.join(", ")));
    }
    changes.extend(more.iter().cloned());
    let about = ["The scenario of a solution that came from a port, as it is scored.".to_owned()];
    scenario.to_toml_with(&changes, &about).map_err(|problem| Failure::bench(problem.message))
}

/// The scenario with which the file is scored.
fn scored(
    scenario: &Scenario,
    folder: &Path,
    switched_on: &[SystemTime],
) -> Result<Scenario, Failure> {
    let read =
        |text: &str| Scenario::parse(text, "scenario.toml", folder, &[]).map_err(Failure::input);
    let as_file = read(&with_file(scenario, switched_on, &[])?)?;
    let SourceSpec::Solution(spec) = &as_file.source else { return Ok(as_file) };
    // The site is that of the bench.
    let mut keys: Vec<String> = keys_of_solution(&as_file, spec)?
        .into_iter()
        .filter(|key| !key.starts_with("site."))
        .collect();
    keys.extend(whole_duration(&as_file, &keys));
    read(&with_file(scenario, switched_on, &keys)?)
}

/// The duration of the navigation in whole periods of the rate among the keys: one that was measured divides no planned
/// duration, and what is left of the last period isn't compared.
fn whole_duration(scenario: &Scenario, keys: &[String]) -> Option<String> {
    if scenario.heading_test.is_some() {
        return None;
    }
    let rate = keys.iter().find_map(|key| key.strip_prefix("imu.rate=")?.strip_suffix(" Hz"))?;
    let period_ns = (1e9 / rate.parse::<f64>().ok()?).round();
    let planned_ns = scenario.navigation.as_ref()?.duration_s? * 1e9;
    let whole_ns = (planned_ns / period_ns + 1e-6).floor() * period_ns;
    Some(format!("procedure.navigation.duration={:.9} s", whole_ns * 1e-9))
}

/// Tells how the taking ended.
fn tell(acquired: &Acquired) {
    let Acquired { end, counts, reached_at, .. } = acquired;
    let came = counted(counts.bytes, "byte", "bytes");
    match end {
        AcquiredEnd::Planned => note!("octant: {came} came from {reached_at}"),
        AcquiredEnd::Silent(time) => note!(
            "octant: nothing came from {reached_at} for {:.1} s, after {came}: the run ends here",
            time.as_secs_f64()
        ),
        AcquiredEnd::Interrupted => note!("octant: interrupted after {came} from {reached_at}"),
    }
}

/// Entry of the manifest on the port.
fn bench(acquired: &Acquired) -> serde_json::Value {
    let Acquired { switched_on, end, counts, reached_at, .. } = acquired;
    let times: Vec<String> = switched_on.iter().map(|time| utc::millis(*time)).collect();
    let how = match end {
        AcquiredEnd::Planned => "as planned".to_owned(),
        AcquiredEnd::Silent(time) => {
            format!("nothing came for {:.1} s", time.as_secs_f64())
        }
        AcquiredEnd::Interrupted => "interrupted".to_owned(),
    };
    serde_json::json!({
        "solution from": reached_at,
        "came": format!(
            "{} in {:.1} s, longest silence {:.2} s, port opened again {} times",
            counted(counts.bytes, "byte", "bytes"),
            counts.lasted.as_secs_f64(),
            counts.longest_silence.as_secs_f64(),
            counts.reopened
        ),
        "switched on": times.join(", "),
        "ended": how,
    })
}
