//! The accepted baseline: a night that somebody has looked at and found good.
//!
//! What is needed of it is kept by itself, so that the folders of nights may go. `baseline.json` says
//! which one it is, and changes by one rename: a program that is killed leaves the old one or the new.

use super::night::{Night, nights, versioned, write};
use super::results::{self, CaseRow};
use crate::campaign::merge::merged;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Version of the form of `baseline.json`.
pub const SCHEMA: u32 = 1;
/// Its name in a history.
pub const FILE_NAME: &str = "baseline.json";

/// Which night is the baseline.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Accepted {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// The night.
    pub night: String,
    /// When it was accepted, UTC, RFC 3339.
    pub accepted: String,
    /// By whom.
    pub operator: Option<String>,
}

/// The baseline with everything that a night is compared with.
#[derive(Clone, Debug)]
pub struct Baseline {
    /// Which one it is.
    pub accepted: Accepted,
    /// The night.
    pub night: Night,
    /// Rows of its campaigns, by name.
    pub rows: BTreeMap<String, Vec<CaseRow>>,
}

fn folder(history: &Path, night: &str) -> PathBuf {
    history.join("baselines").join(night)
}

/// Reads the baseline of a history; `None`: none was accepted.
///
/// # Errors
/// In words, if one was and it can't be read.
pub fn read(history: &Path) -> Result<Option<Baseline>, String> {
    let path = history.join(FILE_NAME);
    if !path.exists() {
        return Ok(None);
    }
    let text = std::fs::read_to_string(&path)
        .map_err(|error| format!("failed to read {}: {error}", path.display()))?;
    let accepted: Accepted = versioned(&path, &text, SCHEMA, "the name of a baseline")?;
    let kept = folder(history, &accepted.night);
    let again = |reason: String| {
        format!("{reason}; octant nightly accept --history {} accepts another", history.display())
    };
    let night = Night::read(&kept).map_err(again)?;
    let rows = rows(&kept, &night).map_err(again)?;
    Ok(Some(Baseline { accepted, night, rows }))
}

/// Rows of the campaigns of a night, from the tables beside it.
///
/// # Errors
/// In words, if they can't be read.
pub fn rows(folder: &Path, night: &Night) -> Result<BTreeMap<String, Vec<CaseRow>>, String> {
    let mut all = BTreeMap::new();
    for campaign in &night.campaigns {
        let rows = results::read(&folder.join(&campaign.name))
            .map_err(|error| format!("failed to {error}"))?;
        all.insert(campaign.name.clone(), rows);
    }
    Ok(all)
}

/// Makes a night the baseline.
///
/// # Errors
/// In words, if it isn't there, hasn't ended, or the system refuses: the old baseline stays then.
pub fn accept(history: &Path, id: &str, operator: Option<String>) -> Result<Accepted, String> {
    let from = nights(history).join(id);
    let night = Night::read(&from)?;
    if night.ended.is_none() {
        return Err(format!("failed to accept night {id}: it hasn't run to its end"));
    }
    let to = folder(history, id);
    let failed = |path: &Path| {
        let path = path.display().to_string();
        move |error: std::io::Error| format!("failed to write {path}: {error}")
    };
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
        accepted: humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string(),
        operator,
    };
    let text = serde_json::to_string_pretty(&accepted)
        .map_err(|error| format!("failed to write the baseline: {error}"))?;
    write(&history.join(FILE_NAME), &(text + "\n"))?;
    // Those before are of no use any more; one that can't be removed does no harm.
    for entry in std::fs::read_dir(history.join("baselines")).into_iter().flatten().flatten() {
        if entry.file_name() != id {
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
    Ok(accepted)
}
