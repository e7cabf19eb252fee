//! Solution at the ends of alignment and calibration.

use super::solution::{attitude_error, velocity_error};
use octant_calibration::config::Prior;
use octant_endpoint::Tells;
use octant_sample::{Mode, Output, Status, Truth};
use octant_score::alignment::SolutionPoint;
use octant_score::attitude::CaseAngles;
use octant_source::Epoch;

/// End of a part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    Aligned,
    Calibrated,
}

impl Moment {
    /// The moment that a change from one mode to another is, if it is one.
    pub(super) fn of(from: Mode, to: Mode) -> Option<Self> {
        match (from, to) {
            (_, Mode::Calibrating) => Some(Self::Aligned),
            (Mode::Calibrating, Mode::Navigating | Mode::Done) => Some(Self::Calibrated),
            (_, Mode::Navigating) => Some(Self::Aligned),
            _ => None,
        }
    }
}

/// Notes the solution at each moment once: at the next answer that is due, and its errors with the truth of that answer.
#[derive(Clone, Debug)]
pub struct Moments {
    tells: Tells,
    /// Angles at which the gimbals stand, where encoders don't tell, rad.
    standing_rad: Option<[f64; 2]>,
    /// Moment that the next answer that is due is.
    next: Option<Moment>,
    /// Moment that the last answer that was due is, whose errors come with its truth.
    noted: Option<Moment>,
    /// Standard deviations with which a filter takes over from the alignment.
    pub prior: Option<Prior>,
    /// Solution at the end of the alignment.
    pub aligned: Option<SolutionPoint>,
    /// Solution at the end of the calibration.
    pub calibrated: Option<SolutionPoint>,
}

impl Moments {
    pub(super) fn new(tells: Tells, standing_rad: Option<[f64; 2]>, prior: Option<Prior>) -> Self {
        Self {
            tells,
            standing_rad,
            next: None,
            noted: None,
            prior,
            aligned: None,
            calibrated: None,
        }
    }

    /// Sets what the unit of a recording tells.
    pub(super) fn unit_tells(&mut self, tells: Tells) {
        self.tells = tells;
    }

    /// Takes the moment that a change of mode is; a change that is none ends the wait for an earlier one.
    pub(super) fn comes(&mut self, moment: Option<Moment>) {
        self.next = moment;
    }

    /// Takes an answer that is due. Taken whether or not a truth follows: without one, later answers aren't this moment's.
    #[inline]
    pub(super) fn due(&mut self, sent: &Epoch, output: &Output) {
        self.noted = self.next.take();
        if let Some(moment) = self.noted {
            self.note(moment, sent, output);
        }
    }

    /// Notes the solution of an answer, with the gimbals of its sample.
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
        *self.point(moment) = Some(SolutionPoint { attitude, ..SolutionPoint::default() });
    }

    /// Adds the errors to the solution that was noted last.
    #[inline]
    pub(super) fn truth(&mut self, output: &Output, truth: &Truth) {
        if let Some(moment) = self.noted.take() {
            self.note_errors(moment, output, truth);
        }
    }

    #[cold]
    fn note_errors(&mut self, moment: Moment, output: &Output, truth: &Truth) {
        let attitude_error = attitude_error(self.tells, output, truth);
        let velocity_error_mps = velocity_error(self.tells, output, truth);
        if let Some(point) = self.point(moment) {
            (point.attitude_error, point.velocity_error_mps) = (attitude_error, velocity_error_mps);
        }
    }

    fn point(&mut self, moment: Moment) -> &mut Option<SolutionPoint> {
        match moment {
            Moment::Aligned => &mut self.aligned,
            Moment::Calibrated => &mut self.calibrated,
        }
    }
}
