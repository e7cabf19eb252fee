//! Uncertainty of a navigation solution, as a filter states it.

/// Covariance of a filter's solution on the axes north, east and down.
///
/// Each matrix is symmetric and stored as its upper triangle by rows: north-north, north-east,
/// north-down, east-east, east-down, down-down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NavigationCovariance {
    /// Position, m².
    pub position_m2: [f64; 6],
    /// Velocity, (m/s)².
    pub velocity_m2ps2: [f64; 6],
    /// Rotation vector of the attitude's error, rad².
    pub attitude_rad2: [f64; 6],
}
