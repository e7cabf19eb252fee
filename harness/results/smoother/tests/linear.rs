//! A linear system with a textbook filter, for tests of the smoother.

use nalgebra::{SMatrix, SVector};
use octant_calibration::covariance::{DV, MOVING, PARAMETERS, STATE_COUNT};
use octant_random::stream::Triad;
use octant_smoother::store::{Measured, Node, Row, Store};
use octant_smoother::{StateVector, States};

/// First of the measured states.
pub(crate) const FIRST: usize = DV;
/// Variance of a measurement.
pub(crate) const VARIANCE: f64 = 0.04;

/// A system of 39 states: nine that move, driven by noise and by constants.
pub(crate) struct Linear {
    /// Standard deviations of the process noise, of the moving states and of the first parameter.
    pub(crate) noise: Row,
    /// Prior standard deviations.
    pub(crate) prior: Row,
}

impl Linear {
    /// Makes one in which every parameter shows in the measured states sooner or later.
    pub(crate) fn new(noise_of_parameter: f64) -> Self {
        let mut noise = [0.0; STATE_COUNT];
        noise[..MOVING].fill(0.1);
        noise[PARAMETERS] = noise_of_parameter;
        Self { noise, prior: [1.0; STATE_COUNT] }
    }

    /// Transition to measurement `k`: the parameters have another effect each time.
    pub(crate) fn transition(&self, k: usize) -> States {
        let mut transition = States::identity();
        for i in 0..MOVING {
            for j in 0..STATE_COUNT {
                // Numbers without a pattern, between −1 and 1.
                let of_time = if j < MOVING { 0 } else { k * 15_485_863 };
                let scatter = ((i * 7919 + j * 104_729 + of_time + 13) % 1009) as f64 / 504.5 - 1.0;
                transition[(i, j)] = if j < MOVING { 0.1 * scatter } else { 0.2 * scatter };
            }
            transition[(i, i)] += 0.8;
        }
        transition
    }

    /// Simulates it from a seed over so many measurements, every `node_every`-th of them a node; `alter` changes the true state before
    /// each transition. Returns the measurements of the filter, and the true state after each.
    pub(crate) fn run(
        &self,
        seed: u64,
        count: usize,
        node_every: usize,
        mut alter: impl FnMut(usize, &mut StateVector),
    ) -> (Store, Vec<StateVector>) {
        let streams: Vec<Triad> =
            (0..14).map(|k| Triad::new(seed, &format!("smoother.{k}"))).collect();
        let normal = |k: usize, step: usize| streams[k / 3].at(step as u64)[k % 3];
        let mut truth = StateVector::from_fn(|i, _| self.prior[i] * normal(i, 0));
        let mut estimate = StateVector::zeros();
        let mut p = States::from_diagonal(&StateVector::from(self.prior).map(|s| s * s));
        let q = States::from_diagonal(&StateVector::from(self.noise).map(|s| s * s));
        let mut store = Store::new().unwrap();
        let mut truths = Vec::new();
        for k in 1..=count {
            alter(k, &mut truth);
            let transition = self.transition(k);
            truth = transition * truth + StateVector::from_fn(|i, _| self.noise[i] * normal(i, k));
            estimate = transition * estimate;
            p = transition * p * transition.transpose() + q;
            let measured = SVector::<f64, 3>::from_fn(|axis, _| {
                truth[FIRST + axis] + VARIANCE.sqrt() * normal(39 + axis, k)
            });
            let innovation = measured - estimate.fixed_rows::<3>(FIRST);
            let s = p.fixed_view::<3, 3>(FIRST, FIRST)
                + SMatrix::<f64, 3, 3>::from_diagonal_element(VARIANCE);
            let gain = p.fixed_columns::<3>(FIRST) * s.try_inverse().unwrap();
            estimate += gain * innovation;
            p -= gain * p.fixed_rows::<3>(FIRST).into_owned();
            p = 0.5 * (p + p.transpose());
            let row = |i: usize| core::array::from_fn(|j| p[(i, j)]);
            let node = k.is_multiple_of(node_every).then(|| {
                Box::new(Node {
                    covariance: core::array::from_fn(row),
                    parameters: core::array::from_fn(|i| estimate[PARAMETERS + i]),
                })
            });
            store
                .push(&Measured {
                    time_s: k as f64,
                    transition: core::array::from_fn(|i| {
                        core::array::from_fn(|j| transition[(i, j)])
                    }),
                    first: FIRST,
                    variance: VARIANCE,
                    innovation: innovation.into(),
                    covariance: core::array::from_fn(|axis| row(FIRST + axis)),
                    node,
                })
                .unwrap();
            // The errors of the estimate are what the smoother finds.
            truths.push(truth - estimate);
        }
        (store, truths)
    }
}
