//! Paths of keys in a scenario: written as the keys are declared, and checked against the declaration when they are
//! compiled.

use super::definition::{Key, Kind, Section};
use super::run::SCENARIO;

/// The dotted path of a key of a scenario, `key!(procedure.calibration.duration)`. A path that the table of keys doesn't
/// have is an error of the compiler.
macro_rules! key {
    ($first:ident $(.$further:ident)*) => {
        const { $crate::keys::key_path::declared(concat!(stringify!($first) $(, ".", stringify!($further))*)) }
    };
}
pub(crate) use key;

/// Paths of several keys of one table, `keys_of!(motion: kind, ship)`.
macro_rules! keys_of {
    ($($table:ident).+: $($key:ident),+ $(,)?) => {
        $crate::keys::key_path::keys_of!(@ [$($table).+] $($key),+)
    };
    (@ $table:tt $($key:ident),+) => {
        [$($crate::keys::key_path::keys_of!(# $table $key)),+]
    };
    (# [$($table:ident).+] $key:ident) => {
        $crate::keys::key_path::key!($($table).+.$key)
    };
}
pub(crate) use keys_of;

/// Returns a path that the table of keys has.
pub(crate) const fn declared(path: &'static str) -> &'static str {
    let bytes = path.as_bytes();
    let mut section = Some(SCENARIO);
    let mut start = 0;
    while start <= bytes.len() {
        let mut end = start;
        while end < bytes.len() && bytes[end] != b'.' {
            end += 1;
        }
        let key = match section {
            Some(section) => key_of(section, bytes, start, end),
            None => None,
        };
        match key {
            Some(key) => section = inner(&key.kind),
            None => panic!("a scenario has no such key"),
        }
        start = end + 1;
    }
    path
}

/// The key of a section whose name is a part of a path.
const fn key_of(
    section: &'static Section,
    path: &[u8],
    start: usize,
    end: usize,
) -> Option<&'static Key> {
    let mut index = 0;
    while index < section.keys.len() {
        let key = &section.keys[index];
        let name = key.name.as_bytes();
        let mut same = 0;
        while same < name.len() && start + same < end && name[same] == path[start + same] {
            same += 1;
        }
        if same == name.len() && start + same == end {
            return Some(key);
        }
        index += 1;
    }
    None
}

/// Keys of the table, or of each table, that a key takes. Those of a table with several forms depend on its content.
const fn inner(kind: &'static Kind) -> Option<&'static Section> {
    match kind {
        Kind::Table(section) | Kind::Tables(section, ..) => Some(section),
        Kind::Either(kinds) => {
            let mut index = 0;
            while index < kinds.len() {
                if let Kind::Table(section) = &kinds[index] {
                    return Some(section);
                }
                index += 1;
            }
            None
        }
        _ => None,
    }
}
