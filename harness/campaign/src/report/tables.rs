//! Checks that the merged tables in the folder of a campaign are those of its results.

use super::error::ReportError;
use crate::chain;
use crate::merge::merged;
use crate::plan::Plan;
use crate::results::TABLES;
use crate::store::CampaignResults;
use crate::table::{ExistingTable, TableError};
use std::path::Path;

/// Lists existing tables with their BLAKE3, and the problems with them. `run` is the number of
/// cases with a result.
///
/// # Errors
/// If they contradict the results.
#[allow(clippy::type_complexity, reason = "names of files with their hashes, and sentences")]
pub(super) fn look(
    plan: &Plan,
    folder: &Path,
    results: &CampaignResults,
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
        match ExistingTable::open(&path) {
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
    // Unreadable tables, or those of another plan, are reported above.
    if of_this_plan == TABLES.len() {
        chain::check(plan, results, |table| merged(folder, table)).map_err(
            |error| match error {
                TableError::System { action, path, source } => {
                    ReportError::System { action, path, source }
                }
                TableError::Form { path, reason } | TableError::Write { path, reason } => {
                    ReportError::Form { path, reason }
                }
            },
        )?;
    }
    Ok((found, wrong))
}
