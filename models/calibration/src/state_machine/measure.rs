//! One measurement: the reference that came with a sample, and the filter's use of it.

use super::estimation::Estimation;
use super::judgement::nis_limit;
use super::{CalibrationRefusal, Core, kalman_of};
use crate::compensation::Compensation;
use crate::drift::DriftTest;
use octant_earth::frames::c_cb;
use octant_sample::parameters::ParameterGroup;
use octant_sample::{Aiding, Health, Parameters, Sample, Status};

/// Standard gravity, for a bound.
const GRAVITY_MPS2: f64 = 9.81;
/// Memory of the running mean of NIS, measurements.
const NIS_MEMORY: f64 = 64.0;

impl Core {
    #[inline(never)]
    pub(super) fn measure(
        &mut self,
        sample: &Sample,
        aiding: Option<&Aiding>,
        health: &mut Health,
        nis: &mut f64,
    ) {
        let mut aiding = aiding;
        // The reference's clock and the instrument's may jitter against each other.
        let stale = |aiding: &Aiding| {
            let apart_ns = aiding.device_time.ns.abs_diff(sample.device_time.ns);
            apart_ns > self.config.sample_period_ns / 2
        };
        if self.config.screening.aiding_stamps && aiding.is_some_and(stale) {
            // A stale reference holds for another time.
            aiding = None;
            *health |= Health::AIDING_STALE;
        }
        let (Estimation::Kalman(_), Some(kalman)) = (&self.estimation, kalman_of(&self.config))
        else {
            return;
        };
        let explains_ticks = self.explains_ticks();
        let after_move = self.has_moved_within(explains_ticks);
        let resting = kalman.further.attitude_at_rest().is_some()
            && !self.gimbals_may_move()
            && !sample.status.contains(Status::GIMBAL_INVALID);
        let period_ticks = kalman.aiding_period_ns / self.config.sample_period_ns;
        let due = self.tick.is_multiple_of(period_ticks);
        self.due_tick = self.tick.checked_next_multiple_of(period_ticks).unwrap_or(u64::MAX);
        if !due && aiding.is_none() {
            return;
        }
        self.account();
        let (Estimation::Kalman(filter), Some(kalman)) =
            (&mut self.estimation, kalman_of(&self.config))
        else {
            return;
        };
        filter.propagate(&self.strapdown);
        if filter.has_sway() {
            let heading = aiding.map(|_| {
                let c_nc = self.strapdown.c_nb()
                    * c_cb(sample.gimbal.azimuth_rad(), sample.gimbal.roll_rad()).transpose();
                libm::atan2(c_nc[(1, 0)], c_nc[(0, 0)])
            });
            filter.learn_sway(heading, &self.strapdown);
        }
        let before = self.parameters;
        let mut measured = aiding.and_then(|aiding| {
            filter.measure(&aiding.reference, &mut self.strapdown, &mut self.parameters)
        });
        if due && resting && measured.is_some_and(|measured| !measured.rejected) {
            let angles =
                filter.measure_angles(sample.gimbal, &mut self.strapdown, &mut self.parameters);
            if let (Some((angles, turned_rad)), Some(measured)) = (angles, &mut measured) {
                measured.turned_rad += turned_rad;
                if angles.rejected {
                    // A case that turned looks the same.
                    *health |= Health::GIMBAL_SLIPPED;
                }
            }
        }
        let further = filter.further();
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if !finite(&self.parameters.to_array())
            || further.as_ref().is_some_and(|further| !finite(&further.value))
        {
            self.parameters = before;
            self.refuse(CalibrationRefusal::Numeric);
            *health |= Health::NUMERIC;
            return;
        }
        if let Some(measured) = measured {
            self.last_measured_tick = self.tick;
            *nis = measured.nis;
            self.innovation = measured.innovation;
            if measured.rejected {
                *health |= Health::INNOVATION_REJECTED;
            } else {
                self.compensation = Compensation::new(&self.parameters);
                self.sigma = filter.parameter_sigmas();
                self.expected_nis = filter.expected_nis();
                if let (Some(found), Some((estimates, compensation))) = (further, &mut self.further)
                {
                    *estimates = found;
                    compensation.set(&found.value);
                }
                self.revision = self.revision.saturating_add(1);
            }
            if let Some(continuity) = &mut self.continuity {
                let force_mps2 = force_change_mps2(&before, &self.parameters);
                continuity.corrected(measured.turned_rad, force_mps2);
            }
            if measured.recovery_started
                && self.tick - self.disturbed_tick > explains_ticks
                && after_move
            {
                // The errors that contradict the measurements may be older than the checkpoint.
                self.unrepaired = self.unrepaired.saturating_add(1);
            }
            self.nis_running += (measured.nis - self.nis_running) / NIS_MEMORY;
        } else if aiding.is_some() {
            *health |= Health::NUMERIC;
        }
        if self.tick - self.last_measured_tick > period_ticks {
            *health |= Health::AIDING_LOST;
        }
        if filter.is_recovering() {
            *health |= Health::RECOVERING;
        }
        if filter.drift().is_some_and(DriftTest::is_found) {
            *health |= Health::DRIFTING;
        }
        if self.nis_running > kalman.refuse_above_mean_nis
            && self.nis_running > nis_limit(filter, kalman)
        {
            *health |= Health::INCONSISTENT;
        }
        self.compare_turns(sample, health);
    }
}

/// Largest change of the compensated specific force by a change of the accelerometers' parameters, m/s².
fn force_change_mps2(before: &Parameters, after: &Parameters) -> f64 {
    let (before, after) = (before.to_array(), after.to_array());
    let changed = |group: ParameterGroup| {
        group.range().fold(0.0f64, |most, i| most.max((after[i] - before[i]).abs()))
    };
    changed(ParameterGroup::AccelBias)
        + GRAVITY_MPS2
            * (changed(ParameterGroup::AccelScale) + changed(ParameterGroup::AccelMisalignment))
}
