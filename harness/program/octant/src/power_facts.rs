//! Power of a device among the facts of a bench.

use octant_recorder::event::PowerRecord;
use serde_json::Value;

/// Adds the power of the device to what the manifest tells of the bench.
pub(crate) fn with_power(bench: Option<Value>, power: Option<&PowerRecord>) -> Option<Value> {
    let Some(power) = power else { return bench };
    let mut bench = match bench {
        Some(Value::Object(bench)) => bench,
        _ => serde_json::Map::new(),
    };
    let end = power.end.map_or("in an unknown state", |end| if end.on { "on" } else { "off" });
    let text = format!(
        "{} ({}, {}), switched {} times, left {end}",
        power.identity,
        power.port,
        power.outlet,
        power.switchings.len()
    );
    bench.insert("power of the device".to_owned(), Value::String(text));
    bench.insert("power".to_owned(), serde_json::to_value(power).unwrap_or_default());
    Some(Value::Object(bench))
}
