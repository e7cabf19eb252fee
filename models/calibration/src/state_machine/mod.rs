//! The procedure: alignment, calibration through the stops, compensation, navigation.

mod bridge;
mod check;
mod edges;
mod ending;
mod estimation;
mod gap;
mod gimbals;
mod judgement;
#[cfg(feature = "state")]
mod state;

pub use check::ConfigError;
pub use judgement::Refusal;
#[cfg(feature = "state")]
pub use state::FORMAT as STATE_FORMAT;

use crate::alignment::CoarseAlignment;
use crate::compensation::Compensation;
use crate::config::{Alignment, Calibration, Config, Estimator, Kalman, Site};
use crate::continuity::{Continuity, POINTS, block_ticks};
use crate::drift::Drift;
use crate::filter::CalibrationFilter;
use crate::monitor::{Monitor, MonitorTally, Order};
use crate::schedule::{Cursor, dwell_s};
use crate::screen::Screen;
use crate::strapdown::{Strapdown, Vertical};
use crate::table::{CalibrationTable, Quality};
use bridge::Bridge;
use edges::Disturbance;
use estimation::{Estimation, Standstill};
use gimbals::Slips;
use judgement::quality_of;
use nalgebra::{UnitQuaternion, Vector3};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, Health, Mode, Output, Parameters, Sample,
};

/// Time after arrival in which the gimbals may still settle, s.
const GIMBAL_SETTLE_S: f64 = 1.0;
/// Memory of the running mean of NIS, measurements.
const NIS_MEMORY: f64 = 64.0;

/// Counts and means over the run, for reports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Of the samples.
    pub monitor: MonitorTally,
    /// Quality of the calibration so far.
    pub quality: Quality,
    /// Epochs in a dwell in which the encoders disagreed with the set point.
    pub gimbal_disagreements: u64,
}

/// What an output says of the gimbals.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
struct Gimbals {
    stop: u16,
    moving: bool,
    command: GimbalCommand,
}

/// The calibration core. See [`Core::step`].
#[derive(Clone, Debug)]
pub struct Core {
    config: Config,
    sample_s: f64,
    /// Samples of the calibration, and of the navigation after it.
    calibration_ticks: u64,
    navigation_ticks: u64,
    settle_ticks: u64,

    /// Samples so far, missing ones included.
    tick: u64,
    /// Tick at which the present schedule started.
    phase_start: u64,
    mode: Mode,
    cursor: Option<Cursor>,
    monitor: Monitor,
    screen: Screen,
    bridge: Bridge,
    slips: Slips,
    /// Where the filter runs and jumps are looked for; its next block is whole at this tick.
    continuity: Option<Continuity>,
    block_tick: u64,
    block_ticks: u64,
    /// Disturbances that were noticed and couldn't be undone.
    unrepaired: u64,
    /// Tick at which something was last noticed that explains a recovery of the filter.
    disturbed_tick: u64,
    disturbance: Option<Disturbance>,
    /// What was felt beyond the known motion in the last blocks, the newest first.
    recent: [(Vector3<f64>, Vector3<f64>); POINTS],
    alignment: Option<(CoarseAlignment, u64)>,
    estimation: Estimation,
    standstill: Standstill,
    parameters: Parameters,
    sigma: [f64; PARAMETER_COUNT],
    revision: u32,
    compensation: Compensation,
    strapdown: Strapdown,
    last_measured_tick: u64,
    /// Next tick, at the earliest, at which aiding is due: a division is dear at every sample.
    due_tick: u64,
    nis_running: f64,
    gimbal_disagreements: u64,
    gimbal_tolerance: u64,
    refusal: Option<Refusal>,
    /// Quality of a filter that was refused.
    last_quality: Quality,
    table: Option<CalibrationTable>,
    /// What the last output said of the gimbals, and its stamp.
    gimbals: Gimbals,
    answered: (u64, DeviceTime),
}

/// Increments (rad and m/s) of counts.
#[inline]
fn increments(theta: [i32; 3], velocity: [i32; 3]) -> (Vector3<f64>, Vector3<f64>) {
    (
        Vector3::from(theta.map(f64::from)) * DELTA_THETA_LSB_RAD,
        Vector3::from(velocity.map(f64::from)) * DELTA_VELOCITY_LSB_MPS,
    )
}

fn ticks(duration_s: f64, sample_s: f64) -> u64 {
    (duration_s / sample_s + 0.5) as u64
}

fn strapdown_at(site: &Site, q_nb: &UnitQuaternion<f64>, velocity: Vector3<f64>) -> Strapdown {
    let Site { latitude_rad, longitude_rad, height_m } = *site;
    Strapdown::new(q_nb, velocity, latitude_rad, longitude_rad, height_m, Vertical::Free)
}

impl Core {
    /// A core that waits for its first sample.
    ///
    /// # Errors
    /// If the configuration contradicts itself: see [`ConfigError`].
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        check::check(config)?;
        let sample_s = config.sample_period_ns as f64 * 1e-9;
        let (q_nb, velocity, alignment) = match &config.alignment {
            Alignment::Given { q_nb, velocity_mps } => (*q_nb, *velocity_mps, None),
            Alignment::Coarse { duration_s } => (
                UnitQuaternion::identity(),
                Vector3::zeros(),
                Some((CoarseAlignment::new(&config.site), ticks(*duration_s, sample_s))),
            ),
        };
        let sqrt_s = libm::sqrt(sample_s);
        let sigmas =
            (config.noise.angle_random_walk * sqrt_s, config.noise.velocity_random_walk * sqrt_s);
        let mut core = Self {
            config: config.clone(),
            sample_s,
            calibration_ticks: 0,
            navigation_ticks: u64::MAX,
            settle_ticks: ticks(GIMBAL_SETTLE_S, sample_s),
            tick: 0,
            phase_start: 0,
            mode: Mode::Aligning,
            cursor: None,
            monitor: Monitor::new(config.sample_period_ns, sigmas, config.screening.stuck_samples),
            screen: Screen::new(&config.screening, &config.noise, &config.turntable, sample_s),
            bridge: Bridge::default(),
            slips: Slips::default(),
            continuity: None,
            block_tick: u64::MAX,
            block_ticks: block_ticks(sample_s),
            unrepaired: 0,
            disturbed_tick: 0,
            disturbance: None,
            recent: Default::default(),
            alignment,
            estimation: Estimation::Idle,
            standstill: Standstill::default(),
            parameters: config.initial_parameters,
            sigma: [0.0; PARAMETER_COUNT],
            revision: 0,
            compensation: Compensation::new(&config.initial_parameters),
            strapdown: strapdown_at(&config.site, &q_nb, velocity),
            last_measured_tick: 0,
            due_tick: 0,
            nis_running: 0.0,
            gimbal_disagreements: 0,
            gimbal_tolerance: gimbals::tolerance_counts(&config.screening),
            refusal: None,
            last_quality: Quality { nis_mean: f64::NAN, ..Quality::default() },
            table: None,
            gimbals: Gimbals::default(),
            answered: Default::default(),
        };
        if let Some(duration_s) = config.navigation.as_ref().and_then(|plan| plan.duration_s) {
            core.navigation_ticks = ticks(duration_s, sample_s);
        }
        if let Some(calibration) = &config.calibration {
            core.start_calibration(calibration)?;
        }
        if core.alignment.is_none() {
            core.leave_alignment();
        }
        Ok(core)
    }

    /// Plans the stops. The clock of the calibration starts with the first sample: a coarse
    /// alignment takes its time from the first dwell.
    fn start_calibration(&mut self, calibration: &Calibration) -> Result<(), ConfigError> {
        let rates = self.config.turntable;
        let dwell = dwell_s(&calibration.sequence, calibration.duration_s, &rates)?;
        self.calibration_ticks = ticks(calibration.duration_s, self.sample_s);
        let home = GimbalAngles::default();
        let sequence = calibration.sequence.clone();
        let cursor = Cursor::new(sequence, home, rates, dwell, self.sample_s, false);
        if let Alignment::Coarse { duration_s: alignment_s } = self.config.alignment {
            let dwell_s = cursor.departure_s();
            if cursor.arrival_s() > 0.0 || alignment_s > dwell_s {
                return Err(ConfigError::Alignment { alignment_s, dwell_s });
            }
        }
        self.cursor = Some(cursor);
        self.estimation = Estimation::new(&self.config, calibration)?;
        if let Estimation::Kalman(filter) = &self.estimation {
            self.sigma = filter.parameter_sigmas();
            self.start_edges();
        }
        Ok(())
    }

    fn leave_alignment(&mut self) {
        self.alignment = None;
        if self.config.calibration.is_some() {
            self.mode = Mode::Calibrating;
        } else {
            self.start_navigation();
        }
    }

    fn start_navigation(&mut self) {
        self.estimation = Estimation::Idle;
        self.phase_start = self.tick;
        let Some(plan) = &self.config.navigation else {
            self.mode = Mode::Done;
            return;
        };
        self.cursor = Some(Cursor::new(
            plan.rotation.clone(),
            self.gimbals.command.target,
            self.config.turntable,
            plan.dwell_s,
            self.sample_s,
            true,
        ));
        self.strapdown.start_free(&self.config.site);
        self.mode = Mode::Navigating;
    }

    /// Takes one sample, and the reference that carries its stamp, and answers.
    ///
    /// The parameters and their σ ([`Self::parameters`], [`Self::sigma`]) have changed when the
    /// output's revision has.
    pub fn step(&mut self, sample: &Sample, aiding: Option<&Aiding>) -> Output {
        let mut output = Output::default();
        self.step_into(sample, aiding, &mut output);
        output
    }

    /// [`Self::step`] in place, for who steps millions of times: a copy of an output that has just
    /// been written waits for the stores.
    pub fn step_into(&mut self, sample: &Sample, aiding: Option<&Aiding>, output: &mut Output) {
        let (order, mut health) = self.monitor.check(sample);
        let mut nis = f64::NAN;
        let interval_ns = match order {
            Order::Behind => return self.answer(sample, health, nis, output),
            Order::Next(interval_ns) => interval_ns,
            Order::Gap { missing } => {
                self.bridge(missing, sample);
                self.config.sample_period_ns
            }
        };
        self.tick = self.tick.saturating_add(1);
        let regular = interval_ns == self.config.sample_period_ns;
        let interval_s = if regular { self.sample_s } else { interval_ns as f64 * 1e-9 };
        self.take(sample, interval_s, &mut health);
        match self.mode {
            Mode::Calibrating => {
                if let Some(continuity) = &mut self.continuity {
                    continuity.follow(sample.gimbal);
                }
                if self.tick >= self.block_tick {
                    self.look_for_edges(sample, &mut health);
                }
                if aiding.is_some() || self.tick >= self.due_tick {
                    self.measure(sample, aiding, &mut health, &mut nis);
                }
                if self.tick >= self.calibration_ticks {
                    self.finish_calibration(sample.device_time);
                }
            }
            Mode::Navigating if self.phase_tick() >= self.navigation_ticks => {
                self.mode = Mode::Done;
            }
            _ => {}
        }
        let phase_tick = self.phase_tick();
        if let Some(cursor) = &mut self.cursor {
            cursor.advance(phase_tick);
        }
        self.compare_gimbals(sample, &mut health);
        if !self.strapdown.is_sound() && self.mode != Mode::Refused {
            // What is no number has not got into the solution: the last good one stands.
            health |= Health::NUMERIC;
            self.refuse(Refusal::Numeric);
        }
        self.answer(sample, health, nis, output);
    }

    /// Samples since the start of the present phase.
    #[inline]
    fn phase_tick(&self) -> u64 {
        self.tick - self.phase_start
    }

    /// Takes the increments of a sample into whatever runs.
    #[inline]
    fn take(&mut self, sample: &Sample, interval_s: f64, health: &mut Health) {
        let ([x, y, z], [u, v, w]) = (sample.delta_theta, sample.delta_velocity);
        match (self.mode, &self.estimation) {
            (Mode::Navigating, _) | (Mode::Calibrating, Estimation::Kalman(_)) => {
                let valid = !health.contains(Health::INERTIAL_INVALID);
                let moving = self.gimbals_may_move();
                if valid && self.integrate_good(interval_s, moving, x, y, z, u, v, w) {
                    self.bridge.gimbal = sample.gimbal;
                } else {
                    self.doubt(sample, interval_s, health);
                }
            }
            (mode, _) => {
                *health |= self.monitor.stuck(x, y, z, u, v, w);
                match mode {
                    Mode::Aligning => self.align(sample, interval_s),
                    Mode::Calibrating => self.watch(sample, interval_s),
                    _ => {}
                }
            }
        }
    }

    /// The gimbals are on their way, or may still settle.
    #[inline]
    fn gimbals_may_move(&self) -> bool {
        self.cursor
            .as_ref()
            .is_some_and(|cursor| self.phase_tick() < cursor.arrival_tick() + self.settle_ticks)
    }

    /// Navigates over one interval if its counts pass the screen: of delta_theta, then of
    /// delta_velocity.
    ///
    /// Each count is an argument of its own, and the call is kept, so that each is read the way it
    /// was written. Read in pairs, right after single ones were stored, they would have to wait
    /// until those stores are through: more than the rest of the step takes.
    #[inline(never)]
    #[allow(clippy::too_many_arguments, reason = "in registers: see above")]
    fn integrate_good(
        &mut self,
        interval_s: f64,
        moving: bool,
        x: i32,
        y: i32,
        z: i32,
        u: i32,
        v: i32,
        w: i32,
    ) -> bool {
        let good = self.screen.passes(moving, x, y, z, u, v, w);
        if good {
            self.integrate(interval_s, x, y, z, u, v, w);
        }
        good
    }

    #[inline]
    #[allow(clippy::too_many_arguments, reason = "in registers: see above")]
    fn integrate(&mut self, interval_s: f64, x: i32, y: i32, z: i32, u: i32, v: i32, w: i32) {
        let (theta, velocity) = increments([x, y, z], [u, v, w]);
        self.navigate(&theta, &velocity, interval_s);
    }

    /// Navigates over one interval by its raw increments, rad and m/s.
    #[inline]
    fn navigate(&mut self, theta: &Vector3<f64>, velocity: &Vector3<f64>, interval_s: f64) {
        let (dtheta, dv) = self.compensation.apply(theta, velocity, interval_s);
        self.strapdown.step(&dtheta, &dv, interval_s);
        if let Estimation::Kalman(filter) = &mut self.estimation {
            filter.accumulate(&self.strapdown, &dtheta, &dv, interval_s);
        }
    }

    #[cold]
    #[inline(never)]
    fn align(&mut self, sample: &Sample, interval_s: f64) {
        let Some((alignment, until)) = &mut self.alignment else { return };
        let (theta, velocity) = increments(sample.delta_theta, sample.delta_velocity);
        let (dtheta, dv) = self.compensation.apply(&theta, &velocity, interval_s);
        alignment.step(&dtheta, &dv, interval_s);
        if self.tick < *until {
            return;
        }
        match alignment.finish() {
            Some(q_nb) => {
                self.strapdown = strapdown_at(&self.config.site, &q_nb, Vector3::zeros());
                self.leave_alignment();
            }
            None => self.refuse(Refusal::Alignment),
        }
    }

    /// A least-squares calibration doesn't navigate: it looks at standstills and at the moves
    /// between them.
    #[inline(never)]
    fn watch(&mut self, sample: &Sample, interval_s: f64) {
        let Some(cursor) = &self.cursor else { return };
        let tick = self.tick;
        let standing = tick > cursor.arrival_tick() + self.settle_ticks;
        if standing {
            let measured = increments(sample.delta_theta, sample.delta_velocity);
            self.standstill.add(&measured, interval_s);
        } else {
            self.standstill = Standstill::default();
        }
        self.estimation.raw_sample(sample, interval_s, standing);
    }

    #[cold]
    #[inline(never)]
    fn refuse(&mut self, refusal: Refusal) {
        if let Some(filter) = self.filter() {
            self.last_quality = self.quality(filter);
        }
        self.refusal = Some(refusal);
        self.estimation = Estimation::Idle;
        self.alignment = None;
        self.mode = Mode::Refused;
    }

    #[inline(never)]
    fn measure(
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
            // Where the instrument was at another time, or is yet to be.
            aiding = None;
            *health |= Health::AIDING_STALE;
        }
        let (Estimation::Kalman(_), Some(kalman)) = (&self.estimation, kalman_of(&self.config))
        else {
            return;
        };
        let explains_ticks = self.explains_ticks();
        let after_move = self.has_moved_within(explains_ticks);
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
        let before = self.parameters;
        let measured = aiding.and_then(|aiding| {
            filter.measure(&aiding.reference, &mut self.strapdown, &mut self.parameters)
        });
        if !self.parameters.to_array().iter().all(|value| value.is_finite()) {
            self.parameters = before;
            self.refuse(Refusal::Numeric);
            *health |= Health::NUMERIC;
            return;
        }
        if let Some(measured) = measured {
            self.last_measured_tick = self.tick;
            *nis = measured.nis;
            if measured.rejected {
                *health |= Health::INNOVATION_REJECTED;
            } else {
                self.compensation = Compensation::new(&self.parameters);
                self.sigma = filter.parameter_sigmas();
                self.revision = self.revision.saturating_add(1);
            }
            if measured.turned_rad > edges::CORRECTION_RAD
                && let Some(continuity) = &mut self.continuity
            {
                continuity.attitude_corrected();
            }
            if measured.recovery_started
                && self.tick - self.disturbed_tick > explains_ticks
                && after_move
            {
                // What contradicts the measurements may have been learned long ago.
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
        if filter.drift().is_some_and(Drift::is_found) {
            *health |= Health::DRIFTING;
        }
        if self.nis_running > kalman.refuse_above_mean_nis {
            *health |= Health::INCONSISTENT;
        }
        self.compare_turns(sample, health);
    }

    #[inline]
    fn answer(&mut self, sample: &Sample, health: Health, nis: f64, output: &mut Output) {
        self.answered = (sample.sequence, sample.device_time);
        if let Some(cursor) = &self.cursor {
            self.gimbals = Gimbals {
                stop: cursor.stop() as u16,
                moving: cursor.moving(self.phase_tick()),
                command: cursor.command(),
            };
        }
        *output = self.output(health, nis);
    }

    /// The output as things stand. Made anew each time: copying one that has just been written
    /// costs more than its computation.
    #[inline]
    fn output(&self, health: Health, nis: f64) -> Output {
        Output {
            sequence: self.answered.0,
            device_time: self.answered.1,
            mode: self.mode,
            stop: self.gimbals.stop,
            moving: self.gimbals.moving,
            gimbal_command: self.gimbals.command,
            navigation: self.strapdown.navigation(),
            health,
            nis,
            parameters_revision: self.revision,
        }
    }

    /// What it was configured with.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// How things stand: before the first sample, or as it was last answered, without flags.
    #[must_use]
    pub fn latest(&self) -> Output {
        self.output(Health::empty(), f64::NAN)
    }

    /// Estimated parameters.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Standard deviations of the parameters, SI, in the order of
    /// [`octant_sample::parameters::NAMES`].
    #[must_use]
    pub fn sigma(&self) -> &[f64; PARAMETER_COUNT] {
        &self.sigma
    }

    /// The finished calibration, once it has been accepted.
    #[must_use]
    pub fn table(&self) -> Option<&CalibrationTable> {
        self.table.as_ref()
    }

    /// Why the calibration was refused, if it was.
    #[must_use]
    pub fn refusal(&self) -> Option<&Refusal> {
        self.refusal.as_ref()
    }

    /// The filter, while it runs.
    #[must_use]
    pub fn filter(&self) -> Option<&CalibrationFilter> {
        match &self.estimation {
            Estimation::Kalman(filter) => Some(filter),
            _ => None,
        }
    }

    fn filter_mut(&mut self) -> Option<&mut CalibrationFilter> {
        match &mut self.estimation {
            Estimation::Kalman(filter) => Some(filter),
            _ => None,
        }
    }

    /// Quality of a filter's calibration so far.
    fn quality(&self, filter: &CalibrationFilter) -> Quality {
        Quality {
            bridged: self.bridge.samples,
            gimbal_slips: self.slips.count,
            ..quality_of(filter)
        }
    }

    /// Counts so far.
    #[must_use]
    pub fn diagnostics(&self) -> Diagnostics {
        let quality = match (self.filter(), &self.table) {
            (Some(filter), _) => self.quality(filter),
            (None, Some(table)) => table.quality,
            (None, None) => self.last_quality,
        };
        Diagnostics {
            monitor: *self.monitor.tally(),
            quality,
            gimbal_disagreements: self.gimbal_disagreements,
        }
    }
}

fn kalman_of(config: &Config) -> Option<&Kalman> {
    match &config.calibration {
        Some(Calibration { estimator: Estimator::Kalman(kalman), .. }) => Some(kalman),
        _ => None,
    }
}
