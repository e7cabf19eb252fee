//! Data of the run that a fault needs before it starts.

use alloc::string::String;
use octant_random::philox::StreamKey;
use octant_random::stream::{Phase, key};

/// Facts of the run that faults are built with.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Seed of every random stream.
    pub seed: u64,
    /// Sample period, ns.
    pub sample_period_ns: u64,
    /// Samples of the calibration phase; all later samples are navigation.
    pub calibration_samples: u64,
    /// Gyro angle random walk of the instrument, rad/√s.
    pub angle_random_walk: f64,
    /// Accelerometer noise density of the instrument, (m/s²)/√Hz.
    pub velocity_random_walk: f64,
    /// Largest rate of the turntable, rad/s.
    pub turntable_rate_radps: f64,
    /// Id of the fault that is built, part of the names of its random streams. The station fills it
    /// in.
    pub id: String,
}

impl Setup {
    /// Sample period, s.
    #[must_use]
    pub fn dt_s(&self) -> f64 {
        self.sample_period_ns as f64 * 1e-9
    }

    /// Keys of a random stream of the fault being built, for calibration and for navigation; named
    /// `fault.<id>.<name>`. Counters are sample numbers in the phase: see
    /// [`crate::rule::Context::counter`].
    #[must_use]
    pub fn stream(&self, name: &str) -> Stream {
        let name = alloc::format!("fault.{}.{name}", self.id);
        Stream {
            calibration: key(self.seed, &name, Phase::Calibration),
            navigation: key(self.seed, &name, Phase::Navigation),
        }
    }
}

/// A random stream of one fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    calibration: StreamKey,
    navigation: StreamKey,
}

impl Stream {
    /// The key of a phase.
    #[must_use]
    pub fn key(&self, phase: Phase) -> StreamKey {
        match phase {
            Phase::Navigation => self.navigation,
            Phase::Calibration | Phase::Draw => self.calibration,
        }
    }
}

/// Reason why a fault can't be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FaultBuildError {
    /// A value doesn't fit the others.
    #[error("{parameter}: {problem}")]
    Value {
        /// The parameter.
        parameter: &'static str,
        /// Value found and values expected.
        problem: String,
    },
    /// Two faults with one id: their receipts could not be told apart.
    #[error("the id {0:?} is given to two faults")]
    DuplicateId(String),
    /// A fault waits for one that isn't there.
    #[error("fault {id:?} waits for {after:?}, which is not among the faults")]
    NoSuchFault {
        /// The fault that waits.
        id: String,
        /// Id of the fault that it waits for.
        after: String,
    },
}

impl FaultBuildError {
    /// Error for a parameter without a value.
    #[must_use]
    pub fn missing(parameter: &'static str) -> Self {
        Self::Value { parameter, problem: "no value was found, one is expected".into() }
    }

    /// Error for a value that doesn't fit.
    #[must_use]
    pub fn value(parameter: &'static str, problem: impl Into<String>) -> Self {
        Self::Value { parameter, problem: problem.into() }
    }
}
