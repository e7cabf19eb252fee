//! Disturbances of the physical world by faults. The plant realises them before its sensors
//! integrate, so that gyros, accelerometers and encoders agree.

use crate::Epoch;
use alloc::vec::Vec;

/// State of the turntable when a fault sets in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motor {
    /// Angles of the drives, azimuth and roll, rad.
    pub angle_rad: [f64; 2],
    /// Rates of the drives, rad/s.
    pub rate_radps: [f64; 2],
}

/// A gimbal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Gimbal {
    /// Inner, about body z.
    Azimuth,
    /// Outer, about case x.
    Roll,
}

impl Gimbal {
    /// Index in pairs of azimuth and roll.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Azimuth => 0,
            Self::Roll => 1,
        }
    }
}

/// Disturbance of the plant, from the start of the interval in which a fault sets in until the
/// fault ends. All SI; vectors in body axes unless said otherwise.
///
/// Motions are smooth: position, velocity and acceleration have no jump where a motion begins and
/// ends (except a shock's acceleration, which is its pulse).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Disturbance {
    /// The sensor block shakes against the gimballed body. It is displaced by `r = w(t) Σ d_i
    /// sin(2π f_i t + φ_i)` and turned by the rotation vector `θ = w(t) Σ α_i sin(2π f_i t + ψ_i)`,
    /// t since the onset. The window w rises from 0 to 1 within the edge, and falls as long after
    /// the fault's end, along 10 u³ − 15 u⁴ + 6 u⁵.
    Vibration {
        /// Lines of the motion.
        lines: Vec<SpectralLine>,
        /// Time over which the motion swells and fades, s, above 0.
        edge_s: f64,
    },
    /// A half-sine pulse of acceleration displaces the sensor block, and its mounts bring it back
    /// along a polynomial of fifth degree. Velocity and displacement have then their earlier
    /// values; the end of the fault changes nothing.
    Shock {
        /// Peak acceleration, m/s².
        peak_mps2: [f64; 3],
        /// Length of the pulse, s, above 0.
        width_s: f64,
        /// Time in which the block comes back after the pulse, s, above 0.
        recoil_s: f64,
    },
    /// The proof masses are further away from the centre of rotation, by row i for axis i, m; until
    /// the fault ends.
    LeverArm([[f64; 3]; 3]),
    /// Temperature rises or falls linearly and stays at its plateau; when the fault ends it returns
    /// at the same rate. Sensitivities of biases and scale factors.
    Temperature {
        /// Ramp, K/s, not 0.
        ramp_kps: f64,
        /// Change at which the ramp ends, K, of the ramp's sign.
        plateau_k: f64,
        /// Gyro bias, (rad/s)/K.
        gyro_bias_per_k: [f64; 3],
        /// Accelerometer bias, (m/s²)/K.
        accel_bias_per_k: [f64; 3],
        /// Gyro scale factor, 1/K.
        gyro_scale_per_k: [f64; 3],
        /// Accelerometer scale factor, 1/K.
        accel_scale_per_k: [f64; 3],
    },
    /// The whole case sways. Displacements are along its mean heading, to starboard and down, m;
    /// angles are added to its roll, pitch and heading, rad. Window as for a vibration.
    Case {
        /// Lines of the motion.
        lines: Vec<SpectralLine>,
        /// Time over which the motion swells and fades, s, above 0.
        edge_s: f64,
    },
    /// The whole case makes one excursion and comes back, `64 u³ (1 − u)³` of its height; the end
    /// of the fault changes nothing. Axes as for the sway.
    Excursion {
        /// Displacement at its middle, m.
        displacement_m: [f64; 3],
        /// Angle at its middle, rad.
        angle_rad: [f64; 3],
        /// Length, s, above 0.
        length_s: f64,
    },
    /// Action on a gimbal.
    Gimbal {
        /// Gimbal.
        gimbal: Gimbal,
        /// Action.
        action: GimbalAction,
    },
}

/// One line of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralLine {
    /// Frequency, Hz, above 0.
    pub frequency_hz: f64,
    /// Linear displacement amplitude, m.
    pub displacement_m: [f64; 3],
    /// Angular amplitude, rad.
    pub angle_rad: [f64; 3],
    /// Phase of the linear motion at the onset, rad.
    pub phase_rad: f64,
    /// Phase of the angular motion at the onset, rad.
    pub angle_phase_rad: f64,
}

/// Action of a fault on a gimbal. The encoder sits on the drive; the sensors feel the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum GimbalAction {
    /// The body turns against its drive by an angle, along 10 u³ − 15 u⁴ + 6 u⁵ within a time, and
    /// stays: the gyros feel it. The end of the fault changes nothing.
    Slip {
        /// Angle, rad.
        angle_rad: f64,
        /// Duration of the turn, s, above 0.
        within_s: f64,
        /// True if the encoder sits on the body and sees the slip.
        seen: bool,
    },
    /// The encoder reads another angle until the fault ends; nothing moves.
    EncoderSlip {
        /// Angle added to the reading, rad.
        angle_rad: f64,
        /// True if the encoder reports the error: samples are flagged that their gimbal angles are
        /// not to be used.
        flagged: bool,
    },
    /// The drive brakes with its largest deceleration and stops, whatever is commanded; when the
    /// fault ends it goes to the set point.
    Stall,
    /// The drive goes to this rate with its largest acceleration and turns on, whatever is
    /// commanded; when the fault ends it goes to the set point.
    Runaway {
        /// Rate, rad/s, signed, not 0.
        rate_radps: f64,
    },
    /// Every move that begins before the fault ends goes beyond its target by an angle and comes
    /// back.
    Overshoot {
        /// Angle, rad, above 0.
        angle_rad: f64,
    },
    /// After every move that begins before the fault ends the body rings about the target, t after
    /// the move: `A exp(−t/τ) sin(2π f t)`, swelling along 10 u³ − 15 u⁴ + 6 u⁵ in its first
    /// quarter of a period, for 30 τ. The encoder doesn't see it.
    Ringing {
        /// Amplitude A, rad.
        amplitude_rad: f64,
        /// Frequency f, Hz, above 0.
        frequency_hz: f64,
        /// Decay time τ, s, above 0.
        decay_s: f64,
    },
    /// The gear gets more play: the body lags by half of it, on the side from which it came. When
    /// the fault ends the additional play closes within 0.1 s, along 10 u³ − 15 u⁴ + 6 u⁵.
    Backlash {
        /// Additional play, rad, above 0.
        play_rad: f64,
    },
}

/// A plant that can be disturbed. Beside it run the plants without the disturbances, with the same set points and
/// the same random numbers, from the first onset on, so that effects are found by comparing.
pub trait Disturbed {
    /// State of the turntable.
    fn motor(&self) -> Motor;
    /// Begins a disturbance at the start of the next interval. `handle` identifies it until its
    /// end. Disturbances act in the order of their handles, whatever the order of their onsets.
    fn begin(&mut self, handle: u32, disturbance: &Disturbance);
    /// Ends a disturbance at the start of the next interval.
    fn end(&mut self, handle: u32);
    /// Returns whether a disturbance, or what it has set in motion, goes on in the next interval: edges, recoil, return.
    fn goes_on(&self, handle: u32) -> bool;
    /// Returns the last epoch as the plant would have delivered it with the disturbances of smaller handles alone;
    /// `None` if this handle has disturbed nothing, or nothing of it is left in the plant.
    fn without(&self, handle: u32) -> Option<&Epoch>;
    /// Counts by which a gyro's and an accelerometer's sum of counts can differ between two plants of which the sensors
    /// felt the same, because their counters carry different remainders.
    fn remainder_counts(&self) -> [i64; 2];
}
