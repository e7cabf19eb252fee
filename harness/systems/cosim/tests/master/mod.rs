//! FMUs stepped together, compared with closed forms.

mod toy;

use self::toy::{Toy, describe, done, refused};
use octant_cosim::error::MasterError;
use octant_cosim::faults::{Faulting, looked_at};
use octant_cosim::flat::Flat;
use octant_cosim::order::SteppingOrder;
use octant_cosim::simulation::{Abilities, Simulation, SteppingSettings};
use octant_cosim::solve::IterationLimits;
use octant_cosim::ssp::package::Package;
use octant_cosim::ssp::structure::SystemStructure;
use octant_cosim::system::System;
use octant_fmu_host::description::Description;
use octant_fmu_host::instance::{Instance, StepOutcome, Stepped};
use octant_scenario::connection_faults;
use std::sync::{Arc, Mutex};

const HEAD: &str = r#"<SystemStructureDescription version="1.0" name="test"
    xmlns="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">"#;

/// FMUs by name, with the connections between them.
struct Bench {
    toys: Vec<(&'static str, Toy)>,
    connections: String,
    order: &'static str,
    step_s: f64,
    steps: u64,
    faults: String,
    fires: Vec<String>,
}

impl Bench {
    fn new(toys: Vec<(&'static str, Toy)>, connections: &[(&str, &str)]) -> Self {
        let connections = connections.iter().map(|(from, to)| connection(from, to, "")).collect();
        Self {
            toys,
            connections,
            order: "jacobi",
            step_s: 0.01,
            steps: 100,
            faults: String::new(),
            fires: Vec::new(),
        }
    }

    /// Returns the system of the toys, with their names and descriptions.
    fn system(&self) -> (Flat, SystemStructure, Vec<Description>) {
        let folder = tempfile::tempdir().unwrap();
        let mut components = String::new();
        for (name, toy) in &self.toys {
            std::fs::write(folder.path().join(format!("{name}.fmu")), "").unwrap();
            let connectors: String = toy
                .description()
                .variables
                .iter()
                .map(|variable| {
                    let kind = format!("{:?}", variable.causality).to_lowercase();
                    format!("<Connector name=\"{}\" kind=\"{kind}\"/>", variable.name)
                })
                .collect();
            components += &format!(
                "<Component name=\"{name}\" source=\"{name}.fmu\"><Connectors>{connectors}\
                 </Connectors></Component>"
            );
        }
        let text = format!(
            "{HEAD}<System name=\"s\"><Elements>{components}</Elements><Connections>{}\
             </Connections></System></SystemStructureDescription>",
            self.connections
        );
        std::fs::write(folder.path().join("SystemStructure.ssd"), text).unwrap();
        let package = Package::open(folder.path()).unwrap();
        let structure = SystemStructure::read(&package).unwrap_or_else(|error| panic!("{error}"));
        let flat = Flat::of(&structure).unwrap_or_else(|error| panic!("{error}"));
        let descriptions = self.toys.iter().map(|(_, toy)| toy.description().clone()).collect();
        (flat, structure, descriptions)
    }

    /// Returns the system with its faults, or the reason why that fails.
    fn faulted(
        &self,
        flat: &Flat,
        structure: &SystemStructure,
        descriptions: &[&Description],
    ) -> Result<(System, Faulting), String> {
        const FILE: &str = "faults.toml";
        let text = format!("schema = 1\n{}", self.faults);
        let names: Vec<&str> = flat.components.iter().map(|c| c.name.as_str()).collect();
        let faults = connection_faults(&text, FILE, self.step_s, self.steps, &self.fires)
            .map_err(|error| error.to_string())?;
        let looked = looked_at(&faults, FILE, &names).map_err(|error| error.to_string())?;
        let system = System::new(structure, flat, descriptions, &looked)
            .map_err(|error| error.to_string())?;
        let faulting = Faulting::new(&faults, FILE, &system, descriptions, 1, self.step_s)
            .map_err(|error| error.to_string())?;
        Ok((system, faulting))
    }

    fn refusal(&self) -> String {
        let (flat, structure, descriptions) = self.system();
        let descriptions: Vec<&Description> = descriptions.iter().collect();
        match self.faulted(&flat, &structure, &descriptions) {
            Ok(_) => panic!("nothing is wrong"),
            Err(error) => error,
        }
    }

    fn run<T>(self, with: impl FnOnce(Result<Simulation<'_>, MasterError>) -> T) -> T {
        let (flat, structure, descriptions) = self.system();
        let descriptions: Vec<&Description> = descriptions.iter().collect();
        let names: Vec<&str> = flat.components.iter().map(|c| c.name.as_str()).collect();
        let (system, faulting) = self
            .faulted(&flat, &structure, &descriptions)
            .unwrap_or_else(|error| panic!("{error}"));
        let order: SteppingOrder = self.order.parse().unwrap();
        let settings = SteppingSettings {
            order: order.of(&names).unwrap(),
            jacobi: order == SteppingOrder::Jacobi,
            start_s: 0.0,
            step_s: self.step_s,
            steps: self.steps,
            tolerance: None,
            loops: IterationLimits::default(),
            halvings: 10,
            no_numbers_max: None,
        };
        let abilities = descriptions
            .iter()
            .map(|d| Abilities::of(d.co_simulation.as_ref().unwrap(), false))
            .collect();
        let instances: Vec<Box<dyn Instance>> =
            self.toys.into_iter().map(|(_, toy)| Box::new(toy) as Box<dyn Instance>).collect();
        let mut simulation =
            Simulation::new(&system, &settings, instances, abilities, Some(faulting));
        let initialized = simulation.initialize().map(|_| ());
        with(initialized.map(|()| simulation))
    }

    /// Steps to the end; returns the values of the outputs of all FMUs after each step.
    fn outputs(self) -> Vec<Vec<f64>> {
        let (steps, nodes) = (self.steps, self.toys.len());
        self.run(|simulation| {
            let mut simulation = simulation.unwrap();
            let mut rows = Vec::new();
            for step in 0..=steps {
                if step > 0 {
                    simulation.advance().unwrap();
                }
                rows.push((0..nodes).flat_map(|n| simulation.outputs(n).to_vec()).collect());
            }
            simulation.terminate().unwrap();
            rows
        })
    }
}

fn connection(from: &str, to: &str, inside: &str) -> String {
    let ((a, y), (b, u)) = (from.split_once('.').unwrap(), to.split_once('.').unwrap());
    format!(
        "<Connection startElement=\"{a}\" startConnector=\"{y}\" endElement=\"{b}\" \
         endConnector=\"{u}\">{inside}</Connection>"
    )
}

/// Makes x' = gain · u, with u held over a step. Reference 1 is u, 2 is x.
fn integrator(name: &str, gain: f64, start: f64, able: bool) -> Toy {
    let description = describe(name, &["u"], &[("x", Some(&[]))], able);
    let law = move |numbers: &mut toy::Numbers, time_s, step_s| {
        *numbers.get_mut(&2).unwrap() += step_s * gain * numbers[&1];
        done(time_s, step_s)
    };
    Toy::new(description, &[(2, start)], Box::new(law), |_| {})
}

/// Makes a mass on a spring: position and velocity are separate FMUs.
fn oscillator(stiffness: f64) -> Bench {
    let toys = vec![
        ("position", integrator("position", 1.0, 1.0, true)),
        ("velocity", integrator("velocity", -stiffness, 0.0, true)),
    ];
    Bench::new(toys, &[("velocity.x", "position.u"), ("position.x", "velocity.u")])
}

#[test]
fn jacobi_is_explicit_euler_and_grows_as_it_must() {
    let (k, h) = (4.0f64, 0.01);
    let rows = oscillator(k).outputs();
    // z = x + i·v/ω is multiplied by 1 − i·h·ω at each step.
    let omega = k.sqrt();
    let (growth, angle) = ((1.0 + h * h * k).sqrt(), (h * omega).atan());
    for (n, row) in rows.iter().enumerate() {
        let (size, phase) = (growth.powi(n as i32), angle * n as f64);
        assert!((row[0] - size * phase.cos()).abs() < 1e-12, "step {n}: {row:?}");
        assert!((row[1] + omega * size * phase.sin()).abs() < 1e-12, "step {n}: {row:?}");
    }
    // All step from the same values: the order of the list has no effect.
    let (mut x, mut v) = (1.0f64, 0.0f64);
    for row in &rows[1..] {
        (x, v) = (x + h * 1.0 * v, v + h * -k * x);
        assert_eq!([row[0].to_bits(), row[1].to_bits()], [x.to_bits(), v.to_bits()]);
    }
}

#[test]
fn gauss_seidel_is_symplectic_euler_and_stays_on_its_ellipse() {
    let (k, h) = (4.0f64, 0.01);
    let mut bench = oscillator(k);
    bench.order = "gauss-seidel=position,velocity";
    bench.steps = 100_000;
    let rows = bench.outputs();
    // Each step conserves k·x² + v² + h·k·x·v and turns by 2·asin(h·ω/2).
    let kept = |row: &[f64]| k * row[0] * row[0] + row[1] * row[1] + h * k * row[0] * row[1];
    let turn = 2.0 * (h * k.sqrt() / 2.0).asin();
    for (n, row) in rows.iter().enumerate() {
        assert!((kept(row) - k).abs() < 1e-9, "step {n}: {}", kept(row));
        // x(n) = cos(n·turn) + tan(turn/2)·sin(n·turn)·(−1): from x(0) = 1, x(1) = 1.
        let x = ((n as f64 - 0.5) * turn).cos() / (turn / 2.0).cos();
        assert!((row[0] - x).abs() < 1e-7, "step {n}: {} {x}", row[0]);
    }
    // The other order is another method: velocity first.
    let mut bench = oscillator(k);
    bench.order = "gauss-seidel=velocity,position";
    let other = bench.outputs();
    let (mut x, mut v) = (1.0f64, 0.0f64);
    for row in &other[1..] {
        v += h * -k * x;
        x += h * 1.0 * v;
        assert_eq!([row[0].to_bits(), row[1].to_bits()], [x.to_bits(), v.to_bits()]);
    }
}

/// Makes y = gain · u + offset, with direct feedthrough. Reference 1 is u, 2 is y.
fn gain(name: &'static str, algebra: toy::Algebra, depends_on: Option<&[usize]>) -> Toy {
    let description = describe(name, &["u"], &[("y", depends_on)], true);
    Toy::new(description, &[], Box::new(|_, time_s, step_s| done(time_s, step_s)), algebra)
}

fn set(numbers: &mut toy::Numbers, reference: u32, value: f64) {
    numbers.insert(reference, value);
}

#[test]
fn an_algebraic_loop_is_found_reported_and_solved() {
    // x = 3·y, y = −4·x + 5.
    let toys = vec![
        ("a", gain("a", |n| set(n, 2, 3.0 * n[&1]), Some(&[0]))),
        ("b", gain("b", |n| set(n, 2, -4.0 * n[&1] + 5.0), Some(&[0]))),
    ];
    Bench::new(toys, &[("a.y", "b.u"), ("b.y", "a.u")]).run(|simulation| {
        let simulation = simulation.unwrap();
        let x = 15.0 / 13.0;
        assert!((simulation.outputs(0)[0] - x).abs() < 1e-9, "{:?}", simulation.outputs(0));
        assert!((simulation.outputs(1)[0] - x / 3.0).abs() < 1e-9);
        let [found] = simulation.loops() else { panic!("{:?}", simulation.loops()) };
        assert_eq!(found.variables, ["a.y", "b.u", "b.y", "a.u"]);
        assert!(!found.solved.exact && found.solved.residual <= 1e-10, "{found:?}");
    });
}

#[test]
fn a_loop_without_a_solution_is_named() {
    let toys = vec![
        ("a", gain("a", |n| set(n, 2, n[&1] + 1.0), Some(&[0]))),
        ("b", gain("b", |n| set(n, 2, n[&1]), Some(&[0]))),
    ];
    Bench::new(toys, &[("a.y", "b.u"), ("b.y", "a.u")]).run(|simulation| {
        let Err(error) = simulation else { panic!("it has no solution") };
        let text = error.to_string();
        assert!(text.contains("a.y -> b.u -> b.y -> a.u depend on each other"), "{text}");
        assert!(text.contains("they have no single solution"), "{text}");
    });
}

#[test]
fn chains_are_initialized_in_their_order_and_what_is_no_loop_is_exact() {
    // c = 0.1·(b), b = 0.1 + a, a = 0.7: the components are listed in the opposite order.
    let third = |n: &mut toy::Numbers| set(n, 2, 0.1 * n[&1]);
    let second = |n: &mut toy::Numbers| set(n, 2, 0.1 + n[&1]);
    let first = |n: &mut toy::Numbers| set(n, 2, 0.7);
    let chain: &[(&str, &str)] = &[("a.y", "b.u"), ("b.y", "c.u")];
    let toys = || {
        vec![
            ("c", gain("c", third, Some(&[0]))),
            ("b", gain("b", second, Some(&[0]))),
            ("a", gain("a", first, None)),
        ]
    };
    Bench::new(toys(), chain).run(|simulation| {
        let simulation = simulation.unwrap();
        assert_eq!(simulation.inputs(0), [0.1 + 0.7]);
        assert!(simulation.loops().is_empty());
    });
    // a doesn't state that it depends on nothing: with c connected to it there appears to be a
    // loop.
    let circle: Vec<_> = chain.iter().copied().chain([("c.y", "a.u")]).collect();
    Bench::new(toys(), &circle).run(|simulation| {
        let simulation = simulation.unwrap();
        assert_eq!(simulation.outputs(0), [0.1 * (0.1 + 0.7)]);
        assert_eq!(simulation.inputs(2), [0.1 * (0.1 + 0.7)]);
        assert!(simulation.loops()[0].solved.exact);
    });
}

/// Counts 1 for each second, and can't step over some times.
fn discarding(events_s: [f64; 2], reaches: bool) -> Toy {
    let description = describe("picky", &["u"], &[("x", Some(&[]))], true);
    let law = move |numbers: &mut toy::Numbers, time_s: f64, step_s: f64| {
        for event_s in events_s {
            if time_s < event_s && time_s + step_s > event_s + 1e-12 {
                let reached_s = if reaches { event_s } else { time_s };
                // Changes up to that time must be undone.
                *numbers.get_mut(&2).unwrap() += 1000.0;
                return refused(reached_s);
            }
        }
        *numbers.get_mut(&2).unwrap() += step_s;
        done(time_s, step_s)
    };
    Toy::new(description, &[], Box::new(law), |_| {})
}

#[test]
fn a_discarded_step_takes_all_back_and_is_made_in_parts() {
    for order in ["jacobi", "gauss-seidel=other,picky"] {
        let toys = vec![
            ("other", integrator("other", 1.0, 0.0, true)),
            ("picky", discarding([0.25, 0.5], true)),
        ];
        let calls = Arc::clone(&toys[0].1.calls);
        let mut bench = Bench::new(toys, &[("picky.x", "other.u"), ("other.x", "picky.u")]);
        (bench.order, bench.step_s, bench.steps) = (order, 0.4, 2);
        bench.run(|simulation| {
            let mut simulation = simulation.unwrap();
            simulation.advance().unwrap();
            simulation.advance().unwrap();
            assert_eq!(simulation.rejected(), 2);
            assert_eq!(simulation.counts()[1].discarded, 2);
            assert!((simulation.outputs(1)[0] - 0.8).abs() < 1e-12);
            // Values are transferred between the parts: 0 at 0 s, 0.25 at 0.25 s, …
            let x = 0.0 * 0.25 + 0.25 * 0.15 + 0.4 * 0.1 + 0.5 * 0.3;
            assert!((simulation.outputs(0)[0] - x).abs() < 1e-12, "{:?}", simulation.outputs(0));
            simulation.terminate().unwrap();
        });
        let calls = calls.lock().unwrap().clone();
        let parts = calls.iter().map(|call| match call.strip_prefix("step ") {
            Some(part) => part.split(' ').map(|n| n.parse::<f64>().unwrap()).collect(),
            None => vec![],
        });
        let expected: [&[f64]; 8] = [
            &[0.0, 0.4],
            &[],
            &[0.0, 0.25],
            &[0.25, 0.15],
            &[0.4, 0.4],
            &[],
            &[0.4, 0.1],
            &[0.5, 0.3],
        ];
        for (part, expected) in parts.zip(expected) {
            assert_eq!(part.len(), expected.len(), "{calls:?}");
            assert!(part.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{calls:?}");
        }
        assert_eq!(calls.len(), 9, "{calls:?}");
    }
}

#[test]
fn parts_are_halved_where_an_fmu_does_not_say_how_far_it_came() {
    let toys = vec![
        ("picky", discarding([0.27, 0.5], false)),
        ("other", integrator("other", 1.0, 0.0, true)),
    ];
    let mut bench = Bench::new(toys, &[("picky.x", "other.u")]);
    (bench.step_s, bench.steps) = (0.4, 2);
    bench.run(|simulation| {
        let mut simulation = simulation.unwrap();
        // 0.27 isn't a sum of a few halves of 0.4: parts become too small.
        let error = simulation.advance().unwrap_err().to_string();
        assert!(error.contains("picky discarded the step from 0.2"), "{error}");
        assert!(error.contains("too long for me; parts of less than"), "{error}");
    });
    let toys = vec![
        ("picky", discarding([0.25, 0.5], false)),
        ("other", integrator("other", 1.0, 0.0, true)),
    ];
    let mut bench = Bench::new(toys, &[("picky.x", "other.u")]);
    (bench.step_s, bench.steps) = (1.0, 1);
    bench.run(|simulation| {
        let mut simulation = simulation.unwrap();
        simulation.advance().unwrap();
        // 1 and ½ are refused, then ¼, ½ and 1 are reached.
        assert_eq!(simulation.rejected(), 2);
        assert!((simulation.outputs(0)[0] - 1.0).abs() < 1e-9);
    });
}

#[test]
fn who_can_not_go_back_is_named() {
    let toys = vec![
        ("picky", discarding([0.25, 0.5], true)),
        ("fixed", integrator("fixed", 1.0, 0.0, false)),
    ];
    let mut bench = Bench::new(toys, &[("picky.x", "fixed.u")]);
    (bench.step_s, bench.steps) = (0.4, 2);
    bench.run(|simulation| {
        let error = simulation.unwrap().advance().unwrap_err().to_string();
        assert_eq!(
            error,
            "picky discarded the step from 0 s to 0.4 s: too long for me; fixed can't go back to a \
             kept state; fixed can't make shorter steps"
        );
    });
}

#[test]
fn early_returns_are_gone_on_from_and_ends_are_obeyed() {
    let description = describe("early", &["u"], &[("x", Some(&[]))], false);
    let law = |numbers: &mut toy::Numbers, time_s: f64, step_s: f64| {
        let (event_s, end_s) = (0.05, 0.095);
        let until = if time_s < event_s && time_s + step_s > event_s + 1e-12 {
            event_s
        } else {
            time_s + step_s
        };
        *numbers.get_mut(&2).unwrap() += until - time_s;
        let early = until < time_s + step_s;
        Stepped {
            time_s: until,
            outcome: if early { StepOutcome::Early } else { StepOutcome::Done },
            event: early,
            terminate: until > end_s,
        }
    };
    let toy = Toy::new(description, &[], Box::new(law), |_| {});
    let calls = Arc::clone(&toy.calls);
    let mut bench = Bench::new(
        vec![("early", toy), ("other", integrator("other", 1.0, 0.0, false))],
        &[("early.x", "other.u")],
    );
    (bench.step_s, bench.steps) = (0.03, 10);
    bench.run(|simulation| {
        let mut simulation = simulation.unwrap();
        let ended: Vec<_> = (0..4).map(|_| simulation.advance().unwrap()).collect();
        assert_eq!(ended, [None, None, None, Some(0)]);
        assert!((simulation.outputs(0)[0] - 0.12).abs() < 1e-12);
        assert_eq!(simulation.rejected(), 0);
    });
    let calls = calls.lock().unwrap().join(", ");
    assert!(calls.contains("step 0.03 0.03, events, step 0.05 0.00"), "{calls}");
}

#[test]
fn types_and_units_are_converted_and_what_does_not_fit_ends_the_run() {
    let source = describe("source", &[], &[("angle:deg", Some(&[])), ("count", Some(&[]))], false);
    let law = |numbers: &mut toy::Numbers, time_s: f64, step_s: f64| {
        numbers.insert(1, 180.0 * (time_s + step_s));
        numbers.insert(2, if time_s + step_s > 2.5 { 2.5 } else { (time_s + step_s).round() });
        done(time_s, step_s)
    };
    let source = Toy::new(source, &[], Box::new(law), |_| {});
    let sink = describe("sink", &["angle:rad", "count/Integer", "on/Boolean"], &[], false);
    let sink = Toy::new(sink, &[], Box::new(|_, t, h| done(t, h)), |_| {});
    let linear = "<ssc:LinearTransformation factor=\"2\" offset=\"1\"/>";
    let mut bench = Bench::new(vec![("source", source), ("sink", sink)], &[]);
    bench.connections = connection("source.angle", "sink.angle", linear)
        + &connection("source.count", "sink.count", "");
    (bench.step_s, bench.steps) = (1.0, 5);
    bench.run(|simulation| {
        let mut simulation = simulation.unwrap();
        simulation.advance().unwrap();
        simulation.advance().unwrap();
        assert!((simulation.delivered()[0] - (2.0 * std::f64::consts::PI + 1.0)).abs() < 1e-12);
        assert_eq!(simulation.delivered()[1], 1.0);
        simulation.advance().unwrap();
        let error = simulation.advance().unwrap_err().to_string();
        assert_eq!(
            error,
            "the connection source.count -> sink.count can't carry 2.5 at 3 s: the input is a \
             Int32 and has no such value"
        );
    });
}

#[test]
fn texts_go_along() {
    let sender = describe("sender", &["u"], &[("name/String", Some(&[]))], false);
    let receiver = describe("receiver", &["name/String"], &[("y", Some(&[]))], false);
    let idle = || Box::new(|_: &mut toy::Numbers, t: f64, h: f64| done(t, h));
    let sender = Toy::new(sender, &[(1, 7.0)], idle(), |_| {});
    let receiver = Toy::new(receiver, &[], idle(), |_| {});
    let calls: Arc<Mutex<Vec<String>>> = Arc::clone(&receiver.calls);
    let mut bench = Bench::new(
        vec![("sender", sender), ("receiver", receiver)],
        &[("sender.name", "receiver.name")],
    );
    bench.steps = 1;
    bench.outputs();
    assert!(calls.lock().unwrap().contains(&"text is 7".to_owned()));
}

#[test]
fn faults_act_on_connections_and_rollback_does_not_move_them() {
    let (k, h) = (4.0f64, 0.01);
    let mut bench = oscillator(k);
    bench.faults = r#"
        [[faults]]
        id = "push"
        kind = "bias"
        connection = "velocity.u"
        value = 0.5
        trigger = { at = "0.2 s" }
        duration = "10 samples"
        [[faults]]
        id = "later"
        kind = "scale"
        connection = "velocity.x -> position.u"
        factor = -1
        trigger = { when = "position.x below 0.9", after = "2 samples" }
        duration = "3 samples"
    "#
    .to_owned();
    let rows = bench.outputs();
    let (mut x, mut v) = (1.0f64, 0.0f64);
    let mut crossed = None;
    for (n, row) in rows.iter().enumerate().skip(1) {
        // Detected at the end of the previous step; the fault sets in two steps later.
        if x < 0.9 && crossed.is_none() {
            crossed = Some(n);
        }
        let flip = crossed.is_some_and(|at| (at + 2..at + 5).contains(&n));
        let factor = if flip { -1.0 } else { 1.0 };
        let bias = if (21..31).contains(&n) { 0.5 } else { 0.0 };
        (x, v) = (x + h * 1.0 * (v + (factor - 1.0) * v), v + h * -k * (x + bias));
        assert_eq!([row[0].to_bits(), row[1].to_bits()], [x.to_bits(), v.to_bits()], "step {n}");
    }
    assert!(crossed.is_some());

    // A held value stays through the parts of a step that is repeated.
    let toys = vec![
        ("picky", discarding([0.25, 0.5], true)),
        ("other", integrator("other", 1.0, 0.0, true)),
    ];
    let mut bench = Bench::new(toys, &[("picky.x", "other.u")]);
    (bench.step_s, bench.steps) = (0.2, 3);
    bench.faults = r#"
        [[faults]]
        id = "held"
        kind = "stuck"
        connection = "other.u"
        trigger = { sample = 2 }
        duration = "1 sample"
    "#
    .to_owned();
    bench.run(|simulation| {
        let mut simulation = simulation.unwrap();
        for _ in 0..3 {
            simulation.advance().unwrap();
        }
        // Step 2 is made in two parts, both with the value of step 1, which is 0.
        let x = 0.0 * 0.2 + 0.0 * 0.2 + 0.4 * 0.1 + 0.5 * 0.1;
        let found = simulation.watched(1);
        assert!((found[0] - x).abs() < 1e-12, "{found:?}");
        let receipt = &simulation.station().unwrap().receipts()[0];
        assert_eq!((receipt.firings, receipt.samples_altered), (1, 1));
        assert_eq!((receipt.first_sample, receipt.last_sample), (Some(2), Some(2)));
    });
}

#[test]
fn a_value_that_an_fmu_refuses_is_kept_out_where_a_fault_made_it() {
    let bench = |faults: &str, nan: bool| {
        let mut sink = integrator("sink", 1.0, 0.0, false);
        sink.refuses_nan = true;
        let source = describe("source", &[], &[("y", Some(&[]))], false);
        let law = move |numbers: &mut toy::Numbers, t: f64, h: f64| {
            numbers.insert(1, if nan && t > 2.5 { f64::NAN } else { t + h });
            done(t, h)
        };
        let source = Toy::new(source, &[], Box::new(law), |_| {});
        let mut bench =
            Bench::new(vec![("source", source), ("sink", sink)], &[("source.y", "sink.u")]);
        (bench.step_s, bench.steps) = (1.0, 5);
        bench.faults = faults.to_owned();
        bench
    };
    let fault = r#"
        [[faults]]
        id = "nan"
        kind = "nan"
        connection = "sink.u"
        trigger = { at = "2 s" }
        duration = "1 s"
    "#;
    bench(fault, false).run(|simulation| {
        let mut simulation = simulation.unwrap();
        for _ in 0..5 {
            simulation.advance().unwrap();
        }
        // Inputs 0, 1, (2 refused: still 1), 3, 4.
        let x = simulation.watched(1);
        assert_eq!(x, [0.0 + 1.0 + 1.0 + 3.0 + 4.0]);
        assert_eq!(simulation.counts()[1].refused, 1);
    });
    bench("", true).run(|simulation| {
        let mut simulation = simulation.unwrap();
        let error = (0..5).find_map(|_| simulation.advance().err()).unwrap();
        assert_eq!(error.to_string(), "sink.u refused NaN at 4 s: not a number");
    });
}

#[test]
fn faults_that_can_not_be_are_refused_with_their_place() {
    let bench = |faults: &str| {
        let source =
            describe("source", &["u"], &[("angle:deg", None), ("on/Boolean", None)], false);
        let sink = describe("sink", &["angle:deg", "on/Boolean", "free"], &[("y", None)], false);
        let idle = || Box::new(|_: &mut toy::Numbers, t: f64, h: f64| done(t, h));
        let toys = vec![
            ("source", Toy::new(source, &[], idle(), |_| {})),
            ("sink", Toy::new(sink, &[], idle(), |_| {})),
        ];
        let wires = [("source.angle", "sink.angle"), ("source.on", "sink.on")];
        let mut bench = Bench::new(toys, &wires);
        bench.faults = faults.to_owned();
        bench
    };
    let fault = |kind: &str, connection: &str, more: &str| {
        format!(
            "[[faults]]\nid = \"x\"\nkind = \"{kind}\"\nconnection = \"{connection}\"\n{more}\n"
        )
    };
    let at = "trigger = { at = \"0 s\" }\n";
    for (faults, expected) in [
        (
            fault("bias", "sink.angel", &format!("value = 1\n{at}")),
            "faults.toml:5:14: faults[0].connection: found \"sink.angel\", which no connection leads \
             to, did you mean \"sink.angle\"?",
        ),
        (fault("bias", "sink.free", &format!("value = 1\n{at}")), "which no connection leads to"),
        (
            fault("bias", "source.on -> sink.angle", &format!("value = 1\n{at}")),
            "which is connected with \"source.angle\"",
        ),
        (
            fault("bias", "sink.on", &format!("value = 1\n{at}")),
            "faults[0].kind: bias can't act on sink.on, which is a Boolean",
        ),
        (fault("stuck", "sink.on", &format!("value = 1\n{at}")), "expected true or false"),
        (
            fault("bias", "sink.angle", &format!("value = \"1 m\"\n{at}")),
            "found \"1 m\", expected a quantity in \"deg\" or another unit of the same",
        ),
        (fault("bias", "sink.angle", &format!("value = 0\n{at}")), "nothing would happen"),
        (fault("noise", "sink.angle", &format!("sigma = -1\n{at}")), "expected a value above 0"),
        (fault("scale", "sink.angle", &format!("factor = 1\n{at}")), "nothing would happen"),
        (fault("delay", "sink.angle", &format!("delay = \"1 ms\"\n{at}")), "0 steps"),
        (fault("drop", "sink.angle", &format!("probability = 2\n{at}")), "above 0, up to 1"),
        (fault("stall", "sink.angle", at), "possible: stuck, bias, scale"),
        (fault("drop", "sink.angle", "trigger = { at = \"2 s\" }"), "it can't fire"),
        (fault("drop", "sink.angle", "trigger = { position = 2 }"), "one of at, sample, when"),
        (
            fault("drop", "sink.angle", "trigger = { when = \"source.angle > 3\" }"),
            "expected an output, above or below, and a value",
        ),
        (
            fault("drop", "sink.angle", "trigger = { when = \"sauce.angle above 3 deg\" }"),
            "\"sauce.angle\" is no output of an FMU; FMUs: source, sink",
        ),
        (
            fault("drop", "sink.angle", "trigger = { when = \"source.angle above 3 kn\" }"),
            "expected a quantity in \"deg\"",
        ),
        (fault("drop", "sink.angle", &format!("{at}recovery = \"1 s\"")), "doesn't fade"),
        ("[[fault]]".to_owned(), "unknown key, did you mean \"faults\"?"),
    ] {
        let error = bench(&faults).refusal();
        assert!(error.contains(expected), "{faults}: {error}");
        assert!(error.starts_with("faults.toml:"), "{error}");
    }
    let fine = fault("stuck", "sink.angle", &format!("value = \"3.141592653589793 rad\"\n{at}"));
    bench(&fine).run(|simulation| {
        let mut simulation = simulation.unwrap();
        simulation.advance().unwrap();
        assert!((simulation.delivered()[0] - 180.0).abs() < 1e-12);
    });
    let mut by_hand =
        bench(&fault("stuck", "sink.on", "value = true\ntrigger = { manual = true }"));
    by_hand.fires = vec!["x=0.5 s".to_owned()];
    by_hand.run(|simulation| {
        let mut simulation = simulation.unwrap();
        let on: Vec<f64> = (0..100)
            .map(|_| {
                simulation.advance().unwrap();
                simulation.delivered()[1]
            })
            .collect();
        assert_eq!(on.iter().position(|on| *on == 1.0), Some(50));
    });
}
