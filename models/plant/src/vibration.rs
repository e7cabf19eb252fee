//! Sinusoidal vibration of the sensor block against the gimballed body.
//!
//! One rigid motion feeds both triads: the block turns by θ(t) = α sin(Ωt + φ) about a fixed axis
//! and is displaced by r(t) = d sin(Ωt) in b, so that
//! ω' = Exp(−θ) ω + θ̇ and f' = Exp(−θ) (f + r̈ + 2 ω × ṙ + ω̇ × r + ω × (ω × r)).

use crate::config::Vibration;
use crate::disturbed::Motion;
use nalgebra::Vector3;

/// Returns the vibration as a motion, to be added to others.
pub(crate) fn motion(vibration: &Vibration, time_s: f64) -> Motion {
    let cycles = time_s * vibration.frequency_hz;
    let turn = 2.0 * core::f64::consts::PI * (cycles - libm::floor(cycles));
    let omega = 2.0 * core::f64::consts::PI * vibration.frequency_hz;
    let sine = |amplitude: [f64; 3], phase: f64| {
        let (s, c) = libm::sincos(phase);
        [s, omega * c, -omega * omega * s].map(|x| Vector3::from(amplitude) * x)
    };
    Motion {
        displacement: sine(vibration.displacement_m, turn),
        turn: sine(vibration.angle_rad, turn + vibration.phase_rad),
    }
}

/// Rate and specific force in the axes of the sensor block.
#[inline]
pub(crate) fn shaken(
    vibration: &Vibration,
    time_s: f64,
    rate: &Vector3<f64>,
    acceleration: &Vector3<f64>,
    force: &Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let cycles = time_s * vibration.frequency_hz;
    let turn = 2.0 * core::f64::consts::PI * (cycles - libm::floor(cycles));
    let omega = 2.0 * core::f64::consts::PI * vibration.frequency_hz;
    let (s, c) = libm::sincos(turn);
    let (angle_s, angle_c) = libm::sincos(turn + vibration.phase_rad);
    let amplitude = Vector3::from(vibration.angle_rad);
    let displacement = Vector3::from(vibration.displacement_m);

    let angle = amplitude * angle_s;
    let r = displacement * s;
    let r_rate = displacement * (omega * c);
    let r_acc = displacement * (-omega * omega * s);
    let felt = force
        + r_acc
        + rate.cross(&r_rate) * 2.0
        + acceleration.cross(&r)
        + rate.cross(&rate.cross(&r));
    let back = octant_earth::rotation::exp(&-angle);
    (back * rate + amplitude * (omega * angle_c), back * felt)
}
