//! Motions of a gimbal's body against its drive: slip and ringing.

use super::smooth::{over, product, rise};
use super::span::seconds_between;
use crate::gimbal::AxisState;

fn axis([angle, rate, acceleration]: [f64; 3]) -> AxisState {
    AxisState { angle, rate, acceleration }
}

/// Slip: the body turns against its drive and stays there.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Slip {
    pub(super) handle: u32,
    pub(super) gimbal: usize,
    pub(super) from_ns: u64,
    pub(super) angle_rad: f64,
    pub(super) within_s: f64,
    pub(super) seen: bool,
}

impl Slip {
    pub(super) fn is_over(&self, now_ns: u64) -> bool {
        seconds_between(self.from_ns, now_ns) >= self.within_s
    }

    pub(super) fn piece_s(&self) -> f64 {
        self.within_s / 32.0
    }

    pub(super) fn knots(&self, start_ns: u64, cuts: &mut Vec<f64>) {
        let onset = -seconds_between(self.from_ns, start_ns);
        cuts.extend([onset, onset + self.within_s]);
    }

    pub(super) fn state(&self, start_ns: u64, at_s: f64) -> AxisState {
        let t = seconds_between(self.from_ns, start_ns) + at_s;
        axis(over(rise(t / self.within_s), self.within_s).map(|x| self.angle_rad * x))
    }
}

/// Decay times after which a ring is dropped: less than 1e-13 of it is left.
const DECAYS: f64 = 30.0;

/// Ringing of the body about the target after a move.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Ring {
    pub(super) handle: u32,
    pub(super) gimbal: usize,
    /// Start of the move, and its duration.
    pub(super) from_ns: u64,
    pub(super) delay_s: f64,
    pub(super) amplitude_rad: f64,
    pub(super) frequency_hz: f64,
    pub(super) decay_s: f64,
}

impl Ring {
    fn since_s(&self, start_ns: u64, at_s: f64) -> f64 {
        seconds_between(self.from_ns, start_ns) + at_s - self.delay_s
    }

    /// Returns whether the move has not ended yet.
    pub(super) fn is_pending(&self, now_ns: u64) -> bool {
        self.since_s(now_ns, 0.0) < 0.0
    }

    pub(super) fn is_over(&self, now_ns: u64) -> bool {
        self.since_s(now_ns, 0.0) >= DECAYS * self.decay_s
    }

    fn edge_s(&self) -> f64 {
        0.25 / self.frequency_hz
    }

    pub(super) fn piece_s(&self) -> f64 {
        (self.edge_s() / 8.0).min(self.decay_s / 8.0)
    }

    pub(super) fn knots(&self, start_ns: u64, cuts: &mut Vec<f64>) {
        let onset = -self.since_s(start_ns, 0.0);
        cuts.extend([onset, onset + self.edge_s(), onset + DECAYS * self.decay_s]);
    }

    pub(super) fn state(&self, start_ns: u64, at_s: f64) -> AxisState {
        let t = self.since_s(start_ns, at_s);
        if t <= 0.0 || t >= DECAYS * self.decay_s {
            return AxisState::default();
        }
        let omega = 2.0 * core::f64::consts::PI * self.frequency_hz;
        let (s, c) = libm::sincos(omega * t);
        let decay = libm::exp(-t / self.decay_s);
        let falling = [decay, -decay / self.decay_s, decay / (self.decay_s * self.decay_s)];
        let ringing = product([s, omega * c, -omega * omega * s], falling);
        let edge_s = self.edge_s();
        let swelling = over(rise(t / edge_s), edge_s);
        axis(product(ringing, swelling).map(|x| self.amplitude_rad * x))
    }
}
