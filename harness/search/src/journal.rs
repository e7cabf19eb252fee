//! The journal of a search: what it is of, and every result, so that an interrupted search goes on.
//!
//! Each line is a checksum and JSON. The first names the search, each further one is a trial. A checksum is the
//! beginning of the BLAKE3 of the one before and of the JSON, so that no line can be edited or left out. A line without
//! an end was interrupted, and is cut off.

use crate::error::FaultSearchError;
use crate::trial::FaultTrial;
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Version of the journal.
pub const JOURNAL_SCHEMA: u32 = 1;

/// Identity of a search: one that differs in any of these has other candidates or other results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchIdentity {
    /// [`JOURNAL_SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub octant: String,
    /// Version of its arithmetic.
    pub numerics: u32,
    /// BLAKE3 of the scenario with every default.
    pub scenario_blake3: String,
    /// BLAKE3 of the space.
    pub space_blake3: String,
    /// Seed of the runs.
    pub seed: u64,
    /// Seed of the search.
    pub search_seed: u64,
    /// The strategy, with what its candidates depend on.
    pub strategy: String,
}

/// An open journal.
#[derive(Debug)]
pub struct SearchJournal {
    path: PathBuf,
    file: File,
    /// Trials that it had when it was opened and that were not taken yet, first last.
    known: Vec<FaultTrial>,
    line: usize,
    /// Checksum of the last line.
    chained: String,
}

/// Characters of a checksum.
const CHECKSUM: usize = 32;

/// Checksum of a line after another one.
fn chain(before: &str, json: &str) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(before.as_bytes());
    hasher.update(json.as_bytes());
    hasher.finalize().to_hex().chars().take(CHECKSUM).collect()
}

impl SearchJournal {
    /// Opens a journal, or begins it.
    ///
    /// # Errors
    /// If it is of another search, is damaged, or the operating system refuses.
    pub fn open(path: &Path, identity: &SearchIdentity) -> Result<Self, FaultSearchError> {
        let failed = |action| {
            move |source| FaultSearchError::Journal { action, path: path.to_owned(), source }
        };
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(path).map_err(failed("open"))?;
        file.try_lock().map_err(|error| failed("lock")(error.into()))?;
        let text = std::fs::read(path).map_err(failed("read"))?;
        let end = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let other =
            |line, problem| FaultSearchError::OtherSearch { path: path.to_owned(), line, problem };
        let whole = std::str::from_utf8(&text[..end])
            .map_err(|_| other(1, "found bytes that are not UTF-8".to_owned()))?;
        let (mut known, mut chained) = (Vec::new(), String::new());
        for (index, line) in whole.lines().enumerate() {
            let (checksum, json) = line.split_once(' ').unwrap_or(("", line));
            if index == 0 {
                refuse_other(identity, json).map_err(|problem| other(1, problem))?;
            }
            chained = chain(&chained, json);
            if checksum != chained {
                let problem = "the checksum doesn't fit: a line was changed or left out".to_owned();
                return Err(other(index + 1, problem));
            }
            if index > 0 {
                let trial = serde_json::from_str(json)
                    .map_err(|error| other(index + 1, format!("expected a trial: {error}")))?;
                known.push(trial);
            }
        }
        known.reverse();
        file.set_len(end as u64).map_err(failed("cut"))?;
        file.seek(SeekFrom::Start(end as u64)).map_err(failed("read"))?;
        let mut journal = Self { path: path.to_owned(), file, known, line: 1, chained };
        if end == 0 {
            journal.append(&[identity])?;
        }
        Ok(journal)
    }

    /// Takes the next trials where the journal has all of them.
    ///
    /// # Errors
    /// If one is of another candidate than is asked for.
    pub fn take(
        &mut self,
        candidates: &[crate::candidate::FaultCandidate],
    ) -> Result<Option<Vec<FaultTrial>>, FaultSearchError> {
        if self.known.len() < candidates.len() {
            // A part of a proposal is run again as a whole.
            let kept = !self.known.is_empty();
            self.known.clear();
            if kept {
                self.forget_from(self.line)?;
            }
            return Ok(None);
        }
        let trials: Vec<FaultTrial> = candidates.iter().filter_map(|_| self.known.pop()).collect();
        for (trial, candidate) in trials.iter().zip(candidates) {
            self.line += 1;
            if trial.candidate != *candidate {
                return Err(FaultSearchError::OtherSearch {
                    path: self.path.clone(),
                    line: self.line,
                    problem: "found another candidate than this search has here".to_owned(),
                });
            }
        }
        Ok(Some(trials))
    }

    /// Cuts off all lines but the first ones.
    fn forget_from(&mut self, lines: usize) -> Result<(), FaultSearchError> {
        let failed =
            |source| FaultSearchError::Journal { action: "cut", path: self.path.clone(), source };
        let text = std::fs::read(&self.path).map_err(failed)?;
        let lines: Vec<&[u8]> = text.split_inclusive(|byte| *byte == b'\n').take(lines).collect();
        let kept = lines.iter().map(|line| line.len()).sum::<usize>() as u64;
        let checksum = lines.last().and_then(|line| line.get(..CHECKSUM)).unwrap_or_default();
        self.chained = String::from_utf8_lossy(checksum).into_owned();
        self.file.set_len(kept).map_err(failed)?;
        self.file.seek(SeekFrom::Start(kept)).map_err(failed)?;
        Ok(())
    }

    /// Appends trials; they are on the disk when this returns.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn keep(&mut self, trials: &[FaultTrial]) -> Result<(), FaultSearchError> {
        self.line += trials.len();
        self.append(trials)
    }

    fn append<T: Serialize>(&mut self, values: &[T]) -> Result<(), FaultSearchError> {
        let failed =
            |source| FaultSearchError::Journal { action: "write", path: self.path.clone(), source };
        let mut text = String::new();
        for value in values {
            let json = serde_json::to_string(value).map_err(|error| failed(error.into()))?;
            self.chained = chain(&self.chained, &json);
            text += &format!("{} {json}\n", self.chained);
        }
        self.file.write_all(text.as_bytes()).map_err(failed)?;
        self.file.sync_data().map_err(failed)
    }
}

/// Refuses the first line of a journal of another search, naming the field.
fn refuse_other(identity: &SearchIdentity, line: &str) -> Result<(), String> {
    let schema = |line: &str| -> Option<u64> {
        serde_json::from_str::<serde_json::Value>(line).ok()?.get("schema")?.as_u64()
    };
    if let Some(newer) = schema(line).filter(|schema| *schema > u64::from(JOURNAL_SCHEMA)) {
        return Err(format!(
            "found schema {newer}, of a newer version: this program reads {JOURNAL_SCHEMA}"
        ));
    }
    let found: SearchIdentity = serde_json::from_str(line)
        .map_err(|error| format!("expected the identity of a search: {error}"))?;
    if found == *identity {
        return Ok(());
    }
    let fields = |identity: &SearchIdentity| {
        serde_json::to_value(identity).ok().and_then(|value| value.as_object().cloned())
    };
    let (found, expected) =
        (fields(&found).unwrap_or_default(), fields(identity).unwrap_or_default());
    let field = expected.iter().find(|(key, value)| found.get(*key) != Some(value));
    let (key, value) =
        field.map_or(("", String::new()), |(key, value)| (key.as_str(), value.to_string()));
    let had = found.get(key).map(ToString::to_string).unwrap_or_default();
    Err(format!(
        "found {key} {had}, expected {value}: it is the journal of another search; choose another folder"
    ))
}
