//! Key that results are signed with.

use crate::failure::Failure;
use octant_evidence::signature::Key;
use std::sync::Arc;

/// Reads the key that the environment names, before anything is run.
pub(crate) fn signing_key() -> Result<Option<Arc<Key>>, Failure> {
    let key = Key::of_environment().map_err(|error| Failure::input(error).failed())?;
    Ok(key.map(Arc::new))
}
