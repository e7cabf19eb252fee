//! Record of a night: program, campaigns and suite, and their results.

use super::error::NightError;
use super::file::{versioned, write};
use super::suite::SuiteResult;
use octant_base::hash::sha256;
use octant_evidence::RunFacts;
use octant_evidence::manifest::{Git, Machine, Manifest};
use octant_score::numerics::in_words;
use octant_verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Version of the form of `night.json`.
pub const SCHEMA: u32 = 1;
/// Name in the folder of a night.
pub const FILE_NAME: &str = "night.json";

/// Night of a regression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Night {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Name: the day on which it began, with a number if there are several.
    pub id: String,
    /// Time of its beginning, UTC, RFC 3339.
    pub started: String,
    /// Time at which everything had run; null if it is in progress or was aborted.
    pub ended: Option<String>,
    /// Program of the night.
    pub program: Program,
    /// Machine that began it.
    pub host: Machine,
    /// BLAKE3 of the suite with its scenarios, hexadecimal; null if it runs none.
    pub suite_blake3: Option<String>,
    /// Results of the suite's cases.
    #[serde(default)]
    pub suite: Vec<SuiteResult>,
    /// Campaigns.
    pub campaigns: Vec<CampaignNight>,
}

/// Program that ran a night.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Version of octant.
    pub octant: String,
    /// Numerics version; null in older records.
    #[serde(default)]
    pub numerics: Option<u32>,
    /// State of the repository from which it was built; null outside of one.
    pub git: Option<Git>,
    /// Compiler.
    pub rustc: Option<String>,
    /// SHA-256 of the lock file.
    pub lock_file: Option<String>,
    /// SHA-256 of the program file.
    pub sha256: String,
    /// Operating system and architecture.
    pub target: String,
}

/// Campaign of a night.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CampaignNight {
    /// Name: that of its file, without the extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// Id of its plan.
    pub plan: String,
    /// Verdict of the campaign alone; null if it hasn't run to its end.
    pub verdict: Option<Verdict>,
    /// Verdict of each of its requirements.
    pub requirements: BTreeMap<String, Verdict>,
    /// Cases with two results in this night.
    pub differing: Vec<String>,
}

impl Program {
    /// Describes a program by its file.
    ///
    /// # Errors
    /// If it can't be read.
    pub fn of(path: &Path) -> Result<Self, NightError> {
        let now = SystemTime::now();
        let Manifest { octant, numerics, git, rustc, lock_file, host, .. } =
            Manifest::of(&RunFacts::between(now, now));
        let sha256 = sha256(path).map_err(NightError::of("read", path))?;
        let target = format!("{} {}", host.os, host.arch);
        Ok(Self { octant, numerics, git, rustc, lock_file, sha256, target })
    }

    /// Returns whether the same inputs must give the same bytes: the same file, or one built from
    /// the same commit, without local changes, with the same compiler and crates.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        let clean = |git: &Option<Git>| git.as_ref().is_some_and(|git| !git.dirty);
        let built = clean(&self.git)
            && self.lock_file.is_some()
            && Self { sha256: String::new(), ..self.clone() }
                == Self { sha256: String::new(), ..other.clone() };
        self.numerics == other.numerics && (self.sha256 == other.sha256 || built)
    }

    /// Describes the program as text.
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
    /// If it can't be read, or isn't a night: found and expected.
    pub fn read(folder: &Path) -> Result<Self, NightError> {
        let path = folder.join(FILE_NAME);
        let text = std::fs::read_to_string(&path).map_err(NightError::of("read", &path))?;
        versioned(&path, &text, SCHEMA, "a night")
    }

    /// Writes the file: whole or not at all.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn write(&self, folder: &Path) -> Result<(), NightError> {
        let text = serde_json::to_string_pretty(self)
            .map_err(|source| NightError::Json { what: "a night".to_owned(), source })?;
        write(&folder.join(FILE_NAME), &(text + "\n"))
    }
}

/// Returns the folder of the nights in a history.
#[must_use]
pub fn nights(history: &Path) -> PathBuf {
    history.join("nights")
}

/// Lists the nights, the oldest first. An unreadable file is an error.
///
/// # Errors
/// If one can't be read.
pub fn all(history: &Path) -> Result<Vec<Night>, NightError> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(nights(history)).into_iter().flatten().flatten() {
        // A night that hasn't begun has another name.
        let is_new = entry.file_name().to_string_lossy().starts_with('.');
        if !is_new && entry.path().join(FILE_NAME).exists() {
            found.push(Night::read(&entry.path())?);
        }
    }
    found.sort_by(|a, b| (&a.started, &a.id).cmp(&(&b.started, &b.id)));
    Ok(found)
}

/// Returns an unused name for a night that begins now: the day, with a number from the second night
/// on.
#[must_use]
pub fn free_name(history: &Path, now: SystemTime, known: &[String]) -> String {
    let day = octant_base::utc::seconds(now);
    let day = day.get(..10).unwrap_or(&day).to_owned();
    let name = |n: u32| if n == 1 { day.clone() } else { format!("{day}.{n}") };
    let taken = |name: &String| known.contains(name) || nights(history).join(name).exists();
    (1..).map(name).find(|name| !taken(name)).unwrap_or(day.clone())
}
