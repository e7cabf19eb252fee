//! The Plant and the Calibrator, wired by the names of their variables and stepped side by side,
//! give the run in one process: sample by sample, bit for bit, with faults, and across a save.

use octant_calibration::config as core;
use octant_endpoint::{Endpoint, InProcess};
use octant_faults::catalogue::{Acts, Lasts};
use octant_faults::station::{Delivered, World};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{FaultSpec, Station, Value, kinds};
use octant_fmu::calibrator::{self, Calibrator};
use octant_fmu::component::ModelComponent;
use octant_fmu::plant;
use octant_fmu::table::{DeclaredCausality, Model};
use octant_fmu::values::CellValues;
use octant_plant::ComparedPlant;
use octant_plant::config as plant_config;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::disturbance::Disturbed;
use octant_sample::{
    Aiding, DeviceTime, Epoch, GimbalAngles, GimbalCommand, Output, Reference, Sample, Status,
    Truth, canonical,
};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use std::path::Path;

fn fixtures() -> String {
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios").to_owned()
}

fn scenario(name: &str) -> Scenario {
    Scenario::load(Path::new(&format!("{}/{name}.toml", fixtures())), &[]).unwrap()
}

/// Returns plant and core of a scenario.
fn configured(scenario: &Scenario) -> (plant_config::PlantConfig, core::CoreConfig) {
    let (plant, core, _) = configurations(scenario, Method::Primary, scenario.seed).unwrap();
    (plant, core)
}

/// Component with its values.
struct Instance<C> {
    component: C,
    values: CellValues,
}

impl<C: ModelComponent> Instance<C> {
    fn new(start: &[(&'static str, Vec<f64>)]) -> Result<Self, String> {
        let mut values = CellValues::new(C::MODEL);
        for (name, numbers) in start {
            let (slot, variable) = C::MODEL.find(name).unwrap();
            for (slot, number) in (slot..).zip(numbers) {
                use octant_fmu::table::ElementType;
                match variable.kind {
                    ElementType::Real => values.set_real(slot, *number),
                    ElementType::Count => values.set_count(slot, *number as u64),
                    ElementType::Integer | ElementType::Enumeration(_) => {
                        values.set_integer(slot, *number as i32);
                    }
                    ElementType::Boolean => values.set_boolean(slot, *number != 0.0),
                    ElementType::Binary(_) | ElementType::Clock(_) => panic!("no parameter is one"),
                }
            }
        }
        Ok(Self {
            component: C::initialize(&mut values).map_err(|error| error.to_string())?,
            values,
        })
    }

    /// Saves the component, and loads it into another instance.
    fn again(&self) -> Self {
        let mut bytes = Vec::new();
        self.component.save(&mut bytes);
        let values = self.values.clone();
        Self { component: C::load(&bytes, &values).unwrap(), values }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.component.save(&mut bytes);
        bytes
    }
}

/// Pairs the slots of outputs of one model with the inputs of the same names of the other.
fn wires(from: &'static Model, to: &'static Model) -> Vec<(usize, usize)> {
    let inputs = to.with_slots().filter(|(_, input)| input.causality == DeclaredCausality::Input);
    let wired = inputs.filter_map(|(slot, input)| {
        let (output, _) = from.find(input.name)?;
        Some((0..input.slots()).map(move |element| (output + element, slot + element)))
    });
    wired.flatten().collect()
}

/// Both models under a parallel master: values are exchanged at communication points, then both
/// step.
struct Pair {
    plant: Instance<plant::PlantFmu>,
    calibrator: Instance<Calibrator>,
    there: Vec<(usize, usize)>,
    back: Vec<(usize, usize)>,
}

impl Pair {
    fn new(
        plant: &plant_config::PlantConfig,
        faults: &[FaultSpec],
        core: &core::CoreConfig,
    ) -> Self {
        let mut start = calibrator::start_values(core);
        // Stamps of the plant: faults of time reach the core.
        start.push(("imu.external_stamps", vec![1.0]));
        Self {
            plant: Instance::new(&plant::start_values(plant, faults).unwrap()).unwrap(),
            calibrator: Instance::new(&start).unwrap(),
            there: wires(&plant::table::MODEL, &calibrator::table::MODEL),
            back: wires(&calibrator::table::MODEL, &plant::table::MODEL),
        }
    }

    fn step(&mut self) {
        for (from, to) in &self.there {
            self.calibrator.values.cells_mut()[*to] = self.plant.values.cells()[*from];
        }
        for (from, to) in &self.back {
            self.plant.values.cells_mut()[*to] = self.calibrator.values.cells()[*from];
        }
        self.plant.component.step(&mut self.plant.values).unwrap();
        self.calibrator.component.step(&mut self.calibrator.values).unwrap();
    }

    /// Returns the plant's output of the last step.
    fn epoch(&self) -> Option<Epoch> {
        let values = &self.plant.values;
        let at = |name: &str| plant::table::MODEL.find(name).unwrap().0;
        if !values.boolean(at("imu.valid")) {
            return None;
        }
        let counts = |name: &str, lsb: f64| {
            values.reals::<3>(at(name)).map(|value| {
                let count = (value / lsb) as i32;
                assert_eq!(f64::from(count) * lsb, value, "a whole count");
                count
            })
        };
        let stamp = values.count(at("imu.device_time_ns"));
        let reference = match values.integer(at("reference.kind")) {
            0 => None,
            1 => Some(Reference::Velocity(values.reals(at("reference.velocity")))),
            _ => Some(Reference::Position {
                latitude_rad: values.real(at("reference.latitude")),
                longitude_rad: values.real(at("reference.longitude")),
                height_m: values.real(at("reference.height")),
            }),
        };
        let age = values.real(at("reference.age_ns")) as i64;
        Some(Epoch {
            sample: Sample {
                sequence: values.count(at("imu.sequence")),
                device_time: DeviceTime::from_ns(stamp),
                delta_theta: counts("gyro.delta_theta", DELTA_THETA_LSB_RAD),
                delta_velocity: counts("accelerometer.delta_velocity", DELTA_VELOCITY_LSB_MPS),
                gimbal: GimbalAngles::from_rad(
                    values.real(at("gimbal.azimuth")),
                    values.real(at("gimbal.roll")),
                ),
                status: Status::from_bits_retain(values.integer(at("imu.status")) as u16),
            },
            aiding: reference.map(|reference| Aiding {
                device_time: DeviceTime::from_ns((stamp as i64 - age) as u64),
                reference,
            }),
        })
    }

    fn truth(&self) -> Truth {
        let values = &self.plant.values;
        let at = |name: &str| plant::table::MODEL.find(name).unwrap().0;
        Truth {
            time: Default::default(),
            latitude_rad: values.real(at("truth.latitude")),
            longitude_rad: values.real(at("truth.longitude")),
            height_m: values.real(at("truth.height")),
            velocity_mps: values.reals(at("truth.velocity")),
            q_nb: values.reals(at("truth.attitude")),
            gimbal_rad: [
                values.real(at("truth.gimbal.azimuth")),
                values.real(at("truth.gimbal.roll")),
            ],
        }
    }

    /// Returns the core's answer of the last step.
    fn output(&self) -> Output {
        let values = &self.calibrator.values;
        let at = |name: &str| calibrator::table::MODEL.find(name).unwrap().0;
        let nis = values.real(at("filter.nis"));
        Output {
            sequence: values.count(at("answer.sequence")),
            device_time: DeviceTime::from_ns(values.count(at("answer.device_time_ns"))),
            mode: octant_sample::Mode::ALL[values.integer(at("mode")) as usize],
            stop: values.integer(at("stop")) as u16,
            moving: values.boolean(at("moving")),
            gimbal_command: GimbalCommand {
                target: GimbalAngles::from_rad(
                    values.real(at("gimbal_command.azimuth")),
                    values.real(at("gimbal_command.roll")),
                ),
            },
            navigation: octant_sample::Navigation {
                latitude_rad: values.real(at("navigation.latitude")),
                longitude_rad: values.real(at("navigation.longitude")),
                height_m: values.real(at("navigation.height")),
                velocity_mps: values.reals(at("navigation.velocity")),
                q_nb: values.reals(at("navigation.attitude")),
            },
            health: octant_sample::Health::from_bits_retain(values.integer(at("health")) as u32),
            nis: if values.boolean(at("filter.measured")) { nis } else { f64::NAN },
            parameters_revision: values.count(at("parameters.revision")) as u32,
        }
    }
}

struct Behind<'a>(&'a mut ComparedPlant);

impl World for Behind<'_> {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        Some(self.0)
    }
    fn truth(&self) -> Option<Truth> {
        Some(self.0.plant().truth())
    }
}

/// Loop of the harness: source, station, endpoint.
struct Loop {
    plant: ComparedPlant,
    station: Station,
    endpoint: InProcess,
    output: Output,
    command: GimbalCommand,
}

impl Loop {
    fn new(
        plant: &plant_config::PlantConfig,
        faults: &[FaultSpec],
        core: &core::CoreConfig,
    ) -> Self {
        Self {
            plant: ComparedPlant::new(plant).unwrap(),
            station: Station::new(faults, &plant::setup(plant)).unwrap(),
            endpoint: InProcess::new(core).unwrap(),
            output: Output::default(),
            command: GimbalCommand::default(),
        }
    }

    /// Makes one epoch; returns the delivered one, if any, which the core has answered.
    fn step(&mut self) -> Option<Epoch> {
        self.station.told();
        let mut command = self.command;
        self.station.before(&mut command, &self.output, &mut Behind(&mut self.plant));
        let step = self.plant.step(&command);
        let clean = Epoch { sample: step.sample, aiding: step.aiding };
        let passed = self.station.after(&clean, &self.output, &mut Behind(&mut self.plant));
        let delivered = match passed.delivered {
            Delivered::Untouched => Some(clean),
            Delivered::These(these) => {
                assert!(these.len() <= 1);
                these.first().copied()
            }
        };
        if let Some(epoch) = &delivered {
            self.endpoint.step(epoch, &mut self.output).unwrap();
            self.command = self.output.gimbal_command;
        }
        delivered
    }
}

fn bits(output: &Output) -> [u8; canonical::OUTPUT_BYTES] {
    let mut bytes = [0; canonical::OUTPUT_BYTES];
    canonical::output(output, &mut bytes);
    bytes
}

/// Runs both and compares the plant's outputs, the core's answers, and truth.
fn same(
    plant: &plant_config::PlantConfig,
    faults: &[FaultSpec],
    core: &core::CoreConfig,
    samples: u64,
    saves: &[u64],
) -> Pair {
    let mut expected = Loop::new(plant, faults, core);
    let mut pair = Pair::new(plant, faults, core);
    let mut before: Option<(Option<Epoch>, Output)> = None;
    let what = || faults.first().map_or("no fault", |fault| fault.kind.name);
    for k in 1..=samples {
        pair.step();
        // The core steps on the sample of the previous step.
        if let Some((_, answered)) = &before {
            assert_eq!(bits(&pair.output()), bits(answered), "{}: answer to {}", what(), k - 1);
        }
        let delivered = expected.step();
        let found = pair.epoch();
        assert_eq!(found.is_some(), delivered.is_some(), "{}: sample {k}", what());
        if let (Some(found), Some(delivered)) = (&found, &delivered) {
            assert!(found.same_bits(delivered), "{}: {k}: {found:?} {delivered:?}", what());
        }
        let truth = Truth { time: Default::default(), ..expected.plant.plant().truth() };
        assert_eq!(format!("{:?}", pair.truth()), format!("{truth:?}"), "{}: {k}", what());
        before = Some((delivered, expected.output));
        if saves.contains(&k) {
            pair.plant = pair.plant.again();
            pair.calibrator = pair.calibrator.again();
        }
    }
    // The receipts are those of the station.
    let at = |name: String| plant::table::MODEL.find(&name).unwrap().0;
    for (place, receipt) in (1..).zip(expected.station.receipts()) {
        let values = &pair.plant.values;
        assert!(values.boolean(at(format!("fault[{place}].armed"))));
        assert_eq!(
            values.count(at(format!("fault[{place}].samples_altered"))),
            receipt.samples_altered,
            "{}",
            what()
        );
        assert_eq!(values.boolean(at(format!("fault[{place}].fired"))), receipt.fired());
    }
    pair
}

#[test]
fn the_lockstep_scenario_is_the_run_in_one_process() {
    let scenario = scenario("lockstep");
    let (plant, core) = configured(&scenario);
    let total = scenario.samples().unwrap();
    assert_eq!(total, 120_000);
    let plain = same(&plant, &[], &core, total, &[]);
    // Across saves too: in a dwell, in a move, at the end of the calibration, in navigation.
    let calibration = scenario.calibration_samples();
    let saves = [777, 10_100, 33_333, calibration - 1, calibration, calibration + 2, 100_000];
    let saved = same(&plant, &[], &core, total, &saves);
    assert_eq!(plain.plant.bytes(), saved.plant.bytes());
    assert_eq!(plain.calibrator.bytes(), saved.calibrator.bytes());
}

#[test]
fn a_ship_is_the_same_too() {
    let mut scenario = scenario("dockside");
    scenario.seed = u64::MAX - 5;
    let (plant, core) = configured(&scenario);
    same(&plant, &[], &core, 20_000, &[5_000]);
}

/// Takes the fault of a kind's scenario as a fault of the plant: for a minute, in which lockstep
/// has two moves.
fn fault_of(kind: &str) -> FaultSpec {
    let mut faults = scenario(&format!("faults/{kind}")).faults;
    let spec = faults.swap_remove(0).spec;
    assert_eq!(spec.kind.name, kind);
    let fades = spec.kind.lasts == Lasts::Fading;
    let schedule = Schedule {
        trigger: Trigger::Epoch(6_001),
        duration: Some(12_000),
        recovery: if fades { 400 } else { 0 },
        repeat: Repeat::Once,
    };
    FaultSpec { id: "fault[1]".into(), schedule, ..spec }
}

fn can_act() -> Vec<&'static str> {
    let items = plant::table::FAULT_KIND.items;
    items.iter().skip(1).map(|item| item.1).collect()
}

#[test]
fn every_kind_that_can_act_in_a_plant_does_the_same_there() {
    let scenario = scenario("lockstep");
    let (plant, core) = configured(&scenario);
    let mut idle = Vec::new();
    for kind in can_act() {
        let mut fault = fault_of(kind);
        // Lockstep is short, and its z gyro senses little but the Earth's rotation: a higher
        // probability, a lower limit.
        if let Some(Value::Quantity(_, dimension)) = fault.values.get("probability") {
            fault.values.set("probability", Value::Quantity(0.01, dimension));
        }
        if let (Some(Value::Quantity(_, dimension)), "saturation") =
            (fault.values.get("limit"), kind)
        {
            fault.values.set("limit", Value::Quantity(3e-5, dimension));
        }
        // Its moves are those of the outer gimbal.
        if let Some(Value::Choice(_)) = fault.values.get("gimbal") {
            fault.values.set("gimbal", Value::Choice("roll"));
        }
        let saves = [5_999, 6_000, 6_001, 9_200, 15_100, 18_000, 18_200, 18_500];
        let pair = same(&plant, &[fault], &core, 20_000, &saves);
        let (slot, _) = plant::table::MODEL.find("fault[1].fired").unwrap();
        if !pair.plant.values.boolean(slot) {
            idle.push(kind);
        }
    }
    // A position error has no effect on a velocity reference.
    assert_eq!(idle, ["position-jump"]);
}

#[test]
fn four_at_once_and_what_has_no_place() {
    let (plant, core) = configured(&scenario("lockstep"));
    let four: Vec<FaultSpec> = ["command-late", "vibration-random", "dropout", "bias-step"]
        .into_iter()
        .enumerate()
        .map(|(place, kind)| FaultSpec { id: format!("fault[{}]", place + 1), ..fault_of(kind) })
        .collect();
    same(&plant, &four, &core, 20_000, &[9_000]);

    let said = |faults: &[FaultSpec]| plant::start_values(&plant, faults).unwrap_err().to_string();
    let five: Vec<FaultSpec> = four.iter().chain(&four[..1]).cloned().collect();
    assert_eq!(said(&five), "5 faults were found, at most 4 are possible");
    for kind in kinds::all().filter(|kind| !can_act().contains(&kind.name)) {
        let why = match kind.acts {
            Acts::Unit => "acts on the unit under test, and a plant has none",
            // These kinds need a device, or a harness, and have no scenario here.
            Acts::Wire | Acts::Host | Acts::Power => continue,
            _ => "can deliver several samples at once, and a plant gives one sample a step",
        };
        let fault = fault_of(kind.name);
        assert_eq!(said(&[fault]), format!("fault \"fault[1]\" ({}) {why}", kind.name));
    }
    let mut moving = fault_of("spike");
    moving.schedule.trigger = Trigger::Mode { mode: octant_sample::Mode::Navigating, delay: 0 };
    assert_eq!(
        said(&[moving]),
        "fault \"fault[1]\" (spike) has a trigger other than a time and a hand, for which there is \
         no place"
    );
}

#[test]
fn what_was_put_is_found_again_bit_for_bit() {
    let setup = |seed| {
        let mut scenario = scenario("tour");
        scenario.seed = seed;
        configured(&scenario).0
    };
    for (mut plant, seed) in
        [setup(1), configured(&scenario("dockside")).0].into_iter().zip([3, 0xFEDC_BA98_7654_3210])
    {
        plant.seed = seed;
        for samples in [plant.calibration_samples, 0, u64::MAX] {
            plant.calibration_samples = samples;
            let found =
                Instance::<plant::PlantFmu>::new(&plant::start_values(&plant, &[]).unwrap());
            let found = plant::config(&found.unwrap().values).unwrap();
            assert_eq!(found, plant);
            assert_eq!(format!("{found:?}"), format!("{plant:?}"));
        }
    }
    let plant = setup(1);
    for kind in can_act() {
        let fault = fault_of(kind);
        let start = plant::start_values(&plant, std::slice::from_ref(&fault)).unwrap();
        let found = Instance::<plant::PlantFmu>::new(&start).unwrap();
        let found = plant::faults(&found.values).unwrap();
        assert_eq!(found.len(), 1);
        let (place, found) = &found[0];
        assert_eq!((*place, &found.id, found.kind.name), (0, &fault.id, kind));
        assert_eq!(found.schedule, fault.schedule, "{kind}");
        for parameter in fault.kind.parameters {
            let (found, put) = (found.values.get(parameter.name), fault.values.get(parameter.name));
            assert_eq!(format!("{found:?}"), format!("{put:?}"), "{kind}: {}", parameter.name);
        }
    }
}
