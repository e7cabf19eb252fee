//! The file `summary.json` with all results of a run, in the units for users.
//!
//! The file contains nothing about host or clock: the same scenario, seed and core give the same bytes.

pub use super::alignment::{AlignmentReference, AlignmentResult, PointScore, SolutionScore};
pub use super::allan::{AllanDeviation, AxisAllan, NoiseTermScore, SensorAllan};
pub use super::calibration::{CalibrationScore, CaseRestScore, HealthCounts, ParameterScore};
pub use super::navigation::{
    ErrorScore, GapScore, HeightChannel, Mark, NavigationScore, RadialScore, SlopeWindow,
};

pub use octant_followed::{Followed, FollowedScore, KnownNoise};
pub use octant_heading::score::{HeadingScore, HeadingTest, RunUpScore};

pub use octant_recorder::event::{
    DeviceClock, FaultResult, LatenessOverRun, LatenessQuantiles, PacingRecord,
};

use super::counterfactual::Counterfactual;
use super::finding::Finding;
use super::reference::AnalyticReference;
use super::verdict::RequirementResult;
use super::work::Work;
use octant_account::Account;
use octant_base::not_finite;
use octant_base::printable::printable;
use octant_verdict::Verdict;
use octant_verdict::decision::Decided;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Newest schema version of `summary.json`, which this program reads.
pub const SCHEMA: u32 = 3;

/// First schema with findings, plan and work done: older files are read without them.
pub const WITH_FINDINGS: u32 = 2;

/// First schema in which a number may be null: it isn't finite. Older programs can't read it, so that a summary without
/// such a number is of the schema before.
pub const NOT_FINITE: u32 = 3;

/// Summary of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Schema version: that of [`Summary::needed_schema`].
    pub schema: u32,
    /// Version of the program that made the run.
    pub octant: String,
    /// Numerics version of that program; null: the program is older than numerics versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub numerics: Option<u32>,
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of every random stream.
    pub seed: u64,
    /// Worst verdict of all parts below.
    pub verdict: Verdict,
    /// Reasons for the verdict, in plain words; "nothing was required" without requirements.
    pub reasons: Vec<String>,
    /// Requirements with their results.
    pub requirements: Vec<RequirementResult>,
    /// Findings other than requirements that affect the verdict.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
    /// Decision rule for values near their limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decision: Option<Decided>,
    /// Work planned.
    #[serde(default)]
    pub planned: Option<Work>,
    /// Work done, from the stream of the run.
    #[serde(default)]
    pub done: Option<Work>,
    /// Accounts of what came in from outside: units read, used, repaired, left out, missing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<Account>,
    /// Faults injected.
    pub faults: Vec<FaultResult>,
    /// Checksums of clean and faulted stream; null if they are the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub altered_streams: Option<AlteredStreamSummary>,
    /// Name of the method of `calibration` and `navigation`.
    pub method: String,
    /// Alignment: the first attitude; null if the run ended before it.
    #[serde(default)]
    pub alignment: Option<AlignmentResult>,
    /// Calibration; null if the run had none.
    pub calibration: Option<CalibrationScore>,
    /// Navigation; null if the run had none, or no truth to compare it with.
    pub navigation: Option<NavigationScore>,
    /// Whether the navigation followed its samples; left out without a navigation that is compared with a truth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub followed: Option<FollowedScore>,
    /// Heading test; left out if the run had none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading: Option<HeadingScore>,
    /// Effect of the faults, compared with the twin without them; null without faults or without a
    /// twin.
    #[serde(default)]
    pub counterfactual: Option<Counterfactual>,
    /// Reports of the core in the run without faults: in the run itself if it has none, else in its twin; left out where
    /// neither ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub false_alarms: Option<u64>,
    /// Second method of the same run: same instrument, same noise.
    pub baseline: Option<BaselineMethod>,
    /// Physical references for the scores.
    pub reference: Option<AnalyticReference>,
    /// Allan deviation of the samples at rest; left out without a stretch at rest, and in the cases of
    /// a campaign.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub allan_deviation: Option<Box<AllanDeviation>>,
    /// Pacing against a real clock; null in simulated time.
    pub pacing: Option<PacingRecord>,
    /// BLAKE3 of the canonical bytes of samples, aiding and outputs.
    pub stream_hash: String,
}

impl Summary {
    /// Finds the oldest schema that holds this summary: [`NOT_FINITE`] if a number isn't finite that readers of the schema
    /// before need, else [`WITH_FINDINGS`].
    ///
    /// # Errors
    /// If the summary can't be written as JSON.
    pub fn needed_schema(&self) -> Result<u32, serde_json::Error> {
        let document = serde_json::to_value(self)?;
        Ok(if Self::deserialize(&document).is_ok() { WITH_FINDINGS } else { NOT_FINITE })
    }

    /// Writes the bytes of `summary.json`: pretty JSON with a final newline. A number that is not
    /// finite becomes null.
    ///
    /// # Errors
    /// If the summary can't be written as JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let mut text = rows_on_one_line(&serde_json::to_string_pretty(self)?);
        text.push('\n');
        // The escapes are those of JSON: the same text is read.
        Ok(match printable(&text) {
            Cow::Borrowed(_) => text,
            Cow::Owned(text) => text,
        })
    }

    /// Reads a `summary.json`. Null in the place of a number is NaN.
    ///
    /// # Errors
    /// If it isn't JSON, isn't a summary, or has a newer `schema`.
    pub fn from_json(text: &str) -> Result<Self, SummaryError> {
        #[derive(Deserialize)]
        struct Version {
            schema: u32,
        }
        let version: Version =
            serde_json::from_str(text).map_err(|e| SummaryError::Form(e.to_string()))?;
        if !(1..=SCHEMA).contains(&version.schema) {
            return Err(SummaryError::Schema { found: version.schema });
        }
        not_finite::from_str(text).map_err(|e| SummaryError::Form(e.to_string()))
    }
}

/// Writes arrays of plain numbers on one line each: a pretty printer uses five lines for every point of
/// a series.
pub fn rows_on_one_line(pretty: &str) -> String {
    let mut text = String::with_capacity(pretty.len());
    let mut rest = pretty;
    let mut in_string = false;
    while let Some(c) = rest.chars().next() {
        if in_string && c == '\\' {
            // An escaped character may be a quotation mark.
            let end = rest.char_indices().nth(2).map_or(rest.len(), |(i, _)| i);
            text.push_str(&rest[..end]);
            rest = &rest[end..];
            continue;
        }
        in_string ^= c == '"';
        if c == '['
            && !in_string
            && let Some(end) = rest.find(']')
            && rest[1..end].bytes().all(|b| b"0123456789+-.eE, \n".contains(&b))
        {
            text.extend(rest[..=end].chars().filter(|c| !c.is_whitespace()));
            rest = &rest[end + 1..];
            continue;
        }
        text.push(c);
        rest = &rest[c.len_utf8()..];
    }
    text
}

/// Error of a summary that could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SummaryError {
    /// The text is no summary.
    #[error("read the summary: {0}")]
    Form(String),
    /// The summary has an unsupported schema.
    #[error(
        "read the summary: schema {found} found, 1 to {SCHEMA} expected; a newer one needs a newer octant"
    )]
    Schema {
        /// Schema found.
        found: u32,
    },
}

/// Returns the results of faults from their receipts.
#[must_use]
pub fn results(receipts: &[octant_faults::Receipt]) -> Vec<FaultResult> {
    let one = |receipt: &octant_faults::Receipt| {
        // A fault that touches no sample (of the unit) leaves both checksums empty.
        let sums = receipt.fired() && receipt.clean_crc32 != receipt.faulted_crc32;
        let hex = |sum: u32| sums.then(|| format!("{sum:08x}"));
        FaultResult {
            id: receipt.id.clone(),
            kind: receipt.kind.to_owned(),
            armed: receipt.armed,
            fired: receipt.fired(),
            first_sample: receipt.first_sample,
            last_sample: receipt.last_sample,
            samples_altered: receipt.samples_altered,
            firings: receipt.firings,
            clean_crc32: hex(receipt.clean_crc32),
            faulted_crc32: hex(receipt.faulted_crc32),
            largest_change: receipt.largest_change,
        }
    };
    receipts.iter().map(one).collect()
}

/// Checksums of the two streams of a run in which faults altered something: as delivered by the source
/// and as received by the core, both from the first difference on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AlteredStreamSummary {
    /// Sequence number of the first sample that was altered, lost or added.
    pub first_sample: u64,
    /// BLAKE3 of the source's stream from then on.
    pub clean_blake3: String,
    /// BLAKE3 of the core's stream from then on.
    pub faulted_blake3: String,
}

impl From<&octant_recorder::AlteredStreams> for AlteredStreamSummary {
    fn from(streams: &octant_recorder::AlteredStreams) -> Self {
        Self {
            first_sample: streams.first_sample,
            clean_blake3: streams.clean_blake3.clone(),
            faulted_blake3: streams.faulted_blake3.clone(),
        }
    }
}

/// Second method of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaselineMethod {
    /// Name of the method.
    pub label: String,
    /// Alignment.
    #[serde(default)]
    pub alignment: Option<AlignmentResult>,
    /// Calibration.
    pub calibration: Option<CalibrationScore>,
    /// Navigation.
    pub navigation: Option<NavigationScore>,
    /// Whether the navigation followed its samples; left out without a navigation that is compared with a truth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub followed: Option<FollowedScore>,
    /// Effect of the faults on it, compared with its own twin.
    #[serde(default)]
    pub counterfactual: Option<Counterfactual>,
    /// Work planned.
    #[serde(default)]
    pub planned: Option<Work>,
    /// Work done, from its stream.
    #[serde(default)]
    pub done: Option<Work>,
    /// BLAKE3 of its stream.
    pub stream_hash: String,
    /// Results of the faults in it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<FaultResult>,
}
