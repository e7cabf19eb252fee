//! An epoch as a recording has it.

use super::Event;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Aiding, Innovation, NavigationCovariance, Output, Sample, Truth};

/// Recorded data of one epoch. With decimation any part can be missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedEpoch {
    /// Simulated time, ns.
    pub time_ns: u64,
    /// Sample that reached the core.
    pub sample: Option<Sample>,
    /// Aiding that reached the core.
    pub aiding: Option<Aiding>,
    /// Sample that the source delivered, if it differs from `sample`; without `sample` if it didn't
    /// reach the core in its step.
    pub clean_sample: Option<Sample>,
    /// Aiding that the source delivered (`Some(None)`: none), if it differs from `aiding`.
    pub clean_aiding: Option<Option<Aiding>>,
    /// Output.
    pub output: Option<Output>,
    /// Innovation of the measurement.
    pub innovation: Option<Innovation>,
    /// Covariance of the solution after the measurement.
    pub covariance: Option<NavigationCovariance>,
    /// Parameters recorded with this epoch.
    pub parameters: Option<ParameterEstimate>,
    /// Truth.
    pub truth: Option<Truth>,
    /// Events since the epoch before, up to this one.
    pub events: Vec<Event>,
}
