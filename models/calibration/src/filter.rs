//! The calibration filter: 39-state error-state Kalman filter, closed loop.
//!
//! The transition is accumulated in sub-steps of at most 50 ms and the covariance is propagated
//! when a measurement is due. Every estimate is fed back at once, so that the error states are zero
//! between measurements.

mod checkpoint;
mod further;
mod known_motion;
mod measurement;
mod noise;
mod oscillator;
mod passage;
mod recovery;
mod solution;
mod sub_step;
mod sway;

pub use further::{
    ANGLE_GATE_NIS, AngleResult, AngleRows, AngleTally, CaseTurn, ExpectedNis, FURTHER_ROW,
    FurtherEffects, FurtherRow, angle_rows,
};
pub use measurement::MeasurementResult;
pub use noise::{add_bias_walk, add_process_noise};
pub use passage::Passage;
pub use sub_step::{SensorIntegrals, sub_step_samples};

use crate::config::{
    AidingMode, Base, ErrorModel, Gate, Kalman, Noise, Screening, Site, SwayNoise,
};
use crate::covariance::{Covariance, DR, DV, PARAMETERS, PHI, STATE_COUNT, Transition};
use crate::drift::{DriftTest, DriftWeights};
use crate::error_model::MotionInterval;
use crate::further::FurtherEstimates;
use crate::screen::ACCELEROMETERS;
use crate::strapdown::Strapdown;
use checkpoint::Checkpoint;
use further::FurtherStates;
use known_motion::KnownMotion;
use nalgebra::{Matrix3, Vector3};
use octant_earth::rotation::exp;
use octant_sample::Parameters;
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};
use sub_step::SubStep;
use sway::SwayStates;

/// Counts over the whole calibration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Tally {
    /// Measurements used.
    pub used: u64,
    /// Measurements rejected by the gate.
    pub rejected: u64,
    /// Sum of NIS over the measurements used.
    pub nis_sum: f64,
    /// Recoveries.
    pub recoveries: u32,
    /// Measurements used while a recovery held the parameters.
    pub held: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
enum Stage {
    Normal,
    /// End of the stage, s of filter time.
    Capture(f64),
    Settle(f64),
}

/// The filter.
#[derive(Clone, Debug)]
pub struct CalibrationFilter {
    model: ErrorModel,
    aiding: AidingMode,
    /// Position of the instrument during the calibration.
    site: Site,
    gate: Option<Gate>,
    gyro_variance_per_s: f64,
    accel_variance_per_s: f64,
    /// Growth of the gyro biases' variance by their random walk, (rad/s)²/s; 0: none.
    walk_variance_per_s: f64,
    covariance: Covariance,
    transition: Transition,
    sub_step: SubStep,
    /// No part of a stored state: a smoother follows a filter from its start.
    passage: Passage,
    /// Known motion at rest, for noisy sensors. No part of the filter's stored state but one beside it, as
    /// [`Self::further_part`].
    known_motion: Option<KnownMotion>,
    /// Time and velocity change by specific force in n since the last propagation.
    elapsed_s: f64,
    force_sum: Vector3<f64>,
    time_s: f64,
    /// Closed sub-steps since the last call of [`Self::take_turned`].
    turned: SensorIntegrals,
    rejected_in_a_row: u32,
    stage: Stage,
    /// True if the recovery is of velocity and position alone: the gyros' turn had no edge.
    keeps_attitude: bool,
    tally: Tally,
    drift: Option<DriftTest>,
    /// States of the base's sway; `None`: none, or white noise of the reference.
    sway: Option<SwayStates>,
    /// States beside the 39, if any group of them is on.
    further: Option<FurtherStates>,
    /// The older and the newer checkpoint.
    checkpoints: Option<[Checkpoint; 2]>,
}

#[cfg(feature = "state")]
octant_state::state! {
    CalibrationFilter {
        values: elapsed_s, force_sum, time_s, turned, rejected_in_a_row, stage, keeps_attitude, tally;
        parts: covariance, transition, sub_step, drift, sway, checkpoints;
        kept: model, aiding, site, gate, gyro_variance_per_s, accel_variance_per_s,
            walk_variance_per_s, further, passage, known_motion;
        check: Self::check_counts
    }
}

#[cfg(feature = "state")]
impl CalibrationFilter {
    fn check_counts(&self) -> Result<(), octant_state::StateError> {
        let Tally { used, rejected, nis_sum: _, recoveries, held } = self.tally;
        octant_state::check_count("tally.used", used)?;
        octant_state::check_count("tally.rejected", rejected)?;
        octant_state::check_count("tally.recoveries", recoveries.into())?;
        octant_state::check_below("tally.held", held, used)
    }
}

/// Initial standard deviations of all states.
#[must_use]
pub fn prior_sigmas(kalman: &Kalman) -> [f64; STATE_COUNT] {
    let mut sigmas = [0.0; STATE_COUNT];
    for axis in 0..3 {
        sigmas[PHI + axis] = kalman.prior.attitude_rad[axis];
        sigmas[DV + axis] = kalman.prior.velocity_mps;
        sigmas[DR + axis] = kalman.prior.position_m;
    }
    for group in ParameterGroup::ALL {
        if kalman.estimated[group as usize] {
            sigmas[PARAMETERS..][group.range()].fill(kalman.prior.of(group));
        }
    }
    sigmas
}

impl CalibrationFilter {
    /// Makes a filter with its prior.
    #[must_use]
    pub fn new(
        kalman: &Kalman,
        site: &Site,
        noise: &Noise,
        screening: &Screening,
        initial: &Parameters,
        sample_period_ns: u64,
    ) -> Self {
        let covariance = Covariance::from_sigmas(&prior_sigmas(kalman));
        // A filter without a group of parameters attributes them to the others, which then aren't
        // constant: by design, and not by a fault of the sensors.
        // The same holds for gyro biases that walk.
        let walk = kalman.further.gyro_rate_random_walk;
        let drift = match screening.drift_sigmas {
            Some(limit) if kalman.estimated == [true; 7] && walk == 0.0 => {
                let weights = match screening.base {
                    Base::Still => DriftWeights::Likelihood,
                    Base::Moving(_) => DriftWeights::Own,
                };
                Some(DriftTest::new(limit, weights, &covariance))
            }
            _ => None,
        };
        let start =
            Checkpoint { time_s: 0.0, parameters: *initial, covariance: covariance.clone() };
        Self {
            model: kalman.error_model,
            aiding: kalman.aiding,
            site: *site,
            gate: screening.gate,
            gyro_variance_per_s: noise.angle_random_walk * noise.angle_random_walk,
            accel_variance_per_s: noise.velocity_random_walk * noise.velocity_random_walk,
            walk_variance_per_s: walk * walk,
            covariance,
            transition: Transition::identity(),
            passage: Passage::new(),
            known_motion: KnownMotion::new(kalman, noise, screening),
            sub_step: SubStep::new(sub_step_samples(sample_period_ns, kalman.aiding_period_ns)),
            elapsed_s: 0.0,
            force_sum: Vector3::zeros(),
            time_s: 0.0,
            turned: SensorIntegrals::default(),
            rejected_in_a_row: 0,
            stage: Stage::Normal,
            keeps_attitude: false,
            tally: Tally::default(),
            drift,
            sway: match kalman.sway {
                SwayNoise::White => None,
                SwayNoise::Coloured => Some(SwayStates::new(kalman.aiding_period_ns as f64 * 1e-9)),
            },
            further: FurtherStates::new(kalman, screening.checkpoints),
            checkpoints: screening.checkpoints.then(|| [start.clone(), start]),
        }
    }

    /// Changes the gate, the standard deviation of the reference and the limit of the drift.
    pub(crate) fn tune(&mut self, kalman: &Kalman, screening: &Screening) {
        self.aiding = kalman.aiding;
        self.gate = screening.gate;
        if let (Some(drift), Some(limit)) = (&mut self.drift, screening.drift_sigmas) {
            drift.tune(limit);
        }
    }

    /// Takes T − T₀, K: the departure of the temperature from the one at which the parameters are as they are
    /// estimated. It holds until the next call.
    #[inline]
    pub fn feel(&mut self, warmth_k: f64) {
        if let Some(further) = &mut self.further {
            further.feel(warmth_k);
        }
    }

    /// Tells whether the gimbals rest, as far as the core knows: it holds until the next call.
    #[inline]
    pub fn rest(&mut self, gimbals_rest: bool) {
        if let Some(known) = &mut self.known_motion {
            known.gimbals_rest = gimbals_rest;
        }
    }

    /// Takes an interval that the strapdown has just integrated.
    #[inline]
    pub fn accumulate(
        &mut self,
        strapdown: &Strapdown,
        dtheta: &Vector3<f64>,
        dv: &Vector3<f64>,
        interval_s: f64,
    ) {
        if let Some(further) = &mut self.further {
            further.accumulate(dtheta, dv, interval_s);
        }
        let step = &mut self.sub_step;
        step.delta_theta += dtheta;
        step.delta_velocity += dv;
        step.delta_velocity_n += strapdown.delta_velocity_n();
        step.elapsed_s += interval_s;
        step.samples += 1;
        if step.samples == step.samples_max.div_ceil(2) {
            step.c_middle = strapdown.c_nb();
            if step.samples_max % 2 == 1 {
                // The middle of the sub-step is that of this sample, which turned the body by dtheta.
                step.c_middle *= exp(&(dtheta * -0.5)).to_rotation_matrix().matrix();
            }
        }
        if step.samples >= step.samples_max {
            self.close_sub_step(strapdown);
        }
    }

    /// Marks these channels as replaced by known motion in the next interval.
    pub fn bridge(&mut self, channels: u8) {
        self.sub_step.bridged |= channels;
    }

    /// Adds variance to attitude (n, rad²) and velocity (n, (m/s)²), which are less certain from
    /// now on than the noise implies.
    pub fn disturb(
        &mut self,
        strapdown: &Strapdown,
        attitude: &Matrix3<f64>,
        velocity: &Matrix3<f64>,
    ) {
        self.propagate(strapdown);
        for i in 0..3 {
            for j in i..3 {
                self.covariance.add(PHI + i, PHI + j, attitude[(i, j)]);
                self.covariance.add(DV + i, DV + j, velocity[(i, j)]);
            }
        }
    }

    fn close_sub_step(&mut self, strapdown: &Strapdown) {
        let fresh = SubStep::new(self.sub_step.samples_max);
        let step = core::mem::replace(&mut self.sub_step, fresh);
        if step.samples == 0 {
            return;
        }
        let c_nb = if step.samples < step.samples_max.div_ceil(2) {
            strapdown.c_nb()
        } else {
            step.c_middle
        };
        let mut interval = MotionInterval {
            interval_s: step.elapsed_s,
            c_nb,
            delta_theta: step.delta_theta,
            delta_velocity: step.delta_velocity,
            delta_velocity_n: step.delta_velocity_n,
            velocity_mps: *strapdown.velocity_mps(),
        };
        let used = |channel: u8| step.bridged & (1 << channel) == 0;
        let gyros_used = [used(0), used(1), used(2)];
        let accelerometers_used = step.bridged & ACCELEROMETERS == 0;
        let earth = strapdown.earth();
        if let Some(known) = &mut self.known_motion {
            known.replace_measured(&mut interval, earth);
        }
        if step.bridged == 0 {
            self.transition.advance(self.model, &interval, earth);
        } else {
            let transition = &mut self.transition;
            let model = self.model;
            transition.advance_bridged(model, &interval, earth, gyros_used, accelerometers_used);
        }
        if let Some(further) = &mut self.further {
            further.advance(self.model, &interval, earth, gyros_used, accelerometers_used);
        }
        self.elapsed_s += step.elapsed_s;
        self.force_sum += step.delta_velocity_n;
        self.turned.add(&step.turned());
    }

    /// Returns the integrals of the sensors since the last call.
    pub fn take_turned(&mut self) -> SensorIntegrals {
        let open = self.sub_step.turned();
        let mut turned = core::mem::take(&mut self.turned);
        turned.add(&open);
        // The next call returns the whole of the open sub-step, less the part returned now.
        self.turned.delta_theta = -open.delta_theta;
        self.turned.delta_velocity_n = -open.delta_velocity_n;
        self.turned.elapsed_s = -open.elapsed_s;
        turned
    }

    /// Propagates the covariance to the present.
    pub fn propagate(&mut self, strapdown: &Strapdown) {
        self.close_sub_step(strapdown);
        if self.elapsed_s == 0.0 {
            return;
        }
        if let Some(sway) = &mut self.sway {
            sway.propagate(&self.transition, self.elapsed_s);
        }
        self.covariance.propagate(&self.transition);
        if let Some(further) = &mut self.further {
            further.propagate(&self.transition, self.elapsed_s, &mut self.covariance);
        }
        if self.walk_variance_per_s > 0.0 {
            let variance = self.walk_variance_per_s * self.elapsed_s;
            add_bias_walk(&mut self.covariance, variance, &self.transition);
        }
        add_process_noise(
            &mut self.covariance,
            (self.gyro_variance_per_s, self.accel_variance_per_s),
            self.elapsed_s,
            &self.force_sum,
        );
        self.time_s += self.elapsed_s;
        self.passage.go_on(&self.transition);
        self.transition = Transition::identity();
        self.elapsed_s = 0.0;
        self.force_sum = Vector3::zeros();
        self.advance_recovery();
    }

    /// Tells the sway what navigation shows when a reference came: heading of the case, rad. `None`:
    /// no reference came.
    pub fn learn_sway(&mut self, heading_rad: Option<f64>, strapdown: &Strapdown) {
        match (&mut self.sway, heading_rad) {
            (Some(sway), Some(heading_rad)) => sway.learn(heading_rad, strapdown.velocity_mps()),
            (Some(sway), None) => sway.miss(),
            (None, _) => {}
        }
    }

    /// Returns whether the filter has states of the base's sway.
    #[must_use]
    pub fn has_sway(&self) -> bool {
        self.sway.is_some()
    }

    /// Estimates of the further states; `None` if all of them are off.
    #[must_use]
    pub fn further(&self) -> Option<FurtherEstimates> {
        self.further.as_ref().map(FurtherStates::estimates)
    }

    /// Mean NIS that is expected of this run; `None` where no further state is considered, and 3 is.
    #[must_use]
    pub fn expected_nis(&self) -> Option<ExpectedNis> {
        self.further.as_ref().and_then(FurtherStates::expected_nis)
    }

    /// Mean NIS that is expected of a run in which the considered states have these values, in units of their σ and in the
    /// order of the border.
    #[cfg(feature = "state")]
    #[must_use]
    pub fn expected_nis_of(&self, values: &[f64]) -> Option<f64> {
        self.further.as_ref().and_then(|further| further.expected_nis_of(values))
    }

    /// Counts of the gimbal angles as measurements; `None` where they are none.
    #[must_use]
    pub fn angle_tally(&self) -> Option<&AngleTally> {
        self.further.as_ref().and_then(FurtherStates::angle_tally)
    }

    /// Contradiction to a case at rest, with the number of slips that the screens noticed; `None` if there is none.
    #[must_use]
    pub fn case_turn(&self, slips: u64) -> Option<CaseTurn> {
        self.further.as_ref().and_then(|further| further.case_turn(slips))
    }

    /// The further states as a part of a stored state. They are no part of [`Self`] there, so that
    /// the bytes of a filter without them are those of a program that had none.
    #[cfg(feature = "state")]
    pub(crate) fn further_part(&self) -> Option<&impl octant_state::State> {
        self.further.as_ref()
    }

    /// [`Self::further_part`], to be changed.
    #[cfg(feature = "state")]
    pub(crate) fn further_part_mut(&mut self) -> Option<&mut impl octant_state::State> {
        self.further.as_mut()
    }

    /// The known motion as a part of a stored state, beside the filter: [`Self::further_part`].
    #[cfg(feature = "state")]
    pub(crate) fn known_motion_part(&self) -> Option<&impl octant_state::State> {
        self.known_motion.as_ref()
    }

    /// [`Self::known_motion_part`], to be changed.
    #[cfg(feature = "state")]
    pub(crate) fn known_motion_part_mut(&mut self) -> Option<&mut impl octant_state::State> {
        self.known_motion.as_mut()
    }

    /// Returns whether every number of the covariance and the further states is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.covariance.is_finite() && self.further.as_ref().is_none_or(FurtherStates::is_finite)
    }

    /// Error covariance of all states after the last propagation and measurement.
    #[must_use]
    pub fn covariance(&self) -> &Covariance {
        &self.covariance
    }

    /// Standard deviations of the parameters.
    #[must_use]
    pub fn parameter_sigmas(&self) -> [f64; PARAMETER_COUNT] {
        core::array::from_fn(|i| self.covariance.sigma(PARAMETERS + i))
    }

    /// Transition of the errors up to the last measurement that was used.
    #[must_use]
    pub fn passage(&self) -> &Passage {
        &self.passage
    }

    /// Counts since the start.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Time since the filter began to measure, at its last propagation, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Drift test, if there is one.
    #[must_use]
    pub fn drift(&self) -> Option<&DriftTest> {
        self.drift.as_ref()
    }

    /// Compares the parameters at the end of the calibration in the drift test.
    pub fn finish_drift(&mut self, parameters: &Parameters) {
        if let Some(drift) = &mut self.drift {
            drift.finish(self.time_s, parameters, &self.covariance);
        }
    }

    /// Returns whether a recovery is under way: the parameters are held.
    #[must_use]
    pub fn is_recovering(&self) -> bool {
        self.stage != Stage::Normal
    }
}
