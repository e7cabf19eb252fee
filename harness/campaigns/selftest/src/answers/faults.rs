//! Effects of faults of known size on the counts of an instrument at rest.

use super::numbers::Found;
use super::plant::{perfect, site};
use octant_earth::units::DEG;
use octant_faults::catalogue::Dimension;
use octant_faults::station::{Delivered, World};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{FaultSpec, Setup, Station, Value, Values, kinds};
use octant_plant::config::{CaseAttitude, Motion, PlantConfig};
use octant_plant::{ComparedPlant, Truth};
use octant_sample::disturbance::Disturbed;
use octant_sample::{Epoch, GimbalAngles, GimbalCommand, Output};
use std::f64::consts::PI;

const MARKS: [u64; 6] = [130, 161, 200, 303, 457, 700];
/// Samples in the pulse of a shock and during its return.
const TRUTH_MARKS: [u64; 4] = [110, 118, 130, 161];
/// First altered sample; `SAMPLES` is their number.
const FIRST: u64 = 101;
const SAMPLES: u64 = 400;

struct Behind<'a>(&'a mut ComparedPlant);

impl World for Behind<'_> {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        Some(self.0)
    }
    fn truth(&self) -> Option<Truth> {
        Some(self.0.plant().truth())
    }
}

pub(super) fn setup(config: &PlantConfig) -> Setup {
    Setup {
        seed: config.seed,
        sample_period_ns: config.sample_period_ns,
        calibration_samples: config.calibration_samples,
        angle_random_walk: 2e-7,
        velocity_random_walk: 5e-4,
        turntable_rate_radps: config.turntable.rate_radps,
        id: String::new(),
    }
}

pub(super) type Named = (&'static str, Value);

fn vector(name: &'static str, of: [f64; 3], dimension: Dimension) -> Named {
    (name, Value::Vector(of, dimension))
}

pub(super) fn size(name: &'static str, of: f64, dimension: Dimension) -> Named {
    (name, Value::Quantity(of, dimension))
}

/// Builds a fault of a kind from a sample on, for a number of samples.
pub(super) fn spec(
    name: &'static str,
    values: Vec<Named>,
    first: u64,
    samples: u64,
) -> Result<FaultSpec, String> {
    let kind = kinds::named(name).ok_or_else(|| format!("find the fault {name}"))?;
    let mut all = Values::default();
    for (name, value) in values {
        all.set(name, value);
    }
    let schedule = Schedule {
        trigger: Trigger::Epoch(first),
        duration: Some(samples),
        recovery: 0,
        repeat: Repeat::Once,
    };
    Ok(FaultSpec { id: "f".to_owned(), kind, values: all, schedule })
}

/// Lists every fault with its values, and the set point of the gimbals.
fn all() -> Vec<(&'static str, Vec<Named>, (f64, f64))> {
    use Dimension::{
        Acceleration, AccelerationPsd, Angle, AngularRate, Frequency, Length, SmallAngle, Time,
    };
    let w = 2.0 * PI * 37.0;
    vec![
        (
            "shock",
            vec![
                vector("peak", [2.0, 0.5, -1.0], Acceleration),
                size("width", 0.1, Time),
                size("recoil", 0.3, Time),
            ],
            (0.0, 0.0),
        ),
        (
            "vibration-sine",
            vec![
                size("frequency", w / (2.0 * PI), Frequency),
                vector("acceleration", [3.0, 0.0, 5.0], Acceleration),
                vector("angle", [1e-4, 2e-4, 0.0], Angle),
                size("phase", 0.7, Angle),
                size("edge", 0.25, Time),
            ],
            (0.0, 0.0),
        ),
        (
            "vibration-random",
            vec![
                vector("psd", [0.2, 0.0, 0.1], AccelerationPsd),
                vector("rate", [0.0, 0.01, 0.02], AngularRate),
                size("low_frequency", 20.0, Frequency),
                size("high_frequency", 60.0, Frequency),
                ("lines", Value::Integer(5)),
                size("edge", 0.2, Time),
            ],
            (0.0, 0.0),
        ),
        (
            "mooring-jerk",
            vec![
                vector("displacement", [0.3, -0.1, 0.2], Length),
                vector("turn", [0.01, 0.02, -0.03], Angle),
                size("length", 2.0, Time),
            ],
            (0.0, 0.0),
        ),
        (
            "sway",
            vec![
                vector("angles", [0.05, 0.03, 0.02], Angle),
                vector("angle_periods", [8.0, 6.0, 10.0], Time),
                vector("displacement", [0.2, 0.15, 0.1], Length),
                vector("displacement_periods", [6.0, 7.0, 8.0], Time),
                size("edge", 0.5, Time),
            ],
            (0.0, 0.0),
        ),
        (
            "gimbal-slip",
            vec![
                ("gimbal", Value::Choice("azimuth")),
                size("angle", 0.01, Angle),
                size("within", 0.3, Time),
                ("encoder", Value::Choice("drive")),
            ],
            (40.0, 25.0),
        ),
        (
            "short-settle",
            vec![
                ("gimbal", Value::Choice("roll")),
                size("amplitude", 1e-3, SmallAngle),
                size("frequency", 7.0, Frequency),
                size("decay", 0.4, Time),
            ],
            (2.0, 1.0),
        ),
    ]
}

pub(super) fn found() -> Result<Found, String> {
    let leaning = CaseAttitude { heading_rad: 1.1, pitch_rad: 0.03, roll_rad: -0.02 };
    let config = perfect(1, site(-60.0, -20.0, 4000.0), Motion::Static(leaning));
    let mut found = Found::new();
    for (kind, values, to) in all() {
        suffer(&mut found, &config, kind, values, to)?;
    }
    Ok(found)
}

fn suffer(
    found: &mut Found,
    config: &PlantConfig,
    name: &'static str,
    values: Vec<Named>,
    (azimuth, roll): (f64, f64),
) -> Result<(), String> {
    // Ringing follows a move that begins under it; all other faults set in during rest or a move.
    let (first, samples) = if name == "short-settle" { (1, 700) } else { (FIRST, SAMPLES) };
    let spec = spec(name, values, first, samples)?;
    let wrong = |what: String| format!("set up the fault {name}: {what}");
    let mut station =
        Station::new(&[spec], &setup(config)).map_err(|(_, error)| wrong(error.to_string()))?;
    let mut plant = ComparedPlant::new(config).map_err(|error| wrong(error.to_string()))?;
    let output = Output::default();
    let (mut gyro, mut accelerometer) = ([0i64; 3], [0i64; 3]);
    for n in 1..=MARKS[MARKS.len() - 1] {
        let mut command =
            GimbalCommand { target: GimbalAngles::from_rad(azimuth * DEG, roll * DEG) };
        station.before(&mut command, &output, &mut Behind(&mut plant));
        let step = plant.step(&command);
        let epoch = Epoch { sample: step.sample, aiding: step.aiding };
        let passed = station.after(&epoch, &output, &mut Behind(&mut plant));
        if passed.delivered != Delivered::Untouched {
            return Err(wrong("it altered a sample on its way".to_owned()));
        }
        station.told();
        for axis in 0..3 {
            gyro[axis] += i64::from(step.sample.delta_theta[axis]);
            accelerometer[axis] += i64::from(step.sample.delta_velocity[axis]);
        }
        if name == "shock" && TRUTH_MARKS.contains(&n) {
            let truth = plant.plant().truth();
            for (axis, label) in ["north", "east", "down"].into_iter().enumerate() {
                found.insert(format!("{name}, velocity {label}, {n}"), truth.velocity_mps[axis]);
            }
            found.insert(format!("{name}, height, {n}"), truth.height_m);
        }
        if MARKS.contains(&n) {
            for (axis, label) in ["x", "y", "z"].into_iter().enumerate() {
                found.insert(format!("{name}, gyro {label}, {n}"), gyro[axis] as f64);
                let counts = accelerometer[axis] as f64;
                found.insert(format!("{name}, accelerometer {label}, {n}"), counts);
            }
        }
    }
    Ok(())
}
