//! Key that results are signed with.

use crate::failure::Failure;
use octant_evidence::signature::SigningKey;
use std::sync::Arc;

/// Reads the key that the environment names, before anything is run.
pub(crate) fn signing_key() -> Result<Option<Arc<SigningKey>>, Failure> {
    let key = SigningKey::of_environment().map_err(|error| Failure::input(error).failed())?;
    Ok(key.map(Arc::new))
}
