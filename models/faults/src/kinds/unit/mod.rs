//! The unit under test itself.

mod power;
mod table;

use crate::catalogue::FaultKind;

pub use power::BROWN_OUT;
pub(super) use power::Once;

pub(super) static KINDS: &[&FaultKind] = &[&power::RESTART, &power::BROWN_OUT, &table::STALE_TABLE];
