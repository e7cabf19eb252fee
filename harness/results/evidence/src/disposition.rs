//! `dispositions.toml`: dispositions of the discrepancies, written by the user.
//!
//! Octant appends entries to the file and changes nothing in it. An entry whose discrepancy is gone
//! stays.

use super::discrepancy::Discrepancy;
use octant_base::failing::{Failing, FailureKind};
use octant_toml_tree::error::{Place, Problem};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Name of the file in the folder of a campaign.
pub const FILE_NAME: &str = "dispositions.toml";
/// Version of the file's form.
pub const SCHEMA: u32 = 1;

/// Reasons why dispositions can't be read.
#[derive(Debug, thiserror::Error)]
pub enum DispositionError {
    /// The file can't be read.
    #[error("read {path}: {source}")]
    System {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The content of the file isn't valid.
    #[error("read {path}: {reason}")]
    Form {
        /// The file.
        path: PathBuf,
        /// Problem found.
        reason: String,
    },
}

impl Failing for DispositionError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Form { .. } => FailureKind::Input,
            Self::System { .. } => FailureKind::Bench,
        }
    }
}

/// Builds the head of a new file for something whose report a command renders again.
fn head(of: &str, command: &str) -> String {
    format!(
        "\
# Discrepancies of {of}, and what is said of them. Fill in disposition (why it is acceptable, or
# what is done about it) and by, and make the report again: `{command}`. Octant adds
# what is new at the end and changes nothing else. A disposition changes no verdict.
schema = {SCHEMA}
"
    )
}

/// Content of the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dispositions {
    /// Text of the file, unchanged; empty if there is none.
    pub text: String,
    /// Entries, in their order.
    pub entries: Vec<DispositionEntry>,
}

/// One entry.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DispositionEntry {
    /// Id of the discrepancy.
    pub id: String,
    /// Description of the discrepancy when the entry was made.
    #[serde(default)]
    pub what: String,
    /// Requirement.
    #[serde(default)]
    pub requirement: Option<String>,
    /// Cases.
    #[serde(default)]
    pub cases: Vec<String>,
    /// Disposition; empty if there is none yet.
    #[serde(default)]
    pub disposition: String,
    /// Author of the disposition.
    #[serde(default)]
    pub by: String,
}

impl DispositionEntry {
    /// Returns whether the disposition is still missing.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.disposition.trim().is_empty()
    }
}

#[derive(Deserialize)]
struct Version {
    schema: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[allow(dead_code, reason = "it is looked at before the rest")]
    schema: u32,
    #[serde(default)]
    discrepancies: Vec<DispositionEntry>,
}

impl Dispositions {
    /// Reads a file; a missing file counts as empty.
    ///
    /// # Errors
    /// If it can't be read, is of another version, or isn't valid.
    pub fn read(path: &Path) -> Result<Self, DispositionError> {
        let path = path.to_owned();
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(Self::default());
            }
            Err(source) => return Err(DispositionError::System { path, source }),
        };
        let entries = parse(&text).map_err(|reason| DispositionError::Form { path, reason })?;
        Ok(Self { text, entries })
    }

    /// Returns the entry of a discrepancy.
    #[must_use]
    pub fn of(&self, id: &str) -> Option<&DispositionEntry> {
        self.entries.iter().find(|entry| entry.id == id)
    }

    /// Lists the discrepancies without a disposition.
    pub fn open<'a>(
        &'a self,
        discrepancies: &'a [Discrepancy],
    ) -> impl Iterator<Item = &'a Discrepancy> {
        discrepancies
            .iter()
            .filter(|found| self.of(&found.id).is_none_or(DispositionEntry::is_open))
    }

    /// Lists the entries whose discrepancy doesn't occur any more.
    #[must_use]
    pub fn gone(&self, discrepancies: &[Discrepancy]) -> Vec<&DispositionEntry> {
        let occurs =
            |entry: &&DispositionEntry| discrepancies.iter().any(|found| found.id == entry.id);
        self.entries.iter().filter(|entry| !occurs(entry)).collect()
    }

    /// Returns the file with an entry added for each discrepancy that has none; existing text stays
    /// unchanged. `of` names the subject in the head of a new file, `command` is the one that
    /// renders the report again.
    ///
    /// # Errors
    /// If the file is in a form to which nothing can be appended.
    pub fn with(
        &self,
        discrepancies: &[Discrepancy],
        path: &Path,
        of: &str,
        command: &str,
    ) -> Result<Self, DispositionError> {
        let new: Vec<&Discrepancy> =
            discrepancies.iter().filter(|found| self.of(&found.id).is_none()).collect();
        if new.is_empty() && !self.text.is_empty() {
            return Ok(self.clone());
        }
        let mut text = if self.text.is_empty() { head(of, command) } else { self.text.clone() };
        if !text.ends_with('\n') {
            text.push('\n');
        }
        for found in new {
            text += &entry(found);
        }
        let entries = parse(&text).map_err(|reason| DispositionError::Form {
            path: path.to_owned(),
            reason: format!("nothing can be added to it: {reason}; expected [[discrepancies]]"),
        })?;
        Ok(Self { text, entries })
    }
}

/// Quotes a text of one line for TOML: as it is where it has quotation marks or backslashes only, and
/// otherwise as JSON does, whose escapes are TOML's too.
fn quoted(text: &str) -> String {
    let is_plain = !text.contains(|c: char| c == '\'' || c.is_control());
    if is_plain && text.contains(['"', '\\']) {
        return format!("'{text}'");
    }
    // TOML forbids DEL in a text, which JSON has no escape of its own for.
    serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}

fn entry(found: &Discrepancy) -> String {
    // On one line: the full text is in the report.
    let what = found.what.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut text =
        format!("\n[[discrepancies]]\nid = {}\nwhat = {}\n", quoted(&found.id), quoted(&what));
    if let Some(requirement) = &found.requirement {
        text += &format!("requirement = {}\n", quoted(requirement));
    }
    if !found.cases.is_empty() {
        let cases: Vec<String> = found.cases.iter().map(|case| quoted(case)).collect();
        text += &format!("cases = [{}]\n", cases.join(", "));
    }
    text + "disposition = \"\"\nby = \"\"\n"
}

fn parse(text: &str) -> Result<Vec<DispositionEntry>, String> {
    let wrong = |Problem { place, message, .. }: Problem| {
        let place = match place {
            Place::File { line, .. } => format!("line {line}: "),
            _ => String::new(),
        };
        format!("{place}{}", message.lines().collect::<Vec<_>>().join(", "))
    };
    let version: Version = octant_toml_tree::read_as(text).map_err(wrong)?;
    if version.schema != SCHEMA {
        return Err(format!(
            "found version {}, this program reads version {SCHEMA}{}",
            version.schema,
            if version.schema > SCHEMA { ": a newer Octant wrote it" } else { "" }
        ));
    }
    let file: File = octant_toml_tree::read_as(text).map_err(wrong)?;
    let mut ids = BTreeSet::new();
    if let Some(twice) = file.discrepancies.iter().find(|entry| !ids.insert(&entry.id)) {
        return Err(format!("{:?} is there a second time, expected it once", twice.id));
    }
    Ok(file.discrepancies)
}
