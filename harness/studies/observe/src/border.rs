//! Further states of an analysis: a border of the covariance of the 39 errors.
//!
//! A state here is true − estimated, as a parameter is. Of a group that the filter doesn't estimate it is the true
//! error itself. Of Gauss-Markov biases it is minus the estimate: their truth is a process of its own
//! ([`Wander`](super::truth::Wander)).

use nalgebra::Vector3;
use octant_calibration::config::{ErrorModel, Further, FurtherUse};
use octant_calibration::covariance::{
    Covariance, DR, DV, MOVING, PARAMETERS, STATE_COUNT, Transition,
};
use octant_calibration::error_model::{MotionInterval, advance_columns};
use octant_calibration::filter::{FURTHER_ROW, FurtherEffects, FurtherRow};
use octant_calibration::further::{DRIVING_COUNT, FurtherGroup, FurtherIntegrals};
use octant_earth::ellipsoid::Ellipsoid;

/// Effect of each further state on the moving states over a step.
pub(super) type Columns = [FurtherRow; MOVING];

/// Dynamics of the further states, and their treatment by the filter.
#[derive(Clone, Debug)]
pub(super) struct FurtherModel {
    effects: FurtherEffects,
    /// Correlation time of each state, s; infinite: a constant.
    correlation_time_s: [f64; DRIVING_COUNT],
    /// σ of the filter's prior; zero where it doesn't know the state.
    prior: [f64; DRIVING_COUNT],
    estimated: [bool; DRIVING_COUNT],
}

impl FurtherModel {
    /// Makes the model of a filter. All states have their effect, whether the filter knows of them or not.
    pub(super) fn new(further: &Further) -> Self {
        let mut model = Self {
            effects: FurtherEffects::all(),
            correlation_time_s: [f64::INFINITY; DRIVING_COUNT],
            prior: [0.0; DRIVING_COUNT],
            estimated: [false; DRIVING_COUNT],
        };
        for group in FurtherGroup::ALL.into_iter().filter(|group| !group.is_of_gimbals()) {
            let Some(sigma) = further.of(group).sigma() else { continue };
            let is_estimated = matches!(further.of(group), FurtherUse::Estimated { .. });
            model.prior[group.range()].fill(sigma);
            model.estimated[group.range()].fill(is_estimated);
            let correlation_time_s = match group {
                FurtherGroup::GyroGaussMarkov => further.gyro_correlation_time_s,
                FurtherGroup::AccelGaussMarkov => further.accel_correlation_time_s,
                _ => f64::INFINITY,
            };
            model.correlation_time_s[group.range()].fill(correlation_time_s);
        }
        model
    }

    /// Covariance that the filter starts with.
    pub(super) fn believed(&self) -> Border {
        Border::new(&self.prior)
    }

    /// Part of each state that is left after `h`.
    pub(super) fn decay(&self, h: f64) -> FurtherRow {
        let mut decay = [1.0; FURTHER_ROW];
        for (decay, time_s) in decay.iter_mut().zip(&self.correlation_time_s) {
            *decay = libm::exp(-h / time_s);
        }
        decay
    }

    /// Advances columns over an interval; `since_s` is the time from the start of the step to its middle.
    pub(super) fn advance(
        &self,
        columns: &mut Columns,
        error_model: ErrorModel,
        interval: &MotionInterval,
        integrals: &FurtherIntegrals,
        earth: &Ellipsoid,
        since_s: f64,
    ) {
        let decay = self.decay(since_s);
        let of = |group: FurtherGroup| decay[group.start()];
        let decay = [of(FurtherGroup::GyroGaussMarkov), of(FurtherGroup::AccelGaussMarkov)];
        let input = self.effects.input(interval, integrals, earth, ([true; 3], true), decay);
        advance_columns(columns, error_model, interval, earth, input, 0..FURTHER_ROW);
    }
}

/// Step of an analysis: transition of the 39 errors, and what the further states do in it.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) transition: Transition,
    /// Columns, and the part of each state that is left; `None` without further states.
    pub(super) further: Option<(Columns, FurtherRow)>,
}

impl Step {
    /// Holds the vertical channel.
    pub(super) fn hold_vertical(&mut self) {
        for state in [DV + 2, DR + 2] {
            self.transition.rows[state].fill(0.0);
            if let Some((columns, _)) = &mut self.further {
                columns[state].fill(0.0);
            }
        }
    }
}

/// Covariance of the further states with the 39 errors and with each other.
#[derive(Clone, Debug)]
pub(super) struct Border {
    cross: Vec<[f64; STATE_COUNT]>,
    own: Vec<FurtherRow>,
}

impl Border {
    /// Makes independent states with these σ.
    pub(super) fn new(sigmas: &[f64; DRIVING_COUNT]) -> Self {
        let mut own = vec![[0.0; FURTHER_ROW]; DRIVING_COUNT];
        for (k, sigma) in sigmas.iter().enumerate() {
            own[k][k] = sigma * sigma;
        }
        Self { cross: vec![[0.0; STATE_COUNT]; DRIVING_COUNT], own }
    }

    /// Adds to the covariance of a further state with one of the 39.
    pub(super) fn add(&mut self, further: usize, state: usize, value: f64) {
        self.cross[further][state] += value;
    }

    /// Propagates, after `errors` was by the transition alone, and adds to those what the further states do:
    /// `e⁺ = Φ e + D z`, `z⁺ = F z`.
    pub(super) fn propagate(
        &mut self,
        transition: &Transition,
        (columns, decay): &(Columns, FurtherRow),
        errors: &mut Covariance,
    ) {
        // Covariance of the moving states with z: by Φ, and by D too.
        let mut carried = [[0.0; FURTHER_ROW]; MOVING];
        let mut moved = carried;
        for i in 0..MOVING {
            for k in 0..DRIVING_COUNT {
                carried[i][k] = sum(&transition.rows[i], &self.cross[k]);
                moved[i][k] = carried[i][k] + sum(&columns[i], &self.own[k]);
            }
        }
        for i in 0..MOVING {
            for j in i..MOVING {
                let value = sum(&columns[i], &moved[j]) + sum(&carried[i], &columns[j]);
                errors.add(i, j, value);
            }
            for j in PARAMETERS..STATE_COUNT {
                let value = columns[i].iter().zip(&self.cross).map(|(d, cross)| d * cross[j]).sum();
                errors.add(i, j, value);
            }
        }
        for k in 0..DRIVING_COUNT {
            for (i, moved) in moved.iter().enumerate() {
                self.cross[k][i] = moved[k];
            }
            self.cross[k].iter_mut().for_each(|value| *value *= decay[k]);
            for (value, other) in self.own[k].iter_mut().zip(decay) {
                *value *= decay[k] * other;
            }
        }
    }

    /// Adds the noise that keeps Gauss-Markov biases at the filter's σ. Its effect on the moving states within a step
    /// is that of a step which is short against the correlation time: none.
    pub(super) fn add_noise(&mut self, model: &FurtherModel, decay: &FurtherRow) {
        for k in 0..DRIVING_COUNT {
            self.own[k][k] += model.prior[k] * model.prior[k] * (1.0 - decay[k] * decay[k]);
        }
    }

    /// Gain of the filter for the further states, where this is its covariance: zero for those that aren't estimated.
    pub(super) fn gain(&self, model: &FurtherModel, state: usize, variance: f64) -> FurtherRow {
        let mut gain = [0.0; FURTHER_ROW];
        for k in (0..DRIVING_COUNT).filter(|k| model.estimated[*k]) {
            gain[k] = self.cross[k][state] / variance;
        }
        gain
    }

    /// Updates with a measurement of one of the 39 errors with variance `r` by any gain, before `errors` is:
    /// `x⁺ = x − K (e_state + noise)`.
    pub(super) fn update(
        &mut self,
        errors: &Covariance,
        (state, r): (usize, f64),
        gain: &[f64; STATE_COUNT],
        further: &FurtherRow,
    ) {
        let variance = errors.at(state, state) + r;
        let measured: Vec<f64> = self.cross.iter().map(|cross| cross[state]).collect();
        for k in 0..DRIVING_COUNT {
            for (j, gain) in gain.iter().enumerate() {
                self.cross[k][j] +=
                    further[k] * (gain * variance - errors.at(state, j)) - measured[k] * gain;
            }
            for (l, measured_too) in measured.iter().enumerate() {
                self.own[k][l] +=
                    further[k] * (further[l] * variance - measured_too) - measured[k] * further[l];
            }
        }
    }

    /// Takes out the correlation with a state that is known anew.
    pub(super) fn forget(&mut self, state: usize) {
        self.cross.iter_mut().for_each(|cross| cross[state] = 0.0);
    }

    /// Adds the products of values of the further states and of the first of the 39 errors to their covariance.
    pub(super) fn add_products(&mut self, further: &FurtherRow, errors: &[f64]) {
        for (cross, further) in self.cross.iter_mut().zip(further) {
            for (cross, error) in cross.iter_mut().zip(errors) {
                *cross += further * error;
            }
        }
    }

    /// Variance of a further state.
    pub(super) fn variance(&self, k: usize) -> f64 {
        self.own[k][k]
    }
}

/// Integrals of an interval over which the rate changes by `change`, rad/s in b, at T − T₀.
pub(super) fn integrals(
    interval: &MotionInterval,
    change: &Vector3<f64>,
    warmth_k: f64,
) -> FurtherIntegrals {
    let (turned, gained) = (&interval.delta_theta, &interval.delta_velocity);
    let square = turned * turned.transpose() / interval.interval_s;
    let size = octant_earth::rotation::skew(change) + square
        - nalgebra::Matrix3::from_diagonal_element(square.trace());
    FurtherIntegrals {
        size,
        turned: turned.abs(),
        pushed: gained.abs(),
        squared: gained.component_mul(gained) / interval.interval_s,
        warmth: warmth_k * interval.interval_s,
        warm_turn: turned * warmth_k,
        warm_push: gained * warmth_k,
    }
}

/// Sum of the products of two rows, of which the shorter one ends it.
pub(super) fn sum(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{SMatrix, SVector};

    const ALL: usize = STATE_COUNT + DRIVING_COUNT;
    type Whole = SMatrix<f64, ALL, ALL>;

    /// Numbers without a pattern, within ±1.
    fn number(i: usize, j: usize) -> f64 {
        libm::sin(12.9898 * (i as f64 + 1.0) + 78.233 * (j as f64 + 1.0))
    }

    /// A covariance of all states, and the same in its parts.
    fn parts() -> (Whole, Covariance, Border) {
        let root = Whole::from_fn(number);
        let whole = root * root.transpose();
        let mut errors = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
        let mut border = Border::new(&[0.0; DRIVING_COUNT]);
        for i in 0..STATE_COUNT {
            (i..STATE_COUNT).for_each(|j| errors.add(i, j, whole[(i, j)]));
        }
        for k in 0..DRIVING_COUNT {
            (0..STATE_COUNT).for_each(|j| border.add(k, j, whole[(STATE_COUNT + k, j)]));
            for l in 0..DRIVING_COUNT {
                border.own[k][l] = whole[(STATE_COUNT + k, STATE_COUNT + l)];
            }
        }
        (whole, errors, border)
    }

    fn assert_same(whole: &Whole, errors: &Covariance, border: &Border) {
        let scale = whole.amax();
        for i in 0..ALL {
            for j in 0..ALL {
                let found = match (i.checked_sub(STATE_COUNT), j.checked_sub(STATE_COUNT)) {
                    (None, None) => errors.at(i, j),
                    (Some(k), None) => border.cross[k][j],
                    (None, Some(k)) => border.cross[k][i],
                    (Some(k), Some(l)) => border.own[k][l],
                };
                assert!((found - whole[(i, j)]).abs() < 1e-12 * scale, "{i} {j}: {found}");
            }
        }
    }

    /// F P Fᵀ of the whole matrix.
    #[test]
    fn a_step_is_that_of_the_whole_covariance() {
        let (whole, mut errors, mut border) = parts();
        let mut transition = Transition::identity();
        let mut columns = [[0.0; FURTHER_ROW]; MOVING];
        let mut decay = [1.0; FURTHER_ROW];
        let mut f = Whole::identity();
        for i in 0..MOVING {
            for j in 0..STATE_COUNT {
                transition.rows[i][j] += 0.3 * number(i + 7, j + 50);
                f[(i, j)] = transition.rows[i][j];
            }
            for k in 0..DRIVING_COUNT {
                columns[i][k] = number(i + 31, k + 3);
                f[(i, STATE_COUNT + k)] = columns[i][k];
            }
        }
        for k in 18..24 {
            decay[k] = 0.9;
            f[(STATE_COUNT + k, STATE_COUNT + k)] = 0.9;
        }
        errors.propagate(&transition);
        border.propagate(&transition, &(columns, decay), &mut errors);
        assert_same(&(f * whole * f.transpose()), &errors, &border);
    }

    /// (I − K h) P (I − K h)ᵀ + K r Kᵀ of the whole matrix, with any gain.
    #[test]
    fn an_update_is_that_of_the_whole_covariance() {
        let (whole, mut errors, mut border) = parts();
        let (state, r) = (4, 0.7);
        let gain: [f64; STATE_COUNT] = core::array::from_fn(|i| 0.1 * number(i, 99));
        let mut further = [0.0; FURTHER_ROW];
        (0..DRIVING_COUNT).filter(|k| k % 3 != 0).for_each(|k| further[k] = 0.1 * number(k, 5));
        border.update(&errors, (state, r), &gain, &further);
        errors.update_with_gain(state, r, &gain);
        let k = SVector::<f64, ALL>::from_fn(|i, _| {
            if i < STATE_COUNT { gain[i] } else { further[i - STATE_COUNT] }
        });
        let mut kept = Whole::identity();
        kept.column_mut(state).axpy(-1.0, &k, 1.0);
        let expected = kept * whole * kept.transpose() + k * k.transpose() * r;
        assert_same(&expected, &errors, &border);
    }
}
