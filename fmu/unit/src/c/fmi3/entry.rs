//! Entry into an instance of FMI 3.0.

use crate::c::call::call;
use crate::c::instance::Instance;
use crate::c::mode::{Refusal, ServedStandard};
use core::ffi::c_void;
use octant_fmi::fmi3::{Boolean, Status};

/// C's `true` and `false`.
pub(super) const TRUE: Boolean = 1;
pub(super) const FALSE: Boolean = 0;

#[inline]
pub(super) fn enter(
    handle: *mut c_void,
    function: &'static str,
    work: impl FnOnce(&mut Instance) -> Result<Status, Refusal>,
) -> Status {
    call(handle, ServedStandard::Fmi3, function, work)
}
