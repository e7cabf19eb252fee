//! Reasons why a recording can't be characterised.

use octant_scenario::FileProblems;
use octant_source::SourceError;

/// Reasons why a recording can't be characterised.
#[derive(Debug, thiserror::Error)]
pub enum CharacteriseError {
    /// The scenario that describes the recording is wrong.
    #[error(transparent)]
    Scenario(#[from] FileProblems),
    /// The recording can't be read.
    #[error("failed to {0}")]
    Source(#[from] SourceError),
    /// The recording isn't one of an instrument at rest, or too little of it.
    #[error("failed to characterise {name}: {reason}")]
    Recording {
        /// Recording.
        name: String,
        /// What was found and what is expected.
        reason: String,
    },
    /// The instrument can't be simulated.
    #[error("failed to simulate the twin: {0}")]
    Twin(String),
}
