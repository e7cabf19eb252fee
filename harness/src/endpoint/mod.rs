//! Where the core is: in this process, in an FMU, at the other end of a wire.

mod in_process;

pub use in_process::InProcess;

use crate::source::Epoch;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Output, Parameters};

/// The estimated parameters with their standard deviations, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterEstimate {
    /// Revision: equal to [`Output::parameters_revision`] of the output that it belongs to.
    pub revision: u32,
    /// Estimates.
    pub parameters: Parameters,
    /// 1σ in the order of [`octant_sample::parameters::NAMES`].
    pub sigma: [f64; PARAMETER_COUNT],
}

/// One realisation of the calibration core.
pub trait Endpoint {
    /// Hands one epoch to the core; its answer goes into `output`, which after an error is of no
    /// use.
    ///
    /// # Errors
    /// If the endpoint failed as a bench part: device gone, process died.
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError>;

    /// The core starts anew, as at power on: it forgets everything and waits for its first sample.
    /// With an offset its stored parameters are by so much (SI) away from those that it was
    /// configured with; without, they are those.
    ///
    /// # Errors
    /// If the endpoint failed, or can't restart its core.
    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError>;

    /// The parameters as of the last output.
    fn parameters(&self) -> ParameterEstimate;
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
    /// The core behind the endpoint can't be started anew.
    #[error("restart the core at {uri}: {reason}")]
    Restart {
        /// URI of the endpoint.
        uri: String,
        /// Why.
        reason: String,
    },
}
