//! Where the core is: in this process, in an FMU, at the other end of a wire.

pub mod answer;
mod fmu;
mod in_process;
mod live;
mod served;

pub use fmu::FmuEndpoint;
pub use in_process::InProcess;
pub use live::{LiveEndpoint, configuration};
pub use served::ServedCore;

use crate::fmu::mapping::stepper::UseError;
use crate::source::Epoch;
use octant_calibration::Config;
use octant_calibration::state_machine::ConfigError;
use octant_calibration::table::CalibrationTable;
use octant_faults::wire::Wired;
use octant_link::harness::SessionError;
use octant_realtime::clock::HostTime;
use octant_recorder::Event;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Output, Parameters};
use octant_scenario::{self as scenario, Scenario};

/// One realisation of the calibration core.
pub trait Endpoint {
    /// Hands one epoch to the core; its answer goes into `output`, which after an error is of no
    /// use.
    ///
    /// # Errors
    /// If the endpoint failed as a bench part: device gone, process died.
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError>;

    /// What the core tells in its answers.
    fn tells(&self) -> Tells {
        Tells::ALL
    }

    /// Name of the endpoint in messages: its URI.
    fn uri(&self) -> String;

    /// Hands over one epoch without waiting for the answer.
    ///
    /// # Errors
    /// As [`Self::step`].
    fn send(&mut self, epoch: &Epoch, output: &mut Output) -> Result<Sent, EndpointError> {
        self.step(epoch, output)?;
        Ok(Sent::Answered)
    }

    /// Waits for an answer until a time of the host. Answers come in the order of their epochs;
    /// `Some` tells how many epochs before the one answered will have none. `None`: none came, and
    /// `output` is as it was.
    ///
    /// # Errors
    /// As [`Self::step`].
    fn answer(
        &mut self,
        _until: HostTime,
        _output: &mut Output,
    ) -> Result<Option<usize>, EndpointError> {
        Ok(None)
    }

    /// How the endpoint's own clock goes against the host's, where it has one that is compared.
    fn remote_clock(&self) -> Option<RemoteClock> {
        None
    }

    /// The core starts anew, as at power on: it forgets everything and waits for its first sample.
    /// With an offset its stored parameters are by so much (SI) away from those that it was
    /// configured with; without, they are those.
    ///
    /// # Errors
    /// If the endpoint failed, or can't restart its core.
    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError>;

    /// The parameters as of the last output.
    fn parameters(&self) -> ParameterEstimate;

    /// The wire to the core, where there is one on which faults can be done.
    fn wired(&mut self) -> Option<&mut dyn Wired> {
        None
    }

    /// The source has ended: what the core makes of that. `None`: it can't be told.
    ///
    /// # Errors
    /// If the endpoint failed.
    fn end_of_stream(&mut self) -> Result<Option<Output>, EndpointError> {
        Ok(None)
    }

    /// What is known of the core at the end of a run beside its outputs; the parameters are then
    /// those of the end.
    fn conclusion(&mut self) -> Conclusion {
        Conclusion::default()
    }
}

impl<E: Endpoint + ?Sized> Endpoint for Box<E> {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        (**self).step(epoch, output)
    }

    fn tells(&self) -> Tells {
        (**self).tells()
    }

    fn uri(&self) -> String {
        (**self).uri()
    }

    fn send(&mut self, epoch: &Epoch, output: &mut Output) -> Result<Sent, EndpointError> {
        (**self).send(epoch, output)
    }

    fn answer(
        &mut self,
        until: HostTime,
        output: &mut Output,
    ) -> Result<Option<usize>, EndpointError> {
        (**self).answer(until, output)
    }

    fn remote_clock(&self) -> Option<RemoteClock> {
        (**self).remote_clock()
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        (**self).restart(offset)
    }

    fn parameters(&self) -> ParameterEstimate {
        (**self).parameters()
    }

    fn end_of_stream(&mut self) -> Result<Option<Output>, EndpointError> {
        (**self).end_of_stream()
    }

    fn conclusion(&mut self) -> Conclusion {
        (**self).conclusion()
    }

    fn wired(&mut self) -> Option<&mut dyn Wired> {
        (**self).wired()
    }
}

/// What a core tells in its answers. What it doesn't isn't held against it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tells {
    /// Where it wants the gimbals.
    pub commands: bool,
    /// Latitude and longitude.
    pub position: bool,
    /// Velocity over ground.
    pub velocity: bool,
    /// Attitude.
    pub attitude: bool,
}

impl Tells {
    /// Everything.
    pub const ALL: Self = Self { commands: true, position: true, velocity: true, attitude: true };
}

/// What a core says at the end of a run, as far as its realisation tells.
#[derive(Clone, Debug, Default)]
pub struct Conclusion {
    /// Why it refused its calibration.
    pub refused: Option<String>,
    /// Mean NIS of the measurements used.
    pub nis_mean: Option<f64>,
    /// Measurements, used and rejected.
    pub measurements: Option<u64>,
    /// The calibration table, where the calibration was accepted.
    pub table: Option<CalibrationTable>,
    /// What is to be recorded of the way to it: what a wire carried, and lost.
    pub events: Vec<Event>,
}

/// What became of an epoch that was handed over without waiting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// Its answer is there already.
    Answered,
    /// It is on its way, and [`Endpoint::answer`] has its answer when it comes.
    Underway,
    /// It could not be sent: too many are underway, or the port didn't take it.
    NotSent,
}

/// An endpoint's clock against the host's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemoteClock {
    /// How far it is ahead, ns, at the last exchange.
    pub offset_ns: f64,
    /// By how much that may be wrong, ns.
    pub bound_ns: f64,
    /// By how much it goes faster; `None`: not known yet.
    pub skew: Option<f64>,
    /// Exchanges of the time.
    pub exchanges: u64,
}

/// Why the endpoint of a scenario can't be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The core's configuration contradicts itself.
    #[error(transparent)]
    Core(#[from] ConfigError),
    /// An FMU can't be used.
    #[error(transparent)]
    Use(#[from] UseError),
    /// A device can't be used.
    #[error("begin a session with the device: {0}")]
    Live(#[from] SessionError),
    /// The line or bus is too slow for the clock.
    #[error(transparent)]
    Load(#[from] octant_link::load::LoadError),
    /// A device has one core, with one configuration.
    #[error(
        "set the core at {uri} to a second method, which the scenario's [baseline] asks for: that can \
         be done with Octant's own core alone"
    )]
    OneMethod {
        /// The port.
        uri: String,
    },
}

/// Opens the endpoint of a scenario with the core of `config`; `None` where it is the core in this
/// process, which is called directly: see [`InProcess`].
///
/// # Errors
/// If it can't be opened, or doesn't fit.
pub fn open(scenario: &Scenario, config: &Config) -> Result<Option<Box<dyn Endpoint>>, OpenError> {
    match &scenario.endpoint {
        scenario::Endpoint::InProcess => Ok(None),
        scenario::Endpoint::Fmu(fmu) => {
            Ok(Some(Box::new(FmuEndpoint::open(scenario, fmu, config)?)))
        }
        scenario::Endpoint::Live(live) => {
            Ok(Some(Box::new(LiveEndpoint::open(scenario, live, config)?)))
        }
    }
}

/// Stored parameters with an offset.
fn sum(stored: &Parameters, offset: &Parameters) -> Parameters {
    let (stored, offset) = (stored.to_array(), offset.to_array());
    Parameters::from_array(&std::array::from_fn(|i| stored[i] + offset[i]))
}

/// Why an endpoint could not go on.
#[derive(Debug, thiserror::Error)]
pub enum EndpointError {
    /// The device or process behind the endpoint is gone.
    #[error("endpoint {uri} is gone: {reason}")]
    Gone {
        /// URI of the endpoint.
        uri: String,
        /// What happened.
        reason: String,
    },
    /// The session with the device can't go on.
    #[error("endpoint {0}")]
    Live(#[from] SessionError),
    /// The core answered what no core may.
    #[error(transparent)]
    Misbehaved(#[from] answer::Misbehaviour),
    /// The core behind the endpoint can't be started anew.
    #[error("restart the core at {uri}: {reason}")]
    Restart {
        /// URI of the endpoint.
        uri: String,
        /// Why.
        reason: String,
    },
}
