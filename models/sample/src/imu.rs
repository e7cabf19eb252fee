//! One inertial sample: increments over an interval, stamped at its end.

use crate::{DeviceTime, GimbalAngles};

bitflags::bitflags! {
    /// Flags that the instrument sets on a sample.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub struct Status: u16 {
        /// At least one gyro count saturated.
        const GYRO_SATURATED = 1 << 0;
        /// At least one accelerometer count saturated.
        const ACCELEROMETER_SATURATED = 1 << 1;
        /// The gimbal angles of this sample are not to be used (no encoder, or encoder error).
        const GIMBAL_INVALID = 1 << 2;
        /// The inertial counts of this sample are not to be used.
        const INERTIAL_INVALID = 1 << 3;
    }
}

/// One sample of the inertial measurement unit with the gimbal angles at its stamp.
///
/// The counts are of body (b) axes, x y z, over the interval that ends at `device_time`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// Number of the sample, from 1 for the first interval; a jump means loss.
    pub sequence: u64,
    /// End of the interval.
    pub device_time: DeviceTime,
    /// Integrated angular rate ω_ib in b, counts of [`crate::counts::DELTA_THETA_LSB_RAD`].
    pub delta_theta: [i32; 3],
    /// Integrated specific force in b, counts of [`crate::counts::DELTA_VELOCITY_LSB_MPS`].
    pub delta_velocity: [i32; 3],
    /// Encoder angles at `device_time`.
    pub gimbal: GimbalAngles,
    /// Flags of the instrument.
    pub status: Status,
}
