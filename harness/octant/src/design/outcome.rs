//! Results of a design, as text and JSON have them.

use octant_design::Rotation;
use octant_design::candidate::{GridStop, Limits};
use octant_design::report::SequenceDesign;
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

/// A design with the sequence that it reports.
pub(super) struct Outcome {
    pub(super) rotation: Rotation,
    pub(super) design: SequenceDesign,
    pub(super) stops: Vec<GridStop>,
    pub(super) shortest: Option<ShortestReport>,
}

/// Name of a rotation in reports and stored states.
pub(super) fn name_of(rotation: Rotation) -> &'static str {
    rotation.name().unwrap_or("scenario")
}
