//! Checks that the merged tables in the folder of a campaign are those of its results.

use super::error::ReportError;
use crate::merge::chain;
use crate::merge::merged;
use crate::merge::results::TABLES;
use crate::plan::Plan;
use crate::store::CampaignResults;
use crate::table::{ExistingTable, TableError};
use std::path::Path;

/// Computes the BLAKE3 of a file, hexadecimal.
fn hash_of(path: &Path) -> std::io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    std::io::copy(&mut std::fs::File::open(path)?, &mut hasher)?;
    Ok(hasher.finalize().to_hex().to_string())
}

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
        let hash = match hash_of(&path) {
            Ok(hash) => hash,
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
        found.push((file, hash));
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
