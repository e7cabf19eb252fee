//! Events: those that older programs stored, and those that this one doesn't know.

use octant_recorder::Event;
use octant_recorder::event::by_name;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use serde_json::Value;

/// Events from recordings of the program that had no types for them.
const STORED: &str = include_str!("../../../../fixtures/formats/events.jsonl");

#[test]
fn stored_events_are_read_and_written_to_the_byte() {
    let mut kinds = std::collections::BTreeSet::new();
    for line in STORED.lines() {
        let event: Event = serde_json::from_str(line).unwrap();
        assert!(!matches!(event, Event::Other { .. }), "{line}");
        assert_eq!(serde_json::to_string(&event).unwrap(), line);
        let stored: Value = serde_json::from_str(line).unwrap();
        kinds.insert(stored["kind"].as_str().unwrap().to_owned());
    }
    let all = [
        "bench",
        "calibration",
        "error",
        "fault",
        "host",
        "link",
        "mode",
        "pace",
        "pacing",
        "receipts",
        "refused",
        "unit",
    ];
    assert!(kinds.iter().eq(all), "{kinds:?}");
}

#[test]
fn other_events_are_kept_as_they_are() {
    for line in [
        r#"{"kind":"weather","detail":{"rain_mm":0.1,"windy":[1,-2,3e+300]}}"#,
        r#"{"kind":"unit","detail":{"action":"melt","sample":3}}"#,
        r#"{"kind":"mode","detail":null}"#,
    ] {
        let event: Event = serde_json::from_str(line).unwrap();
        assert!(matches!(event, Event::Other { .. }), "{line}");
        assert_eq!(serde_json::to_string(&event).unwrap(), line);
    }
    assert!(serde_json::from_str::<Event>(r#"{"detail":{}}"#).is_err());
}

#[test]
fn what_is_not_finite_is_null() {
    let mut values = [0.5; PARAMETER_COUNT];
    values[7] = f64::NAN;
    let named = by_name(&values);
    assert_eq!(named[NAMES[7]], None);
    assert_eq!(named.values().flatten().count(), PARAMETER_COUNT - 1);
}
