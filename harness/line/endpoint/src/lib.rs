//! Endpoints: the core in this process, in an FMU, or at the other end of a wire.

pub mod answer;
mod any;
mod fmu;
mod in_process;
mod live;
mod open;
mod powered;
mod rest;
mod served;
mod solution;

pub use any::AnyEndpoint;
pub use fmu::FmuEndpoint;
pub use in_process::InProcess;
pub use live::{LiveEndpoint, configuration};
pub use open::{check_live, open, open_with};
pub use powered::power_record;
pub use rest::RestUse;
pub use served::ServedCore;
pub use solution::SolutionEndpoint;

use octant_base::failing::{Failing, FailureKind};
use octant_calibration::covariance::SolutionCovariance;
use octant_calibration::state_machine::CoreConfigError;
use octant_calibration::table::CalibrationTable;
use octant_faults::wire::Wired;
use octant_fmu_bind::stepper::UseError;
use octant_link::harness::SessionError;
use octant_power::PowerError;
use octant_realtime::clock::MonotonicTime;
use octant_recorder::Event;
use octant_sample::further::FurtherEstimates;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Epoch, Innovation, NavigationCovariance};
use octant_sample::{Output, Parameters};
use octant_trajectory::PairsError;
use std::time::Duration;

/// Realisation of the calibration core.
pub trait Endpoint {
    /// Passes one epoch to the core and writes its answer into `output`, whose content is undefined
    /// after an error.
    ///
    /// # Errors
    /// If the endpoint failed as a part of the bench: device gone, process died.
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError>;

    /// Returns which quantities the core's answers contain.
    fn tells(&self) -> Tells {
        Tells::ALL
    }

    /// Returns whether the core has to be told the temperature of its instrument before each epoch: errors follow it.
    fn feels(&self) -> bool {
        false
    }

    /// Tells the core the temperature of its instrument over the next epoch, °C. It has a meaning where
    /// [`Self::feels`].
    fn feel(&mut self, _temperature_c: f64) {}

    /// Name of the endpoint in messages: its URI.
    fn uri(&self) -> String;

    /// Sends one epoch without waiting for the answer.
    ///
    /// # Errors
    /// As [`Self::step`].
    fn send(&mut self, epoch: &Epoch, output: &mut Output) -> Result<Sent, EndpointError> {
        self.step(epoch, output)?;
        Ok(Sent::Answered)
    }

    /// Waits for an answer until a time of the host. Answers come in the order of their epochs;
    /// `Some` holds the number of epochs before the answered one that will have no answer. `None`:
    /// no answer came, and `output` is unchanged.
    ///
    /// # Errors
    /// As [`Self::step`].
    fn answer(
        &mut self,
        _until: MonotonicTime,
        _output: &mut Output,
    ) -> Result<Option<usize>, EndpointError> {
        Ok(None)
    }

    /// Tells the core's side that the harness is alive, while the run stands between two steps: to be called many times
    /// a second then.
    ///
    /// # Errors
    /// If the endpoint is gone.
    fn idle(&mut self) -> Result<(), EndpointError> {
        Ok(())
    }

    /// Returns the relation of the endpoint's own clock to the host's, where both are compared.
    fn remote_clock(&self) -> Option<RemoteClock> {
        None
    }

    /// Restarts the core as at power on: it forgets everything and waits for its first sample. With
    /// an offset (SI) its stored parameters differ by it from the configured ones; without, they
    /// are the configured ones.
    ///
    /// # Errors
    /// If the endpoint failed, or can't restart its core.
    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError>;

    /// Cuts the power before the epoch of this number, from 1. Nothing is asked of the core until [`Self::power_on`].
    ///
    /// # Errors
    /// If the power can't be cut.
    fn power_off(&mut self, _sample: u64) -> Result<(), EndpointError> {
        Ok(())
    }

    /// Gives the power back before the epoch of this number: the core restarts.
    ///
    /// # Errors
    /// If the power can't be given, or the core doesn't come back.
    fn power_on(&mut self, _sample: u64) -> Result<(), EndpointError> {
        self.restart(None)
    }

    /// Lowers the voltage of the supply, V, for a time of the host before the epoch of this number. True: the core
    /// restarted; false: it rode through.
    ///
    /// # Errors
    /// If there is no such supply, or the core doesn't come back.
    fn voltage_dip(
        &mut self,
        _voltage_v: f64,
        _length: Duration,
        _sample: u64,
    ) -> Result<bool, EndpointError> {
        Err(EndpointError::Unpowered { uri: self.uri() })
    }

    /// Returns the parameters as of the last output.
    fn parameters(&self) -> ParameterEstimate;

    /// Returns the innovation of the measurement whose NIS the last output has; `None` from a core
    /// that answers with outputs alone.
    fn innovation(&self) -> Option<Innovation> {
        None
    }

    /// Returns the covariance of the solution after the filter's last measurement; `None` from a core
    /// that answers with outputs alone, and while no filter runs.
    fn navigation_covariance(&self) -> Option<NavigationCovariance> {
        None
    }

    /// Returns the wire to the core, where faults can be injected on one.
    fn wired(&mut self) -> Option<&mut dyn Wired> {
        None
    }

    /// Tells the core that the source has ended; returns its output then. `None`: the endpoint
    /// can't pass this on.
    ///
    /// # Errors
    /// If the endpoint failed.
    fn end_of_stream(&mut self) -> Result<Option<Output>, EndpointError> {
        Ok(None)
    }

    /// Returns the facts about the core at the end of a run that its outputs don't contain;
    /// afterwards [`Self::parameters`] returns those of the end.
    fn conclusion(&mut self) -> Conclusion {
        Conclusion::default()
    }

    /// Ends the core, after its conclusion. Nothing else may be called after it.
    ///
    /// # Errors
    /// If the endpoint fails on the way.
    fn close(&mut self) -> Result<(), EndpointError> {
        Ok(())
    }
}

/// Quantities that a core's answers contain. The others aren't judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tells {
    /// Gimbal command.
    pub commands: bool,
    /// Latitude and longitude.
    pub position: bool,
    /// Velocity over ground.
    pub velocity: bool,
    /// Attitude, or the heading alone.
    pub attitude: bool,
    /// Roll and pitch of the attitude.
    pub tilt: bool,
    /// True if the answers are computed from the samples of the run, which they then have to follow.
    pub follows: bool,
}

impl Tells {
    /// All quantities.
    pub const ALL: Self = Self {
        commands: true,
        position: true,
        velocity: true,
        attitude: true,
        tilt: true,
        follows: true,
    };
}

/// Statement of a core at the end of a run, as far as its realisation provides one.
#[derive(Clone, Debug, Default)]
pub struct Conclusion {
    /// Reason for refusing the calibration.
    pub refused: Option<String>,
    /// Mean NIS of the measurements used.
    pub nis_mean: Option<f64>,
    /// Mean NIS that is expected, where it isn't 3: 95 % of runs are between the two.
    pub nis_expected: Option<[f64; 2]>,
    /// Measurements, used and rejected.
    pub measurements: Option<u64>,
    /// The calibration table, where the calibration was accepted.
    pub table: Option<CalibrationTable>,
    /// Covariance of attitude and velocity at the end of the calibration, where there is one.
    pub solution: Option<SolutionCovariance>,
    /// Further states of the filter, where it has any and no wire is between.
    pub further: Option<FurtherEstimates>,
    /// Use of a case that is said to rest, where one is.
    pub rest: Option<RestUse>,
    /// Events of the connection to be recorded: frames that a wire carried and lost.
    pub events: Vec<Event>,
}

/// Result of sending an epoch without waiting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// The answer has already come.
    Answered,
    /// The epoch is underway; [`Endpoint::answer`] returns its answer.
    Underway,
    /// The epoch could not be sent: too many are underway, or the port didn't accept it.
    NotSent,
}

/// Relation of an endpoint's clock to the host's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemoteClock {
    /// Lead of the endpoint's clock at the last exchange, ns.
    pub offset_ns: f64,
    /// Bound on the error of the offset, ns.
    pub bound_ns: f64,
    /// Relative rate error, positive if the endpoint's clock is faster; `None`: not known yet.
    pub skew: Option<f64>,
    /// Number of time exchanges.
    pub exchanges: u64,
}

/// Reasons why the endpoint of a scenario can't be opened.
#[derive(Debug, thiserror::Error)]
pub enum EndpointOpenError {
    /// The core's configuration contradicts itself.
    #[error(transparent)]
    Core(#[from] CoreConfigError),
    /// An FMU can't be used.
    #[error(transparent)]
    Use(#[from] UseError),
    /// A solution can't be used.
    #[error(transparent)]
    Solution(#[from] Box<PairsError>),
    /// A device can't be used.
    #[error("begin a session with the device: {0}")]
    Live(#[from] SessionError),
    /// The power of a device can't be switched.
    #[error("give power to the device: {0}")]
    Power(#[from] PowerError),
    /// The line or bus is too slow for the clock.
    #[error(transparent)]
    Load(#[from] octant_link::load::LoadError),
    /// A second method was requested of a device, which has one core with one configuration.
    #[error(
        "run the scenario's [baseline] on the device at {uri}, which has one core with one configuration: \
         write endpoint.uri = \"in-process\", or remove [baseline] and give the second method a scenario of \
         its own"
    )]
    OneMethod {
        /// The port.
        uri: String,
    },
}

impl Failing for EndpointOpenError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Use(error) => error.kind(),
            Self::Live(error) => error.kind(),
            Self::Power(error) => error.kind(),
            Self::Core(_) | Self::Solution(_) | Self::Load(_) | Self::OneMethod { .. } => {
                FailureKind::Input
            }
        }
    }
}

/// Adds an offset to stored parameters.
fn sum(stored: &Parameters, offset: &Parameters) -> Parameters {
    let (stored, offset) = (stored.to_array(), offset.to_array());
    Parameters::from_array(&std::array::from_fn(|i| stored[i] + offset[i]))
}

/// Reasons why an endpoint could not go on.
#[derive(Debug, thiserror::Error)]
pub enum EndpointError {
    /// The device or process behind the endpoint is gone.
    #[error("endpoint {uri} is gone: {reason}")]
    Gone {
        /// URI of the endpoint.
        uri: String,
        /// Description of the failure.
        reason: String,
    },
    /// The session with the device can't go on.
    #[error("endpoint {0}")]
    Live(#[from] SessionError),
    /// The power of the device failed.
    #[error("power of the device: {0}")]
    Power(#[from] PowerError),
    /// The endpoint has no supply.
    #[error("lower the supply of the core at {uri}: it has none that this program knows of")]
    Unpowered {
        /// URI of the endpoint.
        uri: String,
    },
    /// The power of the device is cut, and it answers.
    #[error(
        "cut the power of {uri}: it answers without: the supply or relay feeds something else, a contact is welded, or the \
         device has another supply"
    )]
    Fed {
        /// URI of the endpoint.
        uri: String,
    },
    /// The core's answer broke the rules.
    #[error(transparent)]
    Misbehaved(#[from] answer::Misbehaviour),
    /// The core behind the endpoint can't be restarted.
    #[error("restart the core at {uri}: {reason}")]
    Restart {
        /// URI of the endpoint.
        uri: String,
        /// Reason.
        reason: String,
    },
}
