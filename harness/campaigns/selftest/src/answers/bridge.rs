//! Attitude and velocity through moves on a static base, with every sample and with some missing,
//! compared with the truth.

use super::numbers::Found;
use crate::judge::Known;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_calibration::{Core, CoreConfig};
use octant_plant::Plant;
use octant_sample::{GimbalCommand, Output, Sample};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use std::path::Path;

/// Scenario without errors, on a fast table: 60 °/s and 60 °/s², at 50 Hz.
const SCENARIO: &str = include_str!("../../../../../fixtures/selftest/bridge.toml");

/// Moves: name, destination stop, and the largest attitude error, rad, after a gap of a second in
/// its middle, and after the whole move without a gap. Encoders read to 2^-27 rad, before and after
/// the gap. If both gimbals turn, the first sample after the gap has no predecessor for its coning
/// correction; and two samples leave about this part of a coning that sets in with 60 °/s².
const MOVES: [(&str, u16, f64, f64); 3] =
    [("roll", 1, 3e-8, 1e-9), ("azimuth", 2, 3e-8, 1e-9), ("both gimbals", 3, 1.5e-6, 1.5e-6)];
/// Largest error of the velocity after all moves, m/s: gravity times the attitude's error over a
/// second or two.
const VELOCITY_MPS: f64 = 5e-5;
/// Number of lost samples; `BEFORE` is the number of samples of the move before them.
const LOST: u32 = 50;
const BEFORE: u32 = 40;

pub(super) fn known() -> Vec<Known> {
    let zero = |name: String, tolerance: f64| Known { name, value: 0.0, tolerance };
    let mut all = vec![zero("velocity behind all moves".to_owned(), VELOCITY_MPS)];
    for (name, _, gap, whole) in MOVES {
        all.push(zero(format!("attitude after a gap in a move of {name}"), gap));
        all.push(zero(format!("attitude after a move of {name}"), whole));
    }
    all
}

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    for (name, stop, ..) in MOVES {
        let mut with_gap = Bench::new()?;
        with_gap.move_towards(stop, BEFORE)?;
        with_gap.lose(LOST);
        with_gap.step();
        all.insert(
            format!("attitude after a gap in a move of {name}"),
            with_gap.attitude_error_rad(),
        );
        let mut whole = Bench::new()?;
        whole.move_towards(stop, 1)?;
        while whole.output.moving {
            whole.step();
        }
        all.insert(format!("attitude after a move of {name}"), whole.attitude_error_rad());
        let velocity = Vector3::from(whole.output.navigation.velocity_mps).norm();
        all.insert("velocity behind all moves".to_owned(), velocity);
    }
    Ok(all)
}

/// Core with the table that it turns.
pub(super) struct Bench {
    plant: Plant,
    pub(super) core: Core,
    output: Output,
}

impl Bench {
    fn new() -> Result<Self, String> {
        Self::with(|_| ())
    }

    /// Makes one whose core is configured otherwise.
    pub(super) fn with(change: impl Fn(&mut CoreConfig)) -> Result<Self, String> {
        let scenario = Scenario::parse(SCENARIO, "bridge.toml", Path::new("."), &[])
            .map_err(|why| why.to_string())?;
        let (plant, mut core, _) =
            configurations(&scenario, Method::Primary, 1).map_err(|why| why.to_string())?;
        change(&mut core);
        let plant = Plant::new(&plant).map_err(|why| why.to_string())?;
        let core = Core::new(&core).map_err(|why| why.to_string())?;
        Ok(Self { plant, core, output: Output::default() })
    }

    fn command(&self) -> GimbalCommand {
        self.output.gimbal_command
    }

    pub(super) fn step(&mut self) {
        self.step_with(|_| ());
    }

    /// Makes a step with a sample that is changed on its way to the core.
    pub(super) fn step_with(&mut self, change: impl Fn(&mut Sample)) {
        let mut step = self.plant.step(&self.command());
        change(&mut step.sample);
        self.output = self.core.step(&step.sample, step.aiding.as_ref());
    }

    fn lose(&mut self, samples: u32) {
        for _ in 0..samples {
            self.plant.step(&self.command());
        }
    }

    /// Makes at most this number of samples of the move to a stop.
    fn move_towards(&mut self, stop: u16, samples: u32) -> Result<(), String> {
        let mut moved = 0;
        while moved < samples {
            self.step();
            if self.output.stop > stop {
                return Err(format!("find the move to stop {stop}"));
            }
            moved += u32::from(self.output.stop == stop && self.output.moving);
        }
        Ok(())
    }

    /// Returns the angle between the core's attitude and the true one.
    fn attitude_error_rad(&self) -> f64 {
        attitude(self.output.navigation.q_nb).angle_to(&attitude(self.plant.truth().q_nb))
    }
}

fn attitude([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}
