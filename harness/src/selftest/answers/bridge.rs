//! What stands in for samples that are missing: on a base that stands it has to lead to the true attitude.

use super::Found;
use crate::run::method::configurations;
use crate::scenario::{Method, Scenario};
use crate::selftest::judge::Known;
use nalgebra::{Quaternion, UnitQuaternion};
use octant_calibration::Core;
use octant_plant::Plant;
use octant_sample::GimbalCommand;
use std::path::Path;

/// Without errors, on a fast table: 60 °/s and 60 °/s², at 50 Hz.
const SCENARIO: &str = include_str!("../../../../fixtures/selftest/bridge.toml");

/// A second without samples in the middle of each of these moves: its name, the stop that it leads to, and the largest error,
/// rad. Encoders read to 2^-27 rad, before the gap and behind it. Where both gimbals turn, the first sample behind the
/// gap has no sample before it by which its coning could be corrected.
const MOVES: [(&str, u16, f64); 3] =
    [("roll", 1, 3e-8), ("azimuth", 2, 3e-8), ("both gimbals", 3, 1.5e-6)];
/// Samples that are lost, and those of the move before them.
const LOST: u32 = 50;
const BEFORE: u32 = 40;

pub(super) fn known() -> Vec<Known> {
    let known = |(name, _, tolerance): &(&str, u16, f64)| Known {
        name: format!("attitude after a gap in a move of {name}"),
        value: 0.0,
        tolerance: *tolerance,
    };
    MOVES.iter().map(known).collect()
}

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    for (name, stop, _) in MOVES {
        all.insert(format!("attitude after a gap in a move of {name}"), error_after_gap(stop)?);
    }
    Ok(all)
}

/// Angle between the core's attitude and the true one after the gap, rad.
fn error_after_gap(stop: u16) -> Result<f64, String> {
    let scenario = Scenario::parse(SCENARIO, "bridge.toml", Path::new("."), &[])
        .map_err(|why| why.to_string())?;
    let (plant, core, _) =
        configurations(&scenario, Method::Primary, 1).map_err(|why| why.to_string())?;
    let mut plant = Plant::new(&plant).map_err(|why| why.to_string())?;
    let mut core = Core::new(&core).map_err(|why| why.to_string())?;
    let mut command = GimbalCommand::default();
    let mut moved = 0;
    loop {
        let step = plant.step(&command);
        let lost = moved >= BEFORE && moved < BEFORE + LOST;
        if lost {
            moved += 1;
            continue;
        }
        let output = core.step(&step.sample, step.aiding.as_ref());
        command = output.gimbal_command;
        if output.stop == stop && output.moving {
            moved += 1;
        }
        if moved > BEFORE + LOST {
            let ours = output.navigation.q_nb;
            return Ok(attitude(ours).angle_to(&attitude(plant.truth().q_nb)));
        }
        if output.stop > stop {
            return Err(format!("lose samples before stop {stop}: it has been passed"));
        }
    }
}

fn attitude([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}
