//! Answer of the core to one sample.

use crate::{DeviceTime, GimbalCommand};

/// Mode of the calibration core.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Mode {
    /// Finding the initial attitude from gravity and Earth rate.
    #[default]
    Aligning = 0,
    /// Turning through the positions of the sequence.
    Calibrating = 1,
    /// The calibration ended and is not valid; the core stops navigating.
    Refused = 2,
    /// Free inertial navigation with compensated sensors.
    Navigating = 3,
    /// The procedure is over (a calibration without navigation).
    Done = 4,
}

impl Mode {
    /// All modes, in the order of their codes.
    pub const ALL: [Self; 5] =
        [Self::Aligning, Self::Calibrating, Self::Refused, Self::Navigating, Self::Done];

    /// The name used in files and on the screen.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Aligning => "aligning",
            Self::Calibrating => "calibrating",
            Self::Refused => "refused",
            Self::Navigating => "navigating",
            Self::Done => "done",
        }
    }
}

bitflags::bitflags! {
    /// Health of the core. A bit is set in the output of every epoch in which its cause holds, and
    /// its cause is counted in the core's diagnostics.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    pub struct Health: u32 {
        /// A measurement was rejected by the innovation gate.
        const INNOVATION_REJECTED = 1 << 0;
        /// The filter re-opened its attitude, velocity and position (recovery).
        const RECOVERING = 1 << 1;
        /// A gyro gives identical counts where its noise forbids it.
        const GYRO_STUCK = 1 << 2;
        /// An accelerometer gives identical counts where its noise forbids it.
        const ACCELEROMETER_STUCK = 1 << 3;
        /// A sample is missing: the sequence number or the stamp jumped forward.
        const GAP = 1 << 4;
        /// A stamp or sequence number did not advance; the sample was not used.
        const OUT_OF_ORDER = 1 << 5;
        /// The sample carries a saturated or invalid inertial count.
        const INERTIAL_INVALID = 1 << 6;
        /// The encoders do not show the commanded position in a dwell.
        const GIMBAL_DISAGREES = 1 << 7;
        /// Aiding is due and did not arrive.
        const AIDING_LOST = 1 << 8;
        /// The innovations contradict the tuning; a calibration in this state is refused.
        const INCONSISTENT = 1 << 9;
        /// A number that is not finite was kept out of the state.
        const NUMERIC = 1 << 10;
        /// Increments jumped further than any motion allows; they were rejected.
        const JUMP = 1 << 11;
        /// Gyros and encoders do not show the same turn: one of them, or the gimbal, slipped.
        const GIMBAL_SLIPPED = 1 << 12;
        /// The corrections of a parameter are larger than its uncertainty allows; a calibration in
        /// which this happened is refused.
        const DRIFTING = 1 << 13;
        /// A reference had a stamp other than that of its sample; it was not used.
        const AIDING_STALE = 1 << 14;
    }
}

/// Navigation solution at the stamp of the sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Navigation {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Longitude, rad, not wrapped.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
    /// Velocity over ground in n (north, east, down), m/s.
    pub velocity_mps: [f64; 3],
    /// Attitude `q_nb` (w, x, y, z), Hamilton: takes a vector in b into n.
    pub q_nb: [f64; 4],
}

/// Output of one step of the core.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Output {
    /// Sequence number of the sample that this answers.
    pub sequence: u64,
    /// Stamp of the sample that this answers.
    pub device_time: DeviceTime,
    /// Mode after this step.
    pub mode: Mode,
    /// Stop of the sequence that the gimbals are at or move to, from 0, over all passes.
    pub stop: u16,
    /// True while the gimbals move to `stop`.
    pub moving: bool,
    /// Set point of the gimbals.
    pub gimbal_command: GimbalCommand,
    /// Navigation solution.
    pub navigation: Navigation,
    /// Health flags of this epoch.
    pub health: Health,
    /// Normalized innovation squared of the measurement used in this epoch (three axes), NaN if
    /// there was none.
    pub nis: f64,
    /// Number of times that the parameters have changed so far; the parameters and their σ are sent
    /// when this number changes.
    pub parameters_revision: u32,
}
