//! Events of the unit in a recording.

use octant_faults::rule::UnitEvent;
use octant_recorder::Event;
use octant_run::unit::{event, of};
use octant_sample::Parameters;

#[test]
fn what_is_recorded_is_read_again() {
    let offset = Parameters::from_array(&std::array::from_fn(|i| 0.1 + i as f64 * 1e-7));
    for happened in [
        UnitEvent::Restart,
        UnitEvent::PowerOff,
        UnitEvent::PowerOn,
        UnitEvent::RestartWith { offset },
    ] {
        let json = serde_json::to_string(&event(&happened, 7)).unwrap();
        let read: Event = serde_json::from_str(&json).unwrap();
        assert_eq!(of(&read).unwrap(), Some(happened));
    }
    let other = Event::Refused { reason: String::new() };
    assert_eq!(of(&other).unwrap(), None);
    let unknown = r#"{"kind":"unit","detail":{"action":"melt","sample":1}}"#;
    let unknown = of(&serde_json::from_str(unknown).unwrap());
    assert!(unknown.unwrap_err().to_string().contains("melt"));
}
