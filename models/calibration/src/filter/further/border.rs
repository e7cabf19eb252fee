//! The border itself: estimates of the further states, and their covariance with the 39 and with each other.

use super::columns::FurtherRow;
#[cfg(feature = "state")]
use super::columns::UNHEATED_ROW;
use super::gimbals::GimbalReference;
use crate::covariance::{Covariance, CovarianceRow, MOVING};
#[cfg(feature = "state")]
use crate::covariance::{load_rows, save_rows};
use crate::further::{DRIVING_COUNT, FURTHER_COUNT, FurtherGroup, TEMPERATURE_START};
use core::ops::Range;

/// States that follow the temperature. Those of the gimbals are in their room: a filter has one of the two.
const SHARED: usize = DRIVING_COUNT - TEMPERATURE_START;
/// First of the three states of the case's attitude, rad in n, true − estimated. They have no estimate: it is
/// in the reference.
pub(super) const CASE: usize = FURTHER_COUNT - SHARED;
/// First of the two states of the rest of the encoders' error curves at the present stop, azimuth and roll.
pub(super) const CURVE: usize = CASE + 3;
/// States of the border where gimbal angles are measurements.
pub(super) const BORDER_COUNT: usize = CURVE + 2;

/// One row over the states of the border: as long as one over the 39, and without padding.
pub(super) type BorderRow = CovarianceRow;
const _: () = assert!(size_of::<BorderRow>() == BORDER_COUNT * size_of::<f64>());

/// Places of a group's states in the border.
pub(super) const fn places(group: FurtherGroup) -> Range<usize> {
    let Range { start, end } = group.range();
    let back = if group.is_of_gimbals() { SHARED } else { 0 };
    start - back..end - back
}

/// A first-order Gauss-Markov process of three further states.
#[derive(Clone, Copy, Debug)]
pub(super) struct Process {
    pub(super) group: FurtherGroup,
    pub(super) sigma: f64,
    pub(super) correlation_time_s: f64,
}

/// Estimates and covariance of the further states at one time.
#[derive(Clone, Debug)]
pub(super) struct Border {
    pub(super) time_s: f64,
    /// States that are there: [`TEMPERATURE_START`], [`DRIVING_COUNT`] with those that follow the temperature, or
    /// [`BORDER_COUNT`] with those of the gimbals. All others stay zero.
    pub(super) count: usize,
    pub(super) value: BorderRow,
    /// Covariance with the 39 states, a row for each further state.
    pub(super) cross: [CovarianceRow; BORDER_COUNT],
    pub(super) own: [BorderRow; BORDER_COUNT],
    pub(super) reference: GimbalReference,
}

impl Border {
    pub(super) fn new(count: usize) -> Self {
        Self {
            time_s: 0.0,
            count,
            value: [0.0; BORDER_COUNT],
            cross: [[0.0; 40]; BORDER_COUNT],
            own: [[0.0; BORDER_COUNT]; BORDER_COUNT],
            reference: GimbalReference::default(),
        }
    }

    /// Lets a process wander over a time: decay, noise, and the effect of that noise on the moving
    /// states, whose columns are those of the same time.
    ///
    /// All of it is exact for an effect with a constant factor c, of which the column is
    /// `c τ (1 − e)`, e = exp(−t/τ): the noise in the state has the variance `σ² (1 − e²)`, with the
    /// moving state the covariance `c σ² τ (1 − e)²`, and in that
    /// `2 c² σ² τ² (t/τ − 2 (1 − e) + (1 − e²)/2)`.
    pub(super) fn wander(
        &mut self,
        process: &Process,
        elapsed_s: f64,
        columns: &[FurtherRow; MOVING],
        errors: &mut Covariance,
    ) {
        let ratio = elapsed_s / process.correlation_time_s;
        let decay = libm::exp(-ratio);
        let lost = -libm::expm1(-ratio);
        let variance = process.sigma * process.sigma;
        for k in process.group.range() {
            self.value[k] *= decay;
            self.cross[k].iter_mut().for_each(|p| *p *= decay);
            self.own[k].iter_mut().for_each(|p| *p *= decay);
            self.own[..self.count].iter_mut().for_each(|row| row[k] *= decay);
            self.own[k][k] += variance * lost * (1.0 + decay);
            for i in 0..MOVING {
                self.cross[k][i] += variance * lost * columns[i][k];
                for j in i..MOVING {
                    let share = columns[i][k] * columns[j][k];
                    errors.add(i, j, variance * share_of_noise(ratio, lost) * share);
                }
            }
        }
    }

    /// Draws a state anew: no correlation, and this standard deviation.
    pub(super) fn renew(&mut self, k: usize, sigma: f64) {
        self.value[k] = 0.0;
        self.cross[k] = [0.0; 40];
        self.own[k] = [0.0; BORDER_COUNT];
        self.own[..self.count].iter_mut().for_each(|row| row[k] = 0.0);
        self.own[k][k] = sigma * sigma;
    }

    /// Returns whether every number is finite.
    pub(super) fn is_finite(&self) -> bool {
        let Self { time_s: _, count: _, value, cross, own, reference: _ } = self;
        value
            .iter()
            .chain(cross.iter().flatten())
            .chain(own.iter().flatten())
            .all(|x| x.is_finite())
    }
}

/// Variance of the integral of a process's noise, by σ² and the square of its column:
/// `2 (a − x − x²/2)/x²` with a = −ln(1 − x); its series where the difference would cancel.
pub(super) fn share_of_noise(ratio: f64, lost: f64) -> f64 {
    let x = lost;
    if x < 1e-2 {
        2.0 * x * (1.0 / 3.0 + x * (0.25 + x * (0.2 + x * (1.0 / 6.0 + x / 7.0))))
    } else {
        2.0 * (ratio - x - 0.5 * x * x) / (x * x)
    }
}

/// Elements of a row beyond those that are always there.
#[cfg(feature = "state")]
const REST: usize = BORDER_COUNT - TEMPERATURE_START;

#[cfg(feature = "state")]
impl octant_state::State for Border {
    /// Without states of the gimbals, or of the temperature, the layout is that of a program that knew none.
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { time_s, count, value, cross, own, reference } = self;
        to.value("time_s", time_s);
        let always: [f64; TEMPERATURE_START] = core::array::from_fn(|k| value[k]);
        to.value("value", &always);
        save_rows(&cross[..*count], to);
        if *count == TEMPERATURE_START {
            for row in &own[..TEMPERATURE_START] {
                let own: [f64; UNHEATED_ROW] = core::array::from_fn(|k| row[k]);
                to.value("own", &own);
            }
            return;
        }
        save_rows(&own[..*count], to);
        let rest: [f64; REST] = core::array::from_fn(|k| value[TEMPERATURE_START + k]);
        to.value("rest of value", &rest);
        if *count == BORDER_COUNT {
            to.value("reference", reference);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        self.time_s = from.value("time_s")?;
        let always: [f64; TEMPERATURE_START] = from.value("value")?;
        self.value[..TEMPERATURE_START].copy_from_slice(&always);
        load_rows(&mut self.cross[..self.count], from)?;
        if self.count == TEMPERATURE_START {
            for row in &mut self.own[..TEMPERATURE_START] {
                let own: [f64; UNHEATED_ROW] = from.value("own")?;
                row[..UNHEATED_ROW].copy_from_slice(&own);
            }
            return Ok(());
        }
        load_rows(&mut self.own[..self.count], from)?;
        let rest: [f64; REST] = from.value("rest of value")?;
        self.value[TEMPERATURE_START..].copy_from_slice(&rest);
        if self.count == BORDER_COUNT {
            self.reference = from.value("reference")?;
        }
        Ok(())
    }
}
