//! Limits of a table's angles and rates.

use crate::{Error, TableAxis};

/// Limits of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Least angle, rad; −∞: none.
    pub least_rad: f64,
    /// Greatest angle, rad; ∞: none.
    pub most_rad: f64,
    /// Largest rate, rad/s.
    pub rate_radps: f64,
    /// Acceleration of the axis's moves, rad/s².
    pub acceleration_radps2: f64,
}

/// Limits of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableLimits {
    /// Limits of azimuth and roll.
    pub axes: [AxisLimits; 2],
}

impl TableLimits {
    /// Limits of one axis.
    #[must_use]
    pub fn of(&self, axis: TableAxis) -> &AxisLimits {
        &self.axes[axis.index()]
    }

    /// Checks that the limits are valid.
    ///
    /// # Errors
    /// If they aren't.
    pub fn check(&self) -> Result<(), Error> {
        for axis in TableAxis::ALL {
            let AxisLimits { least_rad, most_rad, rate_radps, acceleration_radps2 } =
                *self.of(axis);
            let positive = |number: f64| number.is_finite() && number > 0.0;
            if !(least_rad < most_rad && positive(rate_radps) && positive(acceleration_radps2)) {
                return Err(Error::Limits { axis });
            }
        }
        Ok(())
    }

    /// Checks that the axis may go to an angle.
    ///
    /// # Errors
    /// If the angle is beyond the limits.
    pub fn angle(&self, axis: TableAxis, angle_rad: f64) -> Result<(), Error> {
        let limits = self.of(axis);
        // A NaN is outside of every range.
        if (limits.least_rad..=limits.most_rad).contains(&angle_rad) && angle_rad.is_finite() {
            return Ok(());
        }
        Err(Error::Angle {
            axis,
            degrees: angle_rad.to_degrees(),
            least: limits.least_rad.to_degrees(),
            most: limits.most_rad.to_degrees(),
        })
    }

    /// Checks that the axis may turn with a rate.
    pub(crate) fn rate(&self, axis: TableAxis, rate_radps: f64) -> Result<(), Error> {
        let most = self.of(axis).rate_radps;
        if rate_radps.abs() <= most {
            return Ok(());
        }
        Err(Error::Rate { axis, found: rate_radps.to_degrees(), most: most.to_degrees() })
    }

    /// Checks that the axis comes to rest within its limits if it is braked after a time.
    pub(crate) fn can_stop(
        &self,
        axis: TableAxis,
        angle_rad: f64,
        rate_radps: f64,
        within_s: f64,
    ) -> Result<(), Error> {
        let brake = rate_radps.abs() / (2.0 * self.of(axis).acceleration_radps2);
        let at_rest = angle_rad + rate_radps * (within_s + brake);
        // An axis outside of its limits that is on its way back isn't stopped.
        let limits = self.of(axis);
        let outward = (rate_radps > 0.0 && at_rest > limits.most_rad)
            || (rate_radps < 0.0 && at_rest < limits.least_rad);
        if outward { self.angle(axis, at_rest) } else { Ok(()) }
    }
}
