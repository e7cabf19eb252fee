//! Sums of spectral lines under a window: vibration of the sensor block, sway of the case.

use super::motion::Motion;
use super::smooth::{Jet, over, product, rise};
use super::span::Span;
use nalgebra::Vector3;
use octant_sample::disturbance::SpectralLine;

/// Pieces in a period of the highest line, three nodes each: the relative error of an increment is
/// 2e-10.
const PIECES_IN_PERIOD: f64 = 24.0;

/// One line, advanced from piece to piece by a rotation instead of a sine and cosine.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Tone {
    frequency_hz: f64,
    omega: f64,
    phase_rad: f64,
    displacement: Vector3<f64>,
    /// Components of the turn in phase with the sine and with the cosine of the linear motion.
    turn_sin: Vector3<f64>,
    turn_cos: Vector3<f64>,
    /// Sine and cosine of the phase at the middle of the present piece.
    now: (f64, f64),
    /// Sine and cosine of the phase gained in a piece, and from its middle to its last node.
    piece: (f64, f64),
    node: (f64, f64),
}

fn sum((s, c): (f64, f64), (ds, dc): (f64, f64)) -> (f64, f64) {
    (s * dc + c * ds, c * dc - s * ds)
}

impl Tone {
    fn new(line: &SpectralLine) -> Self {
        let (s, c) = libm::sincos(line.angle_phase_rad - line.phase_rad);
        let turn = Vector3::from(line.angle_rad);
        Self {
            frequency_hz: line.frequency_hz,
            omega: 2.0 * core::f64::consts::PI * line.frequency_hz,
            phase_rad: line.phase_rad,
            displacement: Vector3::from(line.displacement_m),
            turn_sin: turn * c,
            turn_cos: turn * s,
            now: (0.0, 1.0),
            piece: (0.0, 1.0),
            node: (0.0, 1.0),
        }
    }

    fn phase(&self, time_s: f64) -> (f64, f64) {
        let cycles = time_s * self.frequency_hz;
        let turn = 2.0 * core::f64::consts::PI * (cycles - libm::floor(cycles));
        libm::sincos(turn + self.phase_rad)
    }

    /// Sine and cosine of the phase at a node of the present piece: −1, 0, 1.
    fn at_node(&self, node: i8) -> (f64, f64) {
        let (s, c) = self.node;
        match node {
            0 => self.now,
            1 => sum(self.now, (s, c)),
            _ => sum(self.now, (-s, c)),
        }
    }

    fn add_to(&self, motion: &mut Motion, (s, c): (f64, f64)) {
        let omega = self.omega;
        let [r, r_rate, r_acc] = &mut motion.displacement;
        *r += self.displacement * s;
        *r_rate += self.displacement * (omega * c);
        *r_acc -= self.displacement * (omega * omega * s);
        let (along, across) =
            (self.turn_sin * s + self.turn_cos * c, self.turn_sin * c - self.turn_cos * s);
        let [turn, turn_rate, turn_acc] = &mut motion.turn;
        *turn += along;
        *turn_rate += across * omega;
        *turn_acc -= along * (omega * omega);
    }
}

/// Lines under their window.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Shake {
    pub(super) span: Span,
    edge_s: f64,
    tones: Vec<Tone>,
    /// Longest piece that the integration may have, s.
    pub(super) piece_s: f64,
}

impl Shake {
    pub(super) fn new(span: Span, lines: &[SpectralLine], edge_s: f64) -> Self {
        let highest = lines.iter().fold(0.0f64, |high, line| high.max(line.frequency_hz));
        let edge_s = edge_s.max(1e-9);
        Self {
            span,
            edge_s,
            tones: lines.iter().map(Tone::new).collect(),
            piece_s: (1.0 / (PIECES_IN_PERIOD * highest)).min(edge_s / 4.0),
        }
    }

    /// Returns whether the motion has faded.
    pub(super) fn is_over(&self, now_ns: u64) -> bool {
        self.span.since_end_s(now_ns, 0.0).is_some_and(|t| t >= self.edge_s)
    }

    /// Times after the start of the interval at which a derivative jumps.
    pub(super) fn knots(&self, start_ns: u64, cuts: &mut Vec<f64>) {
        let onset = -self.span.since_s(start_ns, 0.0);
        cuts.extend([onset, onset + self.edge_s]);
        if let Some(ended) = self.span.since_end_s(start_ns, 0.0) {
            cuts.extend([-ended, -ended + self.edge_s]);
        }
    }

    fn window(&self, start_ns: u64, at_s: f64) -> Jet {
        let swell = over(rise(self.span.since_s(start_ns, at_s) / self.edge_s), self.edge_s);
        let Some(ended) = self.span.since_end_s(start_ns, at_s) else { return swell };
        let fade = over(rise(ended / self.edge_s), self.edge_s);
        product(swell, [1.0 - fade[0], -fade[1], -fade[2]])
    }

    /// Goes to the first of a row of equal pieces.
    pub(super) fn lay(&mut self, start_ns: u64, middle_s: f64, width_s: f64, node_s: f64) {
        let time_s = self.span.since_s(start_ns, middle_s);
        for tone in &mut self.tones {
            tone.now = tone.phase(time_s);
            tone.piece = libm::sincos(tone.omega * width_s);
            tone.node = libm::sincos(tone.omega * node_s);
        }
    }

    /// Goes to the next piece.
    pub(super) fn advance(&mut self) {
        for tone in &mut self.tones {
            tone.now = sum(tone.now, tone.piece);
        }
    }

    /// Motion at a time `at_s` after `start_ns`; `node`: the node of the present piece at that
    /// time, if it is one.
    pub(super) fn motion(&self, start_ns: u64, at_s: f64, node: Option<i8>) -> Motion {
        let time_s = self.span.since_s(start_ns, at_s);
        let mut raw = Motion::default();
        for tone in &self.tones {
            tone.add_to(&mut raw, node.map_or_else(|| tone.phase(time_s), |n| tone.at_node(n)));
        }
        let window = self.window(start_ns, at_s);
        if window == [1.0, 0.0, 0.0] {
            return raw;
        }
        let under = |[value, rate, acceleration]: [Vector3<f64>; 3]| {
            let [w, w_rate, w_acc] = window;
            [
                value * w,
                value * w_rate + rate * w,
                value * w_acc + rate * (2.0 * w_rate) + acceleration * w,
            ]
        };
        Motion { displacement: under(raw.displacement), turn: under(raw.turn) }
    }
}
