//! Statements of a filter about itself: innovations, which are what measurements add to what was known, and the
//! covariance of its solution.

/// Innovation of one measurement, computed minus reference, on the axes north, east and down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Innovation {
    /// Quantity that was measured.
    pub of: InnovationOf,
    /// Innovation: m/s of a velocity, m of a position.
    pub value: [f64; 3],
    /// Standard deviations that the filter expects of it, in the same unit: square roots of the
    /// diagonal of H·P·Hᵀ + R.
    pub sigma: [f64; 3],
}

/// Quantity of a measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InnovationOf {
    /// Velocity, m/s.
    #[default]
    Velocity,
    /// Position, m.
    Position,
}

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
