//! Settings: resolved scenarios, key by key.

use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Key with different values.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SettingDiff {
    /// Dotted key; an entry of a list by its id, or by its number from 0.
    pub key: String,
    /// Value in the first run, as TOML; null where the key isn't there.
    pub first: Option<String>,
    /// Value in the second run.
    pub second: Option<String>,
}

/// Compares two resolved scenarios; the keys are in alphabetical order.
#[must_use]
pub fn compare(first: &toml::Table, second: &toml::Table) -> Vec<SettingDiff> {
    let (mut of_first, mut of_second) = (BTreeMap::new(), BTreeMap::new());
    walk("", first, &mut of_first);
    walk("", second, &mut of_second);
    let keys: BTreeSet<&String> = of_first.keys().chain(of_second.keys()).collect();
    keys.into_iter()
        .filter_map(|key| {
            let (first, second) = (of_first.get(key), of_second.get(key));
            (first != second).then(|| SettingDiff {
                key: key.clone(),
                first: first.cloned(),
                second: second.cloned(),
            })
        })
        .collect()
}

fn walk(start: &str, table: &toml::Table, all: &mut BTreeMap<String, String>) {
    for (name, value) in table {
        let key = if start.is_empty() { name.clone() } else { format!("{start}.{name}") };
        put(&key, value, all);
    }
}

fn put(key: &str, value: &toml::Value, all: &mut BTreeMap<String, String>) {
    match value {
        toml::Value::Table(table) => walk(key, table, all),
        toml::Value::Array(entries) if entries.iter().any(toml::Value::is_table) => {
            for (i, entry) in entries.iter().enumerate() {
                let id = entry.get("id").and_then(toml::Value::as_str);
                let key = id.map_or_else(|| format!("{key}[{i}]"), |id| format!("{key}[{id}]"));
                put(&key, entry, all);
            }
        }
        value => {
            // Texts, numbers and lists of them are written in JSON as in TOML.
            let text = serde_json::to_string(value).unwrap_or_else(|_| format!("{value:?}"));
            all.insert(key.to_owned(), text);
        }
    }
}
