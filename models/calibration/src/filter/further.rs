//! Further states beside those of the filter, see [`crate::further`]: a border of the covariance.
//!
//! A further state drives attitude and velocity and is driven by nothing but its own noise. With the
//! moving states m, the parameters p and the further states z the transition is
//! `m ← T (m, p) + D z, p ← p, z ← F z`, F diagonal. The border holds the columns D, the covariance
//! of z with the 39 states, and its own. The places of groups that are off stay zero; those of the gimbals,
//! whose errors drive nothing (D = 0, F = 1), exist where [their angles are measurements](angles), and those of the
//! temperature where errors follow it: one of the two.

mod angles;
mod border;
mod case;
mod columns;
mod expected;
mod gimbals;
#[cfg(test)]
mod jacobian;
#[cfg(test)]
mod tests;

use crate::config::{Further, FurtherUse, Kalman};
use crate::covariance::{Covariance, MOVING, STATE_COUNT, Transition};
#[cfg(feature = "state")]
use crate::covariance::{load_rows, save_rows};
use crate::error_model::{MotionInterval, advance_columns};
use crate::further::compensation::FurtherIntegrals;
use crate::further::size_effect::SizeEffect;
use crate::further::{
    DRIVING_COUNT, FURTHER_COUNT, FurtherEstimates, FurtherGroup, TEMPERATURE_START,
};
pub use angles::{ANGLE_GATE_NIS, AngleResult, AngleRows, angle_rows};
use border::{BORDER_COUNT, Border, CASE, Process, places};
pub use case::CaseTurn;
use columns::UNHEATED_ROW;
pub use columns::{FURTHER_ROW, FurtherEffects, FurtherRow};
pub use expected::ExpectedNis;
use expected::NisSpread;
pub use gimbals::AngleTally;
use gimbals::GimbalAngleMeasurement;
use nalgebra::{Matrix3, Vector3};
use octant_earth::ellipsoid::Ellipsoid;

/// The further states of a filter.
#[derive(Clone, Debug)]
pub(super) struct FurtherStates {
    border: Border,
    /// D: effect on the moving states since the last propagation.
    columns: [FurtherRow; MOVING],
    /// Time since the last propagation up to the open sub-step, s.
    elapsed_s: f64,
    integrals: FurtherIntegrals,
    /// T − T₀, K; not stored: the core tells it with every sample.
    warmth_k: f64,
    size_effect: SizeEffect,
    /// The older and the newer checkpoint.
    checkpoints: Option<[Border; 2]>,
    effects: FurtherEffects,
    estimated: [bool; BORDER_COUNT],
    processes: [Option<Process>; 2],
    /// Length of a row of the columns that isn't zero.
    driving_row: usize,
    /// Gimbal angles as measurements, if they are.
    angles: Option<GimbalAngleMeasurement>,
    /// What the NIS of a run owes to states that are considered, if any are.
    spread: Option<NisSpread>,
}

impl FurtherStates {
    /// Makes the further states of a filter with their prior; `None` if all groups are off.
    pub(super) fn new(kalman: &Kalman, checkpoints: bool) -> Option<Self> {
        let further = &kalman.further;
        if !further.has_border() {
            return None;
        }
        let angles = further
            .attitude_at_rest()
            .map(|angles| GimbalAngleMeasurement::new(&angles, further.rest));
        let heated = further.follows_temperature();
        let mut border = Border::new(match (&angles, heated) {
            (Some(_), _) => BORDER_COUNT,
            (None, true) => DRIVING_COUNT,
            (None, false) => TEMPERATURE_START,
        });
        let (mut estimated, mut considered) = ([false; BORDER_COUNT], [false; BORDER_COUNT]);
        if angles.is_some() {
            estimated[CASE..].fill(true);
        }
        for group in FurtherGroup::ALL {
            let Some(sigma) = further.of(group).sigma() else { continue };
            for k in places(group) {
                border.own[k][k] = sigma * sigma;
                estimated[k] = matches!(further.of(group), FurtherUse::Estimated { .. });
                considered[k] = !estimated[k];
            }
        }
        Some(Self {
            columns: [[0.0; FURTHER_ROW]; MOVING],
            elapsed_s: 0.0,
            integrals: FurtherIntegrals::default(),
            warmth_k: 0.0,
            size_effect: SizeEffect::default(),
            checkpoints: checkpoints.then(|| [border.clone(), border.clone()]),
            border,
            effects: FurtherEffects::new(further),
            estimated,
            processes: processes(further),
            driving_row: if heated { FURTHER_ROW } else { UNHEATED_ROW },
            angles,
            spread: NisSpread::new(considered),
        })
    }

    /// Takes T − T₀, K.
    #[inline]
    pub(super) fn feel(&mut self, warmth_k: f64) {
        self.warmth_k = warmth_k;
    }

    /// Adds the compensated increments of an interval.
    #[inline(never)]
    pub(super) fn accumulate(&mut self, dtheta: &Vector3<f64>, dv: &Vector3<f64>, interval_s: f64) {
        let size = if self.effects.on(FurtherGroup::AccelLever) {
            self.size_effect.step(dtheta, interval_s)
        } else {
            Matrix3::zeros()
        };
        self.integrals.add(&size, dtheta, dv, interval_s);
        if self.warmth_k != 0.0 {
            self.integrals.add_warm(self.warmth_k, dtheta, dv, interval_s);
        }
    }

    /// Advances the columns over a sub-step, with the transition; the flags say which sensors
    /// measured in it.
    pub(super) fn advance(
        &mut self,
        kalman_model: crate::config::ErrorModel,
        interval: &MotionInterval,
        earth: &Ellipsoid,
        gyros_used: [bool; 3],
        accelerometers_used: bool,
    ) {
        let integrals = core::mem::take(&mut self.integrals);
        let middle_s = self.elapsed_s + 0.5 * interval.interval_s;
        self.elapsed_s += interval.interval_s;
        let mut decay = [1.0; 2];
        for (decay, process) in decay.iter_mut().zip(&self.processes) {
            if let Some(process) = process {
                *decay = libm::exp(-middle_s / process.correlation_time_s);
            }
        }
        let input = self.effects.input(
            interval,
            &integrals,
            earth,
            (gyros_used, accelerometers_used),
            decay,
        );
        let mut interval = *interval;
        if !accelerometers_used {
            // As in `Transition::advance_bridged`.
            interval.delta_velocity_n = Vector3::zeros();
        }
        advance_columns(
            &mut self.columns,
            kalman_model,
            &interval,
            earth,
            input,
            0..self.driving_row,
        );
    }

    /// Propagates to the present, after the covariance of the 39 states was by `transition`, and adds
    /// to that the effect of the further states.
    pub(super) fn propagate(
        &mut self,
        transition: &Transition,
        elapsed_s: f64,
        errors: &mut Covariance,
    ) {
        let columns = core::mem::replace(&mut self.columns, [[0.0; FURTHER_ROW]; MOVING]);
        self.elapsed_s = 0.0;
        let Border { count, cross, own, .. } = &mut self.border;
        let (count, driving) = (*count, self.driving_row);
        // Covariance with the moving states: by the transition alone, and with the columns too.
        let mut carried = [[0.0; BORDER_COUNT]; MOVING];
        let mut moved = [[0.0; BORDER_COUNT]; MOVING];
        for i in 0..MOVING {
            for k in 0..count {
                carried[i][k] = dot(&transition.rows[i], &cross[k]);
                moved[i][k] = carried[i][k] + dot(&columns[i][..driving], &own[k][..driving]);
            }
        }
        for i in 0..MOVING {
            for j in i..MOVING {
                let value = dot(&moved[j][..driving], &columns[i][..driving])
                    + dot(&carried[i][..driving], &columns[j][..driving]);
                errors.add(i, j, value);
            }
            let mut with_parameters = [0.0; 40];
            for (column, row) in columns[i][..driving].iter().zip(&cross[..count]) {
                for (out, p) in with_parameters.iter_mut().zip(row) {
                    *out += column * p;
                }
            }
            for j in MOVING..STATE_COUNT {
                errors.add(i, j, with_parameters[j]);
            }
        }
        for (k, row) in cross[..count].iter_mut().enumerate() {
            for i in 0..MOVING {
                row[i] = moved[i][k];
            }
        }
        self.border.time_s += elapsed_s;
        for process in self.processes.iter().flatten() {
            self.border.wander(process, elapsed_s, &columns, errors);
        }
        self.turn_case(elapsed_s);
    }

    /// Lets the case turn for a time, as far as it may.
    fn turn_case(&mut self, elapsed_s: f64) {
        let variance = self.angles.as_ref().map_or(0.0, |angles| angles.wander_rad2_per_s);
        if variance > 0.0 {
            (CASE..CASE + 3).for_each(|k| self.border.own[k][k] += variance * elapsed_s);
        }
    }

    /// Uses one axis of a measurement: state `s` of the 39 with variance `r`, before that updates
    /// their covariance. `held`: the further states are considered, not estimated, as the parameters
    /// are.
    pub(super) fn update(
        &mut self,
        errors: &Covariance,
        s: usize,
        r: f64,
        innovation: f64,
        held: bool,
    ) {
        let (row, scale) = errors.gain_row(s, r);
        let of_errors = row.map(|value| value * scale);
        let Border { count, value, cross, own, .. } = &mut self.border;
        let count = *count;
        let (cross, own) = (&mut cross[..count], &mut own[..count]);
        let mut gain = [0.0; BORDER_COUNT];
        for (gain, row) in gain.iter_mut().zip(cross.iter()) {
            *gain = row[s] * scale;
        }
        for (k, row) in cross.iter_mut().enumerate() {
            // Two states without a gain keep their covariance (Schmidt).
            let end = if held { MOVING } else { row.len() };
            for (p, u) in row[..end].iter_mut().zip(&of_errors) {
                *p -= gain[k] * u;
            }
        }
        if held {
            return;
        }
        let mut moved = [0.0; BORDER_COUNT];
        for k in 0..count {
            if self.estimated[k] {
                value[k] += gain[k] * (scale * innovation);
                moved[k] = gain[k];
            }
        }
        for (k, row) in own.iter_mut().enumerate() {
            let others = if self.estimated[k] { &gain } else { &moved };
            for (p, u) in row[..count].iter_mut().zip(others) {
                *p -= gain[k] * u;
            }
        }
        self.fold_case();
    }

    /// Takes what a measurement of the states from `first` on tells of the NIS, before the update.
    pub(super) fn expect(&mut self, errors: &Covariance, first: usize, r: f64) {
        if let Some(spread) = &mut self.spread {
            spread.take(&self.border, errors, first, r);
        }
    }

    /// Mean NIS that is expected of the run so far; `None` where no state is considered.
    pub(super) fn expected_nis(&self) -> Option<ExpectedNis> {
        self.spread.as_ref().map(NisSpread::range)
    }

    /// The same where the states of the border have these values, in units of their σ.
    #[cfg(feature = "state")]
    pub(super) fn expected_nis_of(&self, values: &[f64]) -> Option<f64> {
        self.spread.as_ref().map(|spread| spread.of(values))
    }

    /// Takes out the correlation with the moving states, which are reopened.
    pub(super) fn reopen(&mut self) {
        for row in &mut self.border.cross {
            row[..MOVING].fill(0.0);
        }
    }

    /// Keeps the present as the newer checkpoint.
    pub(super) fn remember(&mut self) {
        let Some([older, newer]) = &mut self.checkpoints else { return };
        core::mem::swap(older, newer);
        newer.clone_from(&self.border);
    }

    /// Returns to the older checkpoint. Biases that wander have gone on since then.
    pub(super) fn go_back(&mut self, errors: &mut Covariance) {
        let Some([older, newer]) = &mut self.checkpoints else { return };
        newer.clone_from(older);
        let since_s = self.border.time_s - older.time_s;
        let time_s = self.border.time_s;
        self.border.clone_from(older);
        self.border.time_s = time_s;
        for process in self.processes.iter().flatten() {
            self.border.wander(process, since_s, &[[0.0; FURTHER_ROW]; MOVING], errors);
        }
        self.turn_case(since_s);
        // The stop may be another one.
        self.border.reference.at = None;
    }

    /// Estimates with their standard deviations.
    pub(super) fn estimates(&self) -> FurtherEstimates {
        let mut found =
            FurtherEstimates { value: [0.0; FURTHER_COUNT], sigma: [0.0; FURTHER_COUNT] };
        for group in FurtherGroup::ALL {
            // The other of the two that share a room isn't there.
            let is_there = match (group.is_of_gimbals(), group.start() < TEMPERATURE_START) {
                (true, _) => self.angles.is_some(),
                (false, is_always) => is_always || self.angles.is_none(),
            };
            if !is_there {
                continue;
            }
            for (index, k) in group.range().zip(places(group)) {
                found.value[index] = self.border.value[k];
                found.sigma[index] = libm::sqrt(self.border.own[k][k].max(0.0));
            }
        }
        found
    }

    /// Returns whether every number is finite.
    pub(super) fn is_finite(&self) -> bool {
        self.border.is_finite()
    }
}

fn processes(further: &Further) -> [Option<Process>; 2] {
    let process = |group, correlation_time_s| {
        further.of(group).sigma().map(|sigma| Process { group, sigma, correlation_time_s })
    };
    [
        process(FurtherGroup::GyroGaussMarkov, further.gyro_correlation_time_s),
        process(FurtherGroup::AccelGaussMarkov, further.accel_correlation_time_s),
    ]
}

/// Scalar product in four partial sums: a fixed order that the compiler can vectorize.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

#[cfg(feature = "state")]
impl octant_state::State for FurtherStates {
    /// Without angles as measurements, and errors that follow the temperature, the layout is that of a program that
    /// knew none.
    fn save(&self, to: &mut octant_state::Writer) {
        let Self {
            border,
            columns,
            elapsed_s,
            integrals,
            warmth_k: _,
            size_effect,
            checkpoints,
            effects: _,
            estimated: _,
            processes: _,
            driving_row,
            angles,
            spread,
        } = self;
        if *driving_row == FURTHER_ROW {
            save_rows(columns, to);
        } else {
            let unheated: [[f64; UNHEATED_ROW]; MOVING] =
                core::array::from_fn(|i| core::array::from_fn(|k| columns[i][k]));
            to.value("columns", &unheated);
        }
        to.value("elapsed_s", elapsed_s);
        to.value("integrals", integrals);
        if *driving_row == FURTHER_ROW {
            to.value("warm integrals", &integrals.warm());
        }
        to.value("size_effect", size_effect);
        to.part("border", border);
        to.part("checkpoints", checkpoints);
        if let Some(angles) = angles {
            to.value("angles", &angles.tally);
            if let Some(travel) = &angles.travel {
                to.value("case", travel);
            }
        }
        if let Some(spread) = spread {
            to.part("nis spread", spread);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        if self.driving_row == FURTHER_ROW {
            load_rows(&mut self.columns, from)?;
        } else {
            let unheated: [[f64; UNHEATED_ROW]; MOVING] = from.value("columns")?;
            for (row, unheated) in self.columns.iter_mut().zip(unheated) {
                row[..UNHEATED_ROW].copy_from_slice(&unheated);
            }
        }
        self.elapsed_s = from.value("elapsed_s")?;
        self.integrals = from.value("integrals")?;
        if self.driving_row == FURTHER_ROW {
            self.integrals.set_warm(from.value("warm integrals")?);
        }
        self.size_effect = from.value("size_effect")?;
        from.part("border", &mut self.border)?;
        from.part("checkpoints", &mut self.checkpoints)?;
        if let Some(angles) = &mut self.angles {
            angles.tally = from.value("angles")?;
            octant_state::check_count("angles.used", angles.tally.used)?;
            octant_state::check_count("angles.rejected", angles.tally.rejected)?;
            if let Some(travel) = &mut angles.travel {
                *travel = from.value("case")?;
            }
        }
        if let Some(spread) = &mut self.spread {
            from.part("nis spread", spread)?;
        }
        Ok(())
    }
}
