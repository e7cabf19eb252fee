//! The journal of an estimate: what it is of, and every run, so that an interrupted estimate goes on.
//!
//! Each line is a checksum and JSON. The first names the estimate, each further one is a run. A checksum is the
//! beginning of the BLAKE3 of the one before and of the JSON, so that no line can be edited or left out. A line without
//! an end was interrupted, and is cut off. Runs are known by a digest of their point.

use crate::error::RareError;
use crate::outcome::RareOutcome;
use octant_rare::point::RarePoint;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Version of the journal.
pub const RARE_JOURNAL_SCHEMA: u32 = 1;

/// Identity of an estimate: with another one the runs have other results, or others are made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RareIdentity {
    /// [`RARE_JOURNAL_SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub octant: String,
    /// Version of its arithmetic.
    pub numerics: u32,
    /// BLAKE3 of the scenario with every default.
    pub scenario_blake3: String,
    /// What is looked at.
    pub subject: String,
    /// Settings of the estimate.
    pub plan: String,
}

/// A run of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RunLine {
    point: String,
    outcome: RareOutcome,
}

/// Digest of a point.
pub(crate) type PointDigest = [u8; 16];

/// Digest of a point.
pub(crate) fn digest(point: &RarePoint) -> PointDigest {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&point.noise.to_le_bytes());
    for u in &point.u {
        hasher.update(&u.to_bits().to_le_bytes());
    }
    let mut digest = [0; 16];
    digest.copy_from_slice(&hasher.finalize().as_bytes()[..16]);
    digest
}

/// An open journal.
#[derive(Debug)]
pub struct RareJournal {
    path: PathBuf,
    file: File,
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

fn hex(digest: &PointDigest) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn unhex(text: &str) -> Option<PointDigest> {
    let mut digest = [0; 16];
    if text.len() != 32 || !text.is_ascii() {
        return None;
    }
    for (index, byte) in digest.iter_mut().enumerate() {
        *byte = u8::from_str_radix(text.get(2 * index..2 * index + 2)?, 16).ok()?;
    }
    Some(digest)
}

impl RareJournal {
    /// Opens a journal, or begins it. The runs that it has are put into `known`.
    ///
    /// # Errors
    /// If it is of another estimate, is damaged, or the operating system refuses.
    pub(crate) fn open(
        path: &Path,
        identity: &RareIdentity,
        known: &mut HashMap<PointDigest, RareOutcome>,
    ) -> Result<Self, RareError> {
        let failed =
            |action| move |source| RareError::Journal { action, path: path.to_owned(), source };
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(path).map_err(failed("open"))?;
        file.try_lock().map_err(|error| failed("lock")(error.into()))?;
        let text = std::fs::read(path).map_err(failed("read"))?;
        let end = text.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let other =
            |line, problem| RareError::OtherEstimate { path: path.to_owned(), line, problem };
        let whole = std::str::from_utf8(&text[..end])
            .map_err(|_| other(1, "found bytes that are not UTF-8".to_owned()))?;
        let mut chained = String::new();
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
                let run: RunLine = serde_json::from_str(json)
                    .map_err(|error| other(index + 1, format!("expected a run: {error}")))?;
                let digest = unhex(&run.point);
                let digest = digest.ok_or_else(|| {
                    other(index + 1, format!("found point {:?}, expected 32 digits", run.point))
                })?;
                known.insert(digest, run.outcome);
            }
        }
        file.set_len(end as u64).map_err(failed("cut"))?;
        file.seek(SeekFrom::Start(end as u64)).map_err(failed("read"))?;
        let mut journal = Self { path: path.to_owned(), file, chained };
        if end == 0 {
            journal.append(&[identity])?;
        }
        Ok(journal)
    }

    /// Appends runs; they are on the disk when this returns.
    pub(crate) fn keep(&mut self, runs: &[(PointDigest, RareOutcome)]) -> Result<(), RareError> {
        let line = |(digest, outcome): &(PointDigest, RareOutcome)| RunLine {
            point: hex(digest),
            outcome: outcome.clone(),
        };
        self.append(&runs.iter().map(line).collect::<Vec<_>>())
    }

    fn append<T: Serialize>(&mut self, values: &[T]) -> Result<(), RareError> {
        let failed =
            |source| RareError::Journal { action: "write", path: self.path.clone(), source };
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

/// Refuses the first line of a journal of another estimate, naming the field.
fn refuse_other(identity: &RareIdentity, line: &str) -> Result<(), String> {
    let value: serde_json::Value = serde_json::from_str(line)
        .map_err(|error| format!("expected the identity of an estimate: {error}"))?;
    let schema = value.get("schema").and_then(serde_json::Value::as_u64);
    if let Some(newer) = schema.filter(|schema| *schema > u64::from(RARE_JOURNAL_SCHEMA)) {
        return Err(format!(
            "found schema {newer}, of a newer version: this program reads {RARE_JOURNAL_SCHEMA}"
        ));
    }
    let found: RareIdentity = serde_json::from_value(value)
        .map_err(|error| format!("expected the identity of an estimate: {error}"))?;
    let fields = [
        ("octant", &found.octant, &identity.octant),
        ("scenario_blake3", &found.scenario_blake3, &identity.scenario_blake3),
        ("subject", &found.subject, &identity.subject),
        ("plan", &found.plan, &identity.plan),
    ];
    let other = fields.iter().find(|(_, found, expected)| found != expected);
    match other {
        Some((field, found, expected)) => Err(format!(
            "found {field} {found:?}, expected {expected:?}: it is the journal of another estimate; choose another folder"
        )),
        None if found != *identity => Err(format!(
            "found numerics {}, expected {}: it is the journal of another program; choose another folder",
            found.numerics, identity.numerics
        )),
        None => Ok(()),
    }
}
