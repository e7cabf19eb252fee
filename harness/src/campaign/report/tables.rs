//! The merged tables in the folder of a campaign, and whether they are those of its results.

use super::ReportError;
use crate::campaign::chain;
use crate::campaign::merge::merged;
use crate::campaign::plan::Plan;
use crate::campaign::results::TABLES;
use crate::campaign::table::{Table, TableError};
use std::path::Path;

/// Tables that are there with their BLAKE3, and what is wrong with them. `run` is the number of cases with
/// a result.
///
/// # Errors
/// If they contradict the results.
#[allow(clippy::type_complexity, reason = "names of files with their hashes, and sentences")]
pub(super) fn look(
    plan: &Plan,
    folder: &Path,
    run: usize,
) -> Result<(Vec<(String, String)>, Vec<String>), ReportError> {
    let (mut found, mut wrong, mut of_this_plan) = (Vec::new(), Vec::new(), 0);
    for (name, _) in TABLES {
        let path = merged(folder, name);
        let file = format!("{name}.parquet");
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
            Err(error) => {
                wrong.push(format!("{file} can't be read: {error}"));
                continue;
            }
        };
        match Table::open(&path) {
            Err(error) => wrong.push(format!("{file} can't be read: {error}")),
            Ok(table) if table.plan != plan.id => {
                wrong.push(format!("{file} is of another plan: it has to be merged again"));
            }
            Ok(table) => {
                of_this_plan += 1;
                if name == "cases" && table.rows as u64 != run as u64 {
                    wrong.push(format!(
                        "{file} has {} cases and the folder {run} results: it has to be merged again",
                        table.rows
                    ));
                }
            }
        }
        found.push((file, blake3::hash(&bytes).to_hex().to_string()));
    }
    // What can't be read, or is of another plan, is told above.
    if of_this_plan == TABLES.len() {
        chain::check(plan, folder, |table| merged(folder, table)).map_err(|error| match error {
            TableError::System { action, path, source } => {
                ReportError::System { action, path, source }
            }
            TableError::Form { path, reason } | TableError::Write { path, reason } => {
                ReportError::Form { path, reason }
            }
        })?;
    }
    Ok((found, wrong))
}
