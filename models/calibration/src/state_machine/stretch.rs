//! Data of a stretch of bridged samples.

use nalgebra::Vector3;
use octant_sample::GimbalAngles;

/// Data of the stretch that is being bridged.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Bridge {
    /// Encoder angles of the last sample.
    pub(super) gimbal: GimbalAngles,
    /// Encoder angles before the first of the identical counts of each gyro.
    pub(super) run_start: [GimbalAngles; 3],
    /// Repeated counts of each channel that were used, before it was found stuck.
    pub(super) used_repeats: [u32; 6],
    /// Channels that have been bridged since the last account of the uncertainty.
    pub(super) open: u8,
    /// Increments of rejected jumps beyond the bridged ones: rad and m/s, in b.
    pub(super) disbelieved: (Vector3<f64>, Vector3<f64>),
    /// Channels that were bridged because of a jump, up to the last sample.
    pub(super) jumps: u8,
    /// Encoder angles before the stretch, and whether their uncertainty is accounted for.
    pub(super) start: GimbalAngles,
    pub(super) encoders_counted: [bool; 2],
    /// Length of the stretch so far, and up to the last account, s.
    pub(super) elapsed_s: f64,
    pub(super) accounted_s: f64,
    /// Samples bridged so far.
    pub(super) samples: u64,
}
