//! Plan of a campaign folder.

use crate::failure::Failure;
use octant_campaign::plan::{FILE_NAME, Plan};
use std::path::Path;

/// Reads the plan of a folder.
pub(super) fn read(folder: &Path) -> Result<Plan, Failure> {
    Ok(Plan::read(&folder.join(FILE_NAME))?)
}
