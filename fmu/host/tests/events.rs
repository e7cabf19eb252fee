//! Time events and whole numbers of foreign FMUs in this process.

use super::foreign::{copy, unpacked};
use octant_fmu_host::description::Variable;
use octant_fmu_host::instance::{
    AccessPlan, Instance, OpenOptions, ProcessPlace, VariableGroup, whole,
};
use std::path::Path;

fn open(folder: &Path) -> Box<dyn Instance> {
    let options = OpenOptions { place: ProcessPlace::ThisProcess, ..OpenOptions::default() };
    octant_fmu_host::open(folder, &options).unwrap()
}

fn plan(instance: &dyn Instance, names: &[&str]) -> AccessPlan {
    let description = instance.description();
    let of = |name: &&str| description.variable(name).unwrap().clone();
    let variables: Vec<Variable> = names.iter().map(of).collect();
    AccessPlan::exactly(description, &variables.iter().collect::<Vec<_>>()).unwrap()
}

fn set(instance: &mut dyn Instance, name: &str, value: f64) {
    let description = instance.description();
    let group = VariableGroup::of(description, description.variable(name).unwrap()).unwrap();
    instance.set(&group, &[value]).unwrap();
}

/// Steps to 1 s in ten steps; returns y, the number of events, the shortest step, and warnings.
fn run(instance: &mut dyn Instance, level: impl Fn(usize) -> f64) -> (f64, f64, f64, Vec<String>) {
    instance.enter_initialization(0.0, Some(1.0), None).unwrap();
    instance.exit_initialization().unwrap();
    let inputs = plan(instance, &["level"]);
    let outputs = plan(instance, &["y", "events", "shortest"]);
    let mut numbers = [0.0; 3];
    for step in 0..10 {
        let level = [level(step)];
        let time_s = 0.1 * step as f64;
        let stepped = instance
            .exchange(&inputs.groups, &level, time_s, 0.1, &outputs.groups, &mut numbers)
            .unwrap();
        assert!(!stepped.terminate && !stepped.event);
    }
    let at = |place: usize| numbers[outputs.places[place].start];
    let notes = instance.messages().into_iter().filter(|message| message.is_of_host());
    (at(0), at(1), at(2), notes.map(|message| message.text).collect())
}

#[test]
fn a_step_ends_at_the_time_event_that_an_fmu_has_announced() {
    let (y, events, shortest_s, notes) = run(&mut *open(&unpacked("timed_fmi3")), |_| 0.0);
    assert!((y - 101.0).abs() < 1e-9, "{y}");
    assert!((shortest_s - 0.05).abs() < 1e-9, "{shortest_s}");
    // The input was set once, which is an event, and hasn't changed.
    assert_eq!((events, notes.len()), (2.0, 0), "{notes:?}");
}

#[test]
fn a_time_event_of_an_fmu_with_fixed_steps_is_handled_at_the_next_point_and_that_is_said() {
    let fixed = copy("timed_fmi3", |text| {
        text.replace("canHandleVariableCommunicationStepSize=\"true\"", "")
    });
    let (y, events, shortest_s, notes) = run(&mut *open(fixed.path()), |_| 0.0);
    assert!((y - 101.0).abs() < 1e-9, "{y}");
    assert_eq!((events, shortest_s, notes.len()), (2.0, 0.1, 1), "{notes:?}");
    let found = &notes[0];
    assert!(found.contains("the time event at 0.55 s is handled at 0.6"), "{found}");
    assert!(found.contains("canHandleVariableCommunicationStepSize"), "{found}");
}

#[test]
fn event_mode_is_entered_where_a_held_input_changes() {
    // Changes at steps 0 (the first value), 3 and 7, and the time event.
    let level = |step: usize| [0.0, 5.0, 6.0][usize::from(step >= 3) + usize::from(step >= 7)];
    let (_, events, _, _) = run(&mut *open(&unpacked("timed_fmi3")), level);
    assert_eq!(events, 4.0);
}

#[test]
fn a_time_that_contradicts_the_step_is_said_once() {
    let mut timed = open(&unpacked("timed_fmi3"));
    set(&mut *timed, "wrong_time", 1.0);
    let (y, _, _, notes) = run(&mut *timed, |_| 0.0);
    assert!((y - 101.0).abs() < 1e-9, "{y}");
    assert_eq!(
        notes,
        ["fmi3DoStep: lastSuccessfulTime is 0 s after a whole step from 0 s to 0.1 s"]
    );
}

#[test]
fn an_fmu_that_declares_event_mode_and_refuses_it_runs_without() {
    let folder = copy("timed_fmi3", str::to_owned);
    std::fs::create_dir_all(folder.path().join("resources")).unwrap();
    std::fs::write(folder.path().join("resources/no-event-mode"), "").unwrap();
    let (y, events, _, notes) = run(&mut *open(folder.path()), |_| 0.0);
    assert!((y - 1.0).abs() < 1e-9, "{y}");
    assert_eq!((events, notes.len()), (0.0, 1), "{notes:?}");
    let found = &notes[0];
    assert!(
        found.contains("declares event mode") && found.contains("no event mode here"),
        "{found}"
    );
}

#[test]
fn whole_numbers_of_64_bits_keep_every_bit() {
    let mut signals = open(&unpacked("signals_fmi3"));
    let signals = &mut *signals;
    signals.enter_initialization(0.0, None, None).unwrap();
    signals.exit_initialization().unwrap();
    let (inputs, outputs) =
        (plan(signals, &["i64", "u64"]), plan(signals, &["i64_out", "u64_out", "mode_out"]));
    let numbers = [i128::from(i64::MIN) + 1, i128::from(u64::MAX) - 1];
    let kinds = outputs.groups.iter().map(|group| group.kind).collect::<Vec<_>>();
    let given: Vec<f64> =
        numbers.iter().zip(&kinds).map(|(n, kind)| whole::to_bits(*kind, *n).unwrap()).collect();
    let mut got = [0.0; 3];
    signals.exchange(&inputs.groups, &given, 0.0, 0.1, &outputs.groups, &mut got).unwrap();
    let got: Vec<i128> =
        got.iter().zip(&kinds).map(|(bits, kind)| whole::from_bits(*kind, *bits)).collect();
    assert_eq!(got, [numbers[0], numbers[1], 1]);
}
