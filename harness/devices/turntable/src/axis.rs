//! The two axes of a table, and their status.

use std::time::{Duration, Instant};

/// One of the two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TableAxis {
    /// Inner gimbal, about body z.
    Azimuth,
    /// Outer gimbal, about case x.
    Roll,
}

impl TableAxis {
    /// Both axes.
    pub const ALL: [Self; 2] = [Self::Azimuth, Self::Roll];

    /// Name of the axis.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Azimuth => "azimuth",
            Self::Roll => "roll",
        }
    }

    pub(crate) const fn index(self) -> usize {
        self as usize
    }
}

impl std::fmt::Display for TableAxis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// Status of an axis. Values that its language doesn't report are `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisStatus {
    /// Angle, rad.
    pub angle_rad: f64,
    /// Time of the angle: the middle between query and reply.
    pub at: Option<Instant>,
    /// Uncertainty of that time: half of the time from query to reply.
    pub at_within: Duration,
    /// Rate, rad/s.
    pub rate_radps: Option<f64>,
    /// True while a move is in progress.
    pub moving: Option<bool>,
    /// True if it has found its reference.
    pub homed: Option<bool>,
    /// True if its drive is on.
    pub enabled: Option<bool>,
    /// The controller's fault word; 0: none.
    pub fault: Option<u32>,
}

/// Status of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableStatus {
    /// Status of azimuth and roll.
    pub axes: [AxisStatus; 2],
}

impl TableStatus {
    /// Status of one axis.
    #[must_use]
    pub fn of(&self, axis: TableAxis) -> &AxisStatus {
        &self.axes[axis.index()]
    }
}
