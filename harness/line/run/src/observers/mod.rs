//! Observers of a run as it goes by.
//!
//! Each observer has one subject: [`answers`] the rules of the unit, [`done`] the work completed, [`moments`] the
//! solution at the ends of alignment and calibration, [`drift`] the navigation against the truth, [`convergence`] the
//! parameters, [`measurements`] health and NIS, [`gimbals`] their angles, [`heading`] the readings of a heading test, [`session`] the
//! answers that are compared with another session of the unit; [`at_rest`] the noise of the sensors and
//! [`filtered`] the σ of a filter, which only a report shows. [`Observers`] gives each of them what it needs, once.
//!
//! The same observers see a live run and a recording afterwards ([`Observers::answer`], then
//! [`Observers::parameters`] and [`Observers::truth`] where there are any). A rule broken by the unit,
//! or a real-time limit violated by the bench, ends the observation.

pub mod answers;
pub mod at_rest;
pub mod convergence;
pub mod done;
pub mod drift;
pub mod filtered;
mod fit;
pub mod follow;
pub mod gimbals;
pub mod heading;
pub mod information;
pub mod measurements;
pub mod moments;
pub mod session;
mod solution;
pub mod whiteness;

use self::answers::Answers;
use self::at_rest::AtRest;
use self::convergence::Convergence;
use self::done::{Done, PlannedWork};
use self::drift::NavigationDrift;
use self::filtered::FilteredSeries;
use self::gimbals::GimbalSeries;
use self::heading::HeadingReadings;
use self::information::CalibrationInformation;
use self::measurements::Measurements;
use self::moments::{Moment, Moments};
use self::session::SessionTrack;
use self::solution::{SolutionErrors, attitude_error, errors, position_error, velocity_error};
use octant_endpoint::Tells;
use octant_followed::{Compared, Follower, KnownNoise, Told};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{
    DeviceTime, Innovation, Mode, NavigationCovariance, NoiseIntegral, Output, Truth,
};
use octant_score::trace::RunTrace;
use octant_source::Epoch;
use std::collections::BTreeMap;

/// Interval at which truth is compared with the navigation solution, ns.
const SCORE_PERIOD_NS: u64 = 1_000_000_000;

/// Key of a recording's metadata: whether the unit tells its velocity.
pub(crate) const TELLS_VELOCITY: &str = "tells_velocity";
/// Key of a recording's metadata: whether the unit tells its attitude.
pub(crate) const TELLS_ATTITUDE: &str = "tells_attitude";
/// Key of a recording's metadata, in that of a solution that was made elsewhere: whether it tells its position.
pub(crate) const TELLS_POSITION: &str = "tells_position";
/// Likewise: whether it tells roll and pitch.
pub(crate) const TELLS_TILT: &str = "tells_tilt";

/// The observers of one run.
#[derive(Clone, Debug)]
pub struct Observers {
    now: Now,
    tells: Tells,
    /// The rules of the unit, and the bench's own limits.
    pub answers: Answers,
    /// The work planned and completed.
    pub done: Done,
    /// Solutions at the ends of alignment and calibration.
    pub moments: Moments,
    /// The last navigation against the truth.
    pub drift: NavigationDrift,
    /// The navigation against the noise of its samples.
    pub followed: Follower,
    known_noise: Option<NoiseIntegral>,
    /// Information on the parameters in the samples of the calibration.
    pub information: CalibrationInformation,
    /// The parameters.
    pub convergence: Convergence,
    /// Health, NIS and innovations.
    pub measurements: Measurements,
    /// Gimbal angles.
    pub gimbals: GimbalSeries,
    /// Readings of a heading test, where there is one.
    pub heading: Option<Box<HeadingReadings>>,
    /// Trace for the comparison with a twin, where there is one.
    pub trace: Option<RunTrace>,
    /// Answers for the comparison with another session of the same unit, where there is one.
    pub session: Option<Box<SessionTrack>>,
    /// Series for a report alone.
    pub charts: Charts,
}

/// Where the run is.
#[derive(Clone, Copy, Debug)]
struct Now {
    /// Time of the source at the next output, where faults may have altered its stamp.
    source: Option<DeviceTime>,
    last_ns: u64,
    mode: Mode,
    next_score_ns: u64,
    score_period_ns: u64,
    /// True if the last answer counts for the maxima of the navigation alone.
    between: bool,
}

impl Now {
    /// Returns whether the truth is to be compared at this time; the next one is a period later.
    #[inline(always)]
    fn is_due(&mut self, now_ns: u64) -> bool {
        let period_ns = self.score_period_ns;
        // Also due if time has run back by more than a period: a fault can do that to stamps.
        let due = self.next_score_ns.wrapping_sub(now_ns).wrapping_sub(1) >= period_ns;
        if due {
            self.next_score_ns = (now_ns / period_ns + 1) * period_ns;
        }
        due
    }
}

/// Observers that only a report needs.
#[derive(Clone, Debug, Default)]
pub struct Charts {
    /// Noise of the sensors at rest, where it is wanted.
    pub at_rest: Option<Box<AtRest>>,
    /// Errors and σ of a filter that calibrates, where they are wanted.
    pub filtered: Option<FilteredSeries>,
}

impl Observers {
    /// Creates the observers of a run with this plan.
    #[must_use]
    pub fn new(plan: PlannedWork) -> Self {
        let calibration_s = plan.work.calibration_s.unwrap_or(0.0);
        let follows = plan.tells().is_none_or(|tells| tells.follows);
        let tells = plan.tells().unwrap_or(Tells::ALL);
        let known = plan.known_noise();
        // A solution that was made elsewhere may lack points.
        let gaps_s = (!follows).then(|| plan.period_s());
        let now = Now {
            source: None,
            last_ns: 0,
            mode: Mode::default(),
            next_score_ns: 0,
            between: false,
            // A solution from elsewhere may jump between two seconds.
            score_period_ns: if follows { SCORE_PERIOD_NS } else { 1 },
        };
        Self {
            now,
            tells,
            answers: Answers::new(plan.tells()),
            moments: Moments::new(tells, plan.standing_rad(), plan.prior().copied()),
            done: Done::towards(plan),
            drift: NavigationDrift::of_gaps(gaps_s),
            followed: Follower::new(quantities(tells), known),
            known_noise: None,
            information: CalibrationInformation::default(),
            convergence: Convergence::over(calibration_s),
            measurements: Measurements::new(),
            gimbals: GimbalSeries::default(),
            heading: None,
            trace: None,
            session: None,
            charts: Charts::default(),
        }
    }

    /// Reads the headings of a scenario's heading test, if it has one.
    pub fn read_headings_of(&mut self, scenario: &octant_scenario::Scenario) {
        self.heading = HeadingReadings::of(scenario);
        if let Some(heading) = &self.heading {
            self.now.score_period_ns = self.now.score_period_ns.min(heading.period_ns());
        }
    }

    /// Sets which quantities the unit of a recording tells, from the recording's metadata. A recording
    /// without a statement has all of them.
    pub fn recorded(&mut self, run: &BTreeMap<String, String>) {
        let told = |key: &str| run.get(key).is_none_or(|text| text != "false");
        self.tells.velocity = told(TELLS_VELOCITY);
        self.tells.attitude = told(TELLS_ATTITUDE);
        self.tells.position = told(TELLS_POSITION);
        self.tells.tilt = told(TELLS_TILT);
        self.moments.unit_tells(self.tells);
        self.followed = Follower::new(quantities(self.tells), KnownNoise::Simulated);
    }

    /// Takes the source's epoch, before faults alter it.
    #[inline]
    pub fn source(&mut self, clean: &Epoch) {
        self.now.source = Some(clean.sample.device_time);
        if let Some(at_rest) = &mut self.charts.at_rest {
            at_rest.push(&clean.sample);
        }
        if clean.aiding.is_some() {
            self.done.reference();
        }
    }

    /// Takes the time of the source at an answer to a further epoch of a step.
    #[inline]
    pub(crate) fn source_time(&mut self, step_ns: u64) {
        self.now.source = Some(DeviceTime { ns: step_ns });
    }

    /// Begins anew after a restart of the unit.
    pub fn restarted(&mut self) {
        self.answers.restarted();
        self.done.restarted();
        self.followed.interrupt();
        if let Some(heading) = &mut self.heading {
            let last_ns = self.now.source.map_or(self.now.last_ns, |time| time.ns);
            heading.switched_on(last_ns);
        }
    }

    /// Takes the answer to an epoch as it reached the unit; returns true if truth at it is needed.
    #[inline]
    pub fn answer(&mut self, sent: &Epoch, altered: bool, output: &Output) -> bool {
        self.now.between = false;
        if !self.answers.answer(sent, output) {
            return false;
        }
        let now_ns = self.now.source.unwrap_or(output.device_time).ns;
        self.done.epoch(now_ns, output);
        if let Some(session) = &mut self.session {
            session.answer(sent, output);
        }
        if altered {
            self.answers.altered();
            self.followed.interrupt();
        } else {
            self.answers.follow(now_ns, sent, output);
            if !follow::is_free(output) {
                self.followed.interrupt();
            }
        }
        let due = self.epoch(output);
        if due {
            self.moments.due(sent, output);
        } else {
            self.now.between = output.mode == Mode::Navigating;
        }
        due
    }

    /// Takes the last answer for the maxima of the navigation, which are over every answer, where its errors aren't
    /// scored in full; `stands` says whether the truth is that at the answer before, and `None` that it has to be
    /// compared. Returns true if truth at it is needed.
    #[inline(always)]
    pub fn between(&mut self, output: &Output, stands: impl FnOnce() -> Option<bool>) -> bool {
        if !self.now.between {
            return false;
        }
        match stands() {
            Some(true) => {
                self.drift.between(output);
                false
            }
            Some(false) => self.strays(output),
            None => true,
        }
    }

    /// Returns whether an answer at a truth that moves is to be compared with it.
    #[inline(always)]
    fn strays(&mut self, output: &Output) -> bool {
        let strays = self.drift.strays(output);
        if !strays {
            // The truth moves on, and isn't known from here.
            self.drift.lost();
        }
        strays
    }

    /// Takes an output that answers no sample, or one that isn't known any more; returns true if
    /// truth at it is needed.
    #[inline(always)]
    pub fn epoch(&mut self, output: &Output) -> bool {
        let now_ns = output.device_time.ns;
        self.now.last_ns = now_ns;
        if let Some(trace) = &mut self.trace {
            trace.output(output);
        }
        if output.mode != self.now.mode {
            self.change_mode(output);
        }
        self.measurements.answer(output, self.now.source);
        if self.gimbals.answer(output)
            && let Some(at_rest) = &mut self.charts.at_rest
        {
            at_rest.unit_moves(output.moving);
        }
        self.now.is_due(now_ns)
    }

    #[cold]
    fn change_mode(&mut self, output: &Output) {
        let now_ns = output.device_time.ns;
        // The output in which navigation begins holds the state at its start.
        if output.mode == Mode::Navigating {
            self.drift.begin(now_ns);
            self.trace.iter_mut().for_each(RunTrace::navigation_begins);
            self.now.next_score_ns = now_ns;
        }
        if output.mode == Mode::Done {
            self.now.next_score_ns = 0;
        }
        let moment = Moment::of(self.now.mode, output.mode);
        if moment.is_some() {
            self.now.next_score_ns = now_ns;
        }
        self.moments.comes(moment);
        self.followed.interrupt();
        self.now.mode = output.mode;
    }

    /// Takes the innovation of the measurement in the last output.
    pub fn innovation(&mut self, output: &Output, innovation: &Innovation) {
        self.measurements.innovation(output, innovation);
    }

    /// Takes the filter's covariance after the measurement in the last output.
    #[inline(never)]
    pub fn covariance(&mut self, sent: &Epoch, output: &Output, covariance: &NavigationCovariance) {
        if let Some(filtered) = &mut self.charts.filtered {
            filtered.covariance(&sent.sample, output, covariance);
        }
    }

    /// Takes the parameters that came with the last epoch.
    #[inline]
    pub fn parameters(&mut self, output: &Output, estimate: &ParameterEstimate) {
        if self.answers.parameters(output, estimate) {
            self.convergence.parameters(output, estimate);
        }
    }

    /// Notes an epoch of the source that no answer follows, or none yet.
    pub(crate) fn lost(&mut self) {
        self.drift.lost();
        self.answers.altered();
        self.followed.interrupt();
    }

    /// Takes the truth at an answer that asked for it in [`Self::between`].
    pub fn truth_between(&mut self, output: &Output, truth: &Truth, stands: Option<bool>) {
        let same = stands.is_none() && self.drift.is_at(self.tells, truth);
        if same || stands.is_some() || self.strays(output) {
            self.drift.stand(self.tells, truth);
            self.drift.between(output);
        }
    }

    /// Takes the noise in the samples up to the truth that follows.
    pub fn noise(&mut self, noise: Option<NoiseIntegral>) {
        self.known_noise = noise;
    }

    /// Takes the truth of the last epoch.
    pub fn truth(&mut self, output: &Output, truth: &Truth) {
        if let Some(heading) = &mut self.heading {
            let now_ns = self.now.source.unwrap_or(output.device_time).ns;
            heading.read(self.tells, now_ns, output, truth);
        }
        self.moments.truth(output, truth);
        if output.mode == Mode::Calibrating {
            let now_ns = self.now.source.unwrap_or(output.device_time).ns;
            self.information.truth(now_ns, truth);
        }
        if output.mode == Mode::Navigating {
            let (answer, noise) = (&output.navigation, self.known_noise.take());
            let now_ns = self.now.source.unwrap_or(output.device_time).ns;
            self.followed.compare(&Compared { now_ns, answer, truth, noise });
        }
        let attitude_error = attitude_error(self.tells, output, truth);
        let velocity_error_mps = velocity_error(self.tells, output, truth);
        if let Some(filtered) = &mut self.charts.filtered {
            filtered.errors(output, errors(attitude_error, velocity_error_mps));
        }
        let position_error_rad = position_error(self.tells, output, truth);
        let errors = SolutionErrors { position_error_rad, attitude_error, velocity_error_mps };
        let sample = self.drift.truth(output, truth, &errors);
        self.drift.stand(self.tells, truth);
        if let (Some(trace), Some(sample)) = (&mut self.trace, sample)
            && let Some([latitude_error_rad, longitude_error_rad]) = sample.position_error_rad
        {
            trace.drift(sample.t_s, latitude_error_rad, longitude_error_rad);
        }
    }

    /// Mode after the last epoch.
    #[must_use]
    pub fn last_mode(&self) -> Mode {
        self.now.mode
    }

    /// Returns the length of the run so far, s of device time.
    #[must_use]
    pub(crate) fn elapsed_s(&self) -> f64 {
        self.now.last_ns as f64 * 1e-9
    }
}

/// Quantities of a solution whose errors are tested for the noise of the samples.
fn quantities(tells: Tells) -> Told {
    let Tells { attitude, tilt, velocity, position, .. } = tells;
    Told { attitude: attitude && tilt, velocity, position }
}
