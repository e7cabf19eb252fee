//! Innovations of a filter: what a measurement adds to what was known.

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
