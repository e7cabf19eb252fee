//! The journal of an estimate: what it is of, and every run, so that an interrupted estimate goes on.
//!
//! It has [chained lines](octant_base::chained_lines) of JSON: the first names the estimate, each further one is a run.
//! Runs are known by a digest of their point.

use crate::estimators::point::RarePoint;
use crate::runs::error::RareError;
use crate::runs::outcome::RareOutcome;
use octant_base::chained_lines::ChainedLines;
use octant_base::not_finite;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;

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
    /// The requirement, or the calibration.
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
    lines: ChainedLines,
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
        let first = serde_json::to_string(identity).map_err(|error| unwritten(path, error))?;
        let lines = ChainedLines::open(
            path,
            &first,
            |found| refuse_other(identity, found),
            |json| {
                let run: RunLine = not_finite::from_str(json)
                    .map_err(|error| format!("expected a run: {error}"))?;
                let digest = unhex(&run.point);
                let digest = digest
                    .ok_or_else(|| format!("found point {:?}, expected 32 digits", run.point))?;
                known.insert(digest, run.outcome);
                Ok(())
            },
        )?;
        Ok(Self { lines })
    }

    /// Appends runs; they are on the disk when this returns.
    pub(crate) fn keep(&mut self, runs: &[(PointDigest, RareOutcome)]) -> Result<(), RareError> {
        let line = |(digest, outcome): &(PointDigest, RareOutcome)| {
            serde_json::to_string(&RunLine { point: hex(digest), outcome: outcome.clone() })
        };
        let texts: Result<Vec<String>, _> = runs.iter().map(line).collect();
        let texts = texts.map_err(|error| unwritten(self.lines.path(), error))?;
        Ok(self.lines.append(texts)?)
    }
}

fn unwritten(path: &Path, error: serde_json::Error) -> RareError {
    RareError::Journal { action: "write", path: path.to_owned(), source: error.into() }
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
