//! Reasons why a calibration can't be smoothed.

use crate::store::StoreError;

/// Reasons why a calibration can't be smoothed.
#[derive(Debug, thiserror::Error)]
pub enum SmootherError {
    /// It has no filter.
    #[error("smooth: found estimator = {found:?}, expected \"kalman\"")]
    NoFilter {
        /// Name of the estimator; none if there is no calibration.
        found: &'static str,
    },
    /// The filter has states that the smoother doesn't carry.
    #[error(
        "smooth: found a filter with {found}, expected the 39 states alone: the smoother doesn't carry others"
    )]
    OtherStates {
        /// The states.
        found: &'static str,
    },
    /// The stream has too little of a calibration.
    #[error(
        "smooth: found {found} measurements after the last recovery, expected at least {expected}"
    )]
    TooShort {
        /// Measurements that were used.
        found: usize,
        /// Least number.
        expected: usize,
    },
    /// The history can't be kept.
    #[error(transparent)]
    Store(#[from] StoreError),
}
