//! Counts the completed work of a run from its stream, and takes the planned work from its
//! scenario.

use octant_calibration::config::{CoreConfig, Estimator, Prior, StaticIntervals};
use octant_calibration::schedule::{Cursor, dwell_s};
use octant_calibration::state_machine::prior_after_alignment;
use octant_endpoint::Tells;
use octant_followed::KnownNoise;
use octant_sample::{GimbalAngles, Mode, Output};
use octant_scenario::{CalibrationSpec, Method, Scenario};
use octant_score::work::Work;

/// Largest deviation of a commanded angle from the planned one, rad: a device may store degrees in
/// single precision.
const ANGLE_SLACK_RAD: f64 = 1e-3;
/// Fraction of a dwell for which a stop must be held to count as reached.
const DWELL_PART: f64 = 0.5;
/// Time by which alignment may exceed its plan and still count as part of the calibration, s.
const ALIGNMENT_SLACK_S: f64 = 60.0;

/// Planned work of a method of a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlannedWork {
    /// Planned amounts.
    pub work: Work,
    stops: Vec<PlannedStop>,
    alignment_s: f64,
    /// Standard deviations with which a filter takes over from the alignment.
    prior: Option<Prior>,
    period_ns: u64,
    /// Quantities that the unit reports; `None`: not known, and its answers aren't checked against
    /// its input.
    tells: Option<Tells>,
    is_dithered: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct PlannedStop {
    target: GimbalAngles,
    dwell_ns: u64,
}

impl PlannedWork {
    /// Angles of azimuth and roll at which the gimbals stand through the whole calibration, rad; `None` where
    /// they move, or aren't commanded.
    #[must_use]
    pub(crate) fn standing_rad(&self) -> Option<[f64; 2]> {
        let first = self.stops.first()?.target;
        let standing = self.stops.iter().all(|stop| stop.target == first);
        standing.then(|| [first.azimuth_rad(), first.roll_rad()])
    }

    /// Standard deviations with which a filter takes over from the alignment, where one runs.
    #[must_use]
    pub fn prior(&self) -> Option<&Prior> {
        self.prior.as_ref()
    }

    /// Noise of the samples that is known.
    #[must_use]
    pub(super) fn known_noise(&self) -> KnownNoise {
        if self.is_dithered { KnownNoise::Dither } else { KnownNoise::Simulated }
    }

    /// Returns the quantities that the unit reports, where they are known.
    #[must_use]
    pub fn tells(&self) -> Option<Tells> {
        self.tells
    }

    /// Time between two samples, s.
    pub(crate) fn period_s(&self) -> f64 {
        self.period_ns as f64 * 1e-9
    }

    /// Creates a plan of durations alone, without stops or references.
    #[must_use]
    pub fn lasting(scenario: &Scenario) -> Self {
        let calibration_s = scenario.calibration.as_ref().map(|c| c.duration_s);
        let work = Work { calibration_s, ..Work::default() };
        Self { work, period_ns: scenario.sample_period_ns, ..Self::default() }
    }

    /// Creates the plan of a method, whose core has this configuration. A navigation that lasts
    /// until the source ends is planned over all of its `samples`.
    #[must_use]
    pub fn of(
        scenario: &Scenario,
        method: Method,
        core: &CoreConfig,
        tells: Tells,
        samples: Option<u64>,
    ) -> Self {
        let calibration = scenario.calibration_of(method);
        let stops = match calibration {
            Some(calibration) if tells.commands => stops(calibration, core),
            _ => Vec::new(),
        };
        let period_s = core.sample_period_ns as f64 * 1e-9;
        let calibration_s = calibration.map(|c| c.duration_s);
        let left_s =
            samples.map(|samples| samples as f64 * period_s - calibration_s.unwrap_or(0.0));
        let left_s = left_s.filter(|left_s| *left_s > 0.0);
        let work = Work {
            stops: (!stops.is_empty()).then_some(stops.len() as u64),
            calibration_s,
            references: calibration.and_then(|c| references(c, core.sample_period_ns)),
            navigation_s: scenario.navigation.as_ref().and_then(|n| n.duration_s.or(left_s)),
        };
        let alignment_s = core.alignment.duration_s().unwrap_or(0.0);
        let prior = match core.calibration.as_ref().map(|calibration| &calibration.estimator) {
            Some(Estimator::Kalman(kalman)) => Some(prior_after_alignment(core, kalman).prior),
            _ => None,
        };
        let period_ns = core.sample_period_ns;
        let is_dithered = scenario.dither.is_some();
        Self { work, stops, alignment_s, prior, period_ns, tells: Some(tells), is_dithered }
    }
}

/// Lists the stops that the core is to command, in order; empty if nothing commands them, because
/// the instrument is turned by hand.
fn stops(calibration: &CalibrationSpec, core: &CoreConfig) -> Vec<PlannedStop> {
    let by_hand = matches!(
        &calibration.estimator,
        Estimator::LeastSquares(least_squares)
            if matches!(least_squares.intervals, StaticIntervals::Detected { .. })
    );
    if by_hand {
        return Vec::new();
    }
    let sample_s = core.sample_period_ns as f64 * 1e-9;
    let sequence = &calibration.sequence;
    let Ok(dwell_s) = dwell_s(sequence, calibration.duration_s, &core.turntable) else {
        return Vec::new();
    };
    let from = GimbalAngles::default();
    let mut cursor = Cursor::new(sequence.clone(), from, core.turntable, dwell_s, sample_s, false);
    let count = sequence.stops().len() * sequence.passes() as usize;
    let mut stops = Vec::with_capacity(count);
    loop {
        let held_s = cursor.departure_s() - cursor.arrival_s();
        let dwell_ns = (held_s * 1e9) as u64;
        stops.push(PlannedStop { target: cursor.command().target, dwell_ns });
        if stops.len() == count {
            return stops;
        }
        cursor.advance((cursor.departure_s() / sample_s + 0.5) as u64);
    }
}

/// Returns the number of references that a calibration is to get.
fn references(calibration: &CalibrationSpec, period_ns: u64) -> Option<u64> {
    match &calibration.estimator {
        Estimator::Kalman(kalman) => {
            let duration_ns = (calibration.duration_s * 1e9) as u64;
            Some(duration_ns / kalman.aiding_period_ns.max(period_ns))
        }
        Estimator::LeastSquares(_) | Estimator::ExternalTurntable(_) => None,
    }
}

/// Counts the completed work.
#[derive(Clone, Debug, Default)]
pub struct Done {
    plan: PlannedWork,
    mode: Mode,
    first_ns: Option<u64>,
    last_ns: u64,
    began: Began,
    /// Beginnings by the stamps that the unit got, which a fault may have altered.
    stamped: Began,
    stamped_last_ns: u64,
    stamped_first_ns: u64,
    stop: usize,
    held_ns: u64,
    reached: u64,
    references: u64,
}

/// Times at which the parts of a run began, ns.
#[derive(Clone, Copy, Debug, Default)]
struct Began {
    calibrating: Option<u64>,
    calibrated: Option<u64>,
    navigating: Option<u64>,
}

impl Done {
    /// Creates a counter for a plan.
    #[must_use]
    pub(crate) fn towards(plan: PlannedWork) -> Self {
        Self { plan, ..Self::default() }
    }

    /// Takes another plan, with the same calibration.
    pub(crate) fn plan(&mut self, plan: PlannedWork) {
        self.plan = plan;
    }

    /// Returns the planned work.
    #[must_use]
    pub fn planned(&self) -> Work {
        self.plan.work
    }

    /// Returns the planned and the completed work.
    #[must_use]
    pub fn planned_and_done(&self) -> (Work, Work) {
        (self.planned(), self.work())
    }

    /// Returns the duration of the alignment, s: from the first sample to the first answer after it; 0
    /// for a unit that is given its attitude. `None` as long as the unit aligns.
    #[must_use]
    pub(crate) fn alignment_s(&self) -> Option<f64> {
        let until = self.began.calibrating.or(self.began.navigating)?;
        Some(until.saturating_sub(self.first_ns?) as f64 * 1e-9)
    }

    /// Begins anew after a restart of the unit.
    pub fn restarted(&mut self) {
        let plan = std::mem::take(&mut self.plan);
        *self = Self::towards(plan);
    }

    /// Counts a reference from the source.
    #[inline]
    pub fn reference(&mut self) {
        if matches!(self.mode, Mode::Aligning | Mode::Calibrating) {
            self.references += 1;
        }
    }

    /// Counts an answer, with the time of the source at its sample, ns.
    #[inline]
    pub fn epoch(&mut self, now_ns: u64, output: &Output) {
        let stamped_ns = output.device_time.ns;
        if output.mode != self.mode || self.first_ns.is_none() {
            self.change(now_ns, stamped_ns, output.mode);
        }
        if matches!(output.mode, Mode::Aligning | Mode::Calibrating) {
            self.hold(now_ns.saturating_sub(self.last_ns), output.gimbal_command.target);
        }
        self.last_ns = now_ns;
        self.stamped_last_ns = stamped_ns;
    }

    #[cold]
    fn change(&mut self, now_ns: u64, stamped_ns: u64, mode: Mode) {
        // Stamps mark the ends of intervals.
        let period_ns = self.plan.period_ns;
        if self.first_ns.is_none() {
            self.first_ns = Some(now_ns.saturating_sub(period_ns));
            self.last_ns = now_ns.saturating_sub(period_ns);
            self.stamped_first_ns = stamped_ns.saturating_sub(period_ns);
        }
        for (began, ns, first_ns) in [
            (&mut self.began, now_ns, self.first_ns.unwrap_or_default()),
            (&mut self.stamped, stamped_ns, self.stamped_first_ns),
        ] {
            match mode {
                Mode::Aligning => {}
                Mode::Calibrating => {
                    // A core that is given its attitude calibrates in its first answer.
                    let first = ns.saturating_sub(first_ns) <= period_ns;
                    began.calibrating = Some(if first { first_ns } else { ns });
                }
                Mode::Navigating => {
                    began.calibrated = began.calibrating.and(Some(ns));
                    let first = self.plan.work.calibration_s.is_none()
                        && ns.saturating_sub(first_ns) <= period_ns;
                    began.navigating = Some(if first { first_ns } else { ns });
                }
                Mode::Done | Mode::Refused => {
                    if began.navigating.is_none() {
                        began.calibrated = began.calibrating.and(Some(ns));
                    }
                }
            }
        }
        self.mode = mode;
    }

    /// Counts the time for which a target is commanded.
    #[inline]
    fn hold(&mut self, elapsed_ns: u64, target: GimbalAngles) {
        let Some(stop) = self.plan.stops.get(self.stop) else { return };
        let next = self.plan.stops.get(self.stop + 1);
        if near(target, stop.target) {
            self.held_ns += elapsed_ns;
            let reached = self.stop as u64 + 1;
            if self.reached < reached && self.held_ns as f64 >= stop.dwell_ns as f64 * DWELL_PART {
                self.reached = reached;
            }
            // The last stop of a pass can be the first of the next one.
            if self.held_ns >= stop.dwell_ns
                && next.is_some_and(|next| near(next.target, stop.target))
            {
                (self.stop, self.held_ns) = (self.stop + 1, 0);
            }
        } else if let Some(next) = next
            && near(target, next.target)
            && self.reached == self.stop as u64 + 1
        {
            (self.stop, self.held_ns) = (self.stop + 1, elapsed_ns);
        }
    }

    /// Returns the work completed so far.
    #[must_use]
    pub fn work(&self) -> Work {
        let plan = &self.plan;
        let seconds = |ns: u64| ns as f64 * 1e-9;
        let calibration = |began: &Began, first_ns: u64, last_ns: u64| {
            let from = began.calibrating?;
            let to = began.calibrated.unwrap_or(last_ns);
            let alignment_s = seconds(from.saturating_sub(first_ns));
            let counted_s = alignment_s.min(plan.alignment_s + ALIGNMENT_SLACK_S);
            // In whole nanoseconds, so that work completed to the sample equals the planned work.
            let counted_ns = (counted_s * 1e9).round() as u64;
            Some(seconds(to.saturating_sub(from) + counted_ns))
        };
        let navigation =
            |began: &Began, last_ns: u64| Some(seconds(last_ns.saturating_sub(began.navigating?)));
        let more = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::max);
        let first_ns = self.first_ns.unwrap_or_default();
        let (source, stamped) = (&self.began, &self.stamped);
        // A fault of the stamps alters the duration that the unit measures: the longer of both
        // counts.
        let calibrated = more(
            calibration(source, first_ns, self.last_ns),
            calibration(stamped, self.stamped_first_ns, self.stamped_last_ns),
        );
        let navigated =
            more(navigation(source, self.last_ns), navigation(stamped, self.stamped_last_ns));
        Work {
            stops: plan.work.stops.map(|_| self.reached),
            calibration_s: plan.work.calibration_s.map(|_| calibrated.unwrap_or(0.0)),
            references: plan.work.references.map(|_| self.references),
            navigation_s: navigated.or(plan.work.navigation_s.map(|_| 0.0)),
        }
    }
}

/// Returns whether two targets are equal within [`ANGLE_SLACK_RAD`].
#[inline]
fn near(a: GimbalAngles, b: GimbalAngles) -> bool {
    a == b
        || ((a.azimuth_rad() - b.azimuth_rad()).abs() < ANGLE_SLACK_RAD
            && (a.roll_rad() - b.roll_rad()).abs() < ANGLE_SLACK_RAD)
}
