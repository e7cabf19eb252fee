//! Configuration of the plant. All angles in rad, all quantities SI.

use octant_sample::Parameters;

/// True state of one run.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PlantConfig {
    /// Sample period, ns.
    pub sample_period_ns: u64,
    /// Seed of every random stream.
    pub seed: u64,
    /// Samples of the calibration phase; all later samples are navigation. Random streams are keyed
    /// by phase and count from its first sample.
    pub calibration_samples: u64,
    /// Position of the dock, or of a case fixed to the ground.
    pub site: PlantSite,
    /// Motion of the case.
    pub motion: Motion,
    /// The two gimbals.
    pub turntable: TurntableConfig,
    /// The sensors.
    pub imu: Imu,
    /// The reference handed to the core during calibration.
    pub aiding: AidingSource,
}

/// Geodetic position.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PlantSite {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Longitude, rad.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
    /// Difference of true gravity to normal gravity; the same wherever the instrument goes.
    #[serde(default)]
    pub gravity: GravityDisturbance,
}

/// Difference of true gravity to normal gravity. True gravity in n is (−ξ γ, −η γ, γ + Δg), with
/// normal gravity γ. The default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GravityDisturbance {
    /// Deflection of the vertical to the north ξ, rad: positive where the astronomic zenith is north
    /// of the geodetic one.
    pub deflection_north_rad: f64,
    /// Deflection of the vertical to the east η, rad.
    pub deflection_east_rad: f64,
    /// Gravity anomaly Δg, m/s², positive where gravity is stronger than normal.
    pub anomaly_mps2: f64,
}

impl GravityDisturbance {
    /// Disturbance in n (north, east, down), m/s².
    pub(crate) fn in_n(&self, normal_mps2: f64) -> nalgebra::Vector3<f64> {
        nalgebra::Vector3::new(
            -self.deflection_north_rad * normal_mps2,
            -self.deflection_east_rad * normal_mps2,
            self.anomaly_mps2,
        )
    }
}

/// Mean attitude of the case, `c_nc = Rz(heading) Ry(pitch) Rx(roll)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CaseAttitude {
    /// Heading, rad.
    pub heading_rad: f64,
    /// Pitch, rad.
    pub pitch_rad: f64,
    /// Roll of the case (not of the gimbal), rad.
    pub roll_rad: f64,
}

/// Motion of the case.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Motion {
    /// Fixed to the ground.
    Static(CaseAttitude),
    /// On a moored ship.
    Dockside(Dockside),
}

/// A moored ship: sums of sinusoids about a mean attitude and position.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Dockside {
    /// Mean attitude.
    pub mean: CaseAttitude,
    /// Roll of the ship.
    pub roll: Vec<Sinusoid>,
    /// Pitch of the ship.
    pub pitch: Vec<Sinusoid>,
    /// Yaw of the ship.
    pub yaw: Vec<Sinusoid>,
    /// Surge, along the mean heading, m.
    pub surge: Vec<Sinusoid>,
    /// Sway, to starboard of the mean heading, m.
    pub sway: Vec<Sinusoid>,
    /// Heave, positive down, m.
    pub heave: Vec<Sinusoid>,
    /// Constant offset of the instrument from the site, the dock's reference position that
    /// [`AidingKind::DockPosition`] measures; north, east, down, m.
    pub mooring_offset_m: [f64; 3],
    /// Times at which it moves; by default always.
    #[serde(default)]
    pub times: MotionTimes,
}

/// Times at which a motion is there: between them the case is at rest, at its mean attitude and position.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MotionTimes {
    /// Beginnings and ends, s since the start, in their order; none: the motion is always there.
    pub during_s: Vec<[f64; 2]>,
    /// Time at each end over which the motion grows or dies away, s.
    pub ramp_s: f64,
}

impl MotionTimes {
    /// Returns whether the motion is always there.
    #[must_use]
    pub fn is_always(&self) -> bool {
        self.during_s.is_empty()
    }
}

impl Dockside {
    /// Makes a ship that lies still, at a mean attitude.
    #[must_use]
    pub fn calm(mean: CaseAttitude) -> Self {
        Self {
            mean,
            roll: Vec::new(),
            pitch: Vec::new(),
            yaw: Vec::new(),
            surge: Vec::new(),
            sway: Vec::new(),
            heave: Vec::new(),
            mooring_offset_m: [0.0; 3],
            times: MotionTimes::default(),
        }
    }
}

/// One component `amplitude · sin(2π t / period + phase)`, amplitude in rad or m.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sinusoid {
    /// Amplitude, rad or m.
    pub amplitude: f64,
    /// Period, s.
    pub period_s: f64,
    /// Phase at time 0, rad.
    pub phase_rad: f64,
}

/// The two gimbals and their imperfections.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TurntableConfig {
    /// Largest rate of a move, rad/s.
    pub rate_radps: f64,
    /// Acceleration of a move, rad/s².
    pub acceleration_radps2: f64,
    /// Encoder error, 1σ, rad: a constant of each gimbal and each angle, not white noise. It is
    /// the rms over a turn of a periodic curve, four harmonics drawn from the seed.
    pub encoder_sigma_rad: f64,
    /// Angle η by which the two gimbal axes miss a right angle, rad: the inner axis leans towards
    /// the outer, `c_cb = Rx(roll) · Ry(η) · Rz(azimuth)`.
    pub non_orthogonality_rad: f64,
    /// Play of each gear, rad: the body lags the command by half of it, on the side from which it
    /// came. The encoders sit on the drives and don't see it.
    pub backlash_rad: f64,
    /// Mounting of the body, and errors of the encoders with given coefficients.
    pub errors: GimbalErrors,
}

/// Errors of the gimbals with given coefficients. The default has none of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GimbalErrors {
    /// Mounting μ of the body on the inner gimbal, rad: the body is turned by this vector in its own
    /// axes, `c_cb = Rx(roll) · Ry(η) · Rz(azimuth) · exp([μ×])`.
    pub mounting_rad: [f64; 3],
    /// Zero errors of the encoders of azimuth and roll, rad: measured − true.
    pub encoder_zero_rad: [f64; 2],
    /// Eccentricity of the encoders of azimuth and roll, rad: coefficients c and s of the error
    /// `c cos(angle) + s sin(angle)`, measured − true. They add to the drawn curve.
    pub eccentricity_rad: [[f64; 2]; 2],
    /// White noise of each encoder's reading, 1σ, rad.
    pub encoder_noise_rad: f64,
}

/// The sensors.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Imu {
    /// True coefficients of the error model.
    pub parameters: Parameters,
    /// Gyro angle random walk, rad/√s.
    pub angle_random_walk: f64,
    /// Accelerometer noise density, (m/s²)/√Hz.
    pub velocity_random_walk: f64,
    /// Errors that the filter doesn't model.
    pub extensions: Extensions,
}

/// Errors that the sensors have and the filter doesn't model. The default has none of them.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Extensions {
    /// First-order Gauss-Markov gyro bias: σ (rad/s) and correlation time (s). Like the random
    /// walk, the process continues from calibration into navigation; its driving noise is counted
    /// by phase.
    pub gyro_gauss_markov: Option<GaussMarkov>,
    /// First-order Gauss-Markov accelerometer bias: σ (m/s²) and correlation time (s).
    pub accel_gauss_markov: Option<GaussMarkov>,
    /// Gyro rate random walk, (rad/s)/√s.
    pub gyro_rate_random_walk: f64,
    /// Coefficient B of the gyros' bias instability (1/f noise), rad/s; 0: none. The Allan deviation
    /// has its floor at 0.664 B (IEEE Std 952). [`crate::flicker`] says of which processes it is made.
    /// It starts in its stationary distribution, of standard deviation 2.07 B, and continues from
    /// calibration into navigation.
    pub gyro_bias_instability: f64,
    /// The same of the accelerometers, m/s².
    pub accel_bias_instability: f64,
    /// Quantization of the gyros, coarser than the format, rad per count; 0: none.
    pub gyro_quantization_rad: f64,
    /// Quantization of the accelerometers, m/s per count; 0: none.
    pub accel_quantization_mps: f64,
    /// Range of the gyros, rad/s; 0: only that of the format.
    pub gyro_range_radps: f64,
    /// Range of the accelerometers, m/s²; 0: only that of the format.
    pub accel_range_mps2: f64,
    /// Temperature change and its effects.
    pub temperature: Option<Temperature>,
    /// Vibration of the sensor block.
    pub vibration: Option<Vibration>,
    /// Position of each accelerometer's proof mass from the centre of rotation, in b, m (size
    /// effect): row i is that of axis i.
    pub lever_arm_m: [[f64; 3]; 3],
    /// Asymmetry of the gyros' scale factors a: the reading is too large by a abs(ω).
    #[serde(default)]
    pub gyro_asymmetry: [f64; 3],
    /// Asymmetry of the accelerometers' scale factors a: the reading is too large by a abs(f).
    #[serde(default)]
    pub accel_asymmetry: [f64; 3],
    /// Second-order coefficients k of the accelerometers, 1/(m/s²): the reading is too large by k f².
    /// As in the asymmetries f is the mean over a sample: vibration faster than the samples isn't
    /// rectified.
    #[serde(default)]
    pub accel_quadratic: [f64; 3],
    /// Stamp minus true time of validity, s, 0 to 1: the gyros and accelerometers lag the gimbal
    /// angles.
    pub time_skew_s: f64,
}

/// First-order Gauss-Markov process.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GaussMarkov {
    /// Stationary standard deviation.
    pub sigma: f64,
    /// Correlation time, s.
    pub correlation_time_s: f64,
}

/// Temperature of an instrument at the start, °C: the one for which its parameters are given.
pub const START_TEMPERATURE_C: f64 = 20.0;

/// Linear temperature ramp that ends at a plateau, and first-order sensitivities.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Temperature {
    /// Ramp, K/s.
    pub ramp_kps: f64,
    /// Temperature change at which the ramp ends, K.
    pub plateau_k: f64,
    /// Gyro bias sensitivity, (rad/s)/K.
    pub gyro_bias_per_k: [f64; 3],
    /// Accelerometer bias sensitivity, (m/s²)/K.
    pub accel_bias_per_k: [f64; 3],
    /// Gyro scale factor sensitivity, 1/K.
    pub gyro_scale_per_k: [f64; 3],
    /// Accelerometer scale factor sensitivity, 1/K.
    pub accel_scale_per_k: [f64; 3],
}

/// Sinusoidal vibration of the sensor block: linear and angular, so that gyros and accelerometers
/// feel the same motion.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Vibration {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Linear displacement amplitude in b, m.
    pub displacement_m: [f64; 3],
    /// Angular amplitude in b, rad.
    pub angle_rad: [f64; 3],
    /// Phase of the angular motion against the linear one, rad.
    pub phase_rad: f64,
}

/// The reference handed to the core during calibration.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AidingSource {
    /// Quantity that is measured.
    pub kind: AidingKind,
    /// Period, ns; a multiple of the sample period.
    pub period_ns: u64,
}

/// Quantity that the reference measures. The white noise is the reference's own, from its own
/// stream.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum AidingKind {
    /// Velocity of the ground or dock: zero, with noise of this σ, m/s. Sway is ignored.
    ZeroVelocity {
        /// 1σ of each axis, m/s.
        sigma_mps: f64,
    },
    /// True velocity of the instrument over ground with noise of this σ, m/s.
    Velocity {
        /// 1σ of each axis, m/s.
        sigma_mps: f64,
    },
    /// Position of the dock: constant, with noise of this σ, m. Sway is ignored.
    DockPosition {
        /// 1σ of each axis, m.
        sigma_m: f64,
    },
}
