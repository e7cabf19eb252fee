//! A bench for faults: a stream of samples that any test can compute by itself, and a station.
#![allow(unreachable_pub)]

pub mod counts;

use octant_faults::catalogue::Dimension;
use octant_faults::rule::UnitEvent;
use octant_faults::station::{Delivered, FaultSpec, Occurrence, World};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{Receipt, Setup, Station, Value, Values};
use octant_sample::canonical::{AIDING_BYTES, SAMPLE_BYTES, aiding, sample};
use octant_sample::disturbance::{Disturbance, Disturbed, Motor};
use octant_sample::{
    Aiding, DeviceTime, Epoch, GimbalAngles, GimbalCommand, Output, Reference, Sample, Truth,
};

/// Sample period at 200 Hz, ns.
pub const PERIOD_NS: u64 = 5_000_000;

pub fn setup() -> Setup {
    Setup {
        seed: 7,
        sample_period_ns: PERIOD_NS,
        calibration_samples: 1000,
        angle_random_walk: 2e-7,
        velocity_random_walk: 5e-4,
        turntable_rate_radps: 0.17,
        id: String::new(),
    }
}

/// The clean epoch of a number, from 1: no two samples alike, aiding every 200.
pub fn clean(epoch: u64) -> Epoch {
    let k = epoch as i32;
    Epoch {
        sample: Sample {
            sequence: epoch,
            device_time: DeviceTime::from_ns(epoch * PERIOD_NS),
            delta_theta: [100_000 + 7 * k, -200_000 + 11 * k, 300_000 - 13 * k],
            delta_velocity: [1_000 + 17 * k, -2_000 - 19 * k, 52_000_000 + 23 * k],
            gimbal: GimbalAngles { azimuth: 1000 + 3 * k, roll: 5000 - 2 * k },
            ..Sample::default()
        },
        aiding: epoch.is_multiple_of(200).then(|| Aiding {
            device_time: DeviceTime::from_ns(epoch * PERIOD_NS),
            reference: Reference::Velocity([1e-3, -2e-3, epoch as f64 * 1e-6]),
        }),
    }
}

/// Makes a fault of a kind from an epoch on, for a number of epochs.
pub fn fault(kind: &str, values: &[(&'static str, Value)], first: u64, epochs: u64) -> FaultSpec {
    let mut all = Values::default();
    for (name, value) in values {
        all.set(name, *value);
    }
    let kind = octant_faults::kinds::named(kind).unwrap();
    for parameter in kind.parameters {
        assert!(all.get(parameter.name).is_some(), "{}: {} is missing", kind.name, parameter.name);
    }
    FaultSpec {
        id: "f".into(),
        kind,
        values: all,
        schedule: Schedule {
            trigger: Trigger::Epoch(first),
            duration: Some(epochs),
            recovery: 0,
            repeat: Repeat::Once,
        },
    }
}

/// Epochs for which a disturbance of [`Log`] goes on after its end.
pub const TAIL: u64 = 2;
/// Counts that each disturbance adds to the x gyro.
pub const EACH: i32 = 100;

/// Calls that a plant received. Each disturbance adds to the x gyro as long as it has an effect.
#[derive(Clone, Debug, Default)]
pub struct Log {
    pub begun: Vec<(u32, Disturbance)>,
    pub ended: Vec<u32>,
    pub motor: Motor,
    pub truth: Option<Truth>,
    /// Number of epochs so far.
    pub epochs: u64,
    /// Handles with the first epoch without an effect.
    pub until: Vec<(u32, u64)>,
    pub copies: Vec<(u32, Epoch)>,
}

impl Log {
    fn acts(&self, handle: u32, epoch: u64) -> bool {
        self.until.iter().any(|(of, until)| *of == handle && epoch < *until)
    }

    /// The epoch without a disturbance and those of larger handles.
    pub fn delivered_without(&self, handle: u32, mut epoch: Epoch) -> Epoch {
        let acting = self.until.iter().filter(|(of, until)| *of >= handle && self.epochs < *until);
        let x = &mut epoch.sample.delta_theta[0];
        acting.for_each(|_| *x = x.wrapping_sub(EACH));
        epoch
    }

    /// Takes note of the epoch that the plant delivers next.
    pub fn deliver(&mut self, epoch: &Epoch) {
        self.epochs += 1;
        let handles: Vec<u32> = self.until.iter().map(|(handle, _)| *handle).collect();
        let acting = handles.into_iter().filter(|handle| self.acts(*handle, self.epochs));
        self.copies =
            acting.map(|handle| (handle, self.delivered_without(handle, *epoch))).collect();
    }

    fn set(&mut self, handle: u32, until: u64) {
        self.until.retain(|(of, _)| *of != handle);
        self.until.push((handle, until));
    }
}

impl Disturbed for Log {
    fn motor(&self) -> Motor {
        self.motor
    }
    fn begin(&mut self, handle: u32, disturbance: &Disturbance) {
        self.begun.push((handle, disturbance.clone()));
        self.set(handle, u64::MAX);
    }
    fn end(&mut self, handle: u32) {
        self.ended.push(handle);
        self.set(handle, self.epochs + 1 + TAIL);
    }
    fn goes_on(&self, handle: u32) -> bool {
        self.acts(handle, self.epochs + 1)
    }
    fn without(&self, handle: u32) -> Option<&Epoch> {
        self.copies.iter().find(|(of, _)| *of == handle).map(|(_, epoch)| epoch)
    }
    fn remainder_counts(&self) -> [i64; 2] {
        [1, 1]
    }
}

impl World for Log {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        Some(self)
    }
    fn truth(&self) -> Option<Truth> {
        self.truth
    }
}

/// Result of a run of the bench.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Epochs delivered, each with the epoch of the source in whose step it was delivered.
    pub delivered: Vec<(u64, Epoch)>,
    /// Set points that the turntable got.
    pub commands: Vec<GimbalCommand>,
    pub receipts: Vec<Receipt>,
    pub occurrences: Vec<Occurrence>,
    pub events: Vec<(u64, UnitEvent)>,
    pub log: Log,
}

impl Outcome {
    /// Epochs delivered in a step of the source.
    pub fn at(&self, epoch: u64) -> Vec<Epoch> {
        self.delivered.iter().filter(|(at, _)| *at == epoch).map(|(_, epoch)| *epoch).collect()
    }
}

/// Runs clean epochs 1 to `epochs` through a station. `answer` is the core's output to epoch k (0:
/// before the first); its set point goes to the turntable.
pub fn run_with(specs: &[FaultSpec], epochs: u64, answer: impl Fn(u64) -> Output) -> Outcome {
    let mut station = Station::new(specs, &setup()).unwrap();
    let mut outcome = Outcome::default();
    for k in 1..=epochs {
        let output = answer(k - 1);
        let mut command = output.gimbal_command;
        station.before(&mut command, &output, &mut outcome.log);
        outcome.commands.push(command);
        let epoch = clean(k);
        outcome.log.deliver(&epoch);
        match station.after(&epoch, &output, &mut outcome.log).delivered {
            Delivered::Untouched => outcome.delivered.push((k, epoch)),
            Delivered::These(epochs) => {
                outcome.delivered.extend(epochs.iter().map(|epoch| (k, *epoch)));
            }
        }
        outcome.events.extend(station.unit_events().iter().map(|event| (k, *event)));
        outcome.occurrences.extend_from_slice(station.occurrences());
        station.told();
    }
    outcome.receipts = station.receipts();
    outcome
}

/// Runs with a core that gives only default outputs.
pub fn run(specs: &[FaultSpec], epochs: u64) -> Outcome {
    run_with(specs, epochs, |_| Output::default())
}

/// Returns the message with which a fault is refused.
pub fn refused(spec: &FaultSpec) -> String {
    Station::new(std::slice::from_ref(spec), &setup()).unwrap_err().1.to_string()
}

/// A time as a value of a fault.
pub fn seconds(time_s: f64) -> Value {
    Value::Quantity(time_s, Dimension::Time)
}

/// Canonical bytes of epochs, over which receipts have their checksums.
pub fn bytes(epochs: &[Epoch]) -> Vec<u8> {
    let mut all = Vec::new();
    for epoch in epochs {
        let mut part = [0; SAMPLE_BYTES];
        sample(&epoch.sample, &mut part);
        all.extend_from_slice(&part);
        if let Some(message) = &epoch.aiding {
            let mut part = [0; AIDING_BYTES];
            aiding(message, &mut part);
            all.extend_from_slice(&part);
        }
    }
    all
}
