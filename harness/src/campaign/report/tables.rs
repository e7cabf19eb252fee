//! The merged tables in the folder of a campaign, and whether they are those of its results.

use crate::campaign::merge::merged;
use crate::campaign::plan::Plan;
use crate::campaign::results::TABLES;
use crate::campaign::table::Table;
use std::path::Path;

/// Tables that are there with their BLAKE3, and what is wrong with them. `run` is the number of cases with
/// a result.
pub(super) fn look(plan: &Plan, folder: &Path, run: usize) -> (Vec<(String, String)>, Vec<String>) {
    let (mut found, mut wrong) = (Vec::new(), Vec::new());
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
            Ok(table) if name == "cases" && table.rows as u64 != run as u64 => {
                wrong.push(format!(
                    "{file} has {} cases and the folder {run} results: it has to be merged again",
                    table.rows
                ));
            }
            Ok(_) => {}
        }
        found.push((file, blake3::hash(&bytes).to_hex().to_string()));
    }
    (found, wrong)
}
