//! What is said of a run that ended: its scores, findings and summary.

mod aligned;
pub mod assemble;
mod clock_doubt;
mod compared;
pub mod difference;
pub mod findings;
mod known_noise;
pub(crate) mod method;
pub mod raw_counts;
pub mod refusal;
mod scores_text;
mod uncertainty;
