//! Observes a run as it goes by: drift, health, and the series of the report.
//!
//! The same watcher observes a live run and a recording afterwards ([`Watcher::answer`], then
//! [`Watcher::parameters`] and [`Watcher::truth`] where there are any). A rule broken by the unit,
//! or a real-time limit violated by the bench, ends the observation.

use super::at_rest::AtRest;
use super::done::{Done, PlannedWork};
use super::filtered::FilteredSeries;
use super::follow::RunFollower;
use super::solution::{attitude_error, errors, hours, velocity_error};
use super::true_motion::TrueMotion;
use super::whiteness::Whiteness;
use octant_endpoint::Tells;
use octant_endpoint::answer::{AnswerCheck, Misbehaviour};
use octant_plant::Truth;
use octant_report::{GimbalPoint, NisPoint, ParameterPoint, SolutionSeries};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{DeviceTime, Health, Innovation, Mode, NavigationCovariance, Output, Status};
use octant_score::alignment::SolutionPoint;
use octant_score::attitude::CaseAngles;
use octant_score::drift::{DriftSample, DriftScorer};
use octant_score::health::HealthMonitor;
use octant_score::trace::RunTrace;
use octant_score::work::Work;
use octant_source::Epoch;
use std::collections::BTreeMap;

/// Interval at which truth is compared with the navigation solution, ns.
const SCORE_PERIOD_NS: u64 = 1_000_000_000;
/// Number of points for the parameters' convergence that a report draws well.
const CONVERGENCE_POINTS: u64 = 400;
/// Interval at which a gimbal at rest is drawn, ns.
const STANDING_PERIOD_NS: u64 = 60_000_000_000;
/// Maximum number of NIS points; beyond, every second one is dropped.
const NIS_POINTS_MAX: usize = 50_000;
/// Maximum number of gimbal points: days of rotation in navigation are all alike.
const GIMBAL_POINTS_MAX: usize = 40_000;

/// Key of a recording's metadata: whether the unit tells its velocity.
pub(crate) const TELLS_VELOCITY: &str = "tells_velocity";
/// Key of a recording's metadata: whether the unit tells its attitude.
pub(crate) const TELLS_ATTITUDE: &str = "tells_attitude";

/// Observes one run.
#[derive(Clone, Debug)]
pub struct Watcher {
    next_score_ns: u64,
    score_period_ns: u64,
    convergence_period_ns: u64,
    next_convergence_ns: u64,
    next_standing_ns: u64,
    nis_stride: u64,
    measurements: u64,
    was_moving: bool,
    troubled: bool,
    /// Device time at which the present navigation began.
    navigation_start_ns: Option<u64>,
    /// Device time of the last sample of the drift.
    scored_ns: Option<u64>,
    last_ns: u64,
    /// Angles at which the gimbals stand, where encoders don't tell, rad.
    standing_rad: Option<[f64; 2]>,
    /// Standard deviations with which a filter takes over from the alignment.
    pub prior: Option<octant_calibration::config::Prior>,
    tells: Tells,
    check: AnswerCheck,
    follow: RunFollower,
    pub(super) done: Done,
    drift: DriftScorer,
    drift_samples: u64,
    /// Moment of which the solution is to be noted with the next answer that is due.
    moment: Option<Moment>,
    /// Moment that the last answer that was due is, whose errors come with its truth.
    noted: Option<Moment>,
    /// Solution at the end of the alignment.
    pub aligned: Option<SolutionPoint>,
    /// Solution at the end of the calibration.
    pub calibrated: Option<SolutionPoint>,
    /// Trace for the comparison with a twin, where there is one.
    pub trace: Option<RunTrace>,
    /// Noise of the sensors at rest, where it is wanted.
    pub at_rest: Option<Box<AtRest>>,
    /// Errors and σ of a filter that calibrates, where they are wanted.
    pub filtered: Option<FilteredSeries>,
    /// Whether the innovations are white.
    pub whiteness: Whiteness,
    /// Health and NIS over the run.
    pub health: HealthMonitor,
    /// Time of the source at the next output, where faults may have altered its stamp.
    pub source_time: Option<DeviceTime>,
    /// Convergence of the parameters.
    pub convergence: Vec<ParameterPoint>,
    /// NIS of the measurements.
    pub nis: Vec<NisPoint>,
    /// Errors of attitude and velocity over the last navigation.
    pub solution: SolutionSeries,
    /// Motion of the truth while the unit navigates.
    pub moved: TrueMotion,
    /// Gimbal angles.
    pub gimbals: Vec<GimbalPoint>,
    /// Parameters as last reported.
    pub last_parameters: Option<ParameterEstimate>,
    /// Mode after the last epoch.
    pub last_mode: Mode,
    /// First rule that the unit's answers broke, which ended the run.
    pub misbehaved: Option<Misbehaviour>,
    /// First real-time limit that the bench violated: nothing after it counts.
    pub bench_broke: Option<BenchBroke>,
}

/// End of a part of a run, at which the solution is noted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moment {
    Aligned,
    Calibrated,
}

/// First violation of a real-time limit by the bench.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchBroke {
    /// Time of the source, s.
    pub at_s: f64,
    /// Violation, in plain words.
    pub reason: String,
}

impl Watcher {
    /// Creates a watcher of a run with this plan.
    #[must_use]
    pub fn new(plan: PlannedWork) -> Self {
        let calibration_s = plan.work.calibration_s.unwrap_or(0.0);
        let follows = plan.tells().is_none_or(|tells| tells.follows);
        Self {
            next_score_ns: 0,
            // A solution from elsewhere may jump between two seconds.
            score_period_ns: if follows { SCORE_PERIOD_NS } else { 1 },
            convergence_period_ns: (calibration_s * 1e9) as u64 / CONVERGENCE_POINTS,
            next_convergence_ns: 0,
            next_standing_ns: 0,
            nis_stride: 1,
            measurements: 0,
            was_moving: false,
            troubled: false,
            navigation_start_ns: None,
            scored_ns: None,
            last_ns: 0,
            prior: plan.prior().copied(),
            standing_rad: plan.standing_rad(),
            tells: plan.tells().unwrap_or(Tells::ALL),
            check: AnswerCheck::new(),
            follow: RunFollower::new(plan.tells()),
            done: Done::towards(plan),
            drift: DriftScorer::new(),
            drift_samples: 0,
            moment: None,
            noted: None,
            aligned: None,
            calibrated: None,
            trace: None,
            at_rest: None,
            filtered: None,
            whiteness: Whiteness::default(),
            health: HealthMonitor::new(),
            source_time: None,
            convergence: Vec::new(),
            nis: Vec::new(),
            solution: SolutionSeries::default(),
            moved: TrueMotion::default(),
            gimbals: Vec::new(),
            last_parameters: None,
            last_mode: Mode::default(),
            misbehaved: None,
            bench_broke: None,
        }
    }

    /// Sets which quantities the unit of a recording tells, from the recording's metadata. A recording
    /// without a statement has all of them.
    pub fn recorded(&mut self, run: &BTreeMap<String, String>) {
        let told = |key: &str| run.get(key).is_none_or(|text| text != "false");
        self.tells.velocity = told(TELLS_VELOCITY);
        self.tells.attitude = told(TELLS_ATTITUDE);
    }

    /// Takes the source's epoch, before faults alter it.
    #[inline]
    pub fn source(&mut self, clean: &Epoch) {
        self.source_time = Some(clean.sample.device_time);
        if let Some(at_rest) = &mut self.at_rest {
            at_rest.push(&clean.sample);
        }
        if clean.aiding.is_some() {
            self.done.reference();
        }
    }

    /// Begins anew after a restart of the unit.
    pub fn restarted(&mut self) {
        self.check.restarted();
        self.done.restarted();
    }

    /// Notes a violation of a real-time limit at a time of the source: later answers aren't judged.
    #[cold]
    pub fn bench_broke(&mut self, at_ns: u64, reason: String) {
        if self.bench_broke.is_none() {
            self.bench_broke = Some(BenchBroke { at_s: at_ns as f64 * 1e-9, reason });
        }
    }

    /// True if nothing more is judged.
    fn is_over(&self) -> bool {
        self.misbehaved.is_some() || self.bench_broke.is_some()
    }

    /// Takes the answer to an epoch as it reached the unit; returns true if truth at it is needed.
    #[inline]
    pub fn answer(&mut self, sent: &Epoch, altered: bool, output: &Output) -> bool {
        if self.is_over() {
            return false;
        }
        if let Err(misbehaviour) = self.check.answer(&sent.sample, output) {
            self.misbehaved = Some(misbehaviour);
            return false;
        }
        let now_ns = self.source_time.unwrap_or(output.device_time).ns;
        self.done.epoch(now_ns, output);
        if !altered {
            self.follow.epoch(now_ns, output);
        }
        let due = self.epoch(output);
        if due {
            // Taken whether or not a truth follows: without one, later answers aren't this moment's.
            self.noted = self.moment.take();
            if let Some(moment) = self.noted {
                self.note(moment, sent, output);
            }
        }
        due
    }

    /// Takes an output that answers no sample, or one that isn't known any more; returns true if
    /// truth at it is needed.
    #[inline(always)]
    pub fn epoch(&mut self, output: &Output) -> bool {
        let now_ns = output.device_time.ns;
        self.last_ns = now_ns;
        if let Some(trace) = &mut self.trace {
            trace.output(output);
        }
        if output.mode != self.last_mode {
            self.change_mode(output);
        }
        if !output.health.is_empty() || self.troubled || output.nis.is_finite() {
            self.troubled = !output.health.is_empty();
            self.measurement(output);
        }
        if output.moving != self.was_moving || now_ns >= self.next_standing_ns {
            self.gimbals(output);
        }
        // Also due if time has run back by more than a period: a fault can do that to stamps.
        let period_ns = self.score_period_ns;
        let due = self.next_score_ns.wrapping_sub(now_ns).wrapping_sub(1) >= period_ns;
        if due {
            self.next_score_ns = (now_ns / period_ns + 1) * period_ns;
        }
        due
    }

    #[cold]
    fn change_mode(&mut self, output: &Output) {
        // The output in which navigation begins holds the state at its start.
        if output.mode == Mode::Navigating {
            // A restarted core navigates anew: the last navigation is the one that is scored.
            (self.drift, self.drift_samples) = (DriftScorer::new(), 0);
            self.solution = SolutionSeries::default();
            self.trace.iter_mut().for_each(RunTrace::navigation_begins);
            self.navigation_start_ns = Some(output.device_time.ns);
            self.scored_ns = None;
            self.next_score_ns = output.device_time.ns;
        }
        if output.mode == Mode::Done {
            self.next_score_ns = 0;
        }
        self.moment = match (self.last_mode, output.mode) {
            (_, Mode::Calibrating) => Some(Moment::Aligned),
            (Mode::Calibrating, Mode::Navigating | Mode::Done) => Some(Moment::Calibrated),
            (_, Mode::Navigating) => Some(Moment::Aligned),
            _ => None,
        };
        if self.moment.is_some() {
            self.next_score_ns = output.device_time.ns;
        }
        self.last_mode = output.mode;
    }

    /// Notes the solution at the end of an alignment or calibration, with the gimbals of its sample.
    #[cold]
    fn note(&mut self, moment: Moment, sent: &Epoch, output: &Output) {
        let sample = &sent.sample;
        let gimbal_rad = if sample.status.contains(Status::GIMBAL_INVALID) {
            // Without encoders, as an instrument is that stands alone.
            self.standing_rad
        } else {
            Some([sample.gimbal.azimuth_rad(), sample.gimbal.roll_rad()])
        };
        let attitude = gimbal_rad
            .filter(|_| self.tells.attitude)
            .map(|gimbal_rad| CaseAngles::of(output.navigation.q_nb, gimbal_rad));
        let point = Some(SolutionPoint { attitude, ..SolutionPoint::default() });
        match moment {
            Moment::Aligned => self.aligned = point,
            Moment::Calibrated => self.calibrated = point,
        }
    }

    /// Adds the errors to the noted solution.
    #[cold]
    fn note_errors(&mut self, moment: Moment, output: &Output, truth: &Truth) {
        let attitude_error = attitude_error(self.tells, output, truth);
        let velocity_error_mps = velocity_error(self.tells, output, truth);
        let point = match moment {
            Moment::Aligned => &mut self.aligned,
            Moment::Calibrated => &mut self.calibrated,
        };
        if let Some(point) = point {
            (point.attitude_error, point.velocity_error_mps) = (attitude_error, velocity_error_mps);
        }
    }

    #[inline(never)]
    fn measurement(&mut self, output: &Output) {
        self.health.push_at(output, self.source_time.unwrap_or(output.device_time));
        if output.nis.is_finite() {
            self.measurements += 1;
            if self.nis.len() >= NIS_POINTS_MAX {
                let mut odd = false;
                self.nis.retain(|_| {
                    odd = !odd;
                    odd
                });
                self.nis_stride *= 2;
            }
            // Rejected measurements are always drawn.
            let rejected = output.health.contains(Health::INNOVATION_REJECTED);
            if rejected || self.measurements.is_multiple_of(self.nis_stride) {
                self.nis.push(NisPoint { hours: hours(output), nis: output.nis, innovation: None });
            }
        }
    }

    /// Takes the innovation of the measurement in the last output.
    #[inline(never)]
    pub fn innovation(&mut self, output: &Output, innovation: &Innovation) {
        self.whiteness.push(innovation);
        let at = hours(output);
        if let Some(point) = self.nis.last_mut().filter(|point| point.hours == at) {
            point.innovation = Some(*innovation);
        }
    }

    /// Takes the filter's covariance after the measurement in the last output.
    #[inline(never)]
    pub fn covariance(&mut self, sent: &Epoch, output: &Output, covariance: &NavigationCovariance) {
        if let Some(filtered) = &mut self.filtered {
            filtered.covariance(&sent.sample, output, covariance);
        }
    }

    #[inline(never)]
    fn gimbals(&mut self, output: &Output) {
        let now_ns = output.device_time.ns;
        // A move is drawn as a line between its ends.
        self.next_standing_ns = now_ns + STANDING_PERIOD_NS;
        if let (Some(at_rest), true) = (&mut self.at_rest, output.moving != self.was_moving) {
            at_rest.unit_moves(output.moving);
        }
        self.was_moving = output.moving;
        if self.gimbals.len() < GIMBAL_POINTS_MAX {
            let target = output.gimbal_command.target;
            let (azimuth_deg, roll_deg) =
                (target.azimuth_rad().to_degrees(), target.roll_rad().to_degrees());
            // Until the gimbals arrive they are drawn at their last position.
            let (azimuth_deg, roll_deg) = match self.gimbals.last() {
                Some(last) if output.moving => (last.azimuth_deg, last.roll_deg),
                _ => (azimuth_deg, roll_deg),
            };
            let stop = (output.mode == Mode::Calibrating).then_some(output.stop);
            let (hours, moving) = (hours(output), output.moving);
            self.gimbals.push(GimbalPoint { hours, azimuth_deg, roll_deg, moving, stop });
        }
    }

    /// Takes the parameters that came with the last epoch.
    #[inline]
    pub fn parameters(&mut self, output: &Output, estimate: &ParameterEstimate) {
        if self.is_over() {
            return;
        }
        if let Err(misbehaviour) = self.check.parameters(output.sequence, estimate) {
            self.misbehaved = Some(misbehaviour);
            return;
        }
        self.last_parameters = Some(*estimate);
        if output.device_time.ns >= self.next_convergence_ns {
            self.next_convergence_ns = output.device_time.ns + self.convergence_period_ns.max(1);
            self.convergence.push(ParameterPoint {
                hours: hours(output),
                estimate: estimate.parameters,
                sigma: estimate.sigma,
            });
        }
    }

    /// Takes the truth of the last epoch.
    pub fn truth(&mut self, output: &Output, truth: &Truth) {
        if let Some(moment) = self.noted.take() {
            self.note_errors(moment, output, truth);
        }
        let attitude_error = attitude_error(self.tells, output, truth);
        let velocity_error_mps = velocity_error(self.tells, output, truth);
        if let Some(filtered) = &mut self.filtered {
            filtered.errors(output, errors(attitude_error, velocity_error_mps));
        }
        let (Some(start_ns), now_ns) = (self.navigation_start_ns, output.device_time.ns) else {
            return;
        };
        // A drift is a function of time: stamps that a fault puts before the last scored one are
        // left out, as are those of a restarted core.
        if now_ns < start_ns
            || self.scored_ns.is_some_and(|scored_ns| now_ns <= scored_ns)
            || !matches!(output.mode, Mode::Navigating | Mode::Done)
        {
            return;
        }
        self.scored_ns = Some(now_ns);
        self.moved.push(now_ns, truth);
        self.drift_samples += 1;
        let sample = DriftSample {
            t_s: (now_ns - start_ns) as f64 * 1e-9,
            latitude_error_rad: output.navigation.latitude_rad - truth.latitude_rad,
            longitude_error_rad: output.navigation.longitude_rad - truth.longitude_rad,
            attitude_error,
            velocity_error_mps,
            latitude_rad: truth.latitude_rad,
            height_m: truth.height_m,
        };
        if let Some(trace) = &mut self.trace {
            let (north, east) = (sample.latitude_error_rad, sample.longitude_error_rad);
            trace.drift(sample.t_s, north, east);
        }
        self.solution.push(sample.t_s / 3600.0, errors(attitude_error, velocity_error_mps));
        self.drift.push(&sample);
    }

    /// Returns the drift so far; `None` without navigation or without truth.
    #[must_use]
    pub fn drift(&self) -> Option<&DriftScorer> {
        (self.drift_samples >= 2).then_some(&self.drift)
    }

    /// Returns the time at which the last navigation began, h; `None` without one.
    #[must_use]
    pub fn navigation_start_h(&self) -> Option<f64> {
        self.navigation_start_ns.map(|ns| ns as f64 / 3.6e12)
    }

    /// Returns the planned and the completed work.
    #[must_use]
    pub fn work(&self) -> (Work, Work) {
        (self.done.planned(), self.done.work())
    }

    /// Returns the duration of the alignment, s; `None` as long as the unit aligns.
    #[must_use]
    pub fn alignment_s(&self) -> Option<f64> {
        self.done.alignment_s()
    }

    /// Describes the answers that don't follow the unit's input.
    #[must_use]
    pub fn does_not_follow(&self) -> Vec<String> {
        self.follow.reasons()
    }

    /// Returns the length of the run so far, s of device time.
    #[must_use]
    pub fn elapsed_s(&self) -> f64 {
        self.last_ns as f64 * 1e-9
    }
}
