//! Accepted baseline: a night that a user has reviewed and accepted.
//!
//! The data needed from it is stored separately, so that the folders of nights may be deleted.
//! `baseline.json` names the night, and changes by one rename: a program that is killed leaves the
//! old one or the new.

use super::error::NightError;
use super::file::{versioned, write};
use super::night::{Night, nights};
use super::results::{self, CaseRow};
use octant_campaign::merge::merged;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Version of the form of `baseline.json`.
pub const SCHEMA: u32 = 1;
/// Name in a history.
pub const FILE_NAME: &str = "baseline.json";

/// Identifies the night that is the baseline.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Accepted {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// The night.
    pub night: String,
    /// Time of acceptance, UTC, RFC 3339.
    pub accepted: String,
    /// Operator who accepted it.
    pub operator: Option<String>,
}

/// Baseline with everything that a night is compared with.
#[derive(Clone, Debug)]
pub struct Baseline {
    /// Identity of the baseline.
    pub accepted: Accepted,
    /// The night.
    pub night: Night,
    /// Rows of its campaigns, by name.
    pub rows: BTreeMap<String, Vec<CaseRow>>,
}

fn folder(history: &Path, night: &str) -> PathBuf {
    history.join("baselines").join(night)
}

/// Reads the baseline of a history; `None` if none was accepted.
///
/// # Errors
/// If one was accepted and can't be read.
pub fn read(history: &Path) -> Result<Option<Baseline>, NightError> {
    let path = history.join(FILE_NAME);
    if !path.exists() {
        return Ok(None);
    }
    let text = std::fs::read_to_string(&path).map_err(NightError::of("read", &path))?;
    let accepted: Accepted = versioned(&path, &text, SCHEMA, "the name of a baseline")?;
    let kept = folder(history, &accepted.night);
    let again =
        |error| NightError::Baseline { error: Box::new(error), history: history.to_owned() };
    let night = Night::read(&kept).map_err(again)?;
    let rows = rows(&kept, &night).map_err(again)?;
    Ok(Some(Baseline { accepted, night, rows }))
}

/// Reads the rows of a night's campaigns from the tables beside it.
///
/// # Errors
/// If they can't be read.
pub fn rows(folder: &Path, night: &Night) -> Result<BTreeMap<String, Vec<CaseRow>>, NightError> {
    let mut all = BTreeMap::new();
    for campaign in &night.campaigns {
        let rows = results::read(&folder.join(&campaign.name))?;
        all.insert(campaign.name.clone(), rows);
    }
    Ok(all)
}

/// Accepts a night as the baseline.
///
/// # Errors
/// If it isn't there, hasn't ended, or the operating system refuses: the old baseline then stays.
pub fn accept(history: &Path, id: &str, operator: Option<String>) -> Result<Accepted, NightError> {
    let from = nights(history).join(id);
    let night = Night::read(&from)?;
    if night.ended.is_none() {
        return Err(NightError::NotEnded { id: id.to_owned() });
    }
    let to = folder(history, id);
    let failed = |path: &Path| NightError::of("write", path);
    for campaign in &night.campaigns {
        let into = to.join(&campaign.name);
        std::fs::create_dir_all(&into).map_err(failed(&into))?;
        for table in ["cases", "checks"] {
            let path = merged(&into, table);
            std::fs::copy(merged(&from.join(&campaign.name), table), &path)
                .map_err(failed(&path))?;
        }
    }
    std::fs::create_dir_all(&to).map_err(failed(&to))?;
    night.write(&to)?;
    let accepted = Accepted {
        schema: SCHEMA,
        night: id.to_owned(),
        accepted: octant_base::utc::seconds(std::time::SystemTime::now()),
        operator,
    };
    let text = serde_json::to_string_pretty(&accepted)
        .map_err(|source| NightError::Json { what: "the baseline".to_owned(), source })?;
    write(&history.join(FILE_NAME), &(text + "\n"))?;
    // Earlier baselines aren't needed any more; one that can't be removed does no harm.
    for entry in std::fs::read_dir(history.join("baselines")).into_iter().flatten().flatten() {
        if entry.file_name() != id {
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
    Ok(accepted)
}
