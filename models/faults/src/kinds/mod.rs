//! The kinds of faults, one family a folder.

mod added;
mod digital;

use crate::catalogue::Kind;

/// All kinds, in the order of the documentation.
pub static KINDS: &[&[&Kind]] = &[digital::KINDS];

/// All kinds one by one.
pub fn all() -> impl Iterator<Item = &'static Kind> {
    KINDS.iter().flat_map(|family| family.iter().copied())
}

/// The kind of a name.
#[must_use]
pub fn named(name: &str) -> Option<&'static Kind> {
    all().find(|kind| kind.name == name)
}
