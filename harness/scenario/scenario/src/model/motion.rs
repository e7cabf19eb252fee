//! Motion of the case.

use octant_earth::{UnitQuaternion, frames};
use octant_plant::config as plant;

/// The six motions of a ship, in the order of [`Dockside::components`].
pub(crate) const MOTIONS: [&str; 6] = ["roll", "pitch", "yaw", "surge", "sway", "heave"];

/// Motion of the case; phases that aren't given are drawn.
#[allow(clippy::large_enum_variant, reason = "one of it in a scenario")]
#[derive(Clone, Debug, PartialEq)]
pub enum MotionSpec {
    /// No motion relative to the ground.
    Static(plant::CaseAttitude),
    /// Motion of a moored ship.
    Dockside(DocksideSpec),
}

impl MotionSpec {
    /// Mean heading of the case, rad.
    #[must_use]
    pub fn heading_rad(&self) -> f64 {
        match self {
            Self::Static(mean) => mean.heading_rad,
            Self::Dockside(ship) => ship.mean.heading_rad,
        }
    }
}

/// Components of a moored ship's motion.
#[derive(Clone, Debug, PartialEq)]
pub struct DocksideSpec {
    /// Mean attitude.
    pub mean: plant::CaseAttitude,
    /// Roll, pitch, yaw (rad), surge, sway, heave (m).
    pub components: [Vec<MotionComponent>; 6],
    /// Sinusoids of a spectrum, drawn, in addition.
    pub spectrum: Option<ShipSpectrum>,
    /// Offset from the dock's reference, north, east, down, m.
    pub mooring_offset_m: [f64; 3],
    /// Part of each run-up in which it moves; `None`: always.
    pub span: Option<MotionSpan>,
}

/// Part of a run-up in which the case moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSpan {
    /// Time since switching on at which the motion begins to grow, s.
    pub from_s: f64,
    /// Time at full amplitude, s; `None`: to the end.
    pub duration_s: Option<f64>,
    /// Time over which the motion grows, and after its time dies away, s.
    pub ramp_s: f64,
}

impl MotionSpan {
    /// Beginning and end of the motion, s since switching on; `None` as the end: it goes on.
    #[must_use]
    pub fn from_to_s(&self) -> (f64, Option<f64>) {
        (self.from_s, self.duration_s.map(|full_s| self.from_s + full_s + 2.0 * self.ramp_s))
    }
}

/// One sinusoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionComponent {
    /// Amplitude, rad or m.
    pub amplitude: f64,
    /// Period, s.
    pub period_s: f64,
    /// Phase at time 0, rad; `None`: drawn.
    pub phase_rad: Option<f64>,
}

/// Motions with the shape of a wave spectrum, see [`octant_plant::sea`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShipSpectrum {
    /// Period of the peak, s.
    pub peak_period_s: f64,
    /// Standard deviation of roll, pitch, yaw (rad), surge, sway, heave (m); 0: no contribution.
    pub sigma: [f64; 6],
    /// Number of sinusoids of each motion.
    pub components: usize,
}

/// Attitude of the case, `q_nc`.
pub(crate) fn case_attitude(mean: &plant::CaseAttitude) -> UnitQuaternion<f64> {
    frames::quaternion_from_matrix(&frames::c_nc(mean.heading_rad, mean.pitch_rad, mean.roll_rad))
}
