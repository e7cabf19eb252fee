//! Values of a grid that are equal in another spelling.

use octant_scenario::campaign::{FactorSpec, Levels};
use std::collections::{BTreeMap, HashMap};

/// Finds two values of a grid that are equal in another spelling: they would be the same runs under
/// two names.
pub(super) fn equal_values(factor: &FactorSpec) -> Option<String> {
    let spelled: Vec<(String, String)> = match &factor.levels {
        Levels::Values { values, drawn: false, .. } => {
            values.iter().map(|value| (value.clone(), meaning(value))).collect()
        }
        Levels::Faults { lists, drawn: false, .. } => (lists.iter())
            .map(|list| {
                let mut sorted = list.clone();
                sorted.sort();
                sorted.dedup();
                (format!("{list:?}"), format!("{sorted:?}"))
            })
            .collect(),
        _ => return None,
    };
    let mut seen: HashMap<&str, &str> = HashMap::new();
    spelled.iter().find_map(|(value, meaning)| {
        let other = seen.insert(meaning, value)?;
        Some(format!(
            "factor {:?} has the values {other} and {value}, which are the same: expected values that differ",
            factor.name
        ))
    })
}

/// Normalises a TOML value: numbers without their spelling, quantities in SI.
fn meaning(value: &str) -> String {
    fn of(value: &toml::Value) -> String {
        match value {
            toml::Value::Integer(number) => format!("{:?}", *number as f64 + 0.0),
            toml::Value::Float(number) => format!("{:?}", number + 0.0),
            toml::Value::String(text) => match octant_scenario::quantity_of(text) {
                // Twelve decimals hide the rounding of the conversion: 1 deg equals 60 arcmin.
                Ok(quantity) => format!("{:.12e} in SI", quantity.si + 0.0),
                Err(_) => format!("{:?}", text.trim()),
            },
            toml::Value::Array(all) => format!("{:?}", all.iter().map(of).collect::<Vec<_>>()),
            toml::Value::Table(all) => {
                let all: BTreeMap<&String, String> = all.iter().map(|(k, v)| (k, of(v))).collect();
                format!("{all:?}")
            }
            toml::Value::Boolean(value) => value.to_string(),
            toml::Value::Datetime(value) => value.to_string(),
        }
    }
    let parsed = format!("value = {value}").parse::<toml::Table>();
    let parsed = parsed.ok().and_then(|table| table.get("value").map(of));
    parsed.unwrap_or_else(|| value.trim().to_owned())
}
