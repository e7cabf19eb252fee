//! Ready-made sways of a moored ship.

use crate::config::{CaseAttitude, Dockside, MotionTimes, Sinusoid};
use crate::draw::phases;
use octant_earth::units::DEG;

fn one(amplitude: f64, period_s: f64, phase_rad: f64) -> Vec<Sinusoid> {
    vec![Sinusoid { amplitude, period_s, phase_rad }]
}

/// The default dockside sway: roll 3° in 8 s, pitch 1.5° in 6 s, yaw 1° in 10 s; surge, sway and
/// heave 0.2 m in 6, 7 and 8 s. Heading 0, no mooring offset; phases drawn from the seed.
#[must_use]
pub fn dockside_default(seed: u64) -> Dockside {
    let phase = phases(seed, "dockside", 6);
    Dockside {
        mean: CaseAttitude::default(),
        roll: one(3.0 * DEG, 8.0, phase[0]),
        pitch: one(1.5 * DEG, 6.0, phase[1]),
        yaw: one(1.0 * DEG, 10.0, phase[2]),
        surge: one(0.2, 6.0, phase[3]),
        sway: one(0.2, 7.0, phase[4]),
        heave: one(0.2, 8.0, phase[5]),
        mooring_offset_m: [0.0; 3],
        times: MotionTimes::default(),
    }
}

/// Horizontal acceleration of the dynamic condition of ISO 8728, m/s².
const ISO_8728_ACCELERATION_MPS2: f64 = 0.22;

/// The severe case, the dynamic condition of ISO 8728 at its corner: harmonic roll and pitch of 5°
/// with periods of 6 s and 15 s, and a horizontal acceleration of 0.22 m/s² (a sway of 10 s
/// period, 0.557 m). Heading 0, no mooring offset; phases drawn from the seed.
#[must_use]
pub fn dockside_iso_8728(seed: u64) -> Dockside {
    let phase = phases(seed, "iso_8728", 3);
    let period_s = 10.0;
    let omega = 2.0 * core::f64::consts::PI / period_s;
    Dockside {
        mean: CaseAttitude::default(),
        roll: one(5.0 * DEG, 6.0, phase[0]),
        pitch: one(5.0 * DEG, 15.0, phase[1]),
        yaw: Vec::new(),
        surge: Vec::new(),
        sway: one(ISO_8728_ACCELERATION_MPS2 / (omega * omega), period_s, phase[2]),
        heave: Vec::new(),
        mooring_offset_m: [0.0; 3],
        times: MotionTimes::default(),
    }
}
