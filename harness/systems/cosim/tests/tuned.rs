//! Parameters that change while a system runs: from which step on, and what is refused.

use octant_cosim::error::MasterError;
use octant_cosim::experiment::RunExperiment;
use octant_cosim::flat::Flat;
use octant_cosim::simulation::{Abilities, Simulation, SteppingSettings};
use octant_cosim::solve::IterationLimits;
use octant_cosim::ssp::package::Package;
use octant_cosim::ssp::structure::SystemStructure;
use octant_cosim::system::System;
use octant_cosim::tuning::{Tuning, tunings};
use octant_fmu_bind::testing::{Scripted, With, description, variable};
use octant_fmu_host::description::{Causality, Description, Variability, Variable, VariableType};
use octant_fmu_host::instance::Instance;
use std::sync::{Arc, Mutex};

const TEXT: &str = r#"<SystemStructureDescription version="1.0" name="test"
    xmlns="http://ssp-standard.org/SSP1/SystemStructureDescription">
  <System name="s"><Elements>
    <Component name="a" source="a.fmu"/><Component name="b" source="b.fmu"/>
  </Elements></System></SystemStructureDescription>"#;

fn tunable(mut variable: Variable) -> Variable {
    variable.variability = Variability::Tunable;
    variable
}

/// A gain and a pair that can change, and a rate that can't.
fn model(name: &str) -> Description {
    let number =
        |name, reference, causality| variable(name, reference, VariableType::Float64, causality);
    let mut rate = number("rate", 5, Causality::Parameter);
    rate.variability = Variability::Fixed;
    let mut gain = tunable(number("gain", 1, Causality::Parameter).in_unit("m"));
    gain.min = Some(0.0);
    let pair = tunable(number("pair", 2, Causality::Parameter).array(2));
    description(name, vec![gain, pair, rate, number("y", 6, Causality::Output)])
}

struct Bench {
    flat: Flat,
    system: System,
    descriptions: Vec<Description>,
    experiment: RunExperiment,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.fmu", "b.fmu"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::write(folder.path().join("SystemStructure.ssd"), TEXT).unwrap();
        let structure = SystemStructure::read(&Package::open(folder.path()).unwrap()).unwrap();
        let flat = Flat::of(&structure).unwrap();
        let descriptions = vec![model("a"), model("b")];
        let described: Vec<&Description> = descriptions.iter().collect();
        let system = System::new(&structure, &flat, &described, &[]).unwrap();
        let experiment = RunExperiment { start_s: 1.0, step_s: 0.1, steps: 10 };
        Self { flat, system, descriptions, experiment }
    }

    fn tunings(&self, arguments: &[&str]) -> Result<Vec<Tuning>, String> {
        let arguments: Vec<String> = arguments.iter().map(|one| (*one).to_owned()).collect();
        let described: Vec<&Description> = self.descriptions.iter().collect();
        tunings(&arguments, &self.flat, &described, &self.experiment)
            .map_err(|error| error.to_string())
    }

    /// Gain and pair of both FMUs in each step, by the start of the step in tenths of a second.
    fn run(&self, arguments: &[&str]) -> Vec<[[f64; 3]; 2]> {
        let seen = Arc::new(Mutex::new(vec![[[f64::NAN; 3]; 2]; 10]));
        let instances: Vec<Box<dyn Instance>> = (0..2)
            .map(|node| {
                let seen = Arc::clone(&seen);
                let mut step = 0;
                Scripted::boxed(self.descriptions[node].clone(), move |cells, _| {
                    seen.lock().unwrap()[step][node] = [cells[1], cells[2], cells[3]];
                    step += 1;
                    Ok(true)
                })
            })
            .collect();
        let settings = SteppingSettings {
            order: vec![0, 1],
            jacobi: true,
            start_s: 1.0,
            step_s: 0.1,
            steps: 10,
            tolerance: None,
            loops: IterationLimits::default(),
            halvings: 0,
            no_numbers_max: None,
        };
        let abilities = vec![Abilities::default(); 2];
        let mut simulation = Simulation::new(&self.system, &settings, instances, abilities, None);
        simulation.tune_at(self.tunings(arguments).unwrap());
        simulation.initialize().unwrap();
        for _ in 0..10 {
            simulation.advance().unwrap();
        }
        assert!(simulation.tunings().all(|tuned| tuned.done));
        drop(simulation);
        Arc::into_inner(seen).unwrap().into_inner().unwrap()
    }
}

#[test]
fn a_change_acts_from_the_step_on_that_begins_at_its_time() {
    let bench = Bench::new();
    // In any order; with units; an array whole; the later of two of one time wins.
    let seen = bench.run(&[
        "b.pair=[1, 2]@1.7 s",
        "a.gain=5@1 s",
        "a.gain=\"7 cm\"@1300 ms",
        "b.gain=1@1.7 s",
        "b.gain=2@1.7 s",
    ]);
    for (step, [a, b]) in seen.iter().enumerate() {
        let gain = if step < 3 { 5.0 } else { 0.07 };
        assert!((a[0] - gain).abs() < 1e-15, "{step}: {a:?}");
        assert_eq!(a[1..], [0.0, 0.0], "{step}");
        assert_eq!(*b, if step < 7 { [0.0; 3] } else { [2.0, 1.0, 2.0] }, "{step}");
    }
    let told = bench.tunings(&["b.pair=[1, 2]@1.7 s", "b.gain=2@1.7 s", "a.gain=5@1 s"]).unwrap();
    // One entry for each FMU and time, in the order of the times.
    assert_eq!(told.len(), 2);
    assert!(format!("{told:?}").contains("[\"pair=[1, 2]\", \"gain=2\"]"), "{told:?}");
}

#[test]
fn what_can_t_be_tuned_is_told() {
    let bench = Bench::new();
    for (argument, expected) in [
        ("a.gain=5", "expected FMU.VARIABLE=VALUE@TIME, such as"),
        ("a.gain=5@soon", "found the time \"soon\", expected one such as \"30 s\""),
        (
            "a.gain=5@2 s",
            "found the time 2 s, expected one from the start at 1 s on, and before the end at 2 s",
        ),
        ("a.gain=5@0.9 s", "found the time 0.9 s, expected one from the start at 1 s on"),
        (
            "a.gain=5@1.25 s",
            "found the time 1.25 s, expected a communication point: the nearest are 1.2 s and 1.3 s",
        ),
        ("a.rate=5@1 s", "rate is a fixed parameter, which can't change in a running FMU; "),
        ("a.y=5@1 s", "y is no parameter; "),
        ("a.gian=5@1 s", "the FMU has no variable \"gian\"; nearest are \"gain\""),
        ("c.gain=5@1 s", "\"c\" is no FMU of the system"),
        ("a.gain=-5@1 s", "found -5 m, and gain is at least 0 m"),
        ("a.gain=\"5 s\"@1 s", "gain"),
        ("a.pair=5@1 s", "found 1 values, and pair has 2 elements"),
        (
            "a.pair[1]=5@1 s",
            "pair[1] is one element of pair: expected a value for each of its elements",
        ),
    ] {
        let error = bench.tunings(&[argument]).map(|_| ()).unwrap_err();
        let head = format!("--tune {argument}");
        assert!(error.contains(&head) && error.contains(expected), "{argument}: {error}");
    }
}

/// The values of a run that was cut short: what it didn't come to isn't done.
#[test]
fn a_refused_value_ends_the_run_and_says_so() {
    let error = MasterError::Tuned {
        node: "a".into(),
        values: "gain=5".into(),
        time_s: 1.5,
        said: ": too large".into(),
    };
    assert_eq!(error.to_string(), "a refused gain=5 at 1.5 s: too large");
}
