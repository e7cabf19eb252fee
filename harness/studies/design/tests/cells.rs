//! Cells of the reference table: instruments, durations, and what an independent covariance analysis says
//! of them.

use octant_design::setup::{Rotation, Setup};
use octant_scenario::Scenario;
use std::path::Path;

/// A cell: an instrument, a duration, and the rms of the longitude error in hours 69 to 72, arcmin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    /// 1σ of G, °/h/g.
    pub(crate) g: f64,
    /// Angle random walk, °/√h.
    pub(crate) arw: f64,
    /// Duration of the calibration, h.
    pub(crate) hours: u32,
    /// Eight positions, and those with the tilts (45, 45) and (45, -45).
    pub(crate) eight: f64,
    pub(crate) level: f64,
    /// Best sequence that a search found.
    pub(crate) best: f64,
    /// Bound.
    pub(crate) bound: f64,
}

const fn cell(g: f64, arw: f64, hours: u32, [eight, level, best, bound]: [f64; 4]) -> Cell {
    Cell { g, arw, hours, eight, level, best, bound }
}

/// 36-state covariance analysis by another program: 30.5° N, at rest, sixteen moves in navigation.
pub(crate) const CELLS: [Cell; 6] = [
    cell(5e-3, 7e-4, 4, [5.03, 3.82, 2.91, 2.90]),
    cell(2e-3, 7e-4, 4, [3.29, 2.89, 2.06, 2.05]),
    cell(2e-3, 7e-4, 12, [1.72, 1.59, 0.886, 0.884]),
    cell(5e-4, 7e-4, 4, [1.17, 1.15, 1.00, 0.80]),
    cell(5e-4, 7e-4, 12, [1.05, 1.00, 0.738, 0.703]),
    cell(5e-3, 1e-4, 4, [2.95, 1.75, 0.658, 0.639]),
];

impl Cell {
    pub(crate) fn scenario(&self, more: &str) -> Scenario {
        let Self { g, arw, hours, .. } = self;
        let text = format!(
            "schema = 1\ntitle = \"cell\"\n[site]\nlatitude = \"30.5 deg\"\n[imu]\n\
             g_dependent = {{ normal = \"{g} deg/h/g\" }}\n\
             angle_random_walk = \"{arw} deg/sqrt(h)\"\n[procedure.calibration]\n\
             duration = \"{hours} h\"\n[procedure.navigation]\nduration = \"72 h\"\n{more}"
        );
        Scenario::parse(&text, "cell.toml", Path::new(""), &[]).unwrap()
    }

    pub(crate) fn setup(&self, rotation: Rotation) -> Setup {
        Setup::of(&self.scenario("")).unwrap().with_rotation(rotation)
    }

    pub(crate) fn duration_s(&self) -> f64 {
        f64::from(self.hours) * 3600.0
    }
}
