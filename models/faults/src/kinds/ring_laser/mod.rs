//! Optical effects of ring lasers.

mod dither_residual;
mod lock_in;

use crate::catalogue::Kind;

pub(super) static KINDS: &[&Kind] = &[&lock_in::LOCK_IN, &dither_residual::DITHER_RESIDUAL];
