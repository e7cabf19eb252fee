//! Runs that share their beginning are the undivided ones, bit for bit: any kinds, triggers and positions.

use super::faults_any::{EPOCHS, SCENARIO, draw};
use octant_base::control::Control;
use octant_faults::FaultSpec;
use octant_faults::catalogue::Acts;
use octant_faults::trigger::{Signal, ThresholdSide, Trigger};
use octant_fmu_bind::OpenedFmus;
use octant_run::Plan;
use octant_run::branches::{first_alike, run_branches};
use octant_run::stem::Stem;
use octant_run::{Ended, Prepared, StreamKeeping, assemble, run_method};
use octant_run::{MethodError, MethodRun};
use octant_scenario::{Fault, Method, Place, Scenario};
use proptest::prelude::*;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::Ordering;

fn scenario(specs: &[FaultSpec]) -> Scenario {
    let mut scenario = Scenario::parse(SCENARIO, "f.toml", Path::new(""), &[]).unwrap();
    assert_eq!(scenario.samples(), Some(EPOCHS));
    let fault = |(index, spec): (usize, &FaultSpec)| {
        let mut spec = FaultSpec { id: format!("f{index}"), ..spec.clone() };
        if matches!(&spec.schedule.trigger, Trigger::After { fault, .. } if *fault == spec.id) {
            spec.schedule.trigger = Trigger::Epoch(1000);
        }
        Fault { spec, fires: vec![500], place: Place::Default }
    };
    scenario.faults = specs.iter().enumerate().map(fault).collect();
    scenario
}

/// Everything that a run came to, as text; but for the size of a file, whose chunks end by the host's clock.
fn text(scenario: &Scenario, seed: u64, run: Result<MethodRun, MethodError>) -> String {
    match run {
        Err(error) => error.to_string(),
        Ok(mut run) => {
            run.recorder.bytes = 0;
            let observed = format!("{:?} {:?} {:?}", run.observed, run.recorder, run.receipts);
            let summary = assemble(scenario, seed, run, None).unwrap().summary;
            summary.to_json().unwrap() + &observed
        }
    }
}

fn shared(
    scenarios: &[Scenario],
    seed: u64,
    keeping: StreamKeeping<'_>,
    jobs: usize,
) -> Vec<String> {
    let controls: Vec<Control> = scenarios.iter().map(|_| Control::default()).collect();
    let method = Method::Primary;
    let plans: Vec<Plan<'_>> = (scenarios.iter().zip(&controls))
        .map(|(scenario, control)| Plan::of(scenario, method, seed, keeping, control))
        .collect();
    let found: Mutex<Vec<Vec<String>>> = Mutex::new(vec![Vec::new(); scenarios.len()]);
    run_branches(&plans, jobs, &|index, run| {
        found.lock().unwrap()[index].push(text(&scenarios[index], seed, run));
    });
    let found = found.into_inner().unwrap();
    assert!(found.iter().all(|one| one.len() == 1), "every run is told once");
    found.into_iter().flatten().collect()
}

fn undivided(scenarios: &[Scenario], seed: u64, keeping: StreamKeeping<'_>) -> Vec<String> {
    let run = |scenario| run_method(scenario, Method::Primary, seed, keeping, &Control::default());
    scenarios.iter().map(|scenario| text(scenario, seed, run(scenario))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn runs_that_branch_off_are_the_undivided_ones(
        sets in proptest::collection::vec(proptest::collection::vec(draw::spec(), 0..4), 2..6),
        seed in 0..1000u64,
        jobs in 1..4usize,
        keeping in prop::sample::select(vec![StreamKeeping::Hash, StreamKeeping::HashAlone, StreamKeeping::None]),
    ) {
        let scenarios: Vec<Scenario> = (sets.iter().map(|specs| scenario(specs)))
            .filter(|scenario| scenario.station(seed).is_ok())
            .collect();
        let found = shared(&scenarios, seed, keeping, jobs);
        for (found, expected) in found.iter().zip(undivided(&scenarios, seed, keeping)) {
            prop_assert_eq!(found, &expected);
        }
    }

    #[test]
    fn conditions_on_what_the_core_and_the_truth_say_are_seen_in_time(
        spec in draw::spec(),
        signal in prop::sample::select(vec![
            Signal::Nis, Signal::TrueGimbal(1), Signal::Velocity(0), Signal::LatitudeError,
        ]),
        value in 1e-9..3.0,
        delay in 0..300u64,
        seed in 0..1000u64,
    ) {
        let mut spec = spec;
        let comparison = ThresholdSide::Above;
        spec.schedule.trigger = Trigger::Condition { signal, comparison, value, delay };
        let scenarios = [scenario(&[]), scenario(&[spec])];
        let found = shared(&scenarios, seed, StreamKeeping::Hash, 1);
        prop_assert_eq!(found, undivided(&scenarios, seed, StreamKeeping::Hash));
    }
}

/// A navigation of its own: its length in tenths of a second, and a rotation; `None`: the run ends with the
/// calibration.
fn navigating(scenario: &Scenario, navigation: Option<(u64, bool)>) -> Scenario {
    let mut scenario = scenario.clone();
    let Some((tenths, rotates)) = navigation else {
        scenario.navigation = None;
        return scenario;
    };
    let plan = scenario.navigation.as_mut().unwrap();
    plan.duration_s = Some(tenths as f64 / 10.0);
    if !rotates {
        plan.dwell_s = 1.0;
    }
    scenario
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn runs_that_navigate_otherwise_share_the_calibration(
        sets in proptest::collection::vec((
            proptest::collection::vec(draw::spec(), 0..3),
            prop::option::weighted(0.8, (prop::sample::select(vec![1u64, 17, 30, 45]), any::<bool>())),
        ), 2..7),
        seed in 0..1000u64,
        jobs in 1..4usize,
        keeping in prop::sample::select(vec![StreamKeeping::Hash, StreamKeeping::HashAlone, StreamKeeping::None]),
    ) {
        let scenarios: Vec<Scenario> = (sets.iter())
            .map(|(specs, navigation)| navigating(&scenario(specs), *navigation))
            .filter(|scenario| scenario.station(seed).is_ok())
            .collect();
        let found = shared(&scenarios, seed, keeping, jobs);
        for (found, expected) in found.iter().zip(undivided(&scenarios, seed, keeping)) {
            prop_assert_eq!(found, &expected);
        }
    }
}

/// Runs and their twins as a suite has them: each navigation has its own twin.
#[test]
fn each_navigation_has_a_twin_of_its_own() {
    let clean = scenario(&[]);
    let scenarios = [Some((30, true)), Some((30, true)), Some((45, true)), Some((30, false)), None]
        .map(|navigation| navigating(&clean, navigation));
    let control = Control::default();
    let method = Method::Primary;
    let plans: Vec<Plan<'_>> = (scenarios.iter())
        .map(|scenario| Plan::of(scenario, method, 3, StreamKeeping::Hash, &control))
        .collect();
    assert_eq!(first_alike(&plans), [0, 0, 2, 3, 4]);
}

#[test]
fn other_instruments_places_and_lengths_share_nothing() {
    let clean = scenario(&[]);
    let set = |text: &str| {
        let words = [text.to_owned()];
        Scenario::parse(SCENARIO, "f.toml", Path::new(""), &words).unwrap()
    };
    let scenarios = [
        clean.clone(),
        clean,
        set("site.latitude=\"10 deg\""),
        set("procedure.navigation.duration=\"4 s\""),
        set("imu.rate=\"100 Hz\""),
        set("procedure.calibration.g_states=false"),
        set("source.uri=\"plant\""),
    ];
    let found = shared(&scenarios, 7, StreamKeeping::Hash, 2);
    assert_eq!(found, undivided(&scenarios, 7, StreamKeeping::Hash));
}

#[test]
fn the_end_of_one_run_can_be_asked_for_before_it_branches_off_and_after() {
    let scenario = scenario(&[]);
    let control = Control::default();
    control.cancel.store(true, Ordering::Relaxed);
    let plan = Plan::of(&scenario, Method::Primary, 1, StreamKeeping::Hash, &control);
    let ended = Mutex::new(Vec::new());
    run_branches(&[plan, plan], 1, &|_, run| {
        ended.lock().unwrap().push(run.unwrap().ended);
    });
    assert_eq!(ended.into_inner().unwrap(), [Ended::Cancelled; 2]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn runs_with_some_of_the_faults_go_on_from_where_all_of_them_are_to_come(
        specs in proptest::collection::vec(draw::spec(), 2..5),
        kept in 1..15usize,
        seed in 0..1000u64,
    ) {
        let keep = |index: usize| kept >> index & 1 == 1;
        let all = scenario(&specs);
        let some = all.with_faults(keep);
        if all.station(seed).is_err() || some.station(seed).is_err() || some.faults.is_empty() {
            return Ok(());
        }
        let (method, control) = (Method::Primary, Control::default());
        let plan = |scenario| Plan::of(scenario, method, seed, StreamKeeping::None, &control);
        if let Some(stem) = Stem::of(&plan(&all)).unwrap() {
            let found = text(&some, seed, stem.run(&plan(&some), keep));
            prop_assert_eq!(&found, &undivided(std::slice::from_ref(&some), seed, StreamKeeping::None)[0]);
            // It can be run from more than once.
            prop_assert_eq!(text(&some, seed, stem.run(&plan(&some), keep)), found);
        }
    }
}

/// A recorded run and its twin share their beginning too: recording, twin and summary are those of two runs.
fn with_twin_is_both_alone(scenario: &Scenario, seed: u64) {
    let place = tempfile::tempdir().unwrap();
    let folder = |name: &str| {
        let path = place.path().join(name);
        std::fs::create_dir(&path).unwrap();
        path
    };
    let (together, apart) = (folder("together"), folder("apart"));
    let prepared = Prepared::of(scenario, seed, true, &OpenedFmus::default()).unwrap();
    let mut both = prepared.run(&together).unwrap().remove(0);
    let twin = std::sync::Arc::into_inner(both.twin.take().unwrap()).unwrap();
    let control = Control::default();
    let path = apart.join("recording.mcap");
    let alone = |scenario, keeping| run_method(scenario, Method::Primary, seed, keeping, &control);
    let clean = scenario.without_faults();
    assert_eq!(
        text(&clean, seed, Ok(twin)),
        text(&clean, seed, alone(&clean, StreamKeeping::Hash))
    );
    let one = alone(scenario, StreamKeeping::File(&path));
    assert_eq!(text(scenario, seed, Ok(both)), text(scenario, seed, one));
    let messages = |folder: &Path| {
        let bytes = std::fs::read(folder.join("recording.mcap")).unwrap();
        let all = mcap::MessageStream::new(&bytes).unwrap();
        let one = |message: mcap::Message<'_>| {
            let times = (message.log_time, message.publish_time);
            (message.channel.topic.clone(), message.sequence, times, message.data.into_owned())
        };
        all.map(|message| one(message.unwrap())).collect::<Vec<_>>()
    };
    let recorded = messages(&together);
    assert!(!recorded.is_empty());
    assert!(recorded == messages(&apart), "other messages are recorded");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_recorded_run_and_its_twin_are_two_runs(
        specs in proptest::collection::vec(draw::spec(), 1..4),
        seed in 0..1000u64,
    ) {
        let scenario = scenario(&specs);
        // How long the host was kept busy differs from run to run.
        let of_host = |fault: &Fault| fault.spec.kind.acts == Acts::Host;
        if scenario.station(seed).is_ok() && !scenario.faults.iter().any(of_host) {
            with_twin_is_both_alone(&scenario, seed);
        }
    }
}
