//! Quantities of a step that a fault may change, with their units and resolutions.

use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, GIMBAL_LSB_RAD};
use octant_sample::{Aiding, Epoch, GimbalCommand, Output, Reference};

const DEG: f64 = std::f64::consts::PI / 180.0;

/// Step of a run, as far as a picture shows it.
#[derive(Clone, Copy, Debug)]
pub struct PictureStep<'a> {
    /// Set point of the turntable.
    pub command: GimbalCommand,
    /// Epochs that reached the core.
    pub delivered: &'a [Epoch],
    /// Last answer of the core; `None` where no epoch reached it.
    pub output: Option<&'a Output>,
}

/// One quantity of a step; NaN where the step doesn't have it.
pub(super) struct Quantity {
    pub name: &'static str,
    /// Value of a step of the source by its number from 1, SI.
    pub of: fn(&PictureStep<'_>, &View) -> f64,
    /// Unit, in SI, from the largest first.
    pub units: &'static [(&'static str, f64)],
    /// Resolution, SI: a smaller difference counts as zero.
    pub resolution: f64,
}

/// References of the quantities.
pub(super) struct View {
    pub period_s: f64,
    /// Number of the step.
    pub number: u64,
    /// Position of the reference at the start: positions are shown as offsets from it.
    pub origin: Option<[f64; 3]>,
}

const RATES: &[(&str, f64)] = &[("°/s", DEG), ("°/h", DEG / 3600.0)];
const ACCELERATIONS: &[(&str, f64)] = &[("m/s²", 1.0), ("mg", 9.80665e-3), ("µg", 9.80665e-6)];
const ANGLES: &[(&str, f64)] = &[("°", DEG), ("″", DEG / 3600.0)];
const TIMES: &[(&str, f64)] = &[("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)];
const VELOCITIES: &[(&str, f64)] = &[("m/s", 1.0), ("mm/s", 1e-3), ("µm/s", 1e-6)];
const LENGTHS: &[(&str, f64)] = &[("m", 1.0), ("mm", 1e-3)];
const COUNT: &[(&str, f64)] = &[("", 1.0)];

fn last<'a>(step: &PictureStep<'a>) -> Option<&'a Epoch> {
    step.delivered.last()
}

fn rate(step: &PictureStep<'_>, view: &View, axis: usize) -> f64 {
    last(step).map_or(f64::NAN, |e| {
        f64::from(e.sample.delta_theta[axis]) * DELTA_THETA_LSB_RAD / view.period_s
    })
}

fn force(step: &PictureStep<'_>, view: &View, axis: usize) -> f64 {
    last(step).map_or(f64::NAN, |e| {
        f64::from(e.sample.delta_velocity[axis]) * DELTA_VELOCITY_LSB_MPS / view.period_s
    })
}

pub(super) fn aiding<'a>(step: &PictureStep<'a>) -> Option<&'a Aiding> {
    step.delivered.iter().rev().find_map(|e| e.aiding.as_ref())
}

fn velocity(step: &PictureStep<'_>, axis: usize) -> f64 {
    match aiding(step).map(|a| a.reference) {
        Some(Reference::Velocity(v)) => v[axis],
        _ => f64::NAN,
    }
}

fn position(step: &PictureStep<'_>, view: &View, axis: usize) -> f64 {
    // A spherical Earth is enough for a picture.
    const RADIUS_M: f64 = 6_371_000.0;
    match (aiding(step).map(|a| a.reference), view.origin) {
        (Some(Reference::Position { latitude_rad, longitude_rad, height_m }), Some(o)) => {
            match axis {
                0 => (latitude_rad - o[0]) * RADIUS_M,
                1 => (longitude_rad - o[1]) * RADIUS_M * libm::cos(o[0]),
                _ => o[2] - height_m,
            }
        }
        _ => f64::NAN,
    }
}

fn stamp_error(ns: u64, view: &View) -> f64 {
    // In whole nanoseconds: a correct stamp gives zero to the last bit.
    let right_ns = view.number as f64 * (view.period_s * 1e9).round();
    (ns as f64 - right_ns) * 1e-9
}

macro_rules! quantity {
    ($name:literal, $of:expr, $units:expr, $resolution:expr) => {
        Quantity { name: $name, of: $of, units: $units, resolution: $resolution }
    };
}

const RATE: f64 = DELTA_THETA_LSB_RAD / 0.005;
const FORCE: f64 = DELTA_VELOCITY_LSB_MPS / 0.005;

pub(super) static CHANNELS: [Quantity; 6] = [
    quantity!("gyro x", |s, v| rate(s, v, 0), RATES, RATE),
    quantity!("gyro y", |s, v| rate(s, v, 1), RATES, RATE),
    quantity!("gyro z", |s, v| rate(s, v, 2), RATES, RATE),
    quantity!("accelerometer x", |s, v| force(s, v, 0), ACCELERATIONS, FORCE),
    quantity!("accelerometer y", |s, v| force(s, v, 1), ACCELERATIONS, FORCE),
    quantity!("accelerometer z", |s, v| force(s, v, 2), ACCELERATIONS, FORCE),
];
pub(super) static ENCODERS: [Quantity; 2] = [
    quantity!(
        "encoder, azimuth",
        |s, _| last(s).map_or(f64::NAN, |e| e.sample.gimbal.azimuth_rad()),
        ANGLES,
        GIMBAL_LSB_RAD
    ),
    quantity!(
        "encoder, roll",
        |s, _| last(s).map_or(f64::NAN, |e| e.sample.gimbal.roll_rad()),
        ANGLES,
        GIMBAL_LSB_RAD
    ),
];
pub(super) static COMMANDS: [Quantity; 2] = [
    quantity!("set point, azimuth", |s, _| s.command.target.azimuth_rad(), ANGLES, GIMBAL_LSB_RAD),
    quantity!("set point, roll", |s, _| s.command.target.roll_rad(), ANGLES, GIMBAL_LSB_RAD),
];
pub(super) static STAMPS: [Quantity; 2] = [
    quantity!(
        "stamp of the sample, less its time",
        |s, v| last(s).map_or(f64::NAN, |e| stamp_error(e.sample.device_time.ns, v)),
        TIMES,
        1e-9
    ),
    quantity!(
        "number of the sample, less that of its step",
        |s, v| last(s).map_or(f64::NAN, |e| e.sample.sequence as f64 - v.number as f64),
        COUNT,
        1.0
    ),
];
pub(super) static STATUS: [Quantity; 1] = [quantity!(
    "status of the sample",
    |s, _| last(s).map_or(f64::NAN, |e| f64::from(e.sample.status.bits())),
    COUNT,
    1.0
)];
pub(super) static REFERENCE: [Quantity; 7] = [
    quantity!("reference velocity, north", |s, _| velocity(s, 0), VELOCITIES, 1e-12),
    quantity!("reference velocity, east", |s, _| velocity(s, 1), VELOCITIES, 1e-12),
    quantity!("reference velocity, down", |s, _| velocity(s, 2), VELOCITIES, 1e-12),
    quantity!("reference position, north", |s, v| position(s, v, 0), LENGTHS, 1e-6),
    quantity!("reference position, east", |s, v| position(s, v, 1), LENGTHS, 1e-6),
    quantity!("reference position, down", |s, v| position(s, v, 2), LENGTHS, 1e-6),
    quantity!(
        "stamp of the reference, less its time",
        |s, v| aiding(s).map_or(f64::NAN, |a| stamp_error(a.device_time.ns, v)),
        TIMES,
        1e-9
    ),
];
pub(super) static ANSWERS: [Quantity; 4] = [
    quantity!(
        "position of the procedure, as the core says",
        |s, _| s.output.map_or(f64::NAN, |o| f64::from(o.stop) + 1.0),
        COUNT,
        1.0
    ),
    quantity!(
        "velocity north, as the core says",
        |s, _| s.output.map_or(f64::NAN, |o| o.navigation.velocity_mps[0]),
        VELOCITIES,
        1e-9
    ),
    quantity!(
        "velocity east, as the core says",
        |s, _| s.output.map_or(f64::NAN, |o| o.navigation.velocity_mps[1]),
        VELOCITIES,
        1e-9
    ),
    quantity!(
        "velocity down, as the core says",
        |s, _| s.output.map_or(f64::NAN, |o| o.navigation.velocity_mps[2]),
        VELOCITIES,
        1e-9
    ),
];
