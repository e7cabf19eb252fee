//! Transfer of the core's gimbal commands to a table.

use crate::{Error, TableAxis, TableStatus, Turntable};
use octant_sample::{GimbalAngles, GimbalCommand};

/// Moves a table to the core's set points.
///
/// The core repeats its set point in every output, but the table is commanded only when it changes. A
/// set point that the table refused is sent again with the next output.
#[derive(Clone, Copy, Debug, Default)]
pub struct Follower {
    told: [Option<i32>; 2],
}

impl Follower {
    /// Makes a follower that has sent nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Passes a command on. Returns true if the table was commanded.
    ///
    /// # Errors
    /// If the table doesn't execute it.
    pub fn command(
        &mut self,
        table: &mut impl Turntable,
        command: &GimbalCommand,
    ) -> Result<bool, Error> {
        let target = command.target;
        let mut any = false;
        for (axis, count, angle_rad) in [
            (TableAxis::Azimuth, target.azimuth, target.azimuth_rad()),
            (TableAxis::Roll, target.roll, target.roll_rad()),
        ] {
            if self.told[axis.index()] != Some(count) {
                table.goto(axis, angle_rad, None)?;
                self.told[axis.index()] = Some(count);
                any = true;
            }
        }
        Ok(any)
    }
}

impl TableStatus {
    /// Angles in the form of a sample.
    #[must_use]
    pub fn gimbal(&self) -> GimbalAngles {
        let [azimuth, roll] = self.axes;
        GimbalAngles::from_rad(azimuth.angle_rad, roll.angle_rad)
    }
}
