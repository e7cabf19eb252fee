//! Stored states of an instance, by name.

use super::mode::Refusal;
use super::run::Run;
use core::ffi::c_void;
use core::sync::atomic::{AtomicUsize, Ordering};

/// Next name of a stored state. No name is given twice, so that the name of another instance's or
/// of a freed state is never valid.
static NEXT_NAME: AtomicUsize = AtomicUsize::new(1);

/// Stored states of an instance.
#[derive(Debug, Default)]
pub(super) struct Snapshots {
    pub(super) kept: Vec<(usize, Box<Run>)>,
}

impl Snapshots {
    pub(super) fn place(&self, name: *mut c_void) -> Result<usize, Refusal> {
        self.kept.iter().position(|(kept, _)| *kept == name.addr()).ok_or_else(|| {
            Refusal::error(if name.is_null() {
                "the FMU state is a null pointer"
            } else {
                "the FMU state isn't one of this instance, or has been freed"
            })
        })
    }

    pub(super) fn keep(&mut self, run: Run) -> *mut c_void {
        let name = NEXT_NAME.fetch_add(1, Ordering::Relaxed);
        self.kept.push((name, Box::new(run)));
        core::ptr::without_provenance_mut(name)
    }
}
