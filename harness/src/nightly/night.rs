//! What a night was: which program, which campaigns and suite, and how they ended.

use super::suite::SuiteResult;
use crate::evidence::manifest::{Git, Host, Manifest};
use crate::evidence::{RunFacts, sha256};
use octant_requirements::Verdict;
use octant_score::numerics::in_words;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Version of the form of `night.json`.
pub const SCHEMA: u32 = 1;
/// Its name in the folder of a night.
pub const FILE_NAME: &str = "night.json";

/// A night.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Night {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Its name: the day on which it began, and a number where there are several.
    pub id: String,
    /// When it began, UTC, RFC 3339.
    pub started: String,
    /// When everything had run; null: it goes on, or was broken off.
    pub ended: Option<String>,
    /// The program.
    pub program: Program,
    /// The machine that began it.
    pub host: Host,
    /// BLAKE3 of the suite with its scenarios, hexadecimal; null: it runs none.
    pub suite_blake3: Option<String>,
    /// What the cases of the suite came to.
    #[serde(default)]
    pub suite: Vec<SuiteResult>,
    /// Its campaigns.
    pub campaigns: Vec<CampaignNight>,
}

/// The program that ran a night.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Version of octant.
    pub octant: String,
    /// Its numerics version; null: from before there was one.
    #[serde(default)]
    pub numerics: Option<u32>,
    /// State of the repository that it was built from; null outside of one.
    pub git: Option<Git>,
    /// Compiler.
    pub rustc: Option<String>,
    /// SHA-256 of the lock file.
    pub lock_file: Option<String>,
    /// SHA-256 of its file.
    pub sha256: String,
    /// Operating system and architecture.
    pub target: String,
}

/// A campaign of a night.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CampaignNight {
    /// Its name: that of its file, without the ending.
    pub name: String,
    /// Its title.
    pub title: String,
    /// Id of its plan.
    pub plan: String,
    /// What it came to by itself; null: it hasn't run to its end.
    pub verdict: Option<Verdict>,
    /// What each of its requirements came to.
    pub requirements: BTreeMap<String, Verdict>,
    /// Cases that came to two results in this night.
    pub differing: Vec<String>,
}

impl Program {
    /// A program by its file.
    ///
    /// # Errors
    /// In words, if it can't be read.
    pub fn of(path: &Path) -> Result<Self, String> {
        let now = SystemTime::now();
        let Manifest { octant, numerics, git, rustc, lock_file, host, .. } =
            Manifest::of(&RunFacts::between(now, now));
        let sha256 =
            sha256(path).map_err(|error| format!("failed to read {}: {error}", path.display()))?;
        let target = format!("{} {}", host.os, host.arch);
        Ok(Self { octant, numerics, git, rustc, lock_file, sha256, target })
    }

    /// Whether the same inputs have to give the same bytes: the same file, or one that was built from
    /// the same commit, without changes of its own, with the same compiler and crates.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        let clean = |git: &Option<Git>| git.as_ref().is_some_and(|git| !git.dirty);
        let built = clean(&self.git)
            && self.lock_file.is_some()
            && Self { sha256: String::new(), ..self.clone() }
                == Self { sha256: String::new(), ..other.clone() };
        self.numerics == other.numerics && (self.sha256 == other.sha256 || built)
    }

    /// For people.
    #[must_use]
    pub fn in_words(&self) -> String {
        let commit = self.git.as_ref().map_or("unknown commit".to_owned(), |git| {
            let changed = if git.dirty { " with local changes" } else { "" };
            format!("{}{changed}", git.commit.get(..12).unwrap_or(&git.commit))
        });
        let hash = self.sha256.get(..12).unwrap_or(&self.sha256);
        let numerics = in_words(self.numerics);
        format!("octant {}, {numerics}, {commit}, program {hash}", self.octant)
    }
}

impl Night {
    /// Reads a night.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub fn read(folder: &Path) -> Result<Self, String> {
        let path = folder.join(FILE_NAME);
        let text = std::fs::read_to_string(&path)
            .map_err(|error| format!("failed to read {}: {error}", path.display()))?;
        versioned(&path, &text, SCHEMA, "a night")
    }

    /// Writes it: whole or not at all.
    ///
    /// # Errors
    /// In words, if the system refuses.
    pub fn write(&self, folder: &Path) -> Result<(), String> {
        let text = serde_json::to_string_pretty(self)
            .map_err(|error| format!("failed to write a night: {error}"))?;
        write(&folder.join(FILE_NAME), &(text + "\n"))
    }
}

/// Reads JSON that has a version; a newer one is told as such.
pub(super) fn versioned<T: serde::de::DeserializeOwned>(
    path: &Path,
    text: &str,
    schema: u32,
    what: &str,
) -> Result<T, String> {
    #[derive(Deserialize)]
    struct Version {
        schema: u32,
    }
    let wrong = |error: serde_json::Error| {
        format!("failed to read {}: expected {what}: {error}", path.display())
    };
    let version: Version = serde_json::from_str(text).map_err(wrong)?;
    if version.schema != schema {
        return Err(format!(
            "failed to read {}: found version {}, this program reads version {schema}",
            path.display(),
            version.schema
        ));
    }
    serde_json::from_str(text).map_err(wrong)
}

/// Writes a file: whole or not at all.
pub(super) fn write(path: &Path, text: &str) -> Result<(), String> {
    crate::selftest::record::write(path, text).map_err(|reason| format!("failed to {reason}"))
}

/// Folder of the nights in a history.
#[must_use]
pub fn nights(history: &Path) -> PathBuf {
    history.join("nights")
}

/// Nights that are there, the oldest first. One whose file can't be read is an error.
///
/// # Errors
/// In words.
pub fn all(history: &Path) -> Result<Vec<Night>, String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(nights(history)).into_iter().flatten().flatten() {
        // One that isn't begun has another name yet.
        let is_new = entry.file_name().to_string_lossy().starts_with('.');
        if !is_new && entry.path().join(FILE_NAME).exists() {
            found.push(Night::read(&entry.path())?);
        }
    }
    found.sort_by(|a, b| (&a.started, &a.id).cmp(&(&b.started, &b.id)));
    Ok(found)
}

/// A name for a night that begins now, which no other has: that of the day, and a number from the second
/// on.
#[must_use]
pub fn free_name(history: &Path, now: SystemTime, known: &[String]) -> String {
    let day = humantime::format_rfc3339_seconds(now).to_string();
    let day = day.get(..10).unwrap_or(&day).to_owned();
    let name = |n: u32| if n == 1 { day.clone() } else { format!("{day}.{n}") };
    let taken = |name: &String| known.contains(name) || nights(history).join(name).exists();
    (1..).map(name).find(|name| !taken(name)).unwrap_or(day.clone())
}
