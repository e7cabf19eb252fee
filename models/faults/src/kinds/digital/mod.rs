//! What happens to numbers after they were measured.

mod spike;

use crate::catalogue::Kind;

pub(super) static KINDS: &[&Kind] = &[&spike::SPIKE];
