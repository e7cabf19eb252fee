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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_recorded_is_read_again() {
        let values: [f64; NAMES.len()] = std::array::from_fn(|i| 0.1 + i as f64 * 1e-7);
        let mut sigma = values.map(|v| v / 3.0);
        sigma[7] = f64::NAN;
        let parameters = Parameters::from_array(&values);
        let event = event(&ParameterEstimate { revision: 3, parameters, sigma });
        let json = serde_json::to_string(&event).unwrap();
        let found = estimate(&serde_json::from_str(&json).unwrap()).unwrap();
        assert_eq!(found.parameters, parameters);
        assert_eq!(found.sigma.map(f64::to_bits), sigma.map(f64::to_bits));
        assert_eq!(found.revision, 3);
        let other = Event::Refused { reason: String::new() };
        assert!(estimate(&other).is_none());
    }
}
