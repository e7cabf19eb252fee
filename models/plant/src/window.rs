//! Many samples of a ship's motion at once.
//!
//! A ship moves slowly against the sample period of its instrument. Rate and specific force of the
//! case are computed at a few nodes of a window and interpolated between them (Lagrange on
//! Chebyshev's nodes): in a window in which no sinusoid's phase moves further than ±0.17 rad, ten
//! nodes leave an error of 0.17¹⁰/(10!·2⁹) = 1e-17 of a sinusoid, 1e-14 of its second harmonic and
//! 6e-13 of its third (Trefethen, 2013, Approximation Theory and Approximation Practice, ch. 8):
//! less than the rounding of a sample.
//!
//! The content of a window depends on its number alone, so that a plant that enters it with a
//! restored state finds the same bits.

use crate::interpolation::{self, NODES, Weights};
use crate::kinematics::SixDof;
use crate::sway::Sway;
use nalgebra::Vector3;

/// Largest phase that the fastest sinusoid gains in half a window, rad.
const REACH_RAD: f64 = 0.17;
/// Most samples of a window, so that their weights stay in the cache.
const SAMPLES_MAX: f64 = 64.0;

/// Angular rate and specific force, side by side.
type Six = [f64; 6];

/// Frame at rest against the case: sine and cosine of the gimbal angles.
pub(crate) type Frame = [(f64, f64); 2];

#[derive(Clone, Debug)]
pub(crate) struct Window {
    period_ns: u64,
    length_ns: u64,
    samples: u64,
    /// Sway, evaluated once for each window.
    sway: Sway,
    /// Weights of a sample's regular nodes, by sample and node.
    at_node: Vec<Weights>,
    /// Weights of the integral, by sample.
    integral: Vec<Weights>,
    /// Number of the window that is held.
    number: u64,
    values: [Six; NODES],
    /// Values turned into a frame, and that frame: turned once for all samples of the window.
    turned: [Six; NODES],
    turned_into: Option<Frame>,
    /// Index of the present interval, and start of the next one.
    sample: usize,
    next_ns: u64,
}

impl Window {
    /// Makes a window for samples with these regular nodes (s from the start of their interval, and
    /// weight); `None` if it would cost more work than it saves.
    pub(crate) fn new(sway: &Sway, period_ns: u64, nodes: &[(f64, f64)]) -> Option<Self> {
        // Where a motion begins or ends it has a third derivative that jumps, which nodes don't see.
        if !sway.is_steady() {
            return None;
        }
        let period_s = period_ns as f64 * 1e-9;
        let fastest_radps = sway.fastest_radps();
        let samples = (2.0 * REACH_RAD / (fastest_radps * period_s)).min(SAMPLES_MAX) as u64;
        if samples as usize * nodes.len() < 2 * NODES {
            return None;
        }
        let length_s = samples as f64 * period_s;
        let chebyshev = interpolation::nodes();
        let weights_at =
            |time_s: f64| interpolation::weights(&chebyshev, 2.0 * time_s / length_s - 1.0);
        let mut at_node = Vec::new();
        let mut integral = Vec::new();
        for sample in 0..samples {
            let start_s = sample as f64 * period_s;
            let mut sum = [0.0; NODES];
            for (at, weight) in nodes {
                let weights = weights_at(start_s + at);
                for (sum, w) in sum.iter_mut().zip(&weights) {
                    *sum += weight * w;
                }
                at_node.push(weights);
            }
            integral.push(sum);
        }
        let nodes_s = chebyshev.map(|x| 0.5 * (x + 1.0) * length_s);
        Some(Self {
            period_ns,
            length_ns: samples * period_ns,
            samples,
            sway: sway.with_nodes(length_s, &nodes_s),
            at_node,
            integral,
            number: u64::MAX,
            values: [[0.0; 6]; NODES],
            turned: [[0.0; 6]; NODES],
            turned_into: None,
            sample: 0,
            next_ns: u64::MAX,
        })
    }

    /// Goes to the interval that starts at `start_ns`. `feel` computes rate and specific force for
    /// a state of the sway.
    #[inline]
    pub(crate) fn enter(
        &mut self,
        start_ns: u64,
        feel: impl Fn(&SixDof) -> (Vector3<f64>, Vector3<f64>),
    ) {
        self.sample += 1;
        if start_ns != self.next_ns || self.sample as u64 == self.samples {
            self.go_to(start_ns, feel);
        }
        self.next_ns = start_ns.wrapping_add(self.period_ns);
    }

    #[inline(never)]
    fn go_to(&mut self, start_ns: u64, feel: impl Fn(&SixDof) -> (Vector3<f64>, Vector3<f64>)) {
        let number = start_ns / self.length_ns;
        self.sample = (start_ns % self.length_ns / self.period_ns) as usize;
        if number == self.number {
            return;
        }
        self.number = number;
        self.turned_into = None;
        self.sway.enter_anew((number * self.length_ns) as f64 * 1e-9);
        for (node, values) in self.values.iter_mut().enumerate() {
            let (rate, force) = feel(&self.sway.at_node(node));
            *values = [rate.x, rate.y, rate.z, force.x, force.y, force.z];
        }
    }

    /// Rate and specific force at a regular node of the interval.
    #[inline]
    pub(crate) fn at_node(&self, node: usize) -> (Vector3<f64>, Vector3<f64>) {
        let nodes = self.at_node.len() / self.integral.len();
        sum(&self.values, &self.at_node[self.sample * nodes + node])
    }

    /// Integrals of both over the interval, in the frame into which `turn` takes them.
    #[inline]
    pub(crate) fn integral_in(
        &mut self,
        frame: Frame,
        turn: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        if self.turned_into != Some(frame) {
            self.turned_into = Some(frame);
            for (turned, [a, b, c, d, e, f]) in self.turned.iter_mut().zip(self.values) {
                let (rate, force) = (turn(&Vector3::new(a, b, c)), turn(&Vector3::new(d, e, f)));
                *turned = [rate.x, rate.y, rate.z, force.x, force.y, force.z];
            }
        }
        sum(&self.turned, &self.integral[self.sample])
    }
}

#[inline(always)]
fn sum(values: &[Six; NODES], weights: &Weights) -> (Vector3<f64>, Vector3<f64>) {
    let mut sum = [0.0; 6];
    for (values, weight) in values.iter().zip(weights) {
        for (sum, value) in sum.iter_mut().zip(values) {
            *sum += weight * value;
        }
    }
    let [a, b, c, d, e, f] = sum;
    (Vector3::new(a, b, c), Vector3::new(d, e, f))
}
