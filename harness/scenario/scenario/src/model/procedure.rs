//! Procedure of the core: alignment and the methods of calibration.

use octant_calibration::config as core;
use octant_calibration::visits::VisitedPositions;
use octant_sample::parameters::ParameterGroup;

/// One of the two methods of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// The calibration of `[procedure.calibration]`.
    Primary,
    /// The calibration of `[baseline]`.
    Baseline,
}

/// Alignment of the core, which gives its initial attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlignmentSpec {
    /// The attitude is given with an error.
    Given {
        /// 1σ of the tilt about north and east, rad.
        tilt_rad: f64,
        /// 1σ of the azimuth, rad.
        azimuth_rad: f64,
        /// 1σ of each velocity, m/s.
        velocity_mps: f64,
        /// Attitude error, if it isn't drawn, rad.
        attitude_error_rad: Option<[f64; 3]>,
        /// Velocity error, if it isn't drawn, m/s.
        velocity_error_mps: Option<[f64; 3]>,
    },
    /// The core finds the attitude itself, from averages.
    Coarse {
        /// Averaging time, s.
        duration_s: f64,
    },
    /// The core finds the attitude itself, from the way in which gravity turns.
    Inertial {
        /// Time of the alignment, s.
        duration_s: f64,
    },
}

impl AlignmentSpec {
    /// Time that the core aligns for, s; `None` where the attitude is handed over.
    #[must_use]
    pub fn duration_s(&self) -> Option<f64> {
        match *self {
            Self::Given { .. } => None,
            Self::Coarse { duration_s } | Self::Inertial { duration_s } => Some(duration_s),
        }
    }
}

/// One method of calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationSpec {
    /// Name of the sequence: that of a published one, or the scenario's for its own; `own stops` where it
    /// gives none.
    pub name: String,
    /// Stops.
    pub sequence: octant_calibration::sequence::Sequence,
    /// Total duration, s.
    pub duration_s: f64,
    /// Dwell at a stop of weight 1 that fills the duration, s.
    pub dwell_s: f64,
    /// Estimator of the parameters. The external turntable's survey of the base is exact.
    pub estimator: core::Estimator,
}

/// Stops of a calibration with their positions, to describe them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberedStops {
    /// Number of stops, over all passes.
    pub count: usize,
    /// Positions that they visit.
    pub visited: VisitedPositions,
}

impl NumberedStops {
    /// Describes a stop, which counts from 0: `7 of 19, position 3 of 8`. A stop that the sequence
    /// doesn't have, as a unit under test may report, has its number alone.
    #[must_use]
    pub fn describe(&self, stop: usize) -> String {
        let (number, count, visited) = (stop + 1, self.count, &self.visited);
        if number > count {
            return format!("{number} of {count}");
        }
        format!("{number} of {count}, position {} of {}", visited.at(stop), visited.count())
    }
}

impl CalibrationSpec {
    /// Stops over all passes, with their positions.
    #[must_use]
    pub fn numbered_stops(&self) -> NumberedStops {
        let stops = self.sequence.stops();
        NumberedStops {
            count: stops.len() * self.sequence.passes() as usize,
            visited: VisitedPositions::of(stops),
        }
    }

    /// True if the filter estimates a group of parameters; always true for other estimators, which have
    /// no such choice.
    #[must_use]
    pub fn estimates(&self, group: ParameterGroup) -> bool {
        match &self.estimator {
            core::Estimator::Kalman(kalman) => kalman.estimated[group as usize],
            core::Estimator::LeastSquares(_) | core::Estimator::ExternalTurntable(_) => true,
        }
    }
}
