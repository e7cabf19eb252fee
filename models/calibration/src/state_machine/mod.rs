//! The procedure: alignment, calibration through the stops, compensation, navigation.

mod aligning;
mod bridge;
mod check;
mod disturbance;
mod edges;
mod ending;
mod estimation;
mod gap;
mod gimbals;
mod judgement;
mod measure;
mod slips;
#[cfg(feature = "state")]
mod state;
mod step;
mod stretch;
mod tune;
mod uncertainty;

pub use aligning::prior_after_alignment;
pub use check::CoreConfigError;
pub use judgement::CalibrationRefusal;
#[cfg(feature = "state")]
pub use state::FORMAT as STATE_FORMAT;

use crate::compensation::Compensation;
use crate::config::{Alignment, Calibration, CoreConfig, Estimator, Kalman, NavigationPlan, Site};
use crate::continuity::{Continuity, POINTS, block_ticks};
use crate::covariance::SolutionCovariance;
use crate::filter::{CalibrationFilter, ExpectedNis};
use crate::further::FurtherEstimates;
use crate::further::compensation::FurtherCompensation;
use crate::monitor::{Monitor, MonitorTally};
use crate::schedule::{Cursor, dwell_s};
use crate::screen::Screen;
use crate::strapdown::{Strapdown, Vertical};
use crate::table::{CalibrationTable, Quality};
use aligning::Aligning;
use disturbance::Disturbance;
use estimation::{Estimation, Standstill};
use judgement::quality_of;
use nalgebra::{UnitQuaternion, Vector3};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{
    DeviceTime, GimbalAngles, GimbalCommand, Health, Innovation, Mode, NavigationCovariance,
    Output, Parameters,
};
use slips::Slips;
use stretch::Bridge;

/// Time after arrival in which the gimbals may still settle, s.
const GIMBAL_SETTLE_S: f64 = 1.0;

/// Counts and means over the run, for reports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Counts of the samples.
    pub monitor: MonitorTally,
    /// Quality of the calibration so far.
    pub quality: Quality,
    /// Epochs in a dwell in which the encoders disagreed with the set point.
    pub gimbal_disagreements: u64,
}

/// State of the gimbals as in an output.
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
    config: CoreConfig,
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
    /// Detector of discontinuities, if the filter runs and jumps are screened; its next block is
    /// complete at this tick.
    continuity: Option<Continuity>,
    block_tick: u64,
    block_ticks: u64,
    /// Number of disturbances that couldn't be undone.
    unrepaired: u64,
    /// Tick of the last disturbance that explains a recovery of the filter.
    disturbed_tick: u64,
    disturbance: Option<Disturbance>,
    /// Turn and velocity beyond the known motion in the last blocks, the newest first.
    recent: [(Vector3<f64>, Vector3<f64>); POINTS],
    alignment: Option<(Aligning, u64)>,
    estimation: Estimation,
    standstill: Standstill,
    parameters: Parameters,
    sigma: [f64; PARAMETER_COUNT],
    revision: u32,
    compensation: Compensation,
    /// Estimates of the further states, and their compensation, if the filter has any.
    further: Option<(FurtherEstimates, FurtherCompensation)>,
    strapdown: Strapdown,
    last_measured_tick: u64,
    /// Earliest tick at which aiding is due again; kept because division is slow for every sample.
    due_tick: u64,
    nis_running: f64,
    gimbal_disagreements: u64,
    gimbal_tolerance: u64,
    refusal: Option<CalibrationRefusal>,
    /// Quality of a filter that was refused.
    last_quality: Quality,
    table: Option<CalibrationTable>,
    /// Covariance of attitude and velocity at the end of the calibration. A statement about the past:
    /// nothing computes with it, and a stored state doesn't have it.
    concluded: Option<SolutionCovariance>,
    /// Mean NIS that is expected where states are considered; not stored, as `concluded`.
    expected_nis: Option<ExpectedNis>,
    /// Innovation of the last measurement.
    innovation: Innovation,
    /// Gimbals and stamp of the last output.
    gimbals: Gimbals,
    answered: (u64, DeviceTime),
}

/// Converts counts to increments (rad and m/s).
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

/// Samples of a navigation; one without a duration never ends.
fn navigation_ticks(plan: Option<&NavigationPlan>, sample_s: f64) -> u64 {
    let duration_s = plan.and_then(|plan| plan.duration_s);
    duration_s.map_or(u64::MAX, |duration_s| ticks(duration_s, sample_s))
}

fn strapdown_at(site: &Site, q_nb: &UnitQuaternion<f64>, velocity: Vector3<f64>) -> Strapdown {
    let Site { latitude_rad, longitude_rad, height_m } = *site;
    Strapdown::new(q_nb, velocity, latitude_rad, longitude_rad, height_m, Vertical::Free)
}

impl Core {
    /// Makes a core that waits for its first sample.
    ///
    /// # Errors
    /// If the configuration contradicts itself: see [`CoreConfigError`].
    pub fn new(config: &CoreConfig) -> Result<Self, CoreConfigError> {
        check::check(config)?;
        let sample_s = config.sample_period_ns as f64 * 1e-9;
        let (q_nb, velocity) = match &config.alignment {
            Alignment::Given { q_nb, velocity_mps } => (*q_nb, *velocity_mps),
            Alignment::Coarse { .. } | Alignment::Inertial { .. } => {
                (UnitQuaternion::identity(), Vector3::zeros())
            }
        };
        let alignment = Aligning::new(config).map(|(aligning, s)| (aligning, ticks(s, sample_s)));
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
            monitor: Monitor::new(
                config.sample_period_ns,
                sigmas,
                config.screening.resolution,
                config.screening.stuck_samples,
            ),
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
            further: None,
            strapdown: strapdown_at(&config.site, &q_nb, velocity),
            last_measured_tick: 0,
            due_tick: 0,
            nis_running: 0.0,
            gimbal_disagreements: 0,
            gimbal_tolerance: slips::tolerance_counts(&config.screening),
            refusal: None,
            last_quality: Quality { nis_mean: f64::NAN, ..Quality::default() },
            table: None,
            concluded: None,
            expected_nis: None,
            innovation: Innovation::default(),
            gimbals: Gimbals::default(),
            answered: Default::default(),
        };
        core.navigation_ticks = navigation_ticks(config.navigation.as_ref(), sample_s);
        if let Some(calibration) = &config.calibration {
            core.start_calibration(calibration)?;
        }
        if core.alignment.is_none() {
            core.leave_alignment();
        }
        Ok(core)
    }

    /// Plans another navigation, or none, after the calibration that runs. Nothing before its end
    /// depends on that: the core goes on as one that was made with this plan.
    ///
    /// # Errors
    /// If the plan contradicts the configuration, or the calibration has ended; then nothing has
    /// changed.
    pub fn plan_navigation(
        &mut self,
        navigation: Option<NavigationPlan>,
    ) -> Result<(), CoreConfigError> {
        if self.config.calibration.is_none() || matches!(self.mode, Mode::Navigating | Mode::Done) {
            return Err(CoreConfigError::CalibrationOver);
        }
        let config = CoreConfig { navigation, ..self.config.clone() };
        check::check(&config)?;
        self.navigation_ticks = navigation_ticks(config.navigation.as_ref(), self.sample_s);
        self.config = config;
        Ok(())
    }

    /// Plans the stops. The clock of the calibration starts with the first sample: a coarse
    /// alignment uses time of the first dwell.
    fn start_calibration(&mut self, calibration: &Calibration) -> Result<(), CoreConfigError> {
        let rates = self.config.turntable;
        let dwell = dwell_s(&calibration.sequence, calibration.duration_s, &rates)?;
        self.calibration_ticks = ticks(calibration.duration_s, self.sample_s);
        let home = GimbalAngles::default();
        let sequence = calibration.sequence.clone();
        let cursor = Cursor::new(sequence, home, rates, dwell, self.sample_s, false);
        if let Some(alignment_s) = self.config.alignment.duration_s() {
            let dwell_s = cursor.departure_s();
            if cursor.arrival_s() > 0.0 || alignment_s > dwell_s {
                return Err(CoreConfigError::Alignment { alignment_s, dwell_s });
            }
        }
        self.cursor = Some(cursor);
        self.estimation = Estimation::new(&self.config, calibration)?;
        if let Estimation::Kalman(filter) = &self.estimation {
            self.sigma = filter.parameter_sigmas();
            self.further = filter.further().zip(
                kalman_of(&self.config)
                    .and_then(|kalman| FurtherCompensation::new(&kalman.further, self.sample_s)),
            );
            self.start_edges();
        }
        self.tell_rest();
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

    /// Samples since the start of the present phase.
    #[inline]
    fn phase_tick(&self) -> u64 {
        self.tick - self.phase_start
    }

    /// Returns whether the gimbals are moving, or may still settle.
    #[inline]
    fn gimbals_may_move(&self) -> bool {
        self.cursor
            .as_ref()
            .is_some_and(|cursor| self.phase_tick() < cursor.arrival_tick() + self.settle_ticks)
    }

    /// Tells the filter whether the gimbals rest at the next sample. Called whenever that has changed.
    #[inline]
    fn tell_rest(&mut self) {
        if let Estimation::Kalman(_) = &self.estimation {
            let rest = !self.gimbals_may_move();
            if let Some(filter) = self.filter_mut() {
                filter.rest(rest);
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn refuse(&mut self, refusal: CalibrationRefusal) {
        if let Some(filter) = self.filter() {
            self.last_quality = self.quality(filter);
        }
        self.refusal = Some(refusal);
        self.estimation = Estimation::Idle;
        self.alignment = None;
        self.mode = Mode::Refused;
    }

    /// Makes the output of the present state. Made anew each time: copying one that has just been
    /// written costs more than its computation.
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

    /// Configuration of the core.
    #[must_use]
    pub fn config(&self) -> &CoreConfig {
        &self.config
    }

    /// Number of samples of the calibration, missing ones included; 0 without one.
    #[must_use]
    pub fn calibration_samples(&self) -> u64 {
        self.calibration_ticks
    }

    /// Present output: before the first sample, or as at the last step, without flags.
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

    /// Takes the temperature of the instrument, °C, which holds until the next call: for errors that follow it
    /// ([`config::TemperatureErrors`](crate::config::TemperatureErrors)). A core without any isn't changed by it, nor any
    /// by what is no number.
    #[inline]
    pub fn feel(&mut self, temperature_c: f64) {
        if let Some((_, further)) = &mut self.further {
            further.feel(temperature_c);
        }
    }

    /// Estimates of the further states with their standard deviations, as after the last
    /// measurement; `None` if the calibration has none. Navigation compensates them too.
    #[must_use]
    pub fn further(&self) -> Option<&FurtherEstimates> {
        self.further.as_ref().map(|(estimates, _)| estimates)
    }

    /// The finished calibration, once it has been accepted.
    #[must_use]
    pub fn table(&self) -> Option<&CalibrationTable> {
        self.table.as_ref()
    }

    /// Covariance of attitude and velocity at the end of an accepted calibration by the filter. A core
    /// that was loaded from a state after that end doesn't have it.
    #[must_use]
    pub fn concluded(&self) -> Option<&SolutionCovariance> {
        self.concluded.as_ref()
    }

    /// Innovation of the last measurement; it belongs to the last output where that has a NIS.
    #[must_use]
    pub fn innovation(&self) -> &Innovation {
        &self.innovation
    }

    /// Covariance of the solution after the filter's last measurement; `None` while no filter runs.
    #[must_use]
    pub fn navigation_covariance(&self) -> Option<NavigationCovariance> {
        self.filter().map(|filter| filter.navigation_covariance(&self.strapdown))
    }

    /// Reason why the calibration was refused, if it was.
    #[must_use]
    pub fn refusal(&self) -> Option<&CalibrationRefusal> {
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

fn kalman_of(config: &CoreConfig) -> Option<&Kalman> {
    match &config.calibration {
        Some(Calibration { estimator: Estimator::Kalman(kalman), .. }) => Some(kalman),
        _ => None,
    }
}
