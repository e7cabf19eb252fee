//! States of a ship's sway beside those of the filter, with their correlation to the error states.
//!
//! The position of the dock differs from the instrument's by the sway s: the error of a measurement
//! is `δr + s`. The sway drives no other state, so it stands beside the
//! covariance of the error states as a border.
//!
//! Surge, sway and heave each have a period and a size of their own, estimated along the axes of the
//! ship: three modes. The direction of a horizontal mode says nothing to the filter: each has the
//! same variance along every horizontal axis, with states in north and east. A mode that is narrow
//! across its axis would measure the heading against that axis, which is known from the first
//! azimuth alone, and in an oblique sea, where surge and sway correlate, isn't the ship's.

use super::oscillator::{OfPair, Oscillator, Recursion};
use crate::covariance::{Covariance, CovarianceRow, DR, MOVING, STATE_COUNT, Transition};
#[cfg(feature = "state")]
use crate::covariance::{load_rows, save_rows};
use nalgebra::{Matrix3, Vector3};

/// States of the sway, displacement and velocity of each, m and m/s: surge north and east, sway north
/// and east, heave down.
const SWAY: usize = 10;
/// Mode and axis of n of each displacement.
const PLACES: [(usize, usize); SWAY / 2] = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 2)];
/// Measurements over which the mean heading is taken.
const HEADING_COUNT: u32 = 32;
/// Velocities of the first estimate; each later one takes twice as many, from new ones.
const FIRST_COUNT: u32 = 64;
/// Spacing of the velocities of the estimate, s, at least.
const SPACING_S: f64 = 1.0;
/// Change of the damping's logarithm by one measurement, for each unit by which its squared
/// innovation differs from its variance. With 0.05 the damping follows within a minute and
/// scatters by a third; in the first 150 measurements after the first estimate it is larger, since
/// a minute of velocities tells the damping within orders of magnitude only.
const LEARNING: f64 = 0.05;
const FIRST_LEARNING: (f64, f64) = (10.0, 50.0);
/// Largest squared normalized innovation that the damping learns from, and the mean of a χ² of one
/// degree of freedom that is cut off there.
const LEARNED_MAX: f64 = 9.0;
const LEARNED_MEAN: f64 = 0.995;

/// Covariance of each state of the sway with the error states.
#[derive(Clone, Debug)]
struct Border([CovarianceRow; SWAY]);

#[cfg(feature = "state")]
impl octant_state::State for Border {
    fn save(&self, to: &mut octant_state::Writer) {
        save_rows(&self.0, to);
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        load_rows(&mut self.0, from)
    }
}

/// Sway of the base.
#[derive(Clone, Debug)]
pub(super) struct SwayStates {
    period_s: f64,
    /// Modes: surge, sway and heave.
    modes: [Oscillator; 3],
    state: [f64; SWAY],
    own: [[f64; SWAY]; SWAY],
    cross: Border,
    /// Cosine and sine of the heading of the surge axis.
    heading: (f64, f64),
    heading_sum: (f64, f64),
    headings: u32,
    /// Measurements from one velocity of the estimate to the next, and those since the last.
    stride: u32,
    since: u32,
    wanted: u32,
    /// Measurements since the first estimate.
    estimated: u32,
    recursions: [Recursion; 3],
}

#[cfg(feature = "state")]
octant_state::state! {
    SwayStates {
        values: modes, state, own, heading, heading_sum, headings, since, wanted, estimated, recursions;
        parts: cross;
        kept: period_s, stride;
        check: Self::check_counts
    }
}

#[cfg(feature = "state")]
impl SwayStates {
    fn check_counts(&self) -> Result<(), octant_state::StateError> {
        octant_state::check_below("since", self.since.into(), self.stride.into())?;
        octant_state::check_below("headings", self.headings.into(), HEADING_COUNT.into())
    }
}

/// Gain of one axis: rows of the innovation's covariance with the error states and with the sway's.
struct Gain {
    errors: CovarianceRow,
    sway: [f64; SWAY],
}

impl SwayStates {
    pub(super) fn new(period_s: f64) -> Self {
        let stride = libm::ceil(SPACING_S / period_s - 1e-9).max(1.0);
        let mut sway = Self {
            period_s,
            modes: [Oscillator::unknown(); 3],
            state: [0.0; SWAY],
            own: [[0.0; SWAY]; SWAY],
            cross: Border([[0.0; 40]; SWAY]),
            heading: (1.0, 0.0),
            heading_sum: (0.0, 0.0),
            headings: 0,
            stride: stride as u32,
            since: 0,
            wanted: FIRST_COUNT,
            estimated: 0,
            recursions: [Recursion::default(); 3],
        };
        sway.reopen();
        sway
    }

    /// Starts the states anew, after the covariance of the error states was: the model stays.
    pub(super) fn reopen(&mut self) {
        self.state = [0.0; SWAY];
        self.cross = Border([[0.0; 40]; SWAY]);
        self.own = [[0.0; SWAY]; SWAY];
        for (place, (mode, _)) in PLACES.into_iter().enumerate() {
            let [displacement, velocity] = self.modes[mode].stationary();
            self.own[2 * place][2 * place] = displacement;
            self.own[2 * place + 1][2 * place + 1] = velocity;
        }
    }

    /// Propagates with the error states, before their covariance is.
    pub(super) fn propagate(&mut self, errors: &Transition, elapsed_s: f64) {
        for row in &mut self.cross.0 {
            let before = *row;
            for (i, phi) in errors.rows.iter().enumerate() {
                row[i] = phi.iter().zip(&before).map(|(a, b)| a * b).sum();
            }
        }
        let transitions = self.modes.map(|mode| mode.transition(elapsed_s));
        for (place, (mode, _)) in PLACES.into_iter().enumerate() {
            let t = &transitions[mode];
            let (p, v) = (2 * place, 2 * place + 1);
            let turned = |p: f64, v: f64| (t[0][0] * p + t[0][1] * v, t[1][0] * p + t[1][1] * v);
            (self.state[p], self.state[v]) = turned(self.state[p], self.state[v]);
            for j in 0..STATE_COUNT {
                (self.cross.0[p][j], self.cross.0[v][j]) =
                    turned(self.cross.0[p][j], self.cross.0[v][j]);
            }
            for j in 0..SWAY {
                (self.own[p][j], self.own[v][j]) = turned(self.own[p][j], self.own[v][j]);
            }
            for row in &mut self.own {
                (row[p], row[v]) = turned(row[p], row[v]);
            }
        }
        for (place, (mode, _)) in PLACES.into_iter().enumerate() {
            let noise: OfPair = self.modes[mode].noise(&transitions[mode]);
            for i in 0..2 {
                for j in 0..2 {
                    self.own[2 * place + i][2 * place + j] += noise[i][j];
                }
            }
        }
    }

    /// Axes of the ship in n, as columns.
    fn axes_in_n(&self) -> Matrix3<f64> {
        let (cos, sin) = self.heading;
        Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
    }

    /// Displacement that the sway is believed to have, in n, m.
    pub(super) fn expected_m(&self) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (place, (_, axis)) in PLACES.into_iter().enumerate() {
            sum[axis] += self.state[2 * place];
        }
        sum
    }

    /// Covariance of the innovation in n without the noise of the reference.
    pub(super) fn innovation_covariance(&self, errors: &Covariance) -> Matrix3<f64> {
        let mut sum = Matrix3::from_fn(|i, j| errors.at(DR + i, DR + j));
        for (k, (_, i)) in PLACES.into_iter().enumerate() {
            for j in 0..3 {
                let cross = self.cross.0[2 * k][DR + j];
                sum[(i, j)] += cross;
                sum[(j, i)] += cross;
            }
            for (l, (_, j)) in PLACES.into_iter().enumerate() {
                sum[(i, j)] += self.own[2 * k][2 * l];
            }
        }
        sum
    }

    /// Gain of the measurement along a unit vector in n, before it is divided by its variance.
    fn gain(&self, along: &Vector3<f64>, errors: &Covariance) -> Gain {
        let mut gain = Gain { errors: [0.0; 40], sway: [0.0; SWAY] };
        let mut add = |share: f64, of_errors: &CovarianceRow, of_sway: [f64; SWAY]| {
            for (out, p) in gain.errors.iter_mut().zip(of_errors) {
                *out += share * p;
            }
            for (out, p) in gain.sway.iter_mut().zip(of_sway) {
                *out += share * p;
            }
        };
        for (a, share) in along.iter().enumerate() {
            let column = core::array::from_fn(|k| self.cross.0[k][DR + a]);
            add(*share, &errors.rows()[DR + a], column);
        }
        for (place, (_, axis)) in PLACES.into_iter().enumerate() {
            let column = core::array::from_fn(|k| self.own[k][2 * place]);
            add(along[axis], &self.cross.0[2 * place], column);
        }
        gain
    }

    /// Uses the three axes of a measurement one after the other: `error` in n, `r` the variance of
    /// the reference, `x` the estimate of the error states. `held`: the parameters are considered,
    /// not estimated.
    pub(super) fn update(
        &mut self,
        r: f64,
        error: &Vector3<f64>,
        held: bool,
        errors: &mut Covariance,
        x: &mut [f64; STATE_COUNT],
    ) {
        let learning =
            LEARNING.max(FIRST_LEARNING.0 / (FIRST_LEARNING.1 + f64::from(self.estimated)));
        self.estimated = self.estimated.saturating_add(u32::from(self.wanted > FIRST_COUNT));
        for axis in 0..3 {
            let along = self.axes_in_n().column(axis).into_owned();
            let gain = self.gain(&along, errors);
            let at: f64 = (0..3).map(|a| along[a] * gain.errors[DR + a]).sum();
            let own = PLACES.into_iter().enumerate();
            let own: f64 = own.map(|(place, (_, a))| along[a] * gain.sway[2 * place]).sum();
            let scale = 1.0 / libm::sqrt(at + own + r);
            let estimated: f64 = (0..3).map(|a| along[a] * x[DR + a]).sum();
            let sway = along.dot(&self.expected_m());
            let normalized = (along.dot(error) - estimated - sway) * scale;

            let of_errors = gain.errors.map(|value| value * scale);
            let of_sway = gain.sway.map(|value| value * scale);
            let estimated = if held { MOVING } else { STATE_COUNT };
            for (x, g) in x[..estimated].iter_mut().zip(&of_errors) {
                *x += g * normalized;
            }
            for (state, g) in self.state.iter_mut().zip(&of_sway) {
                *state += g * normalized;
            }
            errors.subtract_square(&of_errors, held);
            for (row, g) in self.cross.0.iter_mut().zip(&of_sway) {
                for (p, e) in row.iter_mut().zip(&of_errors) {
                    *p -= g * e;
                }
            }
            for (row, g) in self.own.iter_mut().zip(&of_sway) {
                for (p, e) in row.iter_mut().zip(&of_sway) {
                    *p -= g * e;
                }
            }
            if !held {
                let square = (normalized * normalized).min(LEARNED_MAX);
                self.modes[axis].damp(learning * (square - LEARNED_MEAN));
            }
        }
    }

    /// Learns from what navigation shows: the heading of the case, and the velocity in n.
    pub(super) fn learn(&mut self, heading_rad: f64, velocity_mps: &Vector3<f64>) {
        if self.headings < HEADING_COUNT {
            let (sin, cos) = libm::sincos(heading_rad);
            self.heading_sum = (self.heading_sum.0 + cos, self.heading_sum.1 + sin);
            self.headings += 1;
            if self.headings == HEADING_COUNT {
                self.set_axes();
            }
            return;
        }
        self.since += 1;
        if self.since < self.stride {
            return;
        }
        self.since = 0;
        let along = self.axes_in_n().transpose() * velocity_mps;
        for (recursion, velocity) in self.recursions.iter_mut().zip(along.iter()) {
            recursion.take(*velocity);
        }
        if self.recursions[0].count() >= self.wanted {
            let spacing_s = self.period_s * f64::from(self.stride);
            for (mode, recursion) in self.modes.iter_mut().zip(&self.recursions) {
                let found = recursion.solve(spacing_s, mode);
                // Innovations tell the damping better than velocities, once there are some.
                let damping = if self.wanted == FIRST_COUNT { found.damping } else { mode.damping };
                *mode = Oscillator { damping, ..found };
            }
            self.recursions = [Recursion::default(); 3];
            self.wanted = self.wanted.saturating_mul(2);
        }
    }

    /// Tells that a measurement didn't come.
    pub(super) fn miss(&mut self) {
        self.since = 0;
        self.recursions.iter_mut().for_each(Recursion::interrupt);
    }

    /// Sets the axes of the ship to the mean heading.
    fn set_axes(&mut self) {
        let (x, y) = self.heading_sum;
        let length = libm::sqrt(x * x + y * y);
        if length >= 0.5 * f64::from(HEADING_COUNT) {
            self.heading = (x / length, y / length);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{SMatrix, SVector};

    const ALL: usize = STATE_COUNT + SWAY;
    type Full = SMatrix<f64, ALL, ALL>;

    /// Numbers without a pattern, the same on every run.
    fn scatter(i: usize, j: usize) -> f64 {
        let n = (i * 7919 + j * 104_729 + 13) % 1009;
        n as f64 / 1009.0 - 0.5
    }

    /// A filter with a full covariance of all states, the sway's last, and the same as one matrix.
    fn example() -> (SwayStates, Covariance, Full) {
        let a = Full::from_fn(scatter);
        let full = a * a.transpose() + Full::identity();
        let mut errors = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
        for i in 0..STATE_COUNT {
            for j in i..STATE_COUNT {
                errors.add(i, j, full[(i, j)]);
            }
        }
        let mut sway = SwayStates::new(1.0);
        sway.heading = (0.8, 0.6);
        sway.modes[1] = Oscillator { omega_radps: 0.6, damping: 0.05, sigma_m: 0.4 };
        for k in 0..SWAY {
            sway.state[k] = scatter(k, 3);
            for j in 0..STATE_COUNT {
                sway.cross.0[k][j] = full[(STATE_COUNT + k, j)];
            }
            for l in 0..SWAY {
                sway.own[k][l] = full[(STATE_COUNT + k, STATE_COUNT + l)];
            }
        }
        (sway, errors, full)
    }

    fn assert_equal(sway: &SwayStates, errors: &Covariance, full: &Full) {
        for i in 0..ALL {
            for j in 0..ALL {
                let found = match (i.checked_sub(STATE_COUNT), j.checked_sub(STATE_COUNT)) {
                    (None, None) => errors.at(i, j),
                    (Some(k), None) => sway.cross.0[k][j],
                    (None, Some(k)) => sway.cross.0[k][i],
                    (Some(k), Some(l)) => sway.own[k][l],
                };
                assert!((found - full[(i, j)]).abs() < 1e-9, "element {i}, {j}");
            }
        }
    }

    /// Row of the measurement of an axis: its share of δr in n, and its displacement.
    fn row(sway: &SwayStates, axis: usize) -> SVector<f64, ALL> {
        let mut h = SVector::<f64, ALL>::zeros();
        let along = sway.axes_in_n().column(axis).into_owned();
        h.fixed_rows_mut::<3>(DR).copy_from(&along);
        for (place, (_, of)) in PLACES.into_iter().enumerate() {
            h[STATE_COUNT + 2 * place] = along[of];
        }
        h
    }

    #[test]
    fn propagation_is_that_of_one_filter_with_all_states() {
        let (mut sway, mut errors, full) = example();
        let mut transition = Transition::identity();
        let (mut phi, mut noise) = (Full::identity(), Full::zeros());
        for i in 0..MOVING {
            for j in 0..STATE_COUNT {
                let value = scatter(j + 3, i) + f64::from(u8::from(i == j));
                transition.rows[i][j] = value;
                phi[(i, j)] = value;
            }
        }
        for (place, (mode, _)) in PLACES.into_iter().enumerate() {
            let (t, at) = (sway.modes[mode].transition(1.5), STATE_COUNT + 2 * place);
            let q = sway.modes[mode].noise(&t);
            for i in 0..2 {
                for j in 0..2 {
                    phi[(at + i, at + j)] = t[i][j];
                    noise[(at + i, at + j)] = q[i][j];
                }
            }
        }
        sway.propagate(&transition, 1.5);
        errors.propagate(&transition);
        assert_equal(&sway, &errors, &(phi * full * phi.transpose() + noise));
    }

    #[test]
    fn an_update_is_that_of_one_filter_with_all_states() {
        for held in [false, true] {
            let (mut sway, mut errors, mut full) = example();
            let error = Vector3::new(0.3, -0.2, 0.7);
            let r = 0.3;
            let mut state = SVector::<f64, ALL>::zeros();
            for k in 0..SWAY {
                state[STATE_COUNT + k] = sway.state[k];
            }
            let rows = [0, 1, 2].map(|axis| row(&sway, axis));
            let in_n = sway.axes_in_n();
            let expected = Matrix3::from_fn(|i, j| rows[i].dot(&(full * rows[j])));
            let found = in_n.transpose() * sway.innovation_covariance(&errors) * in_n;
            assert!((found - expected).amax() < 1e-9);

            for (axis, h) in rows.iter().enumerate() {
                let s = h.dot(&(full * h)) + r;
                let mut gain = full * h / s;
                if held {
                    gain.rows_mut(MOVING, STATE_COUNT - MOVING).fill(0.0);
                }
                let innovation = in_n.column(axis).dot(&error) - h.dot(&state);
                state += gain * innovation;
                let left = Full::identity() - gain * h.transpose();
                full = left * full * left.transpose() + gain * gain.transpose() * r;
            }
            let mut x = [0.0; STATE_COUNT];
            sway.update(r, &error, held, &mut errors, &mut x);
            assert_equal(&sway, &errors, &full);
            for i in 0..ALL {
                let found = if i < STATE_COUNT { x[i] } else { sway.state[i - STATE_COUNT] };
                assert!((found - state[i]).abs() < 1e-10, "state {i}");
            }
        }
    }

    /// The heading chooses along which axes the modes are learned, and no more.
    #[test]
    fn a_heading_changes_neither_expectation_nor_covariance() {
        let (mut sway, errors, _) = example();
        let (expected, covariance) = (sway.expected_m(), sway.innovation_covariance(&errors));
        for _ in 0..HEADING_COUNT {
            sway.learn(0.7, &Vector3::zeros());
        }
        assert!((sway.heading.0 - libm::cos(0.7)).abs() < 1e-12);
        assert_eq!(sway.expected_m(), expected);
        assert_eq!(sway.innovation_covariance(&errors), covariance);
    }
}
