//! Form in which an estimator is stored. A filter without further states is stored as before there
//! were any, so that the bytes of earlier programs remain readable and the same.

use super::{AidingMode, ErrorModel, ExternalTurntable, Further, LeastSquares, Prior, SwayNoise};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// [`super::Estimator`].
#[derive(Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "no_std without alloc: there is no box to put it in")]
enum Estimator {
    Kalman(Kalman),
    LeastSquares(LeastSquares),
    ExternalTurntable(ExternalTurntable),
    KalmanFurther(Kalman, Further),
}

/// [`super::Kalman`] without its further states.
#[derive(Serialize, Deserialize)]
struct Kalman {
    error_model: ErrorModel,
    estimated: [bool; 7],
    prior: Prior,
    aiding: AidingMode,
    aiding_period_ns: u64,
    sway: SwayNoise,
    refuse_above_mean_nis: f64,
}

impl From<super::Kalman> for Kalman {
    fn from(kalman: super::Kalman) -> Self {
        let super::Kalman {
            error_model,
            estimated,
            prior,
            aiding,
            aiding_period_ns,
            sway,
            refuse_above_mean_nis,
            further: _,
        } = kalman;
        Self {
            error_model,
            estimated,
            prior,
            aiding,
            aiding_period_ns,
            sway,
            refuse_above_mean_nis,
        }
    }
}

impl Kalman {
    fn with(self, further: Further) -> super::Kalman {
        let Self {
            error_model,
            estimated,
            prior,
            aiding,
            aiding_period_ns,
            sway,
            refuse_above_mean_nis,
        } = self;
        super::Kalman {
            error_model,
            estimated,
            prior,
            aiding,
            aiding_period_ns,
            sway,
            refuse_above_mean_nis,
            further,
        }
    }
}

impl From<super::Estimator> for Estimator {
    fn from(estimator: super::Estimator) -> Self {
        match estimator {
            super::Estimator::Kalman(kalman) if kalman.further == Further::default() => {
                Self::Kalman(kalman.into())
            }
            super::Estimator::Kalman(kalman) => Self::KalmanFurther(kalman.into(), kalman.further),
            super::Estimator::LeastSquares(settings) => Self::LeastSquares(settings),
            super::Estimator::ExternalTurntable(settings) => Self::ExternalTurntable(settings),
        }
    }
}

impl Serialize for super::Estimator {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Estimator::from(*self).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for super::Estimator {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Estimator::deserialize(deserializer).map(Self::from)
    }
}

impl From<Estimator> for super::Estimator {
    fn from(stored: Estimator) -> Self {
        match stored {
            Estimator::Kalman(kalman) => Self::Kalman(kalman.with(Further::default())),
            Estimator::KalmanFurther(kalman, further) => Self::Kalman(kalman.with(further)),
            Estimator::LeastSquares(settings) => Self::LeastSquares(settings),
            Estimator::ExternalTurntable(settings) => Self::ExternalTurntable(settings),
        }
    }
}
