//! Values as text again: as TOML, and as JSON.

use crate::tree::Value;
use std::fmt::Write as _;

/// Writes a value on one line.
pub fn write_value(value: &Value, out: &mut String) {
    match value {
        Value::Text(text) => write_quoted(text, out),
        Value::Integer(number) => _ = write!(out, "{number}"),
        Value::Number(number) => _ = write!(out, "{number:?}"),
        Value::Boolean(value) => _ = write!(out, "{value}"),
        Value::Date(text) => out.push_str(text),
        Value::Array(entries) => {
            out.push('[');
            for (index, entry) in entries.iter().enumerate() {
                if index > 0 {
                    out.push_str(", ");
                }
                write_value(&entry.value, out);
            }
            out.push(']');
        }
        Value::Table(table) => {
            out.push_str("{ ");
            for (index, entry) in table.entries.iter().enumerate() {
                if index > 0 {
                    out.push_str(", ");
                }
                write_key(&entry.key, out);
                out.push_str(" = ");
                write_value(&entry.node.value, out);
            }
            out.push_str(" }");
        }
    }
}

/// Quotes a text: JSON escapes everything that a basic string of TOML must escape, except DEL.
fn write_quoted(text: &str, out: &mut String) {
    let quoted = serde_json::Value::from(text).to_string();
    out.push_str(&quoted.replace('\u{7f}', "\\u007f"));
}

/// Writes a key, in quotes if necessary.
fn write_key(key: &str, out: &mut String) {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !key.is_empty() && key.chars().all(bare) {
        out.push_str(key)
    } else {
        write_quoted(key, out)
    }
}

/// Converts a value to JSON.
pub fn json(value: &Value) -> serde_json::Value {
    match value {
        Value::Text(text) | Value::Date(text) => serde_json::Value::from(text.as_str()),
        Value::Integer(number) => serde_json::Value::from(*number),
        Value::Number(number) => serde_json::Value::from(*number),
        Value::Boolean(value) => serde_json::Value::from(*value),
        Value::Array(entries) => entries.iter().map(|entry| json(&entry.value)).collect(),
        Value::Table(table) => {
            table.entries.iter().map(|entry| (entry.key.clone(), json(&entry.node.value))).collect()
        }
    }
}
