//! The procedure: alignment, calibration through the stops, compensation, navigation.

use crate::compensation::Compensation;
use crate::config::{AidingMode, Alignment, Calibration, Config, Estimator, Site};
use crate::filter::CalibrationFilter;
use crate::monitor::{Monitor, MonitorTally, Order};
use crate::schedule::{Cursor, DoesNotFit, dwell_s};
use crate::strapdown::{Strapdown, Vertical};
use crate::table::{CalibrationTable, Provenance, Quality};
use nalgebra::Vector3;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{
    Aiding, GimbalAngles, GimbalCommand, Health, Mode, Output, Parameters, Sample, Status,
};

/// Share of measurements that the gate may reject before a calibration is refused.
const REJECTED_SHARE_MAX: f64 = 0.02;
/// Recoveries that a calibration may need before it is refused.
const RECOVERIES_MAX: u32 = 10;
/// Share of the expected measurements that a calibration needs.
const MEASURED_SHARE_MIN: f64 = 0.5;
/// Missing samples over which the last increments are held; what is longer is lost.
const HOLD_MAX_SAMPLES: u64 = 400;
/// Difference of encoder and set point in a dwell that is called a disagreement, counts (0.5°).
const GIMBAL_TOLERANCE: i32 = (0.5 * core::f64::consts::PI / 180.0 * (1u64 << 27) as f64) as i32;
/// Time after arrival in which the gimbals may still settle, s.
const GIMBAL_SETTLE_S: f64 = 1.0;
/// Memory of the running mean of NIS, measurements.
const NIS_MEMORY: f64 = 64.0;

/// Why a configuration can't be run.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ConfigError {
    /// The sequence doesn't fit into the calibration time.
    #[error(transparent)]
    DoesNotFit(#[from] DoesNotFit),
    /// A period is not usable.
    #[error("{field} is {found_ns} ns, {expected} is expected")]
    Period {
        /// Name of the field.
        field: &'static str,
        /// Value found, ns.
        found_ns: u64,
        /// What is expected.
        expected: &'static str,
    },
    /// A number that must be positive and finite isn't.
    #[error("{field} is {found}, a positive number is expected")]
    NotPositive {
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: f64,
    },
    /// The latitude is too close to a pole for a local-level frame.
    #[error("latitude is {found_rad} rad, within ±1.56 (±89.4 deg) is expected")]
    Latitude {
        /// Value found, rad.
        found_rad: f64,
    },
    /// Neither a calibration nor navigation: there is nothing to do.
    #[error("neither a calibration nor a navigation is configured")]
    Nothing,
}

/// Why a calibration was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The innovations are not of the size that the tuning says.
    #[error("the mean NIS of {mean:.1} is above {limit}: the innovations contradict the tuning")]
    Inconsistent {
        /// Mean NIS.
        mean: f64,
        /// Limit.
        limit: f64,
    },
    /// The gate rejected too much.
    #[error(
        "{rejected} of {total} measurements were rejected: the innovations contradict the tuning"
    )]
    Rejected {
        /// Measurements rejected.
        rejected: u64,
        /// All measurements.
        total: u64,
    },
    /// The filter had to recover too often.
    #[error("the filter had to recover {recoveries} times, at most {RECOVERIES_MAX} are accepted")]
    Recoveries {
        /// Recoveries.
        recoveries: u32,
    },
    /// The reference did not come.
    #[error("only {used} of {expected} measurements of the reference came")]
    AidingLost {
        /// Measurements used.
        used: u64,
        /// Measurements expected.
        expected: u64,
    },
    /// The filter's numbers are not finite.
    #[error("the covariance is not finite")]
    Numeric,
}

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

/// The calibration core. See [`Core::step`].
#[derive(Clone, Debug)]
pub struct Core {
    config: Config,
    sample_s: f64,
    calibration_ticks: u64,
    navigation_ticks: u64,
    settle_ticks: u64,

    tick: u64,
    mode: Mode,
    cursor: Option<Cursor>,
    monitor: Monitor,
    parameters: Parameters,
    sigma: [f64; PARAMETER_COUNT],
    revision: u32,
    compensation: Compensation,
    strapdown: Strapdown,
    filter: Option<CalibrationFilter>,
    held: (Vector3<f64>, Vector3<f64>),
    last_measured_tick: u64,
    nis_running: f64,
    gimbal_disagreements: u64,
    refusal: Option<Refusal>,
    table: Option<CalibrationTable>,
    last_output: Output,
}

fn ticks(duration_s: f64, sample_s: f64) -> u64 {
    (duration_s / sample_s + 0.5) as u64
}

fn check(config: &Config) -> Result<(), ConfigError> {
    let period_ns = config.sample_period_ns;
    if period_ns == 0 || period_ns > 1_000_000_000 {
        return Err(ConfigError::Period {
            field: "sample period",
            found_ns: period_ns,
            expected: "1 ns to 1 s",
        });
    }
    if !(config.site.latitude_rad.abs() <= 1.56) {
        return Err(ConfigError::Latitude { found_rad: config.site.latitude_rad });
    }
    let positive = |field, found: f64| {
        if found > 0.0 && found.is_finite() {
            Ok(())
        } else {
            Err(ConfigError::NotPositive { field, found })
        }
    };
    positive("turntable rate", config.turntable.rate_radps)?;
    positive("turntable acceleration", config.turntable.acceleration_radps2)?;
    if let Some(calibration) = &config.calibration {
        positive("calibration duration", calibration.duration_s)?;
        if let Estimator::Kalman(kalman) = &calibration.estimator {
            if kalman.aiding_period_ns == 0 || !kalman.aiding_period_ns.is_multiple_of(period_ns) {
                return Err(ConfigError::Period {
                    field: "aiding period",
                    found_ns: kalman.aiding_period_ns,
                    expected: "a multiple of the sample period",
                });
            }
            let (AidingMode::Velocity { sigma_mps: sigma }
            | AidingMode::Position { sigma_m: sigma }) = kalman.aiding;
            positive("aiding sigma", sigma)?;
        }
    }
    if let Some(navigation) = &config.navigation {
        positive("navigation dwell", navigation.dwell_s)?;
        if let Some(duration_s) = navigation.duration_s {
            positive("navigation duration", duration_s)?;
        }
    }
    if config.calibration.is_none() && config.navigation.is_none() {
        return Err(ConfigError::Nothing);
    }
    Ok(())
}

impl Core {
    /// A core that waits for its first sample.
    ///
    /// # Errors
    /// If the configuration contradicts itself: see [`ConfigError`].
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        check(config)?;
        let sample_s = config.sample_period_ns as f64 * 1e-9;
        let Site { latitude_rad, longitude_rad, height_m } = config.site;
        let (q_nb, velocity) = match &config.alignment {
            Alignment::Given { q_nb, velocity_mps } => (*q_nb, *velocity_mps),
            Alignment::Coarse { .. } => Default::default(),
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
            mode: Mode::Aligning,
            cursor: None,
            monitor: Monitor::new(config.sample_period_ns, sigmas, config.screening.stuck_samples),
            parameters: config.initial_parameters,
            sigma: [0.0; PARAMETER_COUNT],
            revision: 0,
            compensation: Compensation::new(&config.initial_parameters),
            strapdown: Strapdown::new(
                &q_nb,
                velocity,
                latitude_rad,
                longitude_rad,
                height_m,
                Vertical::Free,
            ),
            filter: None,
            held: Default::default(),
            last_measured_tick: 0,
            nis_running: 0.0,
            gimbal_disagreements: 0,
            refusal: None,
            table: None,
            last_output: Output { nis: f64::NAN, ..Output::default() },
        };
        if let Some(duration_s) = config.navigation.as_ref().and_then(|plan| plan.duration_s) {
            core.navigation_ticks = ticks(duration_s, sample_s);
        }
        if let Some(calibration) = &config.calibration {
            core.start_calibration(calibration)?;
        } else {
            core.start_navigation();
        }
        Ok(core)
    }

    fn start_calibration(&mut self, calibration: &Calibration) -> Result<(), ConfigError> {
        let rates = self.config.turntable;
        let dwell = dwell_s(&calibration.sequence, calibration.duration_s, &rates)?;
        self.calibration_ticks = ticks(calibration.duration_s, self.sample_s);
        self.cursor = Some(Cursor::new(
            calibration.sequence.clone(),
            GimbalAngles::default(),
            rates,
            dwell,
            self.sample_s,
            false,
        ));
        if let Estimator::Kalman(kalman) = &calibration.estimator {
            let filter = CalibrationFilter::new(
                kalman,
                &self.config.noise,
                self.config.screening.gate,
                self.config.sample_period_ns,
            );
            self.sigma = filter.parameter_sigmas();
            self.filter = Some(filter);
        }
        self.mode = Mode::Calibrating;
        Ok(())
    }

    fn start_navigation(&mut self) {
        let Some(plan) = &self.config.navigation else {
            self.mode = Mode::Done;
            return;
        };
        let from = self.last_output.gimbal_command.target;
        self.cursor = Some(Cursor::new(
            plan.rotation.clone(),
            from,
            self.config.turntable,
            plan.dwell_s,
            self.sample_s,
            true,
        ));
        let Site { latitude_rad, longitude_rad, height_m } = self.config.site;
        self.strapdown.start_free(latitude_rad, longitude_rad, height_m);
        self.filter = None;
        self.mode = Mode::Navigating;
    }

    /// Takes one sample, and the reference that carries its stamp, and answers.
    ///
    /// The parameters and their σ ([`Self::parameters`], [`Self::sigma`]) have changed when the
    /// output's revision has.
    pub fn step(&mut self, sample: &Sample, aiding: Option<&Aiding>) -> Output {
        let (order, mut health) = self.monitor.check(sample);
        let mut nis = f64::NAN;
        let interval_ns = match order {
            Order::Behind => return self.answer(sample, health, nis),
            Order::Next(interval_ns) => interval_ns,
            Order::Gap { missing } => {
                self.bridge(missing);
                self.config.sample_period_ns
            }
        };
        self.tick += 1;
        if matches!(self.mode, Mode::Calibrating | Mode::Navigating) {
            let interval_s = interval_ns as f64 * 1e-9;
            let raw = |counts: &[i32; 3], lsb: f64| {
                Vector3::new(f64::from(counts[0]), f64::from(counts[1]), f64::from(counts[2])) * lsb
            };
            let measured = (
                raw(&sample.delta_theta, DELTA_THETA_LSB_RAD),
                raw(&sample.delta_velocity, DELTA_VELOCITY_LSB_MPS),
            );
            self.integrate(&measured, interval_s);
        }
        if self.mode == Mode::Calibrating {
            self.measure(aiding, &mut health, &mut nis);
            if self.tick >= self.calibration_ticks {
                self.finish_calibration(sample);
            }
        } else if self.mode == Mode::Navigating && self.phase_tick() >= self.navigation_ticks {
            self.mode = Mode::Done;
        }
        let phase_tick = self.phase_tick();
        if let Some(cursor) = &mut self.cursor {
            cursor.advance(phase_tick);
        }
        self.compare_gimbals(sample, &mut health);
        self.answer(sample, health, nis)
    }

    /// Samples since the start of the present phase.
    fn phase_tick(&self) -> u64 {
        if self.mode == Mode::Calibrating { self.tick } else { self.tick - self.calibration_ticks }
    }

    fn integrate(&mut self, measured: &(Vector3<f64>, Vector3<f64>), interval_s: f64) {
        let (dtheta, dv) = self.compensation.apply(&measured.0, &measured.1, interval_s);
        self.strapdown.step(&dtheta, &dv, interval_s);
        if let Some(filter) = &mut self.filter {
            filter.accumulate(&self.strapdown, &dtheta, &dv, interval_s);
        }
        self.held = *measured;
    }

    /// Bridges missing samples by holding the last increments, up to a bound: a hold without one
    /// makes a fault at the start of a move worse.
    fn bridge(&mut self, missing: u64) {
        let measured = self.held;
        if matches!(self.mode, Mode::Calibrating | Mode::Navigating) {
            for _ in 0..missing.min(HOLD_MAX_SAMPLES) {
                self.integrate(&measured, self.sample_s);
            }
        }
        // The clock of the procedure goes on: the turntable does too.
        self.tick += missing;
    }

    fn measure(&mut self, aiding: Option<&Aiding>, health: &mut Health, nis: &mut f64) {
        let Some(filter) = &mut self.filter else { return };
        let Some(Calibration { estimator: Estimator::Kalman(kalman), .. }) =
            &self.config.calibration
        else {
            return;
        };
        let period_ticks = kalman.aiding_period_ns / self.config.sample_period_ns;
        let due = self.tick.is_multiple_of(period_ticks);
        if !due && aiding.is_none() {
            return;
        }
        filter.propagate(&self.strapdown);
        let measured = aiding.and_then(|aiding| {
            filter.measure(&aiding.reference, &mut self.strapdown, &mut self.parameters)
        });
        if let Some(measured) = measured {
            self.last_measured_tick = self.tick;
            *nis = measured.nis;
            if measured.rejected {
                *health |= Health::INNOVATION_REJECTED;
            } else {
                self.compensation = Compensation::new(&self.parameters);
                self.sigma = filter.parameter_sigmas();
                self.revision += 1;
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
        if self.nis_running > kalman.refuse_above_mean_nis {
            *health |= Health::INCONSISTENT;
        }
    }

    fn finish_calibration(&mut self, sample: &Sample) {
        let verdict = self.judge();
        match verdict {
            Err(refusal) => {
                self.refusal = Some(refusal);
                self.filter = None;
                self.mode = Mode::Refused;
            }
            Ok(quality) => {
                self.table = self.export(sample, quality);
                self.start_navigation();
            }
        }
    }

    /// Can this calibration be vouched for?
    fn judge(&self) -> Result<Quality, Refusal> {
        let (Some(filter), Some(Calibration { estimator: Estimator::Kalman(kalman), .. })) =
            (&self.filter, &self.config.calibration)
        else {
            return Ok(Quality::default());
        };
        let (tally, quality) = (filter.tally(), quality_of(filter));
        let expected =
            self.calibration_ticks * self.config.sample_period_ns / kalman.aiding_period_ns;
        let total = tally.used + tally.rejected;
        if !filter.covariance().is_finite()
            || self.parameters.to_array().iter().any(|value| !value.is_finite())
        {
            return Err(Refusal::Numeric);
        }
        if (total as f64) < MEASURED_SHARE_MIN * expected as f64 {
            return Err(Refusal::AidingLost { used: total, expected });
        }
        if tally.rejected as f64 > REJECTED_SHARE_MAX * total as f64 {
            return Err(Refusal::Rejected { rejected: tally.rejected, total });
        }
        if tally.recoveries > RECOVERIES_MAX {
            return Err(Refusal::Recoveries { recoveries: tally.recoveries });
        }
        if !(quality.nis_mean <= kalman.refuse_above_mean_nis) {
            return Err(Refusal::Inconsistent {
                mean: quality.nis_mean,
                limit: kalman.refuse_above_mean_nis,
            });
        }
        Ok(quality)
    }

    fn export(&self, sample: &Sample, quality: Quality) -> Option<CalibrationTable> {
        let calibration = self.config.calibration.as_ref()?;
        let filter = self.filter.as_ref()?;
        let first = crate::covariance::PARAMETERS;
        let covariance = core::array::from_fn(|i| {
            core::array::from_fn(|j| filter.covariance().at(first + i, first + j))
        });
        let Site { latitude_rad, longitude_rad, height_m } = self.config.site;
        Some(CalibrationTable {
            parameters: self.parameters,
            covariance,
            quality,
            provenance: Provenance {
                ended_ns: sample.device_time.ns,
                duration_s: calibration.duration_s,
                stops: calibration.sequence.stops().len() as u64
                    * u64::from(calibration.sequence.passes()),
                latitude_rad,
                longitude_rad,
                height_m,
                method: 0,
            },
        })
    }

    fn compare_gimbals(&mut self, sample: &Sample, health: &mut Health) {
        let Some(cursor) = &self.cursor else { return };
        if sample.status.contains(Status::GIMBAL_INVALID)
            || self.phase_tick() < cursor.arrival_tick() + self.settle_ticks
            || self.mode == Mode::Refused
        {
            return;
        }
        // Between command and first motion lie two samples in which the set point is already new.
        let GimbalCommand { target } = self.last_output.gimbal_command;
        let off = |reading: i32, target: i32| {
            (i64::from(reading) - i64::from(target)).unsigned_abs() > GIMBAL_TOLERANCE as u64
        };
        if off(sample.gimbal.azimuth, target.azimuth) || off(sample.gimbal.roll, target.roll) {
            *health |= Health::GIMBAL_DISAGREES;
            self.gimbal_disagreements += 1;
        }
    }

    fn answer(&mut self, sample: &Sample, health: Health, nis: f64) -> Output {
        let phase_tick = self.phase_tick();
        let output = &mut self.last_output;
        output.sequence = sample.sequence;
        output.device_time = sample.device_time;
        output.mode = self.mode;
        output.health = health;
        output.nis = nis;
        output.parameters_revision = self.revision;
        output.navigation = self.strapdown.navigation();
        if let Some(cursor) = &self.cursor {
            output.stop = cursor.stop() as u16;
            output.moving = cursor.moving(phase_tick);
            output.gimbal_command = cursor.command();
        }
        self.last_output
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
        self.filter.as_ref()
    }

    /// Counts so far.
    #[must_use]
    pub fn diagnostics(&self) -> Diagnostics {
        let quality = match (&self.filter, &self.table) {
            (Some(filter), _) => quality_of(filter),
            (None, Some(table)) => table.quality,
            (None, None) => Quality { nis_mean: f64::NAN, ..Quality::default() },
        };
        Diagnostics {
            monitor: *self.monitor.tally(),
            quality,
            gimbal_disagreements: self.gimbal_disagreements,
        }
    }
}

fn quality_of(filter: &CalibrationFilter) -> Quality {
    let tally = filter.tally();
    Quality {
        nis_mean: tally.nis_sum / (tally.used - tally.held) as f64,
        used: tally.used,
        rejected: tally.rejected,
        recoveries: u64::from(tally.recoveries),
    }
}
