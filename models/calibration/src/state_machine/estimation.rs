//! The estimator that runs, and its input beside the samples.

use super::aligning::prior_after_alignment;
use crate::config::{Calibration, CoreConfig, Estimator};
use crate::external_turntable::ExternalTurntableEstimator;
use crate::filter::CalibrationFilter;
use crate::least_squares::{Adjustment, AdjustmentRefusal, LeastSquaresEstimator};
use nalgebra::Vector3;
use octant_sample::Sample;

/// Estimator of a calibration. All of it is stored in place: the core doesn't allocate.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "no_std without alloc: there is no box to put it in")]
pub(super) enum Estimation {
    /// No estimator runs.
    Idle,
    Kalman(CalibrationFilter),
    LeastSquares(LeastSquaresEstimator),
    ExternalTurntable(ExternalTurntableEstimator),
}

impl Estimation {
    pub(super) fn new(
        config: &CoreConfig,
        calibration: &Calibration,
    ) -> Result<Self, AdjustmentRefusal> {
        Ok(match &calibration.estimator {
            Estimator::Kalman(kalman) => Self::Kalman(CalibrationFilter::new(
                &prior_after_alignment(config, kalman),
                &config.site,
                &config.noise,
                &config.screening,
                &config.initial_parameters,
                config.sample_period_ns,
            )),
            Estimator::LeastSquares(settings) => Self::LeastSquares(LeastSquaresEstimator::new(
                settings,
                &config.site,
                config.sample_period_ns,
                &config.initial_parameters,
            )?),
            Estimator::ExternalTurntable(settings) => {
                Self::ExternalTurntable(ExternalTurntableEstimator::new(
                    settings,
                    &config.site,
                    &config.noise,
                    &config.initial_parameters,
                )?)
            }
        })
    }

    /// Passes a raw sample to an estimator that uses raw samples.
    pub(super) fn raw_sample(&mut self, sample: &Sample, interval_s: f64, standing: bool) {
        match self {
            Self::LeastSquares(estimator) => estimator.step(sample, interval_s, Some(standing)),
            Self::ExternalTurntable(estimator) => estimator.step(sample, interval_s, standing),
            Self::Idle | Self::Kalman(_) => {}
        }
    }

    /// Computes the adjustment, if the estimator has one.
    pub(super) fn adjust(&self) -> Option<Result<Adjustment, AdjustmentRefusal>> {
        match self {
            Self::LeastSquares(estimator) => Some(estimator.clone().finish()),
            Self::ExternalTurntable(estimator) => Some(estimator.clone().finish()),
            Self::Idle | Self::Kalman(_) => None,
        }
    }
}

/// Sums of raw increments over the present standstill: with these the attitude can be found at its
/// end, when the parameters become known.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Standstill {
    pub(super) delta_theta: Vector3<f64>,
    pub(super) delta_velocity: Vector3<f64>,
    /// First moment of the velocity increments about the start, m.
    pub(super) velocity_moment: Vector3<f64>,
    pub(super) elapsed_s: f64,
}

impl Standstill {
    pub(super) fn add(&mut self, measured: &(Vector3<f64>, Vector3<f64>), interval_s: f64) {
        self.delta_theta += measured.0;
        self.delta_velocity += measured.1;
        self.velocity_moment += measured.1 * (self.elapsed_s + 0.5 * interval_s);
        self.elapsed_s += interval_s;
    }
}
