//! State of the estimation to which a recovery returns.

use crate::covariance::Covariance;
use octant_sample::Parameters;

/// Parameters and covariance of an earlier time.
#[derive(Clone, Debug)]
pub(super) struct Checkpoint {
    pub(super) time_s: f64,
    pub(super) parameters: Parameters,
    pub(super) covariance: Covariance,
}

#[cfg(feature = "state")]
octant_state::state! {
    Checkpoint { values: time_s, parameters; parts: covariance; kept: }
}
