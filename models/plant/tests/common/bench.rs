//! A plant with a station of faults, and its twin without.

use octant_faults::catalogue::Dimension;
use octant_faults::station::{Delivered, World};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{FaultSpec, Setup, Station, Value, Values, kinds};
use octant_plant::config::PlantConfig;
use octant_plant::{ComparedPlant, Plant, PlantStep, Truth};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, Output};

pub(crate) fn setup(config: &PlantConfig) -> Setup {
    Setup {
        seed: config.seed,
        sample_period_ns: config.sample_period_ns,
        calibration_samples: config.calibration_samples,
        angle_random_walk: config.imu.angle_random_walk,
        velocity_random_walk: config.imu.velocity_random_walk,
        turntable_rate_radps: config.turntable.rate_radps,
        id: String::new(),
    }
}

/// Makes a fault that first alters the sample of this number, and lasts for a number of samples.
pub(crate) fn fault(
    kind: &str,
    values: &[(&'static str, Value)],
    first: u64,
    samples: u64,
) -> FaultSpec {
    let kind = kinds::named(kind).unwrap();
    let mut all = Values::default();
    for (name, value) in values {
        all.set(name, *value);
    }
    for parameter in kind.parameters {
        assert!(all.get(parameter.name).is_some(), "{}: {} is missing", kind.name, parameter.name);
    }
    let schedule = Schedule {
        trigger: Trigger::Epoch(first),
        duration: Some(samples),
        recovery: 0,
        repeat: Repeat::Once,
    };
    FaultSpec { id: format!("{}-{first}", kind.name), kind, values: all, schedule }
}

/// One sample with truth at its stamp, of the faulted plant and of its twin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) step: PlantStep,
    pub(crate) truth: Truth,
    pub(crate) twin: PlantStep,
    pub(crate) twin_truth: Truth,
}

impl Pair {
    /// Difference of a gyro's count from that of the twin.
    pub(crate) fn theta(&self, axis: usize) -> i64 {
        i64::from(self.step.sample.delta_theta[axis])
            - i64::from(self.twin.sample.delta_theta[axis])
    }

    /// Difference of an accelerometer's count from that of the twin.
    pub(crate) fn velocity(&self, axis: usize) -> i64 {
        i64::from(self.step.sample.delta_velocity[axis])
            - i64::from(self.twin.sample.delta_velocity[axis])
    }

    pub(crate) fn is_twin(&self) -> bool {
        self.step == self.twin && self.truth == self.twin_truth
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

/// Runs samples 1 to `samples`; `target` is the set point passed with the call for sample k.
pub(crate) fn run_pair(
    config: &PlantConfig,
    specs: &[FaultSpec],
    samples: u64,
    target: impl Fn(u64) -> GimbalCommand,
) -> Vec<Pair> {
    let mut station = Station::new(specs, &setup(config)).unwrap();
    let (mut plant, mut twin) = (ComparedPlant::new(config).unwrap(), Plant::new(config).unwrap());
    let output = Output::default();
    let pairs = (1..=samples).map(|k| {
        let mut command = target(k);
        station.before(&mut command, &output, &mut Behind(&mut plant));
        let step = plant.step(&command);
        let epoch = octant_sample::Epoch { sample: step.sample, aiding: step.aiding };
        let passed = station.after(&epoch, &output, &mut Behind(&mut plant));
        assert_eq!(passed.delivered, Delivered::Untouched);
        station.told();
        let twin_step = twin.step(&target(k));
        Pair { step, truth: plant.plant().truth(), twin: twin_step, twin_truth: twin.truth() }
    });
    let pairs = pairs.collect();
    assert!(station.receipts().iter().all(|receipt| receipt.fired()));
    pairs
}

/// Checks that a fault alters not a bit before its first sample.
pub(crate) fn nothing_before(pairs: &[Pair], first: u64) {
    for pair in &pairs[..first as usize - 1] {
        assert!(pair.is_twin(), "{}", pair.step.sample.sequence);
    }
    let altered = pairs[first as usize - 1..].iter().any(|pair| !pair.is_twin());
    assert!(altered, "nothing happened at all");
}

/// Checks that from a sample on all is as without the fault: truth and angles bit for bit, the
/// integrals of the counts within the one count that a carried remainder can make.
pub(crate) fn nothing_after(pairs: &[Pair], from: u64) {
    let mut sums = [0i64; 6];
    assert!(pairs.len() > from as usize + 100);
    for pair in &pairs[from as usize - 1..] {
        assert_eq!(pair.truth, pair.twin_truth);
        assert_eq!(pair.step.sample.gimbal, pair.twin.sample.gimbal);
        assert_eq!(pair.step.sample.status, pair.twin.sample.status);
        assert_eq!(pair.step.aiding, pair.twin.aiding);
        for axis in 0..3 {
            sums[axis] += pair.theta(axis);
            sums[3 + axis] += pair.velocity(axis);
        }
        assert!(sums.iter().all(|sum| sum.abs() <= 1), "{sums:?}");
    }
}

/// Integral of the difference of the gyros (0 to 2) or accelerometers (3 to 5) from the twin's,
/// from the first sample to each, rad or m/s.
pub(crate) fn gathered(pairs: &[Pair], channel: usize) -> Vec<f64> {
    let mut sum = 0;
    let all = pairs.iter().map(|pair| {
        if channel < 3 {
            sum += pair.theta(channel);
            sum as f64 * DELTA_THETA_LSB_RAD
        } else {
            sum += pair.velocity(channel - 3);
            sum as f64 * DELTA_VELOCITY_LSB_MPS
        }
    });
    all.collect()
}

pub(crate) fn quantity(value: f64, dimension: Dimension) -> Value {
    Value::Quantity(value, dimension)
}

pub(crate) fn vector(value: [f64; 3], dimension: Dimension) -> Value {
    Value::Vector(value, dimension)
}

/// 10 u³ − 15 u⁴ + 6 u⁵ and its derivative.
pub(crate) fn rise(u: f64) -> (f64, f64) {
    let u = u.clamp(0.0, 1.0);
    (u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u), 30.0 * u * u * (1.0 - u) * (1.0 - u))
}
