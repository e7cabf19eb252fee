//! Errors that faults on the way add to samples and references.

use super::faults::{Named, setup, size, spec};
use super::numbers::Found;
use super::plant::{perfect, site};
use octant_faults::catalogue::Dimension;
use octant_faults::station::{Delivered, World};
use octant_faults::{Channels, Station, Value};
use octant_plant::config::{CaseAttitude, Motion};
use octant_sample::{Aiding, DeviceTime, Epoch, GimbalCommand, Output, Reference, Sample};

/// World without a plant.
struct Nowhere;

impl World for Nowhere {
    fn disturbed(&mut self) -> Option<&mut dyn octant_sample::disturbance::Disturbed> {
        None
    }
    fn truth(&self) -> Option<octant_sample::Truth> {
        None
    }
}

/// Latitude and longitude, rad, and height, m, of the disturbed references.
const AT: [f64; 3] = [0.5, 0.2, 100.0];

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    let walk = vec![
        ("channels", Value::Channels(Channels::GYRO)),
        size("coefficient", 1e-2, Dimension::RateRandomWalk),
    ];
    pass("rate-random-walk", walk, |name, n, of| {
        if let (300 | 500, "added") = (n, name) {
            tell(&mut all, "rate-random-walk", n, [of[0], of[1], of[2]]);
        }
    })?;
    let markov = vec![
        ("channels", Value::Channels(Channels::ACCELEROMETER)),
        size("sigma", 0.01, Dimension::Acceleration),
        size("correlation_time", 3.0, Dimension::Time),
        ("start", Value::Choice("drawn")),
    ];
    pass("gauss-markov", markov, |name, n, of| {
        if let (300 | 500, "added") = (n, name) {
            tell(&mut all, "gauss-markov", n, [of[3], of[4], of[5]]);
        }
    })?;
    losses(&mut all)?;
    pass("aiding-noise", vec![size("sigma", 0.3, Dimension::Velocity)], |name, n, of| {
        if name == "velocity" {
            tell(&mut all, "aiding-noise velocity", n, [of[0], of[1], of[2]]);
        }
    })?;
    pass("aiding-noise", vec![size("sigma", 5e4, Dimension::Length)], |name, n, of| {
        if name == "position" {
            let off = [of[0] - AT[0], of[1] - AT[1], of[2] - AT[2]];
            tell(&mut all, "aiding-noise position", n, off);
        }
    })?;
    Ok(all)
}

fn tell(all: &mut Found, name: &str, n: u64, of: [f64; 3]) {
    for (axis, value) in ["x", "y", "z"].into_iter().zip(of) {
        all.insert(format!("{name} {axis}, {n}"), value);
    }
}

/// Counts samples that don't arrive.
fn losses(all: &mut Found) -> Result<(), String> {
    let values = vec![size("loss", 0.3, Dimension::Ratio), ("aiding", Value::Choice("lost"))];
    let (_, mut station) = station("dropout", values)?;
    let (mut lost, mut sum) = (0u32, 0u64);
    for n in 1..=500u64 {
        let sample = Sample { sequence: n, ..Sample::default() };
        let output = Output::default();
        station.before(&mut GimbalCommand::default(), &output, &mut Nowhere);
        if let Delivered::These([]) =
            station.after(&Epoch { sample, aiding: None }, &output, &mut Nowhere).delivered
        {
            (lost, sum) = (lost + 1, sum + n);
        }
        station.told();
    }
    all.insert("dropout, samples lost".to_owned(), f64::from(lost));
    all.insert("dropout, sum of their numbers".to_owned(), sum as f64);
    Ok(())
}

/// Creates a station with one fault, which acts on 400 samples from 101 on; also returns the period
/// of its samples, ns.
fn station(name: &'static str, values: Vec<Named>) -> Result<(u64, Station), String> {
    let config = perfect(1, site(0.0, 0.0, 0.0), Motion::Static(CaseAttitude::default()));
    let spec = spec(name, values, 101, 400)?;
    let station = Station::new(&[spec], &setup(&config))
        .map_err(|(_, error)| format!("set up the fault {name}: {error}"))?;
    Ok((config.sample_period_ns, station))
}

/// Passes samples of zeros through a fault, with a reference at samples 200 and 400; `hear` gets
/// the sum added to the six channels so far, and the references.
fn pass(
    name: &'static str,
    values: Vec<Named>,
    mut hear: impl FnMut(&str, u64, [f64; 6]),
) -> Result<(), String> {
    let (period_ns, mut station) = station(name, values)?;
    let output = Output::default();
    let mut added = [0.0; 6];
    let [latitude_rad, longitude_rad, height_m] = AT;
    for n in 1..=500u64 {
        let device_time = DeviceTime::from_ns(n * period_ns);
        let reference = match name == "aiding-noise" && n % 200 == 0 {
            true => Some([
                Reference::Velocity([0.0; 3]),
                Reference::Position { latitude_rad, longitude_rad, height_m },
            ]),
            false => None,
        };
        // Each kind of reference passes through its own copy of the station.
        for reference in reference.map_or(vec![None], |both| both.map(Some).to_vec()) {
            let mut through = station.clone();
            let station = if matches!(reference, Some(Reference::Velocity(_))) {
                &mut through
            } else {
                &mut station
            };
            station.before(&mut GimbalCommand::default(), &output, &mut Nowhere);
            let sample = Sample { sequence: n, device_time, ..Sample::default() };
            let aiding = reference.map(|reference| Aiding { device_time, reference });
            if let Delivered::These(epochs) =
                station.after(&Epoch { sample, aiding }, &output, &mut Nowhere).delivered
            {
                for epoch in epochs {
                    for axis in 0..3 {
                        added[axis] += f64::from(epoch.sample.delta_theta[axis]);
                        added[3 + axis] += f64::from(epoch.sample.delta_velocity[axis]);
                    }
                    match epoch.aiding.map(|aiding| aiding.reference) {
                        Some(Reference::Velocity([x, y, z])) => {
                            hear("velocity", n, [x, y, z, 0.0, 0.0, 0.0]);
                        }
                        Some(Reference::Position { latitude_rad, longitude_rad, height_m }) => {
                            let of = [latitude_rad, longitude_rad, height_m, 0.0, 0.0, 0.0];
                            hear("position", n, of);
                        }
                        None => {}
                    }
                }
            }
            station.told();
        }
        hear("added", n, added);
    }
    Ok(())
}
