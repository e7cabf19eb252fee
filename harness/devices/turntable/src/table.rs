//! Interface of a table.

use crate::{EmergencyStop, Error, TableAxis, TableLimits, TableStatus};

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
