//! Accounts of imported documents in `requirements.toml`.
//!
//! ```toml
//! [[accounts]]
//! input = "specification.reqif"
//! unit = ["object", "objects"]
//! read = 12
//! used = 11
//! left_out = [
//!   { kind = "without a text", count = 1, first = "_d5 in line 60", doubt = true },
//! ]
//! ```

use super::entries::{array, entry, quoted};
use crate::table::Reader;
use octant_account::{Account, AccountEntry, Weight};
use octant_toml_tree::Value;
use std::fmt::Write as _;

const KEYS: [&str; 8] =
    ["input", "unit", "read", "used", "repaired", "left_out", "missing", "notes"];
const ENTRY: [&str; 6] = ["kind", "count", "first", "remedy", "doubt", "fact"];
/// Lists of an account, with the headings of [`Account::entries`].
const LISTS: [(&str, &str); 4] =
    [("repaired", "repaired"), ("left_out", "left out"), ("missing", "missing"), ("notes", "note")];

pub(super) fn write(out: &mut String, accounts: &[Account]) {
    for account in accounts {
        out.push_str("\n[[accounts]]\n");
        entry(out, "input", account.name());
        array(out, "unit", account.unit());
        _ = writeln!(out, "read = {}", account.read());
        _ = writeln!(out, "used = {}", account.used_count() - account.repaired_count());
        for (key, heading) in LISTS {
            let mut entries = account.entries().filter(|(of, _)| *of == heading).peekable();
            if entries.peek().is_none() {
                continue;
            }
            _ = writeln!(out, "{key} = [");
            entries.for_each(|(_, entry)| line(out, entry));
            out.push_str("]\n");
        }
    }
}

fn line(out: &mut String, entry: &AccountEntry) {
    let AccountEntry { kind, count, first, remedy, weight, is_fact } = entry;
    _ = write!(out, "  {{ kind = {}, count = {count}", on_one_line(kind));
    for (key, text) in [("first", first), ("remedy", remedy)] {
        if let Some(text) = text {
            _ = write!(out, ", {key} = {}", on_one_line(text));
        }
    }
    for (key, holds) in [("doubt", *weight == Weight::Doubt), ("fact", *is_fact)] {
        if holds {
            _ = write!(out, ", {key} = true");
        }
    }
    out.push_str(" },\n");
}

fn on_one_line(text: &str) -> String {
    quoted(&text.replace('\n', " "))
}

pub(super) fn read(root: &Reader<'_>) -> Vec<Account> {
    root.tables("accounts").iter().filter_map(account).collect()
}

fn account(table: &Reader<'_>) -> Option<Account> {
    table.known(&KEYS);
    let input = table.required("input", "the name of a document");
    let units = table.get("unit").map(|value| table.texts_of("unit", value)).unwrap_or_default();
    let [singular, plural] = &units[..] else {
        table.problem("unit", "expected the name of a unit and its plural");
        return None;
    };
    let (read, used) = (count(table, "read")?, count(table, "used")?);
    let mut account = Account::new(input?, [singular, plural]).used(used);
    for (key, _) in LISTS {
        for table in table.tables(key) {
            let entry = account_entry(&table)?;
            account = match key {
                "repaired" => account.repaired(entry),
                "left_out" => account.left_out(entry),
                "missing" => account.missing(entry),
                _ => account.note(entry),
            };
        }
    }
    if account.read() != read {
        let sum = account.read();
        let message =
            format!("found {read}, expected {sum}, the sum of used, repaired and left_out");
        table.problem("read", message);
        return None;
    }
    Some(account)
}

fn account_entry(table: &Reader<'_>) -> Option<AccountEntry> {
    table.known(&ENTRY);
    let kind = table.required("kind", "a kind of repair, or a reason")?;
    let mut entry = AccountEntry::new(count(table, "count")?, kind);
    entry.first = table.optional("first");
    entry.remedy = table.optional("remedy");
    entry.weight = Weight::doubt_if(truth(table, "doubt")?);
    entry.is_fact = truth(table, "fact")?;
    Some(entry)
}

fn count(table: &Reader<'_>, key: &str) -> Option<u64> {
    let found = table.get(key).map(|node| &node.value);
    let count = match found {
        Some(Value::Integer(count)) => u64::try_from(*count).ok(),
        _ => None,
    };
    if count.is_none() {
        table.problem(key, "expected a number of units, 0 or more");
    }
    count
}

/// Truth of a key; false without it, none where it has another value.
fn truth(table: &Reader<'_>, key: &str) -> Option<bool> {
    match table.get(key).map(|node| &node.value) {
        None => Some(false),
        Some(Value::Boolean(truth)) => Some(*truth),
        Some(_) => {
            table.problem(key, "expected true or false");
            None
        }
    }
}
