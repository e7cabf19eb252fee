//! `octant.ssp` and similar systems, run by the program's own master: the bits of the core in
//! process.

use octant_base::control::Control;
use octant_cosim::run::{PreparedSystem, Request, Results};
use octant_cosim::summary::SystemEnded;
use octant_cosim::system::element_names;
use octant_cosim::values::number_of;
use octant_fmu_build::{Options, build};
use octant_fmu_host::description::{Description, VariableType, read_bytes};
use octant_fmu_host::instance::ProcessPlace;
use octant_recorder::StreamHash;
use octant_run::{StreamKeeping, run_method};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters,
    Reference, Sample, Status,
};
use octant_scenario::{Method, Scenario};
use octant_verdict::Verdict;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

fn scenario() -> Scenario {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/scenarios/lockstep.toml");
    Scenario::load(&file, &[]).unwrap()
}

/// Builds our FMUs and system once, with the parameters of the scenario.
pub(super) fn built() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let make = || {
        let folder = tempfile::tempdir().unwrap();
        let options = Options {
            out: folder.path().to_owned(),
            scenario: Some(("lockstep".to_owned(), scenario())),
            ..Options::default()
        };
        build(&options).unwrap();
        folder
    };
    FOLDER.get_or_init(make).path()
}

pub(super) fn request(path: PathBuf) -> Request {
    Request { path, place: ProcessPlace::ThisProcess, ..Request::default() }
}

fn run(request: Request) -> Results {
    let prepared = PreparedSystem::new(request).unwrap_or_else(|error| panic!("{error}"));
    prepared.run(&[], &Control::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Numbers of an FMU by name.
struct Names {
    node: usize,
    at: BTreeMap<String, usize>,
    kinds: Vec<VariableType>,
    numbers: Vec<f64>,
}

impl Names {
    fn real(&self, name: &str) -> f64 {
        self.numbers[self.at[name]]
    }

    fn reals<const N: usize>(&self, name: &str) -> [f64; N] {
        std::array::from_fn(|i| self.real(&format!("{name}[{}]", i + 1)))
    }
}

/// Assembles the core's stream from the calibrator's inputs and outputs, and returns its hash.
fn stream_hash(request: Request, fmus: [&str; 2]) -> (String, Results) {
    let prepared = PreparedSystem::new(request).unwrap_or_else(|error| panic!("{error}"));
    assert!(prepared.warnings().is_empty());
    let descriptions: Vec<Description> = fmus
        .map(|fmu| {
            let mut archive = octant_fmu_host::archive::Archive::open(&built().join(fmu)).unwrap();
            read_bytes(&archive.read("modelDescription.xml").unwrap(), fmu).unwrap()
        })
        .into();
    let mut hash = StreamHash::new();
    let mut names: Option<Names> = None;
    let (mut revision, mut epochs) = (0, 0u64);
    let results = prepared
        .run_watched(&[], &Control::default(), |simulation, system| {
            let names = names.get_or_insert_with(|| {
                let node = system.nodes.iter().position(|node| node.name == "calibrator").unwrap();
                let sides = &system.nodes[node];
                let mut at = BTreeMap::new();
                let mut kinds = BTreeMap::new();
                for side in [&sides.inputs, &sides.outputs, &sides.watched] {
                    // Names are in the order of the variables, numbers in that of the groups.
                    let first = at.len();
                    for (number, range) in side.variables.iter().zip(&side.plan.places) {
                        let variable = &descriptions[node].variables[*number];
                        let names = element_names(&descriptions[node], variable);
                        for (name, place) in names.into_iter().zip(range.clone()) {
                            at.insert(name, first + place);
                            kinds.insert(first + place, variable.kind);
                        }
                    }
                }
                let kinds = kinds.into_values().collect();
                Names { node, numbers: vec![0.0; at.len()], kinds, at }
            });
            let sides = &system.nodes[names.node];
            let [inputs, outputs] = [&sides.inputs, &sides.outputs].map(|s| s.plan.elements);
            names.numbers[..inputs].copy_from_slice(simulation.inputs(names.node));
            names.numbers[inputs..][..outputs].copy_from_slice(simulation.outputs(names.node));
            names.numbers[inputs + outputs..].copy_from_slice(simulation.watched(names.node));
            for (number, kind) in names.numbers.iter_mut().zip(&names.kinds) {
                *number = number_of(*kind, *number).unwrap();
            }
            if simulation.steps() == 0 || names.real("imu.valid") == 0.0 {
                return Ok(());
            }
            epochs += 1;
            let (sample, aiding) = input(names);
            let output = output(names);
            assert_eq!((sample.sequence, output.sequence), (epochs, epochs));
            hash.epoch(&sample, aiding.as_ref(), &output);
            if output.parameters_revision != revision {
                revision = output.parameters_revision;
                hash.parameters(&estimate(names, revision));
            }
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(epochs, scenario().samples().unwrap());
    (hash.hex(), results)
}

fn input(names: &Names) -> (Sample, Option<Aiding>) {
    let counts = |name: &str, lsb: f64| names.reals::<3>(name).map(|value| (value / lsb) as i32);
    let time_ns = names.real("imu.device_time_ns");
    let sample = Sample {
        sequence: names.real("imu.sequence") as u64,
        device_time: DeviceTime::from_ns(time_ns as u64),
        delta_theta: counts("gyro.delta_theta", DELTA_THETA_LSB_RAD),
        delta_velocity: counts("accelerometer.delta_velocity", DELTA_VELOCITY_LSB_MPS),
        gimbal: GimbalAngles::from_rad(names.real("gimbal.azimuth"), names.real("gimbal.roll")),
        status: Status::from_bits_retain(names.real("imu.status") as u16),
    };
    let reference = match names.real("reference.kind") as u8 {
        0 => None,
        1 => Some(Reference::Velocity(names.reals("reference.velocity"))),
        _ => Some(Reference::Position {
            latitude_rad: names.real("reference.latitude"),
            longitude_rad: names.real("reference.longitude"),
            height_m: names.real("reference.height"),
        }),
    };
    let age_ns = names.real("reference.age_ns");
    let device_time = DeviceTime::from_ns((time_ns - age_ns) as u64);
    (sample, reference.map(|reference| Aiding { device_time, reference }))
}

fn output(names: &Names) -> Output {
    let command = ["azimuth", "roll"].map(|axis| names.real(&format!("gimbal_command.{axis}")));
    Output {
        sequence: names.real("answer.sequence") as u64,
        device_time: DeviceTime::from_ns(names.real("answer.device_time_ns") as u64),
        mode: Mode::ALL[names.real("mode") as usize],
        stop: names.real("stop") as u16,
        moving: names.real("moving") != 0.0,
        gimbal_command: GimbalCommand { target: GimbalAngles::from_rad(command[0], command[1]) },
        navigation: Navigation {
            latitude_rad: names.real("navigation.latitude"),
            longitude_rad: names.real("navigation.longitude"),
            height_m: names.real("navigation.height"),
            velocity_mps: names.reals("navigation.velocity"),
            q_nb: names.reals("navigation.attitude"),
        },
        health: Health::from_bits_retain(names.real("health") as u32),
        nis: if names.real("filter.measured") != 0.0 { names.real("filter.nis") } else { f64::NAN },
        parameters_revision: names.real("parameters.revision") as u32,
    }
}

fn estimate(names: &Names, revision: u32) -> octant_sample::parameters::ParameterEstimate {
    let all = |prefix: &str| {
        let mut values = [f64::NAN; 30];
        for group in octant_sample::parameters::ParameterGroup::ALL {
            for (n, value) in values[group.range()].iter_mut().enumerate() {
                *value = names.real(&format!("{prefix}.{}[{}]", group.name(), n + 1));
            }
        }
        values
    };
    octant_sample::parameters::ParameterEstimate {
        revision,
        parameters: Parameters::from_array(&all("parameters")),
        sigma: all("sigma"),
    }
}

/// Returns the hash of the same scenario with plant and core in process.
fn in_process() -> String {
    let scenario = scenario();
    let control = Control::default();
    let run = run_method(&scenario, Method::Primary, scenario.seed, StreamKeeping::Hash, &control)
        .unwrap();
    run.recorder.stream_hash
}

#[test]
fn our_system_gives_the_bits_of_the_core_in_process() {
    let fmus = ["plant_fmi2.fmu", "calibrator_fmi2.fmu"];
    let (hash, results) = stream_hash(request(built().join("octant.ssp")), fmus);
    assert_eq!(hash, in_process());
    let summary = results.summary;
    assert_eq!((summary.verdict, &summary.ended), (Verdict::None, &SystemEnded::AtStop));
    assert_eq!((summary.rejected, summary.connections), (0, 22));
    // The same bytes each time, also without a watcher.
    let again = run(request(built().join("octant.ssp"))).summary;
    assert_eq!(again.to_json().unwrap(), summary.to_json().unwrap());
}

/// Makes a structure of the FMI 3.0 FMUs, connected by arrays, in a folder.
pub(super) fn with_arrays(folder: &Path) {
    let resources = folder.join("resources");
    std::fs::create_dir(&resources).unwrap();
    let mut elements = String::new();
    for (name, inputs, outputs) in
        [("plant", &COMMANDS[..], &SAMPLES[..]), ("calibrator", &SAMPLES[..], &COMMANDS[..])]
    {
        for file in [format!("{name}_fmi3.fmu"), format!("{name}_lockstep.ssv")] {
            std::fs::copy(built().join(&file), resources.join(&file)).unwrap();
        }
        let connectors: String = [(inputs, "input"), (outputs, "output")]
            .into_iter()
            .flat_map(|(names, kind)| {
                names
                    .iter()
                    .map(move |name| format!("<Connector name=\"{name}\" kind=\"{kind}\"/>"))
            })
            .collect();
        elements += &format!(
            "<Component name=\"{name}\" source=\"resources/{name}_fmi3.fmu\"><Connectors>\
             {connectors}</Connectors><ParameterBindings><ParameterBinding \
             source=\"resources/{name}_lockstep.ssv\"/></ParameterBindings></Component>"
        );
    }
    let wires = |from: &str, to: &str, names: &[&str]| -> String {
        names
            .iter()
            .map(|name| {
                format!(
                    "<Connection startElement=\"{from}\" startConnector=\"{name}\" \
                     endElement=\"{to}\" endConnector=\"{name}\"/>"
                )
            })
            .collect()
    };
    let connections =
        wires("plant", "calibrator", &SAMPLES) + &wires("calibrator", "plant", &COMMANDS);
    let text = format!(
        "<SystemStructureDescription version=\"1.0\" name=\"arrays\" \
         xmlns=\"http://ssp-standard.org/SSP1/SystemStructureDescription\"><System name=\"s\">\
         <Elements>{elements}</Elements><Connections>{connections}</Connections></System>\
         </SystemStructureDescription>"
    );
    std::fs::write(folder.join("SystemStructure.ssd"), text).unwrap();
}

const COMMANDS: [&str; 2] = ["gimbal_command.azimuth", "gimbal_command.roll"];
const SAMPLES: [&str; 14] = [
    "gyro.delta_theta",
    "accelerometer.delta_velocity",
    "gimbal.azimuth",
    "gimbal.roll",
    "imu.valid",
    "imu.status",
    "imu.sequence",
    "imu.device_time_ns",
    "reference.kind",
    "reference.velocity",
    "reference.latitude",
    "reference.longitude",
    "reference.height",
    "reference.age_ns",
];

#[test]
fn arrays_of_fmi_3_give_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    with_arrays(folder.path());
    let mut request = request(folder.path().to_owned());
    let period_s = scenario().sample_period_ns as f64 * 1e-9;
    // One step before the first sample.
    request.said.stop_s = Some((scenario().samples().unwrap() + 1) as f64 * period_s);
    let (hash, _) = stream_hash(request, ["plant_fmi3.fmu", "calibrator_fmi3.fmu"]);
    assert_eq!(hash, in_process());
}

#[test]
fn gauss_seidel_is_another_system_and_a_fault_has_its_receipt() {
    let short = |order: &str, faults: Option<&Path>| {
        let mut request = request(built().join("octant.ssp"));
        request.said.stop_s = Some(20.0);
        request.order = Some(order.parse().unwrap());
        request.faults = faults.map(Path::to_owned);
        run(request).summary
    };
    let jacobi = short("jacobi", None);
    let seidel = short("gauss-seidel=plant,calibrator", None);
    assert_ne!(jacobi.stream_hash, seidel.stream_hash);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("faults.toml");
    let write = |text: &str| std::fs::write(&file, format!("schema = 1\n{text}")).unwrap();
    write(
        r#"
        [[faults]]
        id = "theta"
        kind = "bias"
        connection = "calibrator.gyro.delta_theta"
        value = "1 arcsec"
        trigger = { at = "10 s" }
        duration = "5 samples"
        "#,
    );
    let faulted = short("jacobi", Some(&file));
    let receipt = &faulted.faults[0];
    assert_eq!(faulted.verdict, Verdict::None);
    // Three axes, five steps; the first altered one begins at 10 s.
    assert_eq!((receipt.first_sample, receipt.last_sample), (Some(2001), Some(2005)));
    assert_eq!((receipt.firings, receipt.samples_altered), (1, 5));
    assert_ne!(faulted.stream_hash, jacobi.stream_hash);
    // A value that the core's FMU refuses is kept out and counted.
    write(
        r#"
        [[faults]]
        id = "nan"
        kind = "nan"
        connection = "calibrator.accelerometer.delta_velocity[2]"
        trigger = { sample = 100 }
        duration = "3 samples"
        [[faults]]
        id = "never"
        kind = "drop"
        connection = "plant.gimbal_command.roll"
        trigger = { when = "calibrator.navigation.height above 1 km" }
        "#,
    );
    let refused = short("jacobi", Some(&file));
    assert_eq!(refused.fmus[1].refused, 3);
    assert_eq!(refused.verdict, Verdict::Inconclusive);
    assert_eq!(refused.reasons, ["fault never (drop): never fired"]);
}

#[test]
fn what_is_set_reaches_the_fmus_and_what_is_wrong_is_told() {
    let with = |set: &[&str]| {
        let mut request = request(built().join("octant.ssp"));
        request.said.stop_s = Some(1.0);
        request.set = set.iter().map(|one| (*one).to_owned()).collect();
        PreparedSystem::new(request).map(|prepared| prepared.run(&[], &Control::default()))
    };
    let plain = with(&[]).unwrap().unwrap().summary.stream_hash;
    let other = with(&["plant.random.seed=2"]).unwrap().unwrap().summary.stream_hash;
    assert_ne!(plain, other);
    for (set, expected) in [
        ("plant.random.sead=2", "the FMU has no variable \"random.sead\""),
        ("plan.random.seed=2", "\"plan\" is no FMU of the system, did you mean \"plant\"?"),
        ("plant.random.seed", "expected FMU.VARIABLE=VALUE"),
        ("plant.random.seed=many", "--set plant.random.seed=many: found \"many\""),
    ] {
        let error = with(&[set]).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    // Contradictory parameters: the FMU reports them, and no step was made.
    let odd = with(&["calibrator.imu.period_ns=3"]).unwrap();
    assert!(odd.is_err());
}
