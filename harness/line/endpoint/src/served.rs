//! The core as a device, as run by `octant serve`.

use octant_calibration::state_machine::CoreConfigError;
use octant_calibration::{Core, CoreConfig};
use octant_link::device::{Facts, Steps};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Aiding, Output, Parameters, Sample};
use octant_wire::Text;
use octant_wire::message::{Capabilities, EndLimits};

/// The calibration core behind a port.
#[derive(Debug)]
pub struct ServedCore {
    core: Core,
    config: Box<CoreConfig>,
}

impl ServedCore {
    /// Creates a core that waits for its first sample.
    ///
    /// # Errors
    /// If the configuration contradicts itself.
    pub fn new(config: &CoreConfig) -> Result<Self, CoreConfigError> {
        Ok(Self { core: Core::new(config)?, config: Box::new(config.clone()) })
    }

    /// Returns the device's description of itself. `silence_ms`: the harness is considered gone
    /// after such a silence.
    #[must_use]
    pub fn facts(&self, silence_ms: u16) -> Facts {
        Facts {
            name: Text::fitting("octant serve"),
            firmware: Text::fitting(concat!("octant ", env!("CARGO_PKG_VERSION"))),
            capabilities: Capabilities::all(),
            sample_period_ns: self.config.sample_period_ns,
            configuration: super::live::configuration(&self.config),
            limits: EndLimits { window: WINDOW, silence_ms, shortest_period_ns: 0 },
        }
    }
}

/// Samples that may wait in the port's own buffer: a pseudo terminal holds 4096 bytes, or 58
/// samples.
const WINDOW: u16 = 32;

impl Steps for ServedCore {
    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), String> {
        let mut config = CoreConfig::clone(&self.config);
        if let Some(offset) = offset {
            config.initial_parameters = super::sum(&config.initial_parameters, offset);
        }
        self.core = Core::new(&config).map_err(|error| error.to_string())?;
        Ok(())
    }

    fn step(&mut self, sample: &Sample, aiding: Option<&Aiding>, output: &mut Output) {
        self.core.step_into(sample, aiding, output);
    }

    fn end(&mut self) -> Output {
        self.core.end_of_stream()
    }

    fn parameters(&self) -> (Parameters, [f64; PARAMETER_COUNT]) {
        (*self.core.parameters(), *self.core.sigma())
    }
}
