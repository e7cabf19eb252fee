//! FMUs that allow only one instance in a process.

use super::InstanceError;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// Tokens of the FMUs in this process that allow only one instance.
static ONCE: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// Permission to exist once; released with the library.
pub(crate) struct Once(String);

impl Once {
    /// Takes the permission for an FMU by its token, unless another instance has it.
    pub(super) fn take(name: &str, token: &str) -> Result<Self, InstanceError> {
        let mut once = ONCE.lock().unwrap_or_else(PoisonError::into_inner);
        if once.insert(token.into()) {
            return Ok(Self(token.into()));
        }
        Err(InstanceError::unsupported(
            name,
            "run in this process",
            "there is one already, and it can be there only once",
        ))
    }
}

impl Drop for Once {
    fn drop(&mut self) {
        ONCE.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.0);
    }
}
