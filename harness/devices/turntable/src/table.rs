//! Interface of a table.

use crate::{EmergencyStop, Error, TableLimits};
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

/// A two-axis table.
///
/// Angles and rates are those of the gimbals, angles cumulative. A command returns when the table has
/// accepted it, not at the end of the move.
pub trait Turntable: Send {
    /// Turns an axis to an angle, with at most a rate; by default, the largest permitted one.
    ///
    /// # Errors
    /// If it is beyond the limits, the emergency stop was tripped, or the table refuses it.
    fn goto(
        &mut self,
        axis: TableAxis,
        angle_rad: f64,
        rate_radps: Option<f64>,
    ) -> Result<(), Error>;

    /// Turns an axis continuously with a rate; 0 brakes it.
    ///
    /// # Errors
    /// As [`Turntable::goto`].
    fn rate(&mut self, axis: TableAxis, rate_radps: f64) -> Result<(), Error>;

    /// Brakes both axes, also after the emergency stop was tripped.
    ///
    /// # Errors
    /// If the table doesn't execute it: by then the emergency stop was tripped.
    fn stop(&mut self) -> Result<(), Error>;

    /// Homes an axis: lets it find its reference.
    ///
    /// # Errors
    /// As [`Turntable::goto`].
    fn home(&mut self, axis: TableAxis) -> Result<(), Error>;

    /// Asks for the status.
    ///
    /// # Errors
    /// If the table doesn't answer.
    fn status(&mut self) -> Result<TableStatus, Error>;

    /// Soft limits.
    fn limits(&self) -> &TableLimits;

    /// Emergency stop, which works in any state of the table; to be given to every part that may need
    /// it.
    fn emergency(&self) -> EmergencyStop;
}
