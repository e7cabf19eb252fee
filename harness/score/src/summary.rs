//! `summary.json`: everything that a run has shown, in the units that users see.
//!
//! Nothing of host or clock is in it: the same scenario, seed and core give the same bytes.

use super::counterfactual::Counterfactual;
use super::judge::Finding;
use super::reference::Reference;
use super::verdict::RequirementResult;
use super::work::Work;
use octant_requirements::Verdict;
use octant_requirements::decision::Decided;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the form of `summary.json` that this program writes.
pub const SCHEMA: u32 = 2;

/// The first form with findings, plan and done: what was written before is read without them.
pub const WITH_FINDINGS: u32 = 2;

/// The summary of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Version of the program that made the run.
    pub octant: String,
    /// Numerics version of that program; null: it was made before there was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub numerics: Option<u32>,
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of every random stream.
    pub seed: u64,
    /// The worst of everything below.
    pub verdict: Verdict,
    /// Why the verdict is what it is, in plain words; "nothing was required" where nothing was.
    pub reasons: Vec<String>,
    /// Every requirement with what was found.
    pub requirements: Vec<RequirementResult>,
    /// What besides requirements bears on the verdict.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
    /// How it is decided what a value near its limit comes to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decision: Option<Decided>,
    /// What the run was to do.
    #[serde(default)]
    pub planned: Option<Work>,
    /// What it did, as its stream shows.
    #[serde(default)]
    pub done: Option<Work>,
    /// Faults that were injected.
    pub faults: Vec<FaultResult>,
    /// Checksums of clean and faulted stream; null where they are the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub altered_streams: Option<AlteredStreams>,
    /// Name of the method that `calibration` and `navigation` are of.
    pub method: String,
    /// The calibration; null if the run had none.
    pub calibration: Option<Calibration>,
    /// The navigation; null if the run had none, or nothing to compare it with.
    pub navigation: Option<Navigation>,
    /// What the faults did, against the twin of the run without them; null without faults, or
    /// without a twin.
    #[serde(default)]
    pub counterfactual: Option<Counterfactual>,
    /// The second method of the same run: same instrument, same noise.
    pub baseline: Option<Baseline>,
    /// What physics says beside the scores.
    pub reference: Option<Reference>,
    /// Pacing against a real clock; null in simulated time.
    pub pacing: Option<Pacing>,
    /// BLAKE3 of the canonical bytes of samples, aiding and outputs.
    pub stream_hash: String,
}

impl Summary {
    /// The bytes of `summary.json`: pretty JSON with a final newline. A number that is not finite
    /// becomes null.
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

/// Arrays of plain numbers on one line each: a pretty printer gives every point of a series five.
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

/// Why a summary could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SummaryError {
    /// Not a summary.
    #[error("read the summary: {0}")]
    Form(String),
    /// Written by another version.
    #[error(
        "read the summary: schema {found} found, 1 to {SCHEMA} expected; a newer one needs a newer octant"
    )]
    Schema {
        /// The schema found.
        found: u32,
    },
}

/// What became of one fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaultResult {
    /// Its id in the scenario.
    pub id: String,
    /// Its kind.
    pub kind: String,
    /// It was armed.
    pub armed: bool,
    /// It altered at least one sample.
    pub fired: bool,
    /// First sample that it altered.
    pub first_sample: Option<u64>,
    /// Last sample that it altered.
    pub last_sample: Option<u64>,
    /// Samples that it altered.
    pub samples_altered: u64,
    /// How often it set in.
    #[serde(default)]
    pub firings: u32,
    /// CRC-32 of what it was given, over what it altered, hexadecimal; null if that is nothing.
    #[serde(default)]
    pub clean_crc32: Option<String>,
    /// CRC-32 of what it made of it.
    #[serde(default)]
    pub faulted_crc32: Option<String>,
}

impl FaultResult {
    /// `fault spike-1 (spike): fired once, 100 samples from 36001 to 36100`.
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
        // A fault that touches no sample (of the plant, of the unit) leaves both sums empty.
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

/// Checksums of the streams of a run in which faults altered something: what the source delivered
/// and what reached the core, both from the first difference on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AlteredStreams {
    /// Sequence number of the first sample that was altered, lost or added.
    pub first_sample: u64,
    /// BLAKE3 of what the source delivered from then on.
    pub clean_blake3: String,
    /// BLAKE3 of what reached the core from then on.
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

/// The calibration of one method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Name of the position sequence.
    pub positions: String,
    /// Name of the estimator.
    pub estimator: String,
    /// Length, h.
    pub duration_h: f64,
    /// Every parameter by its name.
    pub parameters: BTreeMap<String, ParameterScore>,
    /// Mean normalized innovation squared; 3 for three axes that agree with their tuning.
    pub nis_mean: Option<f64>,
    /// Normalized estimation error squared by group, divided by the size of the group: 1 where the
    /// errors are as large as their σ says. Groups that were not estimated are left out.
    pub nees: BTreeMap<String, f64>,
    /// Largest |error| / σ over all estimated parameters.
    pub worst_normalized_error: Option<f64>,
    /// Why the core refused its own calibration; null if it didn't.
    pub refused: Option<String>,
    /// What the core saw on the way.
    pub health: HealthCounts,
}

/// One parameter, in its unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterScore {
    /// True value; null where nobody knows it.
    pub r#true: Option<f64>,
    /// Estimate.
    pub estimate: f64,
    /// 1σ; null if the parameter was not estimated.
    pub sigma: Option<f64>,
    /// Estimate minus truth.
    pub error: Option<f64>,
    /// Error divided by σ.
    pub normalized: Option<f64>,
    /// Unit of all of them but `normalized`.
    pub unit: String,
}

/// Counts of what the core reported, in epochs unless said otherwise.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct HealthCounts {
    /// Measurements offered to the filter.
    pub measurements: u64,
    /// Measurements rejected by the innovation gate.
    pub rejected: u64,
    /// Recoveries of the filter.
    pub recoveries: u64,
    /// A gyro gave identical counts.
    pub gyro_stuck: u64,
    /// An accelerometer gave identical counts.
    pub accelerometer_stuck: u64,
    /// Samples were missing.
    pub gaps: u64,
    /// Samples that did not advance, not used.
    pub out_of_order: u64,
    /// Samples with saturated or invalid counts.
    pub inertial_invalid: u64,
    /// Encoders did not show the commanded position.
    pub gimbal_disagrees: u64,
    /// Aiding was due and did not come.
    pub aiding_lost: u64,
    /// Innovations contradicted the tuning.
    pub inconsistent: u64,
    /// Numbers that are not finite, kept out.
    pub numeric: u64,
    /// Increments jumped as no motion can, and were not believed.
    pub jumps: u64,
    /// Gyros and encoders did not show the same turn.
    pub gimbal_slips: u64,
    /// A parameter was found to drift.
    pub drifting: u64,
    /// Aiding carried another stamp than its sample, not used.
    pub aiding_stale: u64,
}

/// What was done with the vertical channel during free navigation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HeightChannel {
    /// Height held at its known value.
    Held,
    /// Height damped towards a reference.
    Damped,
    /// Nothing: it diverges, and the horizontal channels with it.
    Free,
}

/// The navigation of one method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Navigation {
    /// Length, h.
    pub duration_h: f64,
    /// The vertical channel.
    pub height: HeightChannel,
    /// Latitude error, arcmin.
    pub latitude_error_arcmin: ErrorScore,
    /// Longitude error, arcmin.
    pub longitude_error_arcmin: ErrorScore,
    /// Horizontal distance from the true position, nmi.
    pub radial_error_nmi: RadialScore,
    /// What the slopes are taken over; null for runs shorter than a Schuler period.
    pub slope_window: Option<SlopeWindow>,
    /// Scores at 24 h and 72 h, for runs that got there, by "24h" and "72h".
    pub marks: BTreeMap<String, Mark>,
    /// Hours, latitude error, longitude error (arcmin): at most 2002 rows, every extreme kept.
    pub series_hours: Vec<[f64; 3]>,
}

/// Score of one error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorScore {
    /// Largest magnitude.
    pub max: f64,
    /// √(1/T ∫ x² dt).
    pub rms: f64,
    /// Last value, with its sign.
    pub r#final: f64,
    /// Secular slope per day; null for runs shorter than a Schuler period.
    pub slope_per_day: Option<f64>,
}

/// Score of the radial error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialScore {
    /// Largest value.
    pub max: f64,
    /// √(1/T ∫ r² dt): time-RMS, as marine systems state it.
    pub rms: f64,
    /// Last value.
    pub r#final: f64,
    /// Regression of radial error on time through the origin, per hour.
    pub rate_per_h: f64,
}

/// What secular slopes are taken over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlopeWindow {
    /// "schuler periods" or "sidereal days".
    pub of: String,
    /// How many.
    pub periods: u32,
    /// Their length together, h.
    pub hours: f64,
}

/// Errors at a mark, and the largest up to it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// Latitude error at the mark, arcmin.
    pub latitude_arcmin: f64,
    /// Longitude error at the mark, arcmin.
    pub longitude_arcmin: f64,
    /// Radial error at the mark, nmi.
    pub radial_nmi: f64,
    /// Largest latitude error up to the mark, arcmin.
    pub latitude_max_arcmin: f64,
    /// Largest longitude error up to the mark, arcmin.
    pub longitude_max_arcmin: f64,
    /// Largest radial error up to the mark, nmi.
    pub radial_max_nmi: f64,
}

/// The second method of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Baseline {
    /// Name of the method.
    pub label: String,
    /// Its calibration.
    pub calibration: Option<Calibration>,
    /// Its navigation.
    pub navigation: Option<Navigation>,
    /// What the faults did to it, against its own twin.
    #[serde(default)]
    pub counterfactual: Option<Counterfactual>,
    /// What it was to do.
    #[serde(default)]
    pub planned: Option<Work>,
    /// What it did, as its stream shows.
    #[serde(default)]
    pub done: Option<Work>,
    /// BLAKE3 of its stream.
    pub stream_hash: String,
    /// What became of the faults in it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<FaultResult>,
}

/// How a run kept time against the host's clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pacing {
    /// Frames that began.
    pub frames: u64,
    /// From one to the next, µs.
    pub period_us: f64,
    /// How late they began.
    pub lateness_us: Lateness,
    /// Histogram of that: an upper edge, ns, and how many were at most as late and later than the
    /// edge before.
    pub lateness_histogram_ns: Vec<[u64; 2]>,
    /// Lateness from which on a frame is an overrun, µs.
    pub overrun_us: f64,
    /// Overruns.
    pub overruns: u64,
    /// Most of them in a row.
    pub overruns_in_a_row: u64,
    /// Number of the first one, from 1.
    pub first_overrun: Option<u64>,
    /// 99 % of the frames left at least so much of their period unused, µs.
    pub slack_p1_us: f64,
    /// From sending a sample to having its answer.
    pub answer_us: Lateness,
    /// Frames that ended without their answer.
    pub late_answers: u64,
    /// Samples whose answer never came, while later ones were answered.
    pub missed_answers: u64,
    /// Samples that could not be sent: the device had too many already, or the port was full.
    pub not_sent: u64,
    /// The device's clock against the host's; null where it has none that was compared.
    pub device_clock: Option<DeviceClock>,
    /// Steps that found no room on their way to the recorder.
    pub dropped_records: u64,
}

/// A device's clock against the host's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceClock {
    /// How far it was ahead at the last exchange, µs.
    pub offset_us: f64,
    /// By how much that may be wrong, µs.
    pub bound_us: f64,
    /// By how much it goes faster; null where there were too few exchanges.
    pub skew_ppm: Option<f64>,
    /// Exchanges of the time.
    pub exchanges: u64,
}

/// Quantiles of a duration, µs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lateness {
    /// Median.
    pub p50: f64,
    /// 99 %.
    pub p99: f64,
    /// 99.9 %.
    pub p999: f64,
    /// The largest.
    pub max: f64,
}
