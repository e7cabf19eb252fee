//! What faults do to the physical world. The plant realises these before its sensors integrate, so
//! that gyros, accelerometers and encoders tell one story.

/// The turntable as it stands when a fault sets in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motor {
    /// Angles of the drives, azimuth and roll, rad.
    pub angle_rad: [f64; 2],
    /// Rates of the drives, rad/s.
    pub rate_radps: [f64; 2],
}

/// A gimbal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Gimbal {
    /// Inner, about body z.
    Azimuth,
    /// Outer, about case x.
    Roll,
}

/// What the plant suffers, from the start of the interval in which a fault sets in until the fault
/// ends. All SI; vectors in body axes unless said otherwise.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Disturbance {
    /// The sensor block shakes, linearly and angularly: `sum of amplitude · sin(2π f t + phase)`,
    /// t since the onset, faded in and out so that velocity and attitude have no jump.
    Vibration {
        /// Lines of the motion.
        lines: alloc::vec::Vec<Line>,
        /// Time over which it swells and fades, s.
        edge_s: f64,
    },
    /// A half-sine pulse of acceleration of the sensor block.
    Shock {
        /// Peak acceleration, m/s².
        peak_mps2: [f64; 3],
        /// Length of the pulse, s.
        width_s: f64,
    },
    /// The proof masses sit away from the centre of rotation: row i is that of axis i, m.
    LeverArm([[f64; 3]; 3]),
    /// Temperature departs linearly and stays; sensitivities of biases and scale factors.
    Temperature {
        /// Ramp, K/s.
        ramp_kps: f64,
        /// Change at which the ramp ends, K.
        plateau_k: f64,
        /// (rad/s)/K.
        gyro_bias_per_k: [f64; 3],
        /// (m/s²)/K.
        accel_bias_per_k: [f64; 3],
        /// 1/K.
        gyro_scale_per_k: [f64; 3],
        /// 1/K.
        accel_scale_per_k: [f64; 3],
    },
    /// The whole case is displaced smoothly in n (north, east, down) and turned about them, and
    /// comes back the same way: a jerk of the mooring, or sway that nobody told the core of.
    Case {
        /// Lines of the displacement, amplitude in m in n, angle in rad about n.
        lines: alloc::vec::Vec<Line>,
        /// Time over which it swells and fades, s.
        edge_s: f64,
        /// A single smooth excursion of this height (m in n) and its length (s), beside the lines.
        excursion: Option<([f64; 3], f64)>,
    },
    /// Something happens to a gimbal.
    Gimbal {
        /// Which.
        gimbal: Gimbal,
        /// What.
        action: GimbalAction,
    },
}

/// One line of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Frequency, Hz.
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

/// What happens to a gimbal. The encoder sits on the drive; the sensors feel the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GimbalAction {
    /// The body turns against its drive by an angle, smoothly within a time, and stays: the gyros
    /// feel it. The encoder follows if it sits on the body.
    Slip {
        /// Angle, rad.
        angle_rad: f64,
        /// Time that it takes, s.
        within_s: f64,
        /// The encoder sees it.
        seen: bool,
    },
    /// The encoder reads another angle from now on; nothing moves.
    EncoderSlip {
        /// Angle added to what it reads, rad.
        angle_rad: f64,
    },
    /// The drive brakes with its largest deceleration and stands, whatever is commanded; when the
    /// fault ends it goes to the set point.
    Stall,
    /// The drive turns on at this rate, whatever is commanded; when the fault ends it goes to the
    /// set point.
    Runaway {
        /// Rate, rad/s, signed.
        rate_radps: f64,
    },
    /// Every move goes beyond its target by an angle and comes back.
    Overshoot {
        /// Angle, rad.
        angle_rad: f64,
    },
    /// After every move the body rings about the target: `amplitude · exp(−t/decay) · sin(2π f t)`.
    Ringing {
        /// First amplitude, rad.
        amplitude_rad: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Decay time, s.
        decay_s: f64,
    },
    /// The gear gets play: the body lags by half of it, on the side it came from.
    Backlash {
        /// Play, rad.
        play_rad: f64,
    },
}

/// Somebody who can be disturbed: the plant.
pub trait Disturbed {
    /// The turntable as it stands.
    fn motor(&self) -> Motor;
    /// A disturbance sets in at the start of the next interval. `handle` names it until its end.
    fn begin(&mut self, handle: u32, disturbance: &Disturbance);
    /// A disturbance ends at the start of the next interval.
    fn end(&mut self, handle: u32);
}
