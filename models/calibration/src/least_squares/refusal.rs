//! Reasons why there is no estimate, and the limits that they name.

/// Largest number of static intervals: six passes of nineteen stops fit.
pub const INTERVALS_MAX: usize = 128;

/// Longest window of the detection of standstill, samples.
pub const WINDOW_SAMPLES_MAX: usize = 512;

/// Residuals in units of their noise above which the adjustment against Earth rate, or an external
/// turntable, is refused. An unknown G of 5e-3 °/h/g reaches 2.7 in 4 h and 5.6 in 24 h.
pub const RESIDUAL_RMS_MAX: f64 = 10.0;

/// Name of a setting. (With this alias serde's derive doesn't take it for text that can be
/// borrowed.)
type Setting = &'static str;

/// Reason why there is no estimate.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum AdjustmentRefusal {
    /// Not enough static intervals.
    #[error("{found} static intervals were found, at least {needed} are needed")]
    TooFewIntervals {
        /// Intervals found.
        found: usize,
        /// Intervals needed.
        needed: usize,
    },
    /// More static intervals than the fixed store holds.
    #[error("more than {INTERVALS_MAX} static intervals were found")]
    TooManyIntervals,
    /// Not enough moves without lost or invalid samples.
    #[error("{found} complete moves between static intervals were found, at least {needed} needed")]
    TooFewMoves {
        /// Moves found.
        found: usize,
        /// Moves needed.
        needed: usize,
    },
    /// The attitudes don't determine a parameter.
    #[error(
        "the positions do not determine {}",
        octant_sample::parameters::NAMES.get(*parameter).unwrap_or(&"the attitudes")
    )]
    Undetermined {
        /// Index of the least determined parameter.
        parameter: usize,
    },
    /// The gyros don't show Earth rate (half to twice of it, with a horizontal part): they are too
    /// coarse for this reference, the site is at a pole, or the instrument was not at rest.
    #[error("interval {interval}: the gyros do not show Earth rate")]
    NoEarthRate {
        /// Index of the interval, from 0.
        interval: usize,
    },
    /// The residuals contradict the noise: the instrument swayed, or has errors far outside of the
    /// model.
    #[error(
        "the residuals are {residual_rms:.1} times their noise, at most {RESIDUAL_RMS_MAX} are \
         accepted: the instrument did not stand, or its errors are not those of the model"
    )]
    Inconsistent {
        /// Root mean square of the residuals in units of their noise.
        residual_rms: f64,
    },
    /// The adjustment did not converge.
    #[error("the adjustment did not converge")]
    Diverged,
    /// Detection window outside of the capacity of the ring.
    #[error("the detection window has {samples:.1} samples, expected 4 to {WINDOW_SAMPLES_MAX}")]
    Window {
        /// Samples in the window.
        samples: f64,
    },
    /// The known static start is shorter than the window.
    #[error("the initial static interval of {initial_s} s is shorter than the detection window")]
    InitialInterval {
        /// Length given, s.
        initial_s: f64,
    },
    /// A threshold that the initial interval itself would fail.
    #[error("the detection threshold is {threshold}, expected a number above 1")]
    Threshold {
        /// Threshold given.
        threshold: f64,
    },
    /// A shortest interval, gravity or other setting that is not a positive number.
    #[error("{field} is {found}, expected a positive number")]
    NotPositive {
        /// Name of the setting.
        #[cfg_attr(feature = "state", serde(with = "setting"))]
        field: Setting,
        /// Value found.
        found: f64,
    },
    /// Initial parameters that are unusable for compensation.
    #[error("the initial parameters are not finite or have no inverse")]
    InitialParameters,
    /// An interval of the external turntable without encoder angles.
    #[error("interval {interval}: no valid gimbal angles")]
    NoEncoder {
        /// Index of the interval, from 0.
        interval: usize,
    },
}

/// Checks that a setting is a positive number.
pub(crate) fn positive(field: &'static str, found: f64) -> Result<(), AdjustmentRefusal> {
    if found > 0.0 && found.is_finite() {
        Ok(())
    } else {
        Err(AdjustmentRefusal::NotPositive { field, found })
    }
}

/// Serde form of the names of settings that have to be positive: their places in a list.
#[cfg(feature = "state")]
mod setting {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    const NAMES: [&str; 5] = [
        "gravity_mps2",
        "shortest_s",
        "encoder_sigma_rad",
        "angle_random_walk",
        "velocity_random_walk",
    ];

    #[allow(clippy::trivially_copy_pass_by_ref, reason = "the signature is serde's")]
    pub(super) fn serialize<S: Serializer>(
        name: &&'static str,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match NAMES.iter().position(|known| known == name) {
            Some(place) => (place as u8).serialize(serializer),
            None => Err(serde::ser::Error::custom("a setting without a place in the list")),
        }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<&'static str, D::Error> {
        let place = usize::from(u8::deserialize(deserializer)?);
        NAMES.get(place).copied().ok_or_else(|| serde::de::Error::custom("no such setting"))
    }
}
