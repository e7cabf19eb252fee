//! What the harness asks of a table.

use crate::{EmergencyStop, Error, Limits};
use std::time::{Duration, Instant};

/// One of the two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Inner gimbal, about body z.
    Azimuth,
    /// Outer gimbal, about case x.
    Roll,
}

impl Axis {
    /// Both of them.
    pub const ALL: [Self; 2] = [Self::Azimuth, Self::Roll];

    /// Its name.
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

impl std::fmt::Display for Axis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// What a table says of an axis. What its language doesn't say is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisStatus {
    /// Where it is, rad.
    pub angle_rad: f64,
    /// When it was there: in the middle between question and reply.
    pub at: Option<Instant>,
    /// How far from that it may have been: half of the time from question to reply.
    pub at_within: Duration,
    /// How fast it turns, rad/s.
    pub rate_radps: Option<f64>,
    /// A move goes on.
    pub moving: Option<bool>,
    /// It has found its reference.
    pub homed: Option<bool>,
    /// Its drive is on.
    pub enabled: Option<bool>,
    /// The controller's fault word; 0: none.
    pub fault: Option<u32>,
}

/// What a table says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status {
    /// Azimuth and roll.
    pub axes: [AxisStatus; 2],
}

impl Status {
    /// Of one axis.
    #[must_use]
    pub fn of(&self, axis: Axis) -> &AxisStatus {
        &self.axes[axis.index()]
    }
}

/// A two-axis table.
///
/// Angles are those of the gimbals, cumulative; rates are theirs. A command returns when the table has
/// taken it, not when the move has ended.
pub trait Turntable: Send {
    /// Turns an axis to an angle, with at most a rate; without one with the largest that is allowed.
    ///
    /// # Errors
    /// If it is beyond the limits, the emergency stop was tripped, or the table doesn't do it.
    fn goto(&mut self, axis: Axis, angle_rad: f64, rate_radps: Option<f64>) -> Result<(), Error>;

    /// Turns an axis on with a rate; 0 brakes it.
    ///
    /// # Errors
    /// As [`Turntable::goto`].
    fn rate(&mut self, axis: Axis, rate_radps: f64) -> Result<(), Error>;

    /// Brakes both axes. It is done also when the emergency stop was tripped.
    ///
    /// # Errors
    /// If the table doesn't do it: the emergency stop has been tripped then.
    fn stop(&mut self) -> Result<(), Error>;

    /// Lets an axis find its reference.
    ///
    /// # Errors
    /// As [`Turntable::goto`].
    fn home(&mut self, axis: Axis) -> Result<(), Error>;

    /// Where it is.
    ///
    /// # Errors
    /// If the table doesn't say it.
    fn status(&mut self) -> Result<Status, Error>;

    /// The soft limits.
    fn limits(&self) -> &Limits;

    /// What stops it whatever happens; to be given to whoever may have to.
    fn emergency(&self) -> EmergencyStop;
}
