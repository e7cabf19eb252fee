//! Builds `summary.json` of a run of a system: description, events, and verdict.
//!
//! It contains nothing of host or clock: the same system and settings give the same bytes.

use super::initialize::Loop;
use super::tuning::TunedResult;
use octant_score::summary::FaultResult;
use octant_score::verdict::RequirementResult;
use octant_verdict::Verdict;
use serde::Serialize;

/// Version of the form of this summary.
pub const SCHEMA: u32 = 1;

/// The summary.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SystemSummary {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Version of the program that made the run.
    pub octant: String,
    /// Name of the system.
    pub system: String,
    /// Seed of the faults' random streams.
    pub seed: u64,
    /// Worst verdict of the parts below.
    pub verdict: Verdict,
    /// Reasons for the verdict, in plain words.
    pub reasons: Vec<String>,
    /// Order of the FMUs: `jacobi`, `gauss-seidel=plant,calibrator`.
    pub order: String,
    /// Start, s.
    pub start_s: f64,
    /// Requested end, s.
    pub stop_s: f64,
    /// Communication step, s.
    pub step_s: f64,
    /// Steps done.
    pub steps: u64,
    /// Steps, or parts of steps, that were repeated because an FMU discarded them.
    pub rejected: u64,
    /// End of the run.
    pub ended: SystemEnded,
    /// Variables that depend on themselves at initialization, and their solution.
    pub loops: Vec<LoopResult>,
    /// Requirements with their results.
    pub requirements: Vec<RequirementResult>,
    /// Faults that were injected; samples are steps.
    pub faults: Vec<FaultResult>,
    /// Parameters that were to change during the run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tuned: Vec<TunedResult>,
    /// The FMUs.
    pub fmus: Vec<FmuResult>,
    /// Number of connected numbers.
    pub connections: usize,
    /// Number of steps between recorded rows.
    pub recorded_every: u64,
    /// Warnings.
    pub warnings: Vec<String>,
    /// BLAKE3 over all recorded inputs, outputs and parameters: see [`super::stream::SystemHash`].
    pub stream_hash: String,
}

/// Ways in which a run ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "how", rename_all = "kebab-case")]
pub enum SystemEnded {
    /// The run reached its end.
    AtStop,
    /// An FMU requested the end.
    AskedByFmu {
        /// Name in the system.
        fmu: String,
        /// Time, s.
        at_s: f64,
    },
    /// The run was interrupted on request.
    Interrupted {
        /// Time, s.
        at_s: f64,
    },
    /// The run could not go on.
    Failed {
        /// Time, s.
        at_s: f64,
        /// Reason.
        reason: String,
    },
}

/// A loop of variables.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoopResult {
    /// Variables of the loop, in its order.
    pub variables: Vec<String>,
    /// Number of iterations.
    pub iterations: u32,
    /// Residual of the equations, over the size of the values.
    pub residual: f64,
    /// True if the loop was only apparent: the values settled to the last bit.
    pub settled: bool,
}

impl From<&Loop> for LoopResult {
    fn from(found: &Loop) -> Self {
        Self {
            variables: found.variables.clone(),
            iterations: found.solved.iterations,
            residual: found.solved.residual,
            settled: found.solved.exact,
        }
    }
}

/// An FMU of the system.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FmuResult {
    /// Name in the system.
    pub name: String,
    /// The file, as the structure names it.
    pub source: String,
    /// SHA-256 of the file, hexadecimal; null for a folder.
    pub sha256: Option<String>,
    /// `modelName`.
    pub model: String,
    /// `guid` or `instantiationToken`.
    pub token: String,
    /// `fmiVersion`.
    pub fmi: String,
    /// `co-simulation` or `model-exchange`.
    pub interface: &'static str,
    /// `generationTool`.
    pub generation_tool: String,
    /// Deviations of the description from the standard that were tolerated.
    pub tolerated: Vec<String>,
    /// Steps that the FMU discarded.
    pub discarded: u64,
    /// Values that the FMU refused; faults had altered them.
    pub refused: u64,
    /// Number of messages that the FMU logged.
    pub messages: usize,
}

impl SystemSummary {
    /// Returns the bytes of `summary.json`: pretty JSON with a final newline.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Renders the summary as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.system, self.verdict.name());
        for reason in &self.reasons {
            text += &format!("  {reason}\n");
        }
        let names: Vec<&str> = self.fmus.iter().map(|fmu| fmu.name.as_str()).collect();
        let end_s = self.start_s + self.steps as f64 * self.step_s;
        text += &format!(
            "{}, {}, {} steps of {} s to {end_s} s\n",
            names.join(" and "),
            self.order,
            self.steps,
            self.step_s
        );
        if let SystemEnded::AskedByFmu { fmu, at_s } = &self.ended {
            text += &format!("  {fmu} wanted it to end at {at_s} s\n");
        }
        if self.rejected > 0 {
            text += &format!("  {} discarded steps were made in parts\n", self.rejected);
        }
        for one in &self.loops {
            let how = if one.settled { "settled" } else { "solved" };
            let around = one.variables.join(" -> ");
            text += &format!("  loop {around}: {how} in {} iterations\n", one.iterations);
        }
        for result in self.requirements.iter().filter(|result| result.verdict == Verdict::Pass) {
            text += &format!("  {}\n", result.sentence());
        }
        for fault in &self.faults {
            text += &format!("  {}\n", fault.sentence());
        }
        for tuned in self.tuned.iter().filter(|tuned| tuned.done) {
            let TunedResult { at_s, fmu, values, done: _ } = tuned;
            text += &format!("  at {at_s} s {fmu} got {}\n", values.join(", "));
        }
        for fmu in self.fmus.iter().filter(|fmu| fmu.refused > 0) {
            text +=
                &format!("  {} refused {} values that faults had made\n", fmu.name, fmu.refused);
        }
        text + &format!("stream hash {}\n", self.stream_hash)
    }
}
