//! Plan of a campaign folder.

use crate::failure::Failure;
use octant_campaign::plan::{FILE_NAME, Plan};
use octant_evidence::manifest::shell_path;
use std::path::Path;

/// Reads the plan of a folder.
pub(super) fn read(folder: &Path) -> Result<Plan, Failure> {
    let path = folder.join(FILE_NAME);
    if folder.is_file() {
        let quoted = shell_path(folder);
        let is_zip = folder.extension().is_some_and(|extension| extension == "zip");
        let folder = folder.display();
        let maker = if is_zip {
            format!("octant campaign unbundle {quoted} DIR")
        } else {
            format!("octant campaign plan {quoted}")
        };
        return Err(Failure::input(format!(
            "found the file {folder}, expected the folder of a campaign: {maker} makes one"
        )));
    }
    if !path.exists() {
        return Err(Failure::input(format!(
            "found no {FILE_NAME} in {}, expected a folder that octant campaign plan has made",
            folder.display()
        )));
    }
    Ok(Plan::read(&path)?)
}
