//! The unit under test itself.

mod power;
mod table;

use crate::catalogue::Kind;

pub(super) static KINDS: &[&Kind] = &[&power::RESTART, &power::BROWN_OUT, &table::STALE_TABLE];
