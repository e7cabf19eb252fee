//! The core behind a device, and the facts that the device declares.

use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Aiding, Output, Parameters, Sample};
use octant_wire::Text;
use octant_wire::message::{Capabilities, EndLimits};

/// The core of a device, which is stepped.
pub trait Steps {
    /// Restarts the core as at power on; with an offset, from stored parameters that differ by that
    /// much from the configured ones.
    ///
    /// # Errors
    /// If the core can't restart, with the reason.
    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), String>;

    /// Steps the core on a sample.
    fn step(&mut self, sample: &Sample, aiding: Option<&Aiding>, output: &mut Output);

    /// Concludes the run after the last sample.
    fn end(&mut self) -> Output;

    /// Parameters as of the last output, and their 1σ, SI.
    fn parameters(&self) -> (Parameters, [f64; PARAMETER_COUNT]);
}

/// Properties that a device declares in its hello.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// Name of the device.
    pub name: Text<24>,
    /// Firmware, with version.
    pub firmware: Text<24>,
    /// Capabilities.
    pub capabilities: Capabilities,
    /// Sample period, ns.
    pub sample_period_ns: u64,
    /// Hash of the configuration; zeros: the device has none.
    pub configuration: [u8; 32],
    /// Limits that the harness has to keep.
    pub limits: EndLimits,
}
