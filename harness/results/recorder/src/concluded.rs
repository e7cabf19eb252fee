//! Stores the parameters of a calibration that ended with the stream, as an event of the recording.
//!
//! Messages on `/parameters` belong to an output, and an output to a sample. After the last sample
//! there is none.

use super::event::{Event, by_name};
use octant_sample::Parameters;
use octant_sample::parameters::NAMES;
use octant_sample::parameters::ParameterEstimate;

/// Builds the event.
#[must_use]
pub fn event(estimate: &ParameterEstimate) -> Event {
    Event::Calibration {
        parameters: by_name(&estimate.parameters.to_array()),
        revision: estimate.revision,
        sigma: by_name(&estimate.sigma),
    }
}

/// Reads the parameters of such an event; `None` for another one, or an incomplete one.
#[must_use]
pub fn estimate(event: &Event) -> Option<ParameterEstimate> {
    let Event::Calibration { parameters: values, revision, sigma: deviations } = event else {
        return None;
    };
    let (mut parameters, mut sigma) = ([0.0; NAMES.len()], [f64::NAN; NAMES.len()]);
    for (i, name) in NAMES.iter().enumerate() {
        parameters[i] = (*values.get(*name)?)?;
        sigma[i] = deviations.get(*name)?.unwrap_or(f64::NAN);
    }
    let parameters = Parameters::from_array(&parameters);
    Some(ParameterEstimate { revision: *revision, parameters, sigma })
}
