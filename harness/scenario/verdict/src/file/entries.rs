//! Keys and texts as TOML has them.

use std::fmt::Write as _;

pub(super) fn entry(out: &mut String, key: &str, value: &str) {
    _ = writeln!(out, "{} = {}", key_of(key), quoted(value));
}

pub(super) fn array(out: &mut String, key: &str, values: &[String]) {
    let values: Vec<String> = values.iter().map(|value| quoted(value)).collect();
    _ = writeln!(out, "{} = [{}]", key_of(key), values.join(", "));
}

fn escape(text: &str) -> String {
    serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}

/// Quotes a text: JSON escapes everything that a basic string of TOML must escape, except DEL. Several
/// lines stay several lines.
pub(super) fn quoted(text: &str) -> String {
    if !text.contains('\n') {
        return escape(text);
    }
    let lines: Vec<String> = text
        .split('\n')
        .map(|line| {
            let quoted = escape(line);
            quoted[1..quoted.len() - 1].to_owned()
        })
        .collect();
    format!("\"\"\"\n{}\"\"\"", lines.join("\n"))
}

fn key_of(key: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !key.is_empty() && key.chars().all(bare) { key.to_owned() } else { escape(key) }
}
