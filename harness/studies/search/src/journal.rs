//! The journal of a search: what it is of, and every result, so that an interrupted search goes on.
//!
//! It has [chained lines](octant_base::chained_lines) of JSON: the first names the search, each further one is a trial.

use crate::error::SearchError;
use crate::space::Space;
use crate::space_file::to_toml;
use crate::trial::Trial;
use octant_base::chained_lines::ChainedLines;
use octant_base::not_finite;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the journal.
pub const JOURNAL_SCHEMA: u32 = 1;

/// Identity of a search: one that differs in any of these has other candidates or other results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identity {
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
pub struct Journal {
    lines: ChainedLines,
    /// Trials that it had when it was opened and that were not taken yet, first last.
    known: Vec<Trial>,
    line: usize,
}

impl Journal {
    /// Opens a journal, or begins it.
    ///
    /// # Errors
    /// If it is of another search, is damaged, or the operating system refuses.
    pub fn open(path: &Path, identity: &Identity) -> Result<Self, SearchError> {
        let mut known = Vec::new();
        let first = serde_json::to_string(identity).map_err(|error| unwritten(path, error))?;
        let lines = ChainedLines::open(
            path,
            &first,
            |found| refuse_other(identity, found),
            |json| {
                let trial = not_finite::from_str(json);
                known.push(trial.map_err(|error| format!("expected a trial: {error}"))?);
                Ok(())
            },
        )?;
        known.reverse();
        Ok(Self { lines, known, line: 1 })
    }

    /// Takes the next trials where the journal has all of them.
    ///
    /// # Errors
    /// If one is of another candidate than is asked for.
    pub fn take(
        &mut self,
        candidates: &[crate::candidate::Candidate],
    ) -> Result<Option<Vec<Trial>>, SearchError> {
        if self.known.len() < candidates.len() {
            // A part of a proposal is run again as a whole.
            let kept = !self.known.is_empty();
            self.known.clear();
            if kept {
                self.lines.forget_from(self.line)?;
            }
            return Ok(None);
        }
        let trials: Vec<Trial> = candidates.iter().filter_map(|_| self.known.pop()).collect();
        for (trial, candidate) in trials.iter().zip(candidates) {
            self.line += 1;
            if trial.candidate != *candidate {
                return Err(SearchError::OtherSearch {
                    path: self.lines.path().to_owned(),
                    line: self.line,
                    problem: "found another candidate than this search has here".to_owned(),
                });
            }
        }
        Ok(Some(trials))
    }

    /// Appends trials; they are on the disk when this returns.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn keep(&mut self, trials: &[Trial]) -> Result<(), SearchError> {
        self.line += trials.len();
        let texts: Result<Vec<String>, _> = trials.iter().map(serde_json::to_string).collect();
        let texts = texts.map_err(|error| unwritten(self.lines.path(), error))?;
        Ok(self.lines.append(texts)?)
    }
}

/// Reads the trials of a journal in a space, and the journal's hash.
///
/// # Errors
/// If there is no journal, it is damaged, of a newer version, of another space, or has no trial.
pub(crate) fn read(path: &Path, space: &Space) -> Result<(Vec<Trial>, String), SearchError> {
    let (mut trials, mut hasher) = (Vec::new(), blake3::Hasher::new());
    let in_space = |line: &str| {
        refuse_newer(line)?;
        let found: Identity = serde_json::from_str(line)
            .map_err(|error| format!("expected the identity of a search: {error}"))?;
        if found.space_blake3 != hash_of(space) {
            return Err(
                "found a search of another space, expected one of the same kinds and values"
                    .to_owned(),
            );
        }
        Ok(())
    };
    ChainedLines::read(path, in_space, |json| {
        hasher.update(json.as_bytes());
        let trial: Trial =
            not_finite::from_str(json).map_err(|error| format!("expected a trial: {error}"))?;
        let faults = &trial.candidate.faults;
        if faults.is_empty() || !faults.iter().all(|fault| fault.is_in(space)) {
            return Err("found no fault, or one that isn't in the space".to_owned());
        }
        trials.push(trial);
        Ok(())
    })?;
    if trials.is_empty() {
        let problem = "found no trial after the first line, expected some".to_owned();
        return Err(SearchError::OtherSearch { path: path.to_owned(), line: 1, problem });
    }
    Ok((trials, hasher.finalize().to_hex().to_string()))
}

/// BLAKE3 of a space.
pub(crate) fn hash_of(space: &Space) -> String {
    blake3::hash(to_toml(space).as_bytes()).to_hex().to_string()
}

/// Refuses a first line of a newer version.
fn refuse_newer(line: &str) -> Result<(), String> {
    let schema = |line: &str| -> Option<u64> {
        serde_json::from_str::<serde_json::Value>(line).ok()?.get("schema")?.as_u64()
    };
    match schema(line).filter(|schema| *schema > u64::from(JOURNAL_SCHEMA)) {
        None => Ok(()),
        Some(newer) => Err(format!(
            "found schema {newer}, of a newer version: this program reads {JOURNAL_SCHEMA}"
        )),
    }
}

fn unwritten(path: &Path, error: serde_json::Error) -> SearchError {
    SearchError::Journal { action: "write", path: path.to_owned(), source: error.into() }
}

/// Refuses the first line of a journal of another search, naming the field.
fn refuse_other(identity: &Identity, line: &str) -> Result<(), String> {
    refuse_newer(line)?;
    let found: Identity = serde_json::from_str(line)
        .map_err(|error| format!("expected the identity of a search: {error}"))?;
    if found == *identity {
        return Ok(());
    }
    let fields = |identity: &Identity| {
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
