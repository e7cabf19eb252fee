//! Optical effects of ring lasers.

mod dither_residual;
mod lock_in;

use crate::catalogue::FaultKind;

pub(super) static KINDS: &[&FaultKind] = &[&lock_in::LOCK_IN, &dither_residual::DITHER_RESIDUAL];
