//! Results of a design, as text and JSON have them.

use octant_design::Rotation;
use octant_design::candidate::Limits;
use octant_design::confirm::{Confirmation, PredictedPair};
use octant_design::report::SequenceDesign;
use octant_design::search::{Found, SearchProblem};
use octant_run::paired::SideResult;
use serde::Serialize;

/// What the command prints as JSON.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) schema: u32,
    pub(super) octant: &'static str,
    pub(super) scenario: String,
    pub(super) measure: String,
    pub(super) unit: &'static str,
    pub(super) seed: u64,
    pub(super) limits: Limits,
    pub(super) candidates: usize,
    /// The designs, the best first.
    pub(super) designs: Vec<SequenceDesign>,
    pub(super) shortest: Option<ShortestReport>,
    /// What simulation says of the designs.
    pub(super) confirmation: Option<ConfirmationReport>,
}

/// Confirmation by simulation.
#[derive(Serialize)]
pub(super) struct ConfirmationReport {
    /// Number of seeds, counted up from the first.
    pub(super) seeds: u64,
    pub(super) first_seed: u64,
    /// Sample rate of the runs.
    pub(super) rate: String,
    /// What a design is compared with.
    pub(super) reference: &'static str,
    /// Largest number of designs that are tried.
    pub(super) attempts_max: u8,
    /// All that were tried, in their order.
    pub(super) attempts: Vec<Attempt>,
    /// Number of the attempt that was confirmed, from 1.
    pub(super) confirmed: Option<usize>,
}

/// A design that was tried.
#[derive(Serialize)]
pub(super) struct Attempt {
    /// Where it comes from.
    pub(super) about: String,
    /// Duration of the quick round in its lead-in, s; 0: none.
    pub(super) round_s: f64,
    pub(super) design: SequenceDesign,
    /// Predicted largest errors.
    pub(super) predicted: PredictedPair,
    pub(super) result: Confirmation,
    /// The runs, in the order of the seeds.
    pub(super) runs: Vec<PairedSeed>,
}

/// Both runs of a seed.
#[derive(Serialize)]
pub(super) struct PairedSeed {
    pub(super) seed: u64,
    pub(super) reference: SideResult,
    pub(super) designed: SideResult,
}

impl ConfirmationReport {
    /// Result in a sentence.
    pub(super) fn words(&self) -> String {
        let Self { seeds, rate, attempts, .. } = self;
        match self.confirmed {
            Some(number) => {
                format!("confirmed by simulation: {seeds} seeds at {rate}, attempt {number}")
            }
            None => format!(
                "not confirmed by simulation: {seeds} seeds at {rate}, {} designs tried",
                attempts.len()
            ),
        }
    }
}

/// The shortest calibration.
#[derive(Serialize)]
pub(super) struct ShortestReport {
    /// Measure of eight positions in 4 h with the scenario's own rotation.
    pub(super) target: f64,
    pub(super) duration_h: f64,
    /// Shortest duration that the bound allows, h.
    pub(super) bound_h: f64,
}

/// A design with the problem and the sequence that it reports.
pub(super) struct Outcome {
    pub(super) rotation: Rotation,
    pub(super) problem: SearchProblem,
    pub(super) found: Found,
    pub(super) design: SequenceDesign,
    pub(super) shortest: Option<ShortestReport>,
}

/// Name of a rotation in reports and stored states.
pub(super) fn name_of(rotation: Rotation) -> &'static str {
    rotation.name().unwrap_or("scenario")
}
