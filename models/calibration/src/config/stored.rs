//! Form in which an estimator is stored. A filter without further states is stored as before there
//! were any, so that the bytes of earlier programs remain readable and the same.

use super::{
    AngleMeasurements, CaseRest, ExternalTurntable, Further, Kalman, LeastSquares, SigmaLimits,
    TemperatureErrors,
};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// [`super::Estimator`], whose filter is stored without its further states.
#[derive(Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "no_std without alloc: there is no box to put it in")]
enum Estimator {
    Kalman(Kalman),
    LeastSquares(LeastSquares),
    ExternalTurntable(ExternalTurntable),
    KalmanFurther(Kalman, Further),
    KalmanAngles(Kalman, Further, AngleMeasurements),
    KalmanTemperature(Kalman, Further, TemperatureErrors, Option<AngleMeasurements>),
    KalmanLimited(
        Kalman,
        SigmaLimits,
        Further,
        Option<TemperatureErrors>,
        Option<AngleMeasurements>,
    ),
    KalmanRest(
        Kalman,
        SigmaLimits,
        Further,
        Option<TemperatureErrors>,
        Option<AngleMeasurements>,
        CaseRest,
    ),
}

impl Serialize for super::Estimator {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let stored = match *self {
            Self::Kalman(kalman) if let Some(rest) = kalman.further.rest => {
                let (limits, further) = (kalman.sigma_limits, kalman.further);
                let (temperature, angles) = (further.temperature, further.angles);
                Estimator::KalmanRest(kalman, limits, further, temperature, angles, rest)
            }
            Self::Kalman(kalman) if kalman.sigma_limits != SigmaLimits::default() => {
                let (limits, further) = (kalman.sigma_limits, kalman.further);
                let (temperature, angles) = (further.temperature, further.angles);
                Estimator::KalmanLimited(kalman, limits, further, temperature, angles)
            }
            Self::Kalman(kalman) if kalman.further == Further::default() => {
                Estimator::Kalman(kalman)
            }
            Self::Kalman(kalman) => {
                let further = kalman.further;
                match (further.temperature, further.angles) {
                    (None, None) => Estimator::KalmanFurther(kalman, further),
                    (None, Some(angles)) => Estimator::KalmanAngles(kalman, further, angles),
                    (Some(temperature), angles) => {
                        Estimator::KalmanTemperature(kalman, further, temperature, angles)
                    }
                }
            }
            Self::LeastSquares(settings) => Estimator::LeastSquares(settings),
            Self::ExternalTurntable(settings) => Estimator::ExternalTurntable(settings),
        };
        stored.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for super::Estimator {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(match Estimator::deserialize(deserializer)? {
            Estimator::Kalman(kalman) => Self::Kalman(kalman),
            Estimator::KalmanFurther(kalman, further) => Self::Kalman(Kalman { further, ..kalman }),
            Estimator::KalmanAngles(kalman, further, angles) => {
                let further = Further { angles: Some(angles), ..further };
                Self::Kalman(Kalman { further, ..kalman })
            }
            Estimator::KalmanTemperature(kalman, further, temperature, angles) => {
                let further = Further { temperature: Some(temperature), angles, ..further };
                Self::Kalman(Kalman { further, ..kalman })
            }
            Estimator::KalmanLimited(kalman, sigma_limits, further, temperature, angles) => {
                let further = Further { temperature, angles, ..further };
                Self::Kalman(Kalman { further, sigma_limits, ..kalman })
            }
            Estimator::KalmanRest(kalman, sigma_limits, further, temperature, angles, rest) => {
                let further = Further { temperature, angles, rest: Some(rest), ..further };
                Self::Kalman(Kalman { further, sigma_limits, ..kalman })
            }
            Estimator::LeastSquares(settings) => Self::LeastSquares(settings),
            Estimator::ExternalTurntable(settings) => Self::ExternalTurntable(settings),
        })
    }
}
