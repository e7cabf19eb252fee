//! What is kept of a run: the recording and the hash of its stream.

use crate::endpoint::ParameterEstimate;
use crate::source::Epoch;
use octant_plant::Truth;
use octant_sample::Output;

/// Everything of one epoch, as it passes the recorder.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// What the source delivered.
    pub clean: Epoch,
    /// What reached the endpoint.
    pub faulted: Epoch,
    /// What the core answered.
    pub output: Output,
}

/// What rides along with some frames only.
#[derive(Clone, Copy, Debug)]
pub enum Extra {
    /// Truth at the stamp of the frame just given.
    Truth(Truth),
    /// The parameters have changed with the frame just given.
    Parameters(ParameterEstimate),
}
