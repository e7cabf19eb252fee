//! The Calibrator through the C functions of FMI 2.0 and FMI 3.0 compared with the core in process:
//! the same bits over the whole stream, also across states that are saved, serialised and restored
//! in another instance in the middle of the calibration.
#![allow(unsafe_code, reason = "C functions are called")]
#![allow(
    clippy::undocumented_unsafe_blocks,
    reason = "everywhere the same: handles are those of instances, arrays as long as is said"
)]

use octant_calibration::{Core, CoreConfig};
use octant_fmi::fmi2::{CO_SIMULATION, OK};
use octant_fmu::c::fmi2::*;
use octant_fmu::c::fmi3::*;
use octant_fmu::c::{ServedStandard, token};
use octant_fmu::calibrator::start_values;
use octant_fmu::calibrator::table::MODEL;
use octant_fmu::table::ElementType;
use octant_sample::canonical::{OUTPUT_BYTES, PARAMETERS_BYTES};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{
    DeviceTime, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters,
    Reference, canonical,
};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use octant_source::{Epoch, PlantSource, Source};
use std::ffi::CString;
use std::path::Path;
use std::ptr::{null, null_mut};

/// Importer that follows one of the two standards.
struct Unit {
    standard: ServedStandard,
    /// True if inputs are set in event mode.
    events: bool,
    handle: *mut core::ffi::c_void,
    step: u64,
}

impl Drop for Unit {
    fn drop(&mut self) {
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => fmi2FreeInstance(self.handle),
                ServedStandard::Fmi3 => fmi3FreeInstance(self.handle),
            }
        }
    }
}

const fn slot(name: &str) -> u32 {
    MODEL.slot(name) as u32
}

impl Unit {
    fn instantiate(standard: ServedStandard, events: bool) -> Self {
        let token = CString::new(token(&MODEL, standard)).unwrap();
        let (name, token, none) = (c"unit".as_ptr(), token.as_ptr(), null());
        let handle = unsafe {
            match standard {
                ServedStandard::Fmi2 => {
                    fmi2Instantiate(name, CO_SIMULATION, token, none, null(), 0, 0)
                }
                ServedStandard::Fmi3 => fmi3InstantiateCoSimulation(
                    name,
                    token,
                    none,
                    0,
                    0,
                    events.into(),
                    0,
                    null(),
                    0,
                    null_mut(),
                    None,
                    None,
                ),
            }
        };
        assert!(!handle.is_null());
        Self { standard, events, handle, step: 0 }
    }

    fn new(standard: ServedStandard, events: bool, config: &CoreConfig) -> Self {
        let unit = Self::instantiate(standard, events);
        for (name, values) in start_values(config) {
            let (slot, variable) = MODEL.find(name).unwrap();
            unit.set_as(variable.kind, slot as u32, &values);
        }
        // Stamps come from the source.
        unit.set_as(ElementType::Boolean, slot("imu.external_stamps"), &[1.0]);
        unsafe {
            match standard {
                ServedStandard::Fmi2 => {
                    assert_eq!(fmi2SetupExperiment(unit.handle, 0, 0.0, 0.0, 0, 0.0), OK);
                    assert_eq!(fmi2EnterInitializationMode(unit.handle), OK);
                    assert_eq!(fmi2ExitInitializationMode(unit.handle), OK);
                }
                ServedStandard::Fmi3 => {
                    let handle = unit.handle;
                    assert_eq!(fmi3EnterInitializationMode(handle, 0, 0.0, 0.0, 0, 0.0), OK);
                    assert_eq!(fmi3ExitInitializationMode(handle), OK);
                    if events {
                        unit.finish_event();
                    }
                }
            }
        }
        unit
    }

    /// Sets a variable: element by element in FMI 2.0, as a whole in FMI 3.0.
    fn set_as(&self, kind: ElementType, first: u32, values: &[f64]) {
        let count = values.len();
        match (self.standard, kind) {
            (ServedStandard::Fmi2, ElementType::Real | ElementType::Count) => {
                let references: Vec<u32> = (first..).take(count).collect();
                self.set_reals(&references, values);
            }
            (ServedStandard::Fmi2, _) => {
                for (reference, value) in (first..).zip(values) {
                    let value = *value as i32;
                    let set = match kind {
                        ElementType::Boolean => fmi2SetBoolean,
                        _ => fmi2SetInteger,
                    };
                    assert_eq!(unsafe { set(self.handle, &reference, 1, &value) }, OK);
                }
            }
            (ServedStandard::Fmi3, ElementType::Real) => self.set_reals(&[first], values),
            (ServedStandard::Fmi3, ElementType::Count) => {
                let whole: Vec<u64> = values.iter().map(|value| *value as u64).collect();
                let (handle, whole) = (self.handle, whole.as_ptr());
                assert_eq!(unsafe { fmi3SetUInt64(handle, &first, 1, whole, count) }, OK);
            }
            (ServedStandard::Fmi3, ElementType::Integer) => {
                let value = values[0] as i32;
                assert_eq!(unsafe { fmi3SetInt32(self.handle, &first, 1, &value, 1) }, OK);
            }
            (ServedStandard::Fmi3, ElementType::Enumeration(_)) => {
                let value = values[0] as i64;
                assert_eq!(unsafe { fmi3SetInt64(self.handle, &first, 1, &value, 1) }, OK);
            }
            (ServedStandard::Fmi3, ElementType::Boolean) => {
                let value = values[0] as u8;
                assert_eq!(unsafe { fmi3SetBoolean(self.handle, &first, 1, &value, 1) }, OK);
            }
            (ServedStandard::Fmi3, ElementType::Binary(_) | ElementType::Clock(_)) => {
                panic!("the core has none")
            }
        }
    }

    fn set_reals(&self, references: &[u32], values: &[f64]) {
        let (pointer, count) = (references.as_ptr(), references.len());
        let status = unsafe {
            match self.standard {
                ServedStandard::Fmi2 => fmi2SetReal(self.handle, pointer, count, values.as_ptr()),
                ServedStandard::Fmi3 => {
                    let (values, length) = (values.as_ptr(), values.len());
                    fmi3SetFloat64(self.handle, pointer, count, values, length)
                }
            }
        };
        assert_eq!(status, OK, "{references:?} {values:?}");
    }

    fn reals<const N: usize>(&self, first: u32) -> [f64; N] {
        let mut values = [f64::NAN; N];
        let references: [u32; N] = std::array::from_fn(|i| first + i as u32);
        let status = unsafe {
            match self.standard {
                ServedStandard::Fmi2 => {
                    fmi2GetReal(self.handle, references.as_ptr(), N, values.as_mut_ptr())
                }
                ServedStandard::Fmi3 => {
                    fmi3GetFloat64(self.handle, &first, 1, values.as_mut_ptr(), N)
                }
            }
        };
        assert_eq!(status, OK);
        values
    }

    fn integer(&self, reference: u32, is_enumeration: bool) -> i64 {
        let (mut narrow, mut wide) = (-1, -1);
        let status = unsafe {
            match (self.standard, is_enumeration) {
                (ServedStandard::Fmi2, _) => {
                    fmi2GetInteger(self.handle, &reference, 1, &mut narrow)
                }
                (_, false) => fmi3GetInt32(self.handle, &reference, 1, &mut narrow, 1),
                (_, true) => fmi3GetInt64(self.handle, &reference, 1, &mut wide, 1),
            }
        };
        assert_eq!(status, OK);
        if self.standard == ServedStandard::Fmi3 && is_enumeration { wide } else { narrow.into() }
    }

    fn count(&self, reference: u32) -> u64 {
        if self.standard == ServedStandard::Fmi2 {
            let [value] = self.reals::<1>(reference);
            return value as u64;
        }
        let mut value = u64::MAX;
        let status = unsafe { fmi3GetUInt64(self.handle, &reference, 1, &mut value, 1) };
        assert_eq!(status, OK);
        value
    }

    fn boolean(&self, reference: u32) -> bool {
        let (mut wide, mut narrow) = (9, 9);
        let status = unsafe {
            match self.standard {
                ServedStandard::Fmi2 => fmi2GetBoolean(self.handle, &reference, 1, &mut wide),
                ServedStandard::Fmi3 => fmi3GetBoolean(self.handle, &reference, 1, &mut narrow, 1),
            }
        };
        assert_eq!(status, OK);
        wide == 1 || narrow == 1
    }

    fn finish_event(&self) {
        let (mut flags, mut next_s) = ([9u8; 5], f64::NAN);
        let [need, terminate, nominals, states, defined] = flags.each_mut();
        unsafe {
            let update = fmi3UpdateDiscreteStates;
            let status =
                update(self.handle, need, terminate, nominals, states, defined, &mut next_s);
            assert_eq!(status, OK);
            assert_eq!(flags, [0, 0, 0, 0, 1]);
            assert_eq!(fmi3EnterStepMode(self.handle), OK);
        }
        assert!((next_s - (self.step + 1) as f64 * 0.005).abs() < 1e-9, "{next_s}");
    }

    fn epoch(&mut self, epoch: &Epoch) -> Output {
        if self.events {
            assert_eq!(unsafe { fmi3EnterEventMode(self.handle) }, OK);
        }
        let sample = &epoch.sample;
        let theta = sample.delta_theta.map(|count| f64::from(count) * DELTA_THETA_LSB_RAD);
        let velocity = sample.delta_velocity.map(|count| f64::from(count) * DELTA_VELOCITY_LSB_MPS);
        self.set_as(ElementType::Real, slot("gyro.delta_theta"), &theta);
        self.set_as(ElementType::Real, slot("accelerometer.delta_velocity"), &velocity);
        let gimbal = [sample.gimbal.azimuth_rad(), sample.gimbal.roll_rad()];
        self.set_reals(&[slot("gimbal.azimuth"), slot("gimbal.roll")], &gimbal);
        self.set_as(ElementType::Boolean, slot("imu.valid"), &[1.0]);
        self.set_as(ElementType::Integer, slot("imu.status"), &[f64::from(sample.status.bits())]);
        self.set_as(ElementType::Count, slot("imu.sequence"), &[sample.sequence as f64]);
        self.set_as(
            ElementType::Count,
            slot("imu.device_time_ns"),
            &[sample.device_time.ns as f64],
        );
        let kind = match epoch.aiding.map(|aiding| aiding.reference) {
            None => 0.0,
            Some(Reference::Velocity(velocity)) => {
                self.set_as(ElementType::Real, slot("reference.velocity"), &velocity);
                1.0
            }
            Some(Reference::Position { latitude_rad, longitude_rad, height_m }) => {
                let references = ["latitude", "longitude", "height"]
                    .map(|name| MODEL.slot(&format!("reference.{name}")) as u32);
                self.set_reals(&references, &[latitude_rad, longitude_rad, height_m]);
                2.0
            }
        };
        let (reference_kind, variable) = MODEL.find("reference.kind").unwrap();
        self.set_as(variable.kind, reference_kind as u32, &[kind]);
        if let Some(aiding) = epoch.aiding {
            let age_ns = sample.device_time.ns as f64 - aiding.device_time.ns as f64;
            self.set_as(ElementType::Real, slot("reference.age_ns"), &[age_ns]);
        }
        if self.events {
            self.finish_event();
        }
        let time_s = self.step as f64 * 0.005;
        self.step += 1;
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => assert_eq!(fmi2DoStep(self.handle, time_s, 0.005, 1), OK),
                ServedStandard::Fmi3 => {
                    let (mut event, mut end, mut early, mut last_s) = (9, 9, 9, f64::NAN);
                    let do_step = fmi3DoStep;
                    let status = do_step(
                        self.handle,
                        time_s,
                        0.005,
                        1,
                        &mut event,
                        &mut end,
                        &mut early,
                        &mut last_s,
                    );
                    assert_eq!((status, event, end, early), (OK, self.events.into(), 0, 0));
                }
            }
        }
        self.output()
    }

    fn output(&self) -> Output {
        let [azimuth_rad] = self.reals(slot("gimbal_command.azimuth"));
        let [roll_rad] = self.reals(slot("gimbal_command.roll"));
        let [latitude_rad] = self.reals(slot("navigation.latitude"));
        let [longitude_rad] = self.reals(slot("navigation.longitude"));
        let [height_m] = self.reals(slot("navigation.height"));
        let [nis] = self.reals(slot("filter.nis"));
        Output {
            sequence: self.count(slot("answer.sequence")),
            device_time: DeviceTime::from_ns(self.count(slot("answer.device_time_ns"))),
            mode: Mode::ALL[self.integer(slot("mode"), true) as usize],
            stop: self.integer(slot("stop"), false) as u16,
            moving: self.boolean(slot("moving")),
            gimbal_command: GimbalCommand { target: GimbalAngles::from_rad(azimuth_rad, roll_rad) },
            navigation: Navigation {
                latitude_rad,
                longitude_rad,
                height_m,
                velocity_mps: self.reals(slot("navigation.velocity")),
                q_nb: self.reals(slot("navigation.attitude")),
            },
            health: Health::from_bits_retain(self.integer(slot("health"), false) as u32),
            nis: if self.boolean(slot("filter.measured")) { nis } else { f64::NAN },
            parameters_revision: self.count(slot("parameters.revision")) as u32,
        }
    }

    fn parameters(&self) -> (Parameters, [f64; 30]) {
        let all = |prefix: &str| {
            let mut values = [f64::NAN; 30];
            for group in octant_sample::parameters::ParameterGroup::ALL {
                let first = MODEL.slot(&format!("{prefix}.{}", group.name())) as u32;
                let range = group.range();
                match range.len() {
                    3 => values[range].copy_from_slice(&self.reals::<3>(first)),
                    6 => values[range].copy_from_slice(&self.reals::<6>(first)),
                    _ => values[range].copy_from_slice(&self.reals::<9>(first)),
                }
            }
            values
        };
        (Parameters::from_array(&all("parameters")), all("sigma"))
    }

    /// Returns the state as bytes.
    fn state(&self) -> Vec<u8> {
        let (mut state, mut size) = (null_mut(), 0);
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => {
                    assert_eq!(fmi2GetFMUstate(self.handle, &mut state), OK);
                    assert_eq!(fmi2SerializedFMUstateSize(self.handle, state, &mut size), OK);
                    let mut bytes = vec![0u8; size];
                    let to = bytes.as_mut_ptr().cast();
                    assert_eq!(fmi2SerializeFMUstate(self.handle, state, to, size), OK);
                    assert_eq!(fmi2FreeFMUstate(self.handle, &mut state), OK);
                    bytes
                }
                ServedStandard::Fmi3 => {
                    assert_eq!(fmi3GetFMUState(self.handle, &mut state), OK);
                    assert_eq!(fmi3SerializedFMUStateSize(self.handle, state, &mut size), OK);
                    let mut bytes = vec![0u8; size];
                    let to = bytes.as_mut_ptr();
                    assert_eq!(fmi3SerializeFMUState(self.handle, state, to, size), OK);
                    assert_eq!(fmi3FreeFMUState(self.handle, &mut state), OK);
                    bytes
                }
            }
        }
    }

    /// Creates a fresh instance that continues from such bytes.
    fn revived(&self, bytes: &[u8]) -> Self {
        let mut fresh = Self::instantiate(self.standard, self.events);
        let (mut state, size) = (null_mut(), bytes.len());
        unsafe {
            match self.standard {
                ServedStandard::Fmi2 => {
                    let from = bytes.as_ptr().cast();
                    assert_eq!(fmi2DeSerializeFMUstate(fresh.handle, from, size, &mut state), OK);
                    assert_eq!(fmi2SetFMUstate(fresh.handle, state), OK);
                }
                ServedStandard::Fmi3 => {
                    let from = bytes.as_ptr();
                    assert_eq!(fmi3DeserializeFMUState(fresh.handle, from, size, &mut state), OK);
                    assert_eq!(fmi3SetFMUState(fresh.handle, state), OK);
                }
            }
        }
        fresh.step = self.step;
        fresh
    }
}

/// Runs the whole stream of the scenario through a core in process and through an instance;
/// `between` may replace the instance after any epoch.
fn compare(
    standard: ServedStandard,
    events: bool,
    mut between: impl FnMut(u64, &mut Unit, &CoreConfig),
) {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/scenarios/lockstep.toml");
    let scenario = Scenario::load(&file, &[]).unwrap();
    let (plant, config, _) = configurations(&scenario, Method::Primary, scenario.seed).unwrap();
    let mut source = PlantSource::new(&plant, scenario.samples().unwrap()).unwrap();
    let mut core = Core::new(&config).unwrap();
    let mut unit = Unit::new(standard, events, &config);
    let (mut epoch, mut command) = (Epoch::default(), GimbalCommand::default());
    let (mut epochs, mut revision, mut modes) = (0, 0, Vec::new());
    while source.next(&command, &mut epoch).unwrap() {
        let expected = core.step(&epoch.sample, epoch.aiding.as_ref());
        let found = unit.epoch(&epoch);
        let bytes = |output: &Output| {
            let mut bytes = [0; OUTPUT_BYTES];
            canonical::output(output, &mut bytes);
            bytes
        };
        assert!(bytes(&found) == bytes(&expected), "{found:?}\n{expected:?}");
        if found.parameters_revision != revision {
            revision = found.parameters_revision;
            let bytes = |parameters: &Parameters, sigma: &[f64; 30]| {
                let mut bytes = [0; PARAMETERS_BYTES];
                canonical::parameters(parameters, sigma, &mut bytes);
                bytes
            };
            let (parameters, sigma) = unit.parameters();
            let expected = bytes(core.parameters(), core.sigma());
            assert!(bytes(&parameters, &sigma) == expected, "revision {revision}");
        }
        if modes.last() != Some(&found.mode) {
            modes.push(found.mode);
        }
        command = found.gimbal_command;
        epochs += 1;
        between(epochs, &mut unit, &config);
    }
    assert_eq!(epochs, 120_000);
    assert!(revision > 400, "{revision}");
    assert_eq!(modes, [Mode::Calibrating, Mode::Navigating, Mode::Done]);
}

#[test]
fn fmi_2_gives_the_bits_of_the_core() {
    compare(ServedStandard::Fmi2, false, |_, _, _| ());
}

#[test]
fn fmi_3_gives_the_bits_of_the_core() {
    compare(ServedStandard::Fmi3, false, |_, _, _| ());
}

#[test]
fn fmi_3_with_event_mode_gives_the_bits_of_the_core() {
    compare(ServedStandard::Fmi3, true, |_, _, _| ());
}

/// Replaces the instance with a fresh one restored from its bytes: in the middle of the
/// calibration, in a move, at the end of the calibration, and in navigation.
fn revive(epochs: u64, unit: &mut Unit, config: &CoreConfig) {
    if [1, 777, 48_000, 50_001, 95_999, 96_000, 110_000].contains(&epochs) {
        let bytes = unit.state();
        assert_eq!(unit.state(), bytes, "the same state, the same bytes");
        let revived = unit.revived(&bytes);
        assert_eq!(revived.state(), bytes, "there and back");
        *unit = revived;
    }
    if epochs == 60_000 {
        // An instance that has processed other data forgets it.
        let bytes = unit.state();
        let mut other = Unit::new(unit.standard, unit.events, config);
        for _ in 0..300 {
            other.epoch(&Epoch::default());
        }
        let mut revived = other.revived(&bytes);
        revived.step = unit.step;
        *unit = revived;
    }
}

#[test]
fn fmi_2_goes_on_from_bytes_in_a_fresh_instance() {
    compare(ServedStandard::Fmi2, false, revive);
}

#[test]
fn fmi_3_goes_on_from_bytes_in_a_fresh_instance() {
    compare(ServedStandard::Fmi3, false, revive);
}

/// Every 10 000 epochs the instance takes a wrong step, and is restored.
#[test]
fn a_step_that_is_taken_back_leaves_no_trace() {
    compare(ServedStandard::Fmi2, false, |epochs, unit, _| {
        if !epochs.is_multiple_of(10_000) {
            return;
        }
        let (mut state, step) = (null_mut(), unit.step);
        unsafe { assert_eq!(fmi2GetFMUstate(unit.handle, &mut state), OK) };
        let mut wrong = Epoch::default();
        for k in 1..=500 {
            wrong.sample.sequence = 1_000_000 + k;
            wrong.sample.device_time = DeviceTime::from_ns((1_000_000 + k) * 5_000_000);
            wrong.sample.delta_theta = [k as i32 * 1_000_000; 3];
            unit.epoch(&wrong);
        }
        unsafe {
            assert_eq!(fmi2SetFMUstate(unit.handle, state), OK);
            assert_eq!(fmi2FreeFMUstate(unit.handle, &mut state), OK);
        }
        unit.step = step;
    });
}
