//! The file `summary.json` with all results of a run, in the units for users.
//!
//! The file contains nothing about host or clock: the same scenario, seed and core give the same bytes.

pub use super::calibration::{Calibration, HealthCounts, ParameterScore};
pub use super::navigation::{
    ErrorScore, HeightChannel, Mark, Navigation, RadialScore, SlopeWindow,
};

use super::counterfactual::Counterfactual;
use super::finding::Finding;
use super::reference::Reference;
use super::verdict::RequirementResult;
use super::work::Work;
use octant_requirements::Verdict;
use octant_requirements::decision::Decided;
use serde::{Deserialize, Serialize};

/// Schema version of `summary.json` that this program writes.
pub const SCHEMA: u32 = 2;

/// First schema with findings, plan and work done: older files are read without them.
pub const WITH_FINDINGS: u32 = 2;

/// Summary of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Schema version: [`SCHEMA`].
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
    /// Faults injected.
    pub faults: Vec<FaultResult>,
    /// Checksums of clean and faulted stream; null if they are the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub altered_streams: Option<AlteredStreams>,
    /// Name of the method of `calibration` and `navigation`.
    pub method: String,
    /// Calibration; null if the run had none.
    pub calibration: Option<Calibration>,
    /// Navigation; null if the run had none, or no truth to compare it with.
    pub navigation: Option<Navigation>,
    /// Effect of the faults, compared with the twin without them; null without faults or without a
    /// twin.
    #[serde(default)]
    pub counterfactual: Option<Counterfactual>,
    /// Second method of the same run: same instrument, same noise.
    pub baseline: Option<Baseline>,
    /// Physical references for the scores.
    pub reference: Option<Reference>,
    /// Pacing against a real clock; null in simulated time.
    pub pacing: Option<Pacing>,
    /// BLAKE3 of the canonical bytes of samples, aiding and outputs.
    pub stream_hash: String,
}

impl Summary {
    /// Writes the bytes of `summary.json`: pretty JSON with a final newline. A number that is not
    /// finite becomes null.
    ///
    /// # Errors
    /// If the summary can't be written as JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let mut text = rows_on_one_line(&serde_json::to_string_pretty(self)?);
        text.push('\n');
        Ok(text)
    }

    /// Reads a `summary.json`.
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
        serde_json::from_str(text).map_err(|e| SummaryError::Form(e.to_string()))
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

/// Result of one fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaultResult {
    /// Id in the scenario.
    pub id: String,
    /// Kind.
    pub kind: String,
    /// True if the fault was armed.
    pub armed: bool,
    /// True if it altered at least one sample.
    pub fired: bool,
    /// First sample altered.
    pub first_sample: Option<u64>,
    /// Last sample altered.
    pub last_sample: Option<u64>,
    /// Number of samples altered.
    pub samples_altered: u64,
    /// Number of firings.
    #[serde(default)]
    pub firings: u32,
    /// CRC-32 of the samples before the alteration, hexadecimal; null if there are none.
    #[serde(default)]
    pub clean_crc32: Option<String>,
    /// CRC-32 of the samples after the alteration.
    #[serde(default)]
    pub faulted_crc32: Option<String>,
}

impl FaultResult {
    /// Text `fault spike-1 (spike): fired once, 100 samples from 36001 to 36100`.
    #[must_use]
    pub fn sentence(&self) -> String {
        let times = match self.firings {
            1 => "once".to_owned(),
            n => format!("{n} times"),
        };
        let what = match (self.first_sample, self.last_sample) {
            (Some(first), Some(last)) if first == last => format!("fired {times}, sample {first}"),
            (Some(first), Some(last)) => {
                format!("fired {times}, {} samples from {first} to {last}", self.samples_altered)
            }
            _ if self.firings > 0 => format!("set in {times} and altered nothing"),
            _ => "never fired".to_owned(),
        };
        format!("fault {} ({}): {what}", self.id, self.kind)
    }
}

impl From<&octant_faults::Receipt> for FaultResult {
    fn from(receipt: &octant_faults::Receipt) -> Self {
        // A fault that touches no sample (of the plant, of the unit) leaves both checksums empty.
        let sums = receipt.fired() && receipt.clean_crc32 != receipt.faulted_crc32;
        let hex = |sum: u32| sums.then(|| format!("{sum:08x}"));
        Self {
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
        }
    }
}

/// Checksums of the two streams of a run in which faults altered something: as delivered by the source
/// and as received by the core, both from the first difference on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AlteredStreams {
    /// Sequence number of the first sample that was altered, lost or added.
    pub first_sample: u64,
    /// BLAKE3 of the source's stream from then on.
    pub clean_blake3: String,
    /// BLAKE3 of the core's stream from then on.
    pub faulted_blake3: String,
}

impl From<&octant_recorder::AlteredStreams> for AlteredStreams {
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
pub struct Baseline {
    /// Name of the method.
    pub label: String,
    /// Calibration.
    pub calibration: Option<Calibration>,
    /// Navigation.
    pub navigation: Option<Navigation>,
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

/// Timing of a run against the host's clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pacing {
    /// Number of frames.
    pub frames: u64,
    /// Period of the frames, µs.
    pub period_us: f64,
    /// Lateness of the frames, µs.
    pub lateness_us: Lateness,
    /// Histogram of the lateness: an upper edge, ns, and the number of frames up to it and above the
    /// edge before.
    pub lateness_histogram_ns: Vec<[u64; 2]>,
    /// Lateness above which a frame is an overrun, µs.
    pub overrun_us: f64,
    /// Number of overruns.
    pub overruns: u64,
    /// Largest number of overruns in a row.
    pub overruns_in_a_row: u64,
    /// Number of the first overrun frame, from 1.
    pub first_overrun: Option<u64>,
    /// Part of the period that 99 % of the frames left unused at least, µs.
    pub slack_p1_us: f64,
    /// Time from sending a sample to receiving its answer, µs.
    pub answer_us: Lateness,
    /// Number of frames that ended without their answer.
    pub late_answers: u64,
    /// Number of samples whose answer never came, while later ones were answered.
    pub missed_answers: u64,
    /// Number of samples that could not be sent: the device's window or the port was full.
    pub not_sent: u64,
    /// Clock of the device against the host's; null if there was none to compare.
    pub device_clock: Option<DeviceClock>,
    /// Number of steps that found no room on their way to the recorder.
    pub dropped_records: u64,
}

/// Clock of a device against the host's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceClock {
    /// Offset by which it was ahead at the last exchange, µs.
    pub offset_us: f64,
    /// Bound of the error of the offset, µs.
    pub bound_us: f64,
    /// Relative rate by which it is fast; null with too few exchanges.
    pub skew_ppm: Option<f64>,
    /// Number of exchanges of the time.
    pub exchanges: u64,
}

/// Quantiles of a duration, µs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lateness {
    /// Median.
    pub p50: f64,
    /// 99 % quantile.
    pub p99: f64,
    /// 99.9 % quantile.
    pub p999: f64,
    /// Maximum.
    pub max: f64,
}
