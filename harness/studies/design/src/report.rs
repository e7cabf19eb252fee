//! The result of a design: its scores beside those of the published sequences, the bound, and what each
//! stop adds.

use crate::bound::{DriftBound, bound};
use crate::continuous::ContinuousRotation;
use crate::contribution::Contribution;
use crate::search::{Found, SearchError, SearchProblem};
use crate::setup::DesignError;
use octant_calibration::positions::{SEQUENCES, from_degrees};
use serde::Serialize;

/// Version of the form of a report.
pub const SCHEMA: u32 = 1;

/// A design for one rotation in navigation.
#[derive(Clone, Debug, Serialize)]
pub struct SequenceDesign {
    /// Rotation in navigation: the name of a scheme, or "scenario" for the scenario's own.
    pub rotation: &'static str,
    /// Duration of the calibration, h.
    pub duration_h: f64,
    /// Measure of the designed sequence, by the fast evaluation.
    pub score: f64,
    /// The same by the full recursion of `octant observe`, with the filter as the scenario tunes it.
    pub observed: f64,
    /// The bound with its certificate.
    pub bound: DriftBound,
    /// Published sequences of the same duration.
    pub published: Vec<Published>,
    /// Continuous rotation under the same conditions, where it was asked for.
    pub continuous: Option<ContinuousRotation>,
    /// Stops of the designed sequence, and what each adds.
    pub stops: Vec<Contribution>,
}

/// A published sequence under the same conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Published {
    /// Its name.
    pub name: &'static str,
    /// Measure; `None` where its moves don't fit the duration.
    pub score: Option<f64>,
}

impl SequenceDesign {
    /// Reports a sequence that was found for a problem.
    ///
    /// # Errors
    /// If it doesn't fit.
    pub fn of(
        problem: &SearchProblem,
        rotation: &'static str,
        found: &Found,
    ) -> Result<Self, SearchError> {
        let mut judge = problem.judge();
        let published = SEQUENCES
            .iter()
            .map(|(name, stops, _)| {
                let sequence = from_degrees(stops, 1).ok();
                let score = sequence.and_then(|s| judge.score(&s, problem.duration_s).ok());
                Published { name, score }
            })
            .collect();
        let full = problem.setup.observe(&found.sequence, problem.duration_s)?;
        let stops = found.sequence.stops();
        Ok(Self {
            rotation,
            duration_h: problem.duration_s / 3600.0,
            score: found.score,
            observed: judge.score_of(full.achieved, &stops[stops.len() - 1]),
            bound: bound(&judge, problem.duration_s).map_err(DesignError::from)?,
            published,
            continuous: None,
            stops: problem.contributions(&mut judge, &found.sequence).map_err(DesignError::from)?,
        })
    }
}
