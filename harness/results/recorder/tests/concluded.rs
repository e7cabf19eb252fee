//! Parameters of a calibration as an event of the recording.

use octant_recorder::Event;
use octant_recorder::concluded::{estimate, event};
use octant_sample::Parameters;
use octant_sample::parameters::{NAMES, ParameterEstimate};

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
