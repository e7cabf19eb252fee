//! Rates of the moves.

/// Rates of the turntable.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct TurntableRates {
    /// Largest rate of a move, rad/s.
    pub rate_radps: f64,
    /// Acceleration of a move, rad/s².
    pub acceleration_radps2: f64,
}
