//! Free navigation after a calibration, as weights of the errors at its start.
//!
//! Errors in navigation are linear in those at its start, and the rotation doesn't depend on the
//! calibration. So the variance of each position error is `wᵀ P w + noise` with the covariance P at the
//! start, and the mean over a window is a quadratic form, computed once for a rotation.

use super::platform::{KNOWN_AT_START, NAVIGATING_S, Platform, hold_vertical};
use octant_calibration::config::{ErrorModel, NavigationPlan};
use octant_calibration::covariance::{
    Covariance, CovarianceRow, DR, MOVING, STATE_COUNT, Transition,
};
use octant_calibration::schedule::move_between_s;
use octant_calibration::sequence::Stop;

/// Longest step in which height and vertical velocity are held, s.
const STEP_S: f64 = 10.0;
/// Longest time between two points of the drift, s.
const BLOCK_S: f64 = 100.0;
/// Window of the drift at the end of navigation, s.
pub const LAST_S: f64 = 3.0 * 3600.0;

/// A quadratic form of the errors at the start, and what the noise of navigation adds.
#[derive(Clone, Debug)]
pub struct Quadratic {
    weight: Box<[CovarianceRow; STATE_COUNT]>,
    /// Part of the noise.
    pub constant: f64,
}

impl Quadratic {
    /// Creates the form that is zero.
    #[must_use]
    pub fn zero() -> Self {
        Self { weight: Box::new([ZEROS; STATE_COUNT]), constant: 0.0 }
    }

    /// Creates the form whose value is the variance of one state.
    #[must_use]
    pub fn of_state(state: usize) -> Self {
        let mut form = Self::zero();
        form.weight[state][state] = 1.0;
        form
    }

    /// Weight of the product of two errors.
    #[must_use]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.weight[i][j]
    }

    /// Adds the square of the error with these weights of the errors at the start, and its noise.
    pub(crate) fn add(&mut self, weights: &CovarianceRow, noise: f64, factor: f64) {
        for (row, left) in self.weight.iter_mut().zip(weights) {
            let scaled = factor * left;
            for (out, right) in row.iter_mut().zip(weights) {
                *out += scaled * right;
            }
        }
        self.constant += factor * noise;
    }

    /// Returns the sum with another form, which counts `factor` times.
    #[must_use]
    pub fn plus(mut self, other: &Self, factor: f64) -> Self {
        for (row, more) in self.weight.iter_mut().zip(other.weight.iter()) {
            for (out, more) in row.iter_mut().zip(more) {
                *out += factor * more;
            }
        }
        self.constant += factor * other.constant;
        self
    }

    /// Returns the same form times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self::zero().plus(&self, factor)
    }

    /// Returns its value for a covariance at the start.
    #[must_use]
    pub fn of(&self, covariance: &Covariance) -> f64 {
        let rows = self.weight.iter().zip(covariance.rows());
        let products = |(w, p): (&CovarianceRow, &CovarianceRow)| -> f64 {
            let mut sums = [0.0; 4];
            for (w, p) in w.chunks_exact(4).zip(p.chunks_exact(4)) {
                for lane in 0..4 {
                    sums[lane] += w[lane] * p[lane];
                }
            }
            (sums[0] + sums[1]) + (sums[2] + sums[3])
        };
        rows.map(products).sum::<f64>() + self.constant
    }
}

const ZEROS: CovarianceRow = [0.0; 40];

/// Mean squares of the position errors of a navigation, m²: north and east.
#[derive(Clone, Debug)]
pub struct Drift {
    /// First stop of the rotation, where the weights start.
    pub first: Stop,
    /// Over the last three hours, or all of a shorter navigation.
    pub last: [Quadratic; 2],
    /// Over all of it.
    pub whole: [Quadratic; 2],
    /// At the end.
    pub end: [Quadratic; 2],
    /// Duration, s.
    pub duration_s: f64,
}

/// A part of the rotation: its transition, the noise that comes in, and its length, s.
pub(crate) struct Block {
    pub(crate) transition: Transition,
    pub(crate) noise: Covariance,
    pub(crate) length_s: f64,
}

impl Block {
    fn standing(platform: &Platform, at: &Stop, length_s: f64) -> Self {
        let steps = libm::ceil(length_s / STEP_S - 1e-9).max(1.0);
        let h = length_s / steps;
        let mut step = platform.standing(at, h, NAVIGATING_S, ErrorModel::Phi);
        hold_vertical(&mut step);
        Self::repeated(platform, &step, h, steps as u32)
    }

    fn repeated(platform: &Platform, step: &Transition, h: f64, times: u32) -> Self {
        let mut transition = Transition::identity();
        let mut noise = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
        for _ in 0..times {
            transition = after(&transition, step);
            platform.carry(&mut noise, step, h);
            KNOWN_AT_START[2..].iter().for_each(|state| noise.reopen(*state, 0.0));
        }
        Self { transition, noise, length_s: f64::from(times) * h }
    }

    /// Carries the covariance of the noise through the part.
    pub(crate) fn come_into(&self, noise: &mut Covariance) {
        noise.propagate(&self.transition);
        for i in 0..MOVING {
            for j in i..MOVING {
                noise.add(i, j, self.noise.at(i, j));
            }
        }
    }

    fn moving(platform: &Platform, from: &Stop, to: &Stop) -> Vec<Self> {
        let (parts, h) = platform.moving(from, to, STEP_S, ErrorModel::Phi);
        let held = parts.into_iter().map(|mut part| {
            hold_vertical(&mut part);
            Self::repeated(platform, &part, h, 1)
        });
        held.collect()
    }
}

/// Returns the transition of `first` and `next` after it.
pub(crate) fn after(first: &Transition, next: &Transition) -> Transition {
    let mut rows = next.rows;
    for (row, step) in rows.iter_mut().zip(&next.rows) {
        row[..MOVING].fill(0.0);
        for (before, factor) in first.rows.iter().zip(step) {
            for (out, value) in row.iter_mut().zip(before) {
                *out += factor * value;
            }
        }
    }
    Transition { rows }
}

/// Makes the parts of one round of a rotation.
pub(crate) fn round(platform: &Platform, plan: &NavigationPlan) -> Vec<Block> {
    let stops = plan.rotation.stops();
    let mut blocks = Vec::new();
    for (index, stop) in stops.iter().enumerate() {
        let dwell_s = plan.dwell_s * stop.weight;
        let count = libm::ceil(dwell_s / BLOCK_S - 1e-9).max(1.0);
        for _ in 0..count as u32 {
            blocks.push(Block::standing(platform, stop, dwell_s / count));
        }
        let next = &stops[(index + 1) % stops.len()];
        if move_between_s(stop, next, &platform.rates) > 1e-6 {
            blocks.extend(Block::moving(platform, stop, next));
        }
    }
    blocks
}

/// Computes the weights of a navigation of `duration_s`.
#[must_use]
pub fn drift(platform: &Platform, plan: &NavigationPlan, duration_s: f64) -> Drift {
    let blocks = round(platform, plan);
    let (mut last, mut whole, mut end) = (Mean::new(), Mean::new(), Mean::new());
    let mut weights = Transition::identity();
    let mut noise = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
    let last_from_s = (duration_s - LAST_S).max(0.0);
    let mut t = 0.0;
    for block in blocks.iter().cycle() {
        t += block.length_s;
        if t > duration_s + 1e-6 && whole.length_s > 0.0 {
            break;
        }
        weights = after(&weights, &block.transition);
        block.come_into(&mut noise);
        whole.add(&weights, &noise, block.length_s);
        if t > last_from_s {
            last.add(&weights, &noise, block.length_s);
        }
    }
    end.add(&weights, &noise, 1.0);
    Drift {
        first: plan.rotation.stops()[0],
        last: last.forms(),
        whole: whole.forms(),
        end: end.forms(),
        duration_s,
    }
}

/// Mean of the squares of both position errors over time.
struct Mean {
    forms: [Quadratic; 2],
    length_s: f64,
}

impl Mean {
    fn new() -> Self {
        Self { forms: [Quadratic::zero(), Quadratic::zero()], length_s: 0.0 }
    }

    fn add(&mut self, weights: &Transition, noise: &Covariance, length_s: f64) {
        for (axis, form) in self.forms.iter_mut().enumerate() {
            let state = DR + axis;
            form.add(&weights.rows[state], noise.at(state, state), length_s);
        }
        self.length_s += length_s;
    }

    fn forms(self) -> [Quadratic; 2] {
        self.forms.map(|form| form.times(1.0 / self.length_s))
    }
}
