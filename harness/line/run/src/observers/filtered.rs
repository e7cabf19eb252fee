//! Errors of attitude and velocity while a filter calibrates, with the filter's own σ.

use octant_calibration::config::Estimator;
use octant_earth::units::ARCMIN;
use octant_sample::{Mode, NavigationCovariance, Output, Sample, Status};
use octant_scenario::{Method, Scenario};
use octant_score::alignment::case_sigma;
use octant_score::attitude::CaseAngles;
use octant_score::run_series::SolutionSeries;

/// Number of points of σ over a calibration.
const SIGMA_POINTS: u64 = 400;
/// Largest number of stretches whose extremes are kept of the errors.
const ERROR_STRETCHES: usize = 500;

/// Series of one calibration by a filter.
#[derive(Clone, Debug)]
pub struct FilteredSeries {
    /// Errors over the hours of the run.
    pub errors: SolutionSeries,
    /// Rows of σ: hours of the run; heading, pitch and roll of the case, arcmin; velocity north and
    /// east, m/s.
    pub sigma: Vec<[f64; 6]>,
    period_ns: u64,
    next_ns: u64,
    last_ns: Option<u64>,
}

impl FilteredSeries {
    /// Creates the series of a method that calibrates by a filter; `None` for another method: least
    /// squares has no attitude over time.
    #[must_use]
    pub fn of(scenario: &Scenario, method: Method) -> Option<Self> {
        let calibration = scenario.calibration_of(method)?;
        let filters = matches!(calibration.estimator, Estimator::Kalman(_));
        let period_ns = (calibration.duration_s * 1e9) as u64 / SIGMA_POINTS;
        filters.then(|| Self {
            errors: SolutionSeries::of_stretches(ERROR_STRETCHES),
            sigma: Vec::new(),
            period_ns,
            next_ns: 0,
            last_ns: None,
        })
    }

    /// Takes the rows of σ out, for the summary.
    pub(crate) fn take_sigma(&mut self) -> Vec<[f64; 6]> {
        std::mem::take(&mut self.sigma)
    }

    /// Takes errors, in the order of [`SolutionSeries::push`].
    pub(super) fn errors(&mut self, output: &Output, errors: [f64; 5]) {
        let now_ns = output.device_time.ns;
        // Stamps that a fault put back are left out: a chart goes forward in time.
        if output.mode == Mode::Calibrating && self.last_ns.is_none_or(|last_ns| now_ns > last_ns) {
            self.last_ns = Some(now_ns);
            self.errors.push(output.device_time.seconds() / 3600.0, errors);
        }
    }

    /// Takes the filter's covariance after the measurement in an output, with the sample that this
    /// answers: the encoders turn the attitude back to the case.
    pub(super) fn covariance(
        &mut self,
        sample: &Sample,
        output: &Output,
        covariance: &NavigationCovariance,
    ) {
        let now_ns = output.device_time.ns;
        if now_ns < self.next_ns || sample.status.contains(Status::GIMBAL_INVALID) {
            return;
        }
        self.next_ns = now_ns + self.period_ns;
        let gimbal_rad = [sample.gimbal.azimuth_rad(), sample.gimbal.roll_rad()];
        let attitude = CaseAngles::of(output.navigation.q_nb, gimbal_rad);
        let [nn, ne, nd, ee, ed, dd] = covariance.attitude_rad2;
        let phi = [[nn, ne, nd], [ne, ee, ed], [nd, ed, dd]];
        let [heading, pitch, roll] = case_sigma(&phi, &attitude);
        let [north, _, _, east, ..] =
            covariance.velocity_m2ps2.map(|variance| variance.max(0.0).sqrt());
        let hours = output.device_time.seconds() / 3600.0;
        let arcmin = |sigma_rad: f64| sigma_rad / ARCMIN;
        self.sigma.push([hours, arcmin(heading), arcmin(pitch), arcmin(roll), north, east]);
    }
}
