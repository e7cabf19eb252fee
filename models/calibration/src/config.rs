//! Configuration of the core, given before the first sample. All angles in rad, all quantities SI.

mod further;
mod sigma_limits;
#[cfg(feature = "state")]
mod stored;

pub use further::{AngleMeasurements, CaseRest, Further, FurtherUse, TemperatureErrors};
pub use octant_positions::schedule::TurntableRates;
pub use sigma_limits::{SigmaLimits, UncertainQuantity};

use crate::sequence::Sequence;
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::{UnitQuaternion, Vector3};
use octant_sample::Parameters;
use octant_sample::parameters::ParameterGroup;

/// Configuration of the core.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct CoreConfig {
    /// Sample period, ns.
    pub sample_period_ns: u64,
    /// Position of the instrument; navigation starts here.
    pub site: Site,
    /// Method of finding the initial attitude.
    pub alignment: Alignment,
    /// The calibration; `None`: navigate at once with `initial_parameters`.
    pub calibration: Option<Calibration>,
    /// Navigation after the calibration; `None`: stop there.
    pub navigation: Option<NavigationPlan>,
    /// Rates of the turntable, as far as the core needs them for its timing.
    pub turntable: TurntableRates,
    /// Noise of the sensors, as assumed by the core.
    pub noise: Noise,
    /// Initial parameters, from an earlier calibration or zero.
    pub initial_parameters: Parameters,
    /// Screens and gates.
    pub screening: Screening,
}

/// Geodetic position of the instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Site {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Longitude, rad.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
}

/// Method of finding the initial attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum Alignment {
    /// Attitude and velocity are given (with errors of the size of the filter's prior).
    Given {
        /// Attitude `q_nb` at the start of the first interval.
        q_nb: UnitQuaternion<f64>,
        /// Velocity in n, m/s.
        velocity_mps: Vector3<f64>,
    },
    /// Gravity and Earth rate averaged over the first seconds of the first stop.
    Coarse {
        /// Averaging time, s.
        duration_s: f64,
    },
    /// Turn of gravity in the inertial frame over the first seconds of the first stop: the base may
    /// turn, and the filter starts with the σ that this leaves.
    Inertial {
        /// Time of the alignment, s.
        duration_s: f64,
    },
}

impl Alignment {
    /// Time that the core aligns for, s; `None` where it doesn't.
    #[must_use]
    pub fn duration_s(&self) -> Option<f64> {
        match *self {
            Self::Given { .. } => None,
            Self::Coarse { duration_s } | Self::Inertial { duration_s } => Some(duration_s),
        }
    }
}

/// A calibration through a position sequence.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Calibration {
    /// The stops, their relative dwell times and the passes.
    pub sequence: Sequence,
    /// Total time of the calibration, s: moves, dwells, all passes.
    pub duration_s: f64,
    /// Method of estimating the parameters.
    pub estimator: Estimator,
}

/// Method of estimating the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no_std without alloc: there is no box to put it in")]
pub enum Estimator {
    /// 39-state error-state Kalman filter, closed loop.
    Kalman(Kalman),
    /// Multi-position least squares on the norm of gravity and of Earth rate.
    LeastSquares(LeastSquares),
    /// The case on a precise external turntable whose angles are the reference.
    ExternalTurntable(ExternalTurntable),
}

/// The form of the system error model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum ErrorModel {
    /// Attitude error against the true navigation frame (paper, eq. 1 to 3).
    #[default]
    Phi,
    /// Attitude error against the computer frame.
    Psi,
}

/// Tuning of the Kalman filter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Kalman {
    /// Form of the error model.
    pub error_model: ErrorModel,
    /// Groups of parameters that are states, in the order of [`ParameterGroup::ALL`]. The six-position
    /// filter of the conventional method has no [`ParameterGroup::GDependent`].
    pub estimated: [bool; 7],
    /// Prior standard deviations.
    pub prior: Prior,
    /// The reference and its standard deviation.
    pub aiding: AidingMode,
    /// Period of aiding and of covariance propagation, ns: a multiple of the sample period.
    pub aiding_period_ns: u64,
    /// What the sway of the base is to the filter.
    pub sway: SwayNoise,
    /// Mean NIS (three axes) above which the calibration is refused.
    pub refuse_above_mean_nis: f64,
    /// Errors beside the parameters that the filter takes into account. An estimator is stored with
    /// them: see `stored`.
    #[cfg_attr(feature = "state", serde(skip))]
    pub further: Further,
    /// Largest standard deviations of a calibration that is published. An estimator is stored with them: see
    /// `stored`.
    #[cfg_attr(feature = "state", serde(skip))]
    pub sigma_limits: SigmaLimits,
}

/// What the sway of the base is to a filter whose reference is fixed to the dock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum SwayNoise {
    /// White noise, within the standard deviation of the reference.
    #[default]
    White,
    /// Coloured noise of second order on each axis of the ship, whose period, size and damping are
    /// estimated.
    Coloured,
}

/// Prior standard deviations, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Prior {
    /// Attitude error north, east, down, rad.
    pub attitude_rad: [f64; 3],
    /// Velocity, each axis, m/s.
    pub velocity_mps: f64,
    /// Position, each axis, m.
    pub position_m: f64,
    /// Parameters by group, in the order of [`ParameterGroup::ALL`], SI.
    pub parameters: [f64; 7],
}

impl Prior {
    /// Prior standard deviation of a parameter group, SI.
    #[must_use]
    pub fn of(&self, group: ParameterGroup) -> f64 {
        self.parameters[group as usize]
    }
}

/// Reference of the filter's measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum AidingMode {
    /// Velocity over ground: zero when static, of the dock's reference on a ship.
    Velocity {
        /// Standard deviation of each axis, m/s.
        sigma_mps: f64,
    },
    /// Position of the dock, from which the sway moves the instrument.
    Position {
        /// Standard deviation of each axis, m.
        sigma_m: f64,
    },
}

/// Settings of the least-squares estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct LeastSquares {
    /// Local gravity, m/s²; `None`: normal gravity at the site.
    pub gravity_mps2: Option<f64>,
    /// Reference of the gyro bias and of the gyro matrix.
    pub gyro: GyroReference,
    /// Method of finding static intervals.
    pub intervals: StaticIntervals,
}

/// Reference of the gyros in the least-squares estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum GyroReference {
    /// Norm of Earth rate over the static intervals: for gyros that resolve it.
    EarthRate,
    /// Gravity turned between neighbouring static attitudes, bias from the first interval: for
    /// gyros that don't resolve Earth rate (MEMS).
    RotatedGravity,
}

/// Method of finding static intervals in the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum StaticIntervals {
    /// From the procedure: the core commands the gimbals and knows when they rest.
    Commanded,
    /// From the data: windowed standard deviation of specific force below a multiple of that in the
    /// first interval, which is known to be static.
    Detected {
        /// Length of the first interval, known to be static, s.
        initial_s: f64,
        /// Window, s.
        window_s: f64,
        /// Threshold as a multiple of the standard deviation in the first interval.
        threshold: f64,
        /// Shortest interval to use, s.
        shortest_s: f64,
    },
}

/// Settings of the external-turntable estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct ExternalTurntable {
    /// Attitude of the table's base, `q_nc`, known from its survey.
    pub q_nc: UnitQuaternion<f64>,
    /// Standard deviation of each of its angles, 1σ, rad.
    pub encoder_sigma_rad: f64,
}

/// Navigation after the calibration: free inertial, height held.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct NavigationPlan {
    /// Duration, s; `None`: until the source ends.
    pub duration_s: Option<f64>,
    /// Stops that are repeated throughout the navigation; one stop: no rotation.
    pub rotation: Sequence,
    /// Dwell at each stop of weight 1, s.
    pub dwell_s: f64,
}

/// Noise of the sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Noise {
    /// Gyro angle random walk, rad/√s.
    pub angle_random_walk: f64,
    /// Accelerometer noise density (velocity random walk), (m/s²)/√Hz.
    pub velocity_random_walk: f64,
}

/// Screens and gates. Each can be switched off, which leaves the bare core.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Screening {
    /// Innovation gate; `None`: every measurement is used.
    pub gate: Option<Gate>,
    /// Identical counts in a row that make a channel "stuck"; `None`: no test.
    pub stuck_samples: Option<u32>,
    /// Rejects samples that jump further than turntable and base can move; see [`crate::screen`].
    pub jumps: bool,
    /// Bridges samples that are missing, flagged invalid, stuck or rejected by the known motion,
    /// with the uncertainty of that motion. Without bridging they are used as they are, and a gap
    /// is bridged by holding the last increments.
    pub bridging: bool,
    /// Compares gyros with encoders, and encoders with the set point.
    pub gimbals: bool,
    /// Limit of a parameter's correction over a stretch of the calibration, in the standard
    /// deviations that the correction should have; above it the calibration is refused. `None`: no
    /// test. See [`crate::drift`].
    pub drift_sigmas: Option<f64>,
    /// Lets a recovery return to the parameters of one to two minutes before it.
    pub checkpoints: bool,
    /// Rejects a reference that doesn't carry the stamp of its sample.
    pub aiding_stamps: bool,
    /// Motion of the base, from which the limits of the screens follow.
    pub base: Base,
    /// Standard deviation of an encoder's gimbal angle, 1σ, rad.
    pub encoder_sigma_rad: f64,
    /// Coarsest step of the increments beyond the format's own, rad and m/s; 0: none.
    pub resolution: (f64, f64),
    /// Largest change of an increment from one sample to the next by vibration, rad and m/s.
    pub vibration: (f64, f64),
}

/// Encoder of a precise turntable, 1σ: 18″ (the turntable of the paper's Table 1), rad.
const ENCODER_SIGMA_RAD: f64 = 8.726_646_259_971_648e-5;

impl Screening {
    /// No screening: the bare core.
    #[must_use]
    pub const fn none() -> Self {
        Self {
            gate: None,
            stuck_samples: None,
            jumps: false,
            bridging: false,
            gimbals: false,
            drift_sigmas: None,
            checkpoints: false,
            aiding_stamps: false,
            base: Base::Still,
            encoder_sigma_rad: ENCODER_SIGMA_RAD,
            resolution: (0.0, 0.0),
            vibration: (0.0, 0.0),
        }
    }

    /// Innovation gate with this recovery and the flag for stuck channels only.
    #[must_use]
    pub const fn gated(recovery: Recovery) -> Self {
        Self {
            gate: Some(Gate { nis: 25.0, rejections: 5, recovery }),
            stuck_samples: Some(8),
            ..Self::none()
        }
    }

    /// All screens and gates, for a base with this motion.
    ///
    /// The gate is at 36, six σ: it rejects 8e-8 of good measurements (χ² of three), one in 900
    /// runs of four hours. (At 25 it would be 1.5e-5, one in five.)
    #[must_use]
    pub const fn hardened(base: Base) -> Self {
        Self {
            jumps: true,
            bridging: true,
            gimbals: true,
            drift_sigmas: Some(match base {
                Base::Still => crate::drift::LIMIT_SIGMAS,
                Base::Moving(_) => crate::drift::LIMIT_MOVING_SIGMAS,
            }),
            checkpoints: true,
            aiding_stamps: true,
            base,
            gate: Some(Gate { nis: 36.0, rejections: 5, recovery: Recovery::Widening }),
            ..Self::gated(Recovery::Widening)
        }
    }
}

/// Motion of the base on which the instrument's case stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum Base {
    /// Fixed to the ground.
    #[default]
    Still,
    /// On a ship, within these bounds.
    Moving(BaseMotion),
}

/// Bounds of the motion of a base, each for the norm of the vector.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct BaseMotion {
    /// Angle from the mean attitude, rad.
    pub angle_rad: f64,
    /// Angular rate, rad/s.
    pub rate_radps: f64,
    /// Angular acceleration, rad/s².
    pub acceleration_radps2: f64,
    /// Acceleration of the instrument, m/s².
    pub force_mps2: f64,
    /// Rate of change of that, m/s³.
    pub jerk_mps3: f64,
}

/// Innovation gate and its recovery.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Gate {
    /// NIS (three axes) above which a measurement is rejected.
    pub nis: f64,
    /// Rejections in a row that start a recovery.
    pub rejections: u32,
    /// Action of a recovery.
    pub recovery: Recovery,
}

/// Action of the core when the gate has rejected too often.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum Recovery {
    /// Zeroes the covariance of φ, δv, δr with its cross terms, sets the given σ, applies the
    /// update.
    Reset {
        /// σ of φ, rad.
        attitude_rad: f64,
        /// σ of δv, m/s.
        velocity_mps: f64,
        /// σ of δr, m.
        position_m: f64,
    },
    /// Opens φ, δv, δr as wide as the innovation requires, holds the parameters while the attitude
    /// settles, then continues their estimation from the covariance that they had.
    Widening,
}

/// Heading and tilt may be this many times as uncertain as before the calibration.
const OF_PRIOR: f64 = 2.0;
/// Heading may be this many times as uncertain as white noise of the gyros leaves it where Earth rate is averaged
/// over the calibration. That of the presets is 2 to 3.
const OF_EARTH_RATE: f64 = 10.0;
/// Tilt may be this many times as large as the accelerometers' biases made it before the calibration.
const OF_BIAS: f64 = 2.0;

impl CoreConfig {
    /// Limits of heading and tilt, rad, of the instrument's grade: by what the filter knew before the calibration (`kalman` is
    /// the one that runs, after the alignment) and by the noise that the gyros are said to have. Infinite for a filter
    /// without a gate, the bare one.
    #[must_use]
    pub fn attitude_of_grade(&self, kalman: &Kalman, duration_s: f64) -> (f64, f64) {
        if self.screening.gate.is_none() {
            return (f64::INFINITY, f64::INFINITY);
        }
        let earth = Ellipsoid::at(self.site.latitude_rad, self.site.height_m);
        let north_rate = EARTH_RATE_RADPS * earth.cos_latitude.abs();
        let averaged = self.noise.angle_random_walk / (north_rate * libm::sqrt(duration_s));
        let [north, east, azimuth] = kalman.prior.attitude_rad;
        let bias = kalman.prior.of(ParameterGroup::AccelBias) / earth.gravity_mps2;
        (
            (OF_PRIOR * azimuth).max(OF_EARTH_RATE * averaged),
            (OF_PRIOR * north.max(east)).max(OF_BIAS * bias),
        )
    }
}
