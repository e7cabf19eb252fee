//! The two gimbals: outer roll about case x, inner azimuth about body z.
//!
//! `c_cb = Rx(roll) · Rz(azimuth)`.

use crate::counts::GIMBAL_LSB_RAD;

/// Gimbal angles in counts of [`GIMBAL_LSB_RAD`], cumulative (not wrapped), ±16 rad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GimbalAngles {
    /// Inner gimbal, about body z.
    pub azimuth: i32,
    /// Outer gimbal, about case x.
    pub roll: i32,
}

impl GimbalAngles {
    /// The nearest counts to angles in rad; beyond ±16 rad it saturates.
    #[must_use]
    pub fn from_rad(azimuth_rad: f64, roll_rad: f64) -> Self {
        // A shift by half a count makes the truncating cast round to nearest.
        let count = |angle_rad: f64| {
            let counts = angle_rad / GIMBAL_LSB_RAD;
            (counts + if counts < 0.0 { -0.5 } else { 0.5 }) as i32
        };
        Self { azimuth: count(azimuth_rad), roll: count(roll_rad) }
    }

    /// Inner gimbal angle in rad.
    #[must_use]
    pub fn azimuth_rad(self) -> f64 {
        f64::from(self.azimuth) * GIMBAL_LSB_RAD
    }

    /// Outer gimbal angle in rad.
    #[must_use]
    pub fn roll_rad(self) -> f64 {
        f64::from(self.roll) * GIMBAL_LSB_RAD
    }
}

/// Gimbal angles that the core commands. They are a set point, not an event, and are in every
/// output, so that a lost message costs time but not a position.
///
/// A command computed from sample k acts from the end of interval k + 1, and is first felt in
/// sample k + 2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GimbalCommand {
    /// Set point of both gimbals.
    pub target: GimbalAngles,
}
