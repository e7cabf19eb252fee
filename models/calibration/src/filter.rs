//! The calibration filter: 39-state error-state Kalman filter, closed loop.
//!
//! The transition is accumulated in sub-steps of at most 50 ms and the covariance is propagated
//! when a measurement is due. Every estimate is fed back at once, so the error states are zero
//! between measurements.

use crate::config::{AidingMode, ErrorModel, Gate, Kalman, Noise, Recovery, Screening, Site};
use crate::continuity::Edge;
use crate::covariance::{Covariance, DR, DV, PARAMETERS, PHI, STATE_COUNT, Transition};
use crate::drift::Drift;
use crate::error_model::{Interval, computer_frame_error};
use crate::screen::ACCELEROMETERS;
use crate::strapdown::Strapdown;
use nalgebra::{Matrix3, Vector3};
use octant_sample::parameters::{Group, PARAMETER_COUNT};
use octant_sample::{Parameters, Reference};

/// Longest sub-step of the transition, ns.
const SUB_STEP_MAX_NS: u64 = 50_000_000;

/// First stage of the widening recovery: attitude and velocity find their feet, and the gate doesn't
/// reject but opens them again: so long has to pass without that, s.
const CAPTURE_S: f64 = 10.0;
/// Second stage: the attitude settles, the parameters are considered but not estimated, s.
const SETTLE_S: f64 = 120.0;
/// σ with which the second stage starts: what linearization errors of the first can have left.
const SETTLE_ATTITUDE_RAD: [f64; 3] = [6e-4, 6e-4, 3e-3];
/// σ of velocity and position with which the second stage starts, m/s and m.
const SETTLE_VELOCITY_MPS: f64 = 0.1;
const RECOVERY_POSITION_M: f64 = 10.0;
/// Smallest σ of the attitude in the first stage, rad: 600″.
const CAPTURE_ATTITUDE_RAD: f64 = 2.9e-3;
/// Smallest σ of azimuth there, rad: 3°. An azimuth error shows only through Earth rate: by the time
/// that it opens the gate it may be of any size, and the innovation doesn't say.
const CAPTURE_AZIMUTH_RAD: f64 = 0.052;
/// σ of an attitude that a disturbance of the accelerometers left as it was, rad: 50″, more than what one
/// measurement that the gate lets through makes of it.
const KEPT_ATTITUDE_RAD: f64 = 2.4e-4;

/// Largest σ of velocity, m/s, and position, m, in the first stage: a reference that is farther off
/// is not followed.
const CAPTURE_VELOCITY_MAX_MPS: f64 = 1e4;
const CAPTURE_POSITION_MAX_M: f64 = 1e6;

/// Age between which a checkpoint is gone back to, s: no less than the first, no more than twice. A
/// fault opens the gate within seconds, or within a minute or so where it grows slowly; what was
/// learned in two minutes is soon learned again.
const CHECKPOINT_S: f64 = 60.0;

/// What came of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Normalized innovation squared over three axes: 3 in the mean.
    pub nis: f64,
    /// The gate kept it out.
    pub rejected: bool,
    /// It started a recovery.
    pub recovery_started: bool,
    /// Angle by which it turned the attitude, rad.
    pub turned_rad: f64,
}

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
    /// Until these seconds of filter time.
    Capture(f64),
    Settle(f64),
}

/// Parameters and covariance of an earlier time.
#[derive(Clone, Debug)]
struct Checkpoint {
    time_s: f64,
    parameters: Parameters,
    covariance: Covariance,
}

#[cfg(feature = "state")]
octant_state::state! {
    Checkpoint { values: time_s, parameters; parts: covariance; kept: }
}

/// The filter.
#[derive(Clone, Debug)]
pub struct CalibrationFilter {
    model: ErrorModel,
    aiding: AidingMode,
    /// Where the instrument stands during the calibration.
    site: Site,
    gate: Option<Gate>,
    gyro_variance_per_s: f64,
    accel_variance_per_s: f64,
    covariance: Covariance,
    transition: Transition,
    sub_step: SubStep,
    /// Since the last propagation: time and velocity change by specific force in n.
    elapsed_s: f64,
    force_sum: Vector3<f64>,
    time_s: f64,
    /// Of closed sub-steps since the last account of them: see [`Self::take_turned`].
    turned: Turned,
    rejected_in_a_row: u32,
    stage: Stage,
    /// The recovery is of velocity and position alone: the gyros' turn never broke off.
    keeps_attitude: bool,
    tally: Tally,
    drift: Option<Drift>,
    /// The older one and the newer one.
    checkpoints: Option<[Checkpoint; 2]>,
}

#[cfg(feature = "state")]
octant_state::state! {
    CalibrationFilter {
        values: elapsed_s, force_sum, time_s, turned, rejected_in_a_row, stage, keeps_attitude, tally;
        parts: covariance, transition, sub_step, drift, checkpoints;
        kept: model, aiding, site, gate, gyro_variance_per_s, accel_variance_per_s;
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

/// What the sensors felt over a while: increments of the gyros (b, rad), change of velocity by specific
/// force (n, m/s), and how long it was, s.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Turned {
    /// Increments of the gyros, compensated, in b, rad.
    pub delta_theta: Vector3<f64>,
    /// Change of velocity by specific force in n, m/s.
    pub delta_velocity_n: Vector3<f64>,
    /// Duration, s.
    pub elapsed_s: f64,
    /// Channels that were bridged somewhere in it, as bits.
    pub bridged: u8,
}

impl Turned {
    fn add(&mut self, other: &Self) {
        self.delta_theta += other.delta_theta;
        self.delta_velocity_n += other.delta_velocity_n;
        self.elapsed_s += other.elapsed_s;
        self.bridged |= other.bridged;
    }
}

/// Sums over the samples of one sub-step.
#[derive(Clone, Debug)]
struct SubStep {
    samples_max: u32,
    samples: u32,
    elapsed_s: f64,
    c_middle: Matrix3<f64>,
    delta_theta: Vector3<f64>,
    delta_velocity: Vector3<f64>,
    delta_velocity_n: Vector3<f64>,
    /// Channels that were bridged somewhere in it, as bits.
    bridged: u8,
}

#[cfg(feature = "state")]
octant_state::state! {
    SubStep {
        values: samples, elapsed_s, c_middle, delta_theta, delta_velocity, delta_velocity_n,
            bridged;
        parts: ;
        kept: samples_max;
        check: Self::check_samples
    }
}

#[cfg(feature = "state")]
impl SubStep {
    fn check_samples(&self) -> Result<(), octant_state::StateError> {
        octant_state::check_below("samples", self.samples.into(), self.samples_max.into())
    }
}

impl SubStep {
    fn turned(&self) -> Turned {
        Turned {
            delta_theta: self.delta_theta,
            delta_velocity_n: self.delta_velocity_n,
            elapsed_s: self.elapsed_s,
            bridged: self.bridged,
        }
    }

    fn new(samples_max: u32) -> Self {
        Self {
            samples_max,
            samples: 0,
            elapsed_s: 0.0,
            c_middle: Matrix3::identity(),
            delta_theta: Vector3::zeros(),
            delta_velocity: Vector3::zeros(),
            delta_velocity_n: Vector3::zeros(),
            bridged: 0,
        }
    }
}

/// Standard deviations of all states at the start.
#[must_use]
pub fn prior_sigmas(kalman: &Kalman) -> [f64; STATE_COUNT] {
    let mut sigmas = [0.0; STATE_COUNT];
    for axis in 0..3 {
        sigmas[PHI + axis] = kalman.prior.attitude_rad[axis];
        sigmas[DV + axis] = kalman.prior.velocity_mps;
        sigmas[DR + axis] = kalman.prior.position_m;
    }
    for group in Group::ALL {
        if kalman.estimated[group as usize] {
            sigmas[PARAMETERS..][group.range()].fill(kalman.prior.of(group));
        }
    }
    sigmas
}

/// Samples of a sub-step: as many as fit into 50 ms and divide the period.
#[must_use]
pub fn sub_step_samples(sample_period_ns: u64, period_ns: u64) -> u32 {
    let in_period = (period_ns / sample_period_ns.max(1)).max(1);
    let mut samples = (SUB_STEP_MAX_NS / sample_period_ns.max(1)).clamp(1, in_period);
    while !in_period.is_multiple_of(samples) {
        samples -= 1;
    }
    samples as u32
}

/// Adds the process noise of white gyro and accelerometer noise over `elapsed_s`, in which the
/// specific force in n integrates to `force_sum` (m/s).
pub fn add_process_noise(
    covariance: &mut Covariance,
    noise: (f64, f64),
    elapsed_s: f64,
    force_sum: &Vector3<f64>,
) {
    let (gyro, accel) = (noise.0 * elapsed_s, noise.1 * elapsed_s);
    // δv̇ = f × φ: with a constant f the velocity takes up half of f T times the noise of φ, and a
    // third of its square.
    let f = octant_earth::rotation::skew(force_sum);
    let cross = f * (0.5 * gyro);
    let square = f * f.transpose() * (gyro / 3.0);
    for i in 0..3 {
        covariance.add(PHI + i, PHI + i, gyro);
        covariance.add(DV + i, DV + i, accel);
        for j in 0..3 {
            covariance.add(DV + i, PHI + j, cross[(i, j)]);
            if j >= i {
                covariance.add(DV + i, DV + j, square[(i, j)]);
            }
        }
    }
}

impl CalibrationFilter {
    /// A filter with its prior.
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
        // A filter that leaves a group of parameters out sees it in the others, which then don't
        // stand still: by design, and no fault of the sensors.
        let drift = match screening.drift_sigmas {
            Some(limit) if kalman.estimated == [true; 7] => Some(Drift::new(limit, &covariance)),
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
            covariance,
            transition: Transition::identity(),
            sub_step: SubStep::new(sub_step_samples(sample_period_ns, kalman.aiding_period_ns)),
            elapsed_s: 0.0,
            force_sum: Vector3::zeros(),
            time_s: 0.0,
            turned: Turned::default(),
            rejected_in_a_row: 0,
            stage: Stage::Normal,
            keeps_attitude: false,
            tally: Tally::default(),
            drift,
            checkpoints: screening.checkpoints.then(|| [start.clone(), start]),
        }
    }

    /// Takes in one interval that the strapdown has just integrated.
    #[inline]
    pub fn accumulate(
        &mut self,
        strapdown: &Strapdown,
        dtheta: &Vector3<f64>,
        dv: &Vector3<f64>,
        interval_s: f64,
    ) {
        let step = &mut self.sub_step;
        step.delta_theta += dtheta;
        step.delta_velocity += dv;
        step.delta_velocity_n += strapdown.delta_velocity_n();
        step.elapsed_s += interval_s;
        step.samples += 1;
        if step.samples == step.samples_max.div_ceil(2) {
            step.c_middle = strapdown.c_nb();
        }
        if step.samples >= step.samples_max {
            self.close_sub_step(strapdown);
        }
    }

    /// The next interval takes what is known of the motion in place of these channels' counts.
    pub fn bridge(&mut self, channels: u8) {
        self.sub_step.bridged |= channels;
    }

    /// Attitude (n, rad²) and velocity (n, (m/s)²) are less sure than the noise says, from now on.
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

    /// The attitude may be off by more than its linear error model bears: until it has settled, the
    /// parameters are held.
    pub fn hold(&mut self) {
        self.keeps_attitude = false;
        self.stage = Stage::Capture(self.time_s + CAPTURE_S);
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
        let interval = Interval {
            interval_s: step.elapsed_s,
            c_nb,
            delta_theta: step.delta_theta,
            delta_velocity: step.delta_velocity,
            delta_velocity_n: step.delta_velocity_n,
            velocity_mps: *strapdown.velocity_mps(),
        };
        if step.bridged == 0 {
            self.transition.advance(self.model, &interval, strapdown.earth());
        } else {
            let used = |channel: u8| step.bridged & (1 << channel) == 0;
            self.transition.advance_bridged(
                self.model,
                &interval,
                strapdown.earth(),
                [used(0), used(1), used(2)],
                step.bridged & ACCELEROMETERS == 0,
            );
        }
        self.elapsed_s += step.elapsed_s;
        self.force_sum += step.delta_velocity_n;
        self.turned.add(&step.turned());
    }

    /// What was felt since this was last asked for.
    pub fn take_turned(&mut self) -> Turned {
        let open = self.sub_step.turned();
        let mut turned = core::mem::take(&mut self.turned);
        turned.add(&open);
        // The next one gets the whole of the sub-step that is open.
        self.turned.delta_theta = -open.delta_theta;
        self.turned.delta_velocity_n = -open.delta_velocity_n;
        self.turned.elapsed_s = -open.elapsed_s;
        turned
    }

    /// Something is wrong with the increments of the last seconds: what was learned from them is
    /// undone, and attitude and velocity are open again. `false`: the configuration has no such
    /// recovery.
    ///
    /// Where the gyros' turn didn't break off the attitude stays within a minute of arc of what it is: taken
    /// for a tilt, an acceleration that isn't there would carry the azimuth off by degrees.
    pub fn suspect(
        &mut self,
        edge: Edge,
        strapdown: &mut Strapdown,
        parameters: &mut Parameters,
    ) -> bool {
        let Some(gate @ Gate { recovery: Recovery::Widening, .. }) = self.gate else {
            return false;
        };
        if self.checkpoints.is_none() {
            return false;
        }
        self.propagate(strapdown);
        if self.stage == Stage::Normal {
            self.go_back(parameters);
            self.tally.recoveries = self.tally.recoveries.saturating_add(1);
            self.keeps_attitude = true;
        }
        self.keeps_attitude &= edge == Edge::Velocity;
        self.rejected_in_a_row = 0;
        self.open_wide(&gate, &Vector3::zeros(), strapdown);
        true
    }

    /// Brings the covariance to the present.
    pub fn propagate(&mut self, strapdown: &Strapdown) {
        self.close_sub_step(strapdown);
        if self.elapsed_s == 0.0 {
            return;
        }
        self.covariance.propagate(&self.transition);
        add_process_noise(
            &mut self.covariance,
            (self.gyro_variance_per_s, self.accel_variance_per_s),
            self.elapsed_s,
            &self.force_sum,
        );
        self.time_s += self.elapsed_s;
        self.transition = Transition::identity();
        self.elapsed_s = 0.0;
        self.force_sum = Vector3::zeros();
        self.advance_recovery();
    }

    /// Uses a reference: gate, update, feedback into navigation and parameters.
    ///
    /// `None` when the reference is not of the kind that the filter is tuned for, or not finite.
    /// In psi-angle form a velocity reference is taken as δv without its difference δθ × v between
    /// the forms, which is below 1e-7 m/s for a moored ship.
    pub fn measure(
        &mut self,
        reference: &Reference,
        strapdown: &mut Strapdown,
        parameters: &mut Parameters,
    ) -> Option<Measured> {
        let (first, sigma, error) = self.error_against(reference, strapdown)?;
        let r = sigma * sigma;
        let nis = self.nis(first, r, &error)?;

        let mut recovery_started = false;
        if let Some(gate) = self.gate
            && nis > gate.nis
        {
            if gate.recovery == Recovery::Widening && !self.is_plausible(&error) {
                self.tally.rejected += 1;
                return Some(Measured { nis, rejected: true, recovery_started, turned_rad: 0.0 });
            }
            if matches!(self.stage, Stage::Capture(_)) {
                // What started it still lasts, or one opening was not wide enough.
                self.open_wide(&gate, &error, strapdown);
            } else {
                self.rejected_in_a_row = self.rejected_in_a_row.saturating_add(1);
                if self.rejected_in_a_row < gate.rejections {
                    self.tally.rejected += 1;
                    return Some(Measured {
                        nis,
                        rejected: true,
                        recovery_started,
                        turned_rad: 0.0,
                    });
                }
                self.go_back(parameters);
                self.start_recovery(&gate, &error, strapdown);
                recovery_started = true;
            }
        }
        self.rejected_in_a_row = 0;

        let mut x = [0.0; STATE_COUNT];
        let held = self.stage != Stage::Normal;
        for axis in 0..3 {
            let innovation = error[axis] - x[first + axis];
            if held {
                self.covariance.update_moving(first + axis, r, innovation, &mut x);
            } else {
                self.covariance.update(first + axis, r, innovation, &mut x);
            }
        }
        let turned_rad = self.feed_back(&x, strapdown, parameters);
        self.tally.used += 1;
        if held {
            self.tally.held += 1;
        } else {
            self.tally.nis_sum += nis;
            self.remember(parameters);
            if let Some(drift) = &mut self.drift {
                drift.watch(self.time_s, parameters, &self.covariance);
            }
        }
        Some(Measured { nis, rejected: false, recovery_started, turned_rad })
    }

    /// First state, standard deviation and error (computed − reference) of a measurement.
    fn error_against(
        &self,
        reference: &Reference,
        strapdown: &Strapdown,
    ) -> Option<(usize, f64, Vector3<f64>)> {
        let found = match (reference, self.aiding) {
            (Reference::Velocity(velocity), AidingMode::Velocity { sigma_mps }) => {
                (DV, sigma_mps, strapdown.velocity_mps() - Vector3::from(*velocity))
            }
            (
                Reference::Position { latitude_rad, longitude_rad, height_m },
                AidingMode::Position { sigma_m },
            ) => {
                let (earth, navigation) = (strapdown.earth(), strapdown.navigation());
                let error = Vector3::new(
                    (navigation.latitude_rad - latitude_rad) * earth.meridian_radius_m,
                    (navigation.longitude_rad - longitude_rad)
                        * (earth.transverse_radius_m * earth.cos_latitude),
                    height_m - navigation.height_m,
                );
                (DR, sigma_m, error)
            }
            _ => return None,
        };
        found.2.iter().all(|value| value.is_finite()).then_some(found)
    }

    /// A reference so far off is no reference, and nothing to recover towards.
    fn is_plausible(&self, error: &Vector3<f64>) -> bool {
        error.norm()
            <= match self.aiding {
                AidingMode::Velocity { .. } => CAPTURE_VELOCITY_MAX_MPS,
                AidingMode::Position { .. } => CAPTURE_POSITION_MAX_M,
            }
    }

    fn nis(&self, first: usize, r: f64, error: &Vector3<f64>) -> Option<f64> {
        let s = Matrix3::from_fn(|i, j| {
            self.covariance.at(first + i, first + j) + if i == j { r } else { 0.0 }
        });
        let nis = error.dot(&(s.try_inverse()? * error));
        nis.is_finite().then_some(nis)
    }

    fn feed_back(
        &self,
        x: &[f64; STATE_COUNT],
        strapdown: &mut Strapdown,
        parameters: &mut Parameters,
    ) -> f64 {
        let at = |i: usize| Vector3::new(x[i], x[i + 1], x[i + 2]);
        let (mut phi, mut dv, dr) = (at(PHI), at(DV), at(DR));
        if self.model == ErrorModel::Psi {
            let frame = computer_frame_error(&dr, strapdown.earth());
            phi += frame;
            dv -= frame.cross(strapdown.velocity_mps());
        }
        strapdown.correct(&phi, &dv, &dr);
        let mut all = parameters.to_array();
        for (value, change) in all.iter_mut().zip(&x[PARAMETERS..]) {
            *value += change;
        }
        *parameters = Parameters::from_array(&all);
        phi.norm()
    }

    /// Keeps the parameters of one to two minutes ago.
    fn remember(&mut self, parameters: &Parameters) {
        let Some([older, newer]) = &mut self.checkpoints else { return };
        if self.time_s - newer.time_s >= CHECKPOINT_S {
            core::mem::swap(older, newer);
            newer.time_s = self.time_s;
            newer.parameters = *parameters;
            newer.covariance.clone_from(&self.covariance);
        }
    }

    /// What leaked into the parameters before the gate shut is undone.
    fn go_back(&mut self, parameters: &mut Parameters) {
        let Some([older, newer]) = &mut self.checkpoints else { return };
        newer.clone_from(older);
        *parameters = older.parameters;
        self.covariance.clone_from(&older.covariance);
        if let Some(drift) = &mut self.drift {
            drift.go_back(older.time_s);
        }
    }

    fn start_recovery(&mut self, gate: &Gate, error: &Vector3<f64>, strapdown: &mut Strapdown) {
        self.tally.recoveries += 1;
        self.keeps_attitude = false;
        match gate.recovery {
            Recovery::Reset { attitude_rad, velocity_mps, position_m } => {
                self.reopen([attitude_rad; 3], velocity_mps, position_m);
            }
            Recovery::Widening => self.open_wide(gate, error, strapdown),
        }
    }

    /// Starts the first stage of the widening recovery, or starts it over.
    fn open_wide(&mut self, gate: &Gate, error: &Vector3<f64>, strapdown: &mut Strapdown) {
        // An attitude error φ has grown into a velocity error g φ t, or a position error g φ t²/2,
        // while the gate was shut; twice that and no less than 600″.
        let t = f64::from(gate.rejections.max(1));
        let reach = match self.aiding {
            AidingMode::Velocity { .. } => error.norm() / t,
            AidingMode::Position { .. } => 2.0 * error.norm() / (t * t),
        };
        let attitude = (2.0 * reach / 9.8).clamp(CAPTURE_ATTITUDE_RAD, 1.0);
        let velocity = (2.0 * reach * t).clamp(1.0, CAPTURE_VELOCITY_MAX_MPS);
        let position = match self.aiding {
            // Velocity doesn't show how far a fault has carried the solution, and 100 m of height
            // are 30 µg of gravity. But the instrument hasn't gone anywhere.
            AidingMode::Velocity { .. } => {
                strapdown.move_to(&self.site);
                RECOVERY_POSITION_M
            }
            AidingMode::Position { .. } => {
                (2.0 * error.norm()).clamp(RECOVERY_POSITION_M, CAPTURE_POSITION_MAX_M)
            }
        };
        let azimuth = attitude.max(CAPTURE_AZIMUTH_RAD);
        let attitude = if self.keeps_attitude {
            self.attitude_at_least([KEPT_ATTITUDE_RAD; 3])
        } else {
            [attitude, attitude, azimuth]
        };
        self.reopen(attitude, velocity, position);
        self.stage = Stage::Capture(self.time_s + CAPTURE_S);
    }

    fn advance_recovery(&mut self) {
        match self.stage {
            Stage::Capture(until) if self.time_s >= until => {
                // Azimuth hardly shows in 10 s: what was opened wide for it has to stay open.
                let attitude = self.attitude_at_least(if self.keeps_attitude {
                    [KEPT_ATTITUDE_RAD; 3]
                } else {
                    SETTLE_ATTITUDE_RAD
                });
                self.reopen(attitude, SETTLE_VELOCITY_MPS, RECOVERY_POSITION_M);
                self.stage = Stage::Settle(self.time_s + SETTLE_S);
            }
            Stage::Settle(until) if self.time_s >= until => self.stage = Stage::Normal,
            _ => {}
        }
    }

    /// σ of the attitude, no less than this, rad.
    fn attitude_at_least(&self, least_rad: [f64; 3]) -> [f64; 3] {
        core::array::from_fn(|axis| least_rad[axis].max(self.covariance.sigma(PHI + axis)))
    }

    fn reopen(&mut self, attitude_rad: [f64; 3], velocity_mps: f64, position_m: f64) {
        for axis in 0..3 {
            self.covariance.reopen(PHI + axis, attitude_rad[axis]);
            self.covariance.reopen(DV + axis, velocity_mps);
            self.covariance.reopen(DR + axis, position_m);
        }
    }

    /// Error covariance of all states, as of the last propagation and measurement.
    #[must_use]
    pub fn covariance(&self) -> &Covariance {
        &self.covariance
    }

    /// Standard deviations of the parameters.
    #[must_use]
    pub fn parameter_sigmas(&self) -> [f64; PARAMETER_COUNT] {
        core::array::from_fn(|i| self.covariance.sigma(PARAMETERS + i))
    }

    /// Counts since the start.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// The watch over the parameters, where there is one.
    #[must_use]
    pub fn drift(&self) -> Option<&Drift> {
        self.drift.as_ref()
    }

    /// Brings the watch over the parameters up to the end of the calibration.
    pub fn finish_drift(&mut self, parameters: &Parameters) {
        if let Some(drift) = &mut self.drift {
            drift.finish(self.time_s, parameters, &self.covariance);
        }
    }

    /// A recovery is under way: the parameters are held.
    #[must_use]
    pub fn is_recovering(&self) -> bool {
        self.stage != Stage::Normal
    }
}
