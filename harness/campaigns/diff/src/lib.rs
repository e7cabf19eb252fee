//! Differences between two runs, or between two campaigns.
//!
//! Two runs differ in their settings, in their streams and in their scores; each is compared on its own. The programs
//! that made them are told, and are no difference by themselves.
//!
//! - [`side`] reads a run: its summary, scenario, manifest and recording
//! - [`settings`] compares the resolved scenarios, key by key
//! - [`stream`] compares the recordings, message by message, bit for bit; [`fields`] names what differs in a message
//! - [`scores`] sets the numbers of the summaries side by side
//! - [`cases`] compares two campaigns over their pairs of cases
//! - [`text`] and [`page`] render the result for a terminal and as one HTML file

pub mod cases;
mod error;
pub mod fields;
pub mod page;
pub mod scores;
pub mod settings;
pub mod side;
pub mod stream;
pub mod text;

pub use cases::CampaignDiff;
pub use error::DiffError;

use serde::Serialize;
use settings::SettingDiff;
use side::{Side, SideAbout};
use std::path::Path;

/// Version of the form of `octant diff --json`.
pub const SCHEMA: u32 = 1;

/// Difference between two runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunDiff {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// True if settings, streams and scores are the same.
    pub equal: bool,
    /// The two runs: origin, program, seed, stream hash.
    pub runs: [SideAbout; 2],
    /// Keys of the resolved scenarios with different values.
    pub settings: Vec<SettingDiff>,
    /// Comparison of the recordings.
    pub stream: stream::StreamDiff,
    /// Numbers of the summaries.
    pub scores: Vec<scores::ScoreDiff>,
    /// Estimated parameters, with their difference in σ.
    pub parameters: Vec<scores::ParameterDiff>,
    /// Sentences about what couldn't be compared.
    pub notes: Vec<String>,
}

/// Compares two runs.
///
/// # Errors
/// If one of them can't be read.
pub fn runs(first: &Side, second: &Side) -> Result<RunDiff, DiffError> {
    let settings = settings::compare(&first.scenario, &second.scenario);
    let stream = stream::compare(first, second)?;
    let mut notes = Vec::new();
    for side in [first, second] {
        let path = side.about.path.display();
        if side.summary.is_none() {
            notes
                .push(format!("{path} has no summary of an ended run: its scores aren't compared"));
        }
        if side.about.truncated {
            notes.push(format!("{path} is truncated: it is compared up to its end"));
        }
    }
    if !stream.is_same_policy {
        notes.push(
            "the recordings keep different samples: those that both have are compared".to_owned(),
        );
    }
    let scores = scores::compare(first.summary.as_ref(), second.summary.as_ref());
    let parameters = scores::parameters(first.summary.as_ref(), second.summary.as_ref());
    let same_hash = match (&first.about.stream_hash, &second.about.stream_hash) {
        (Some(first), Some(second)) => first == second,
        _ => true,
    };
    let equal = settings.is_empty()
        && first.about.seed == second.about.seed
        && same_hash
        && stream.is_equal()
        && scores.iter().all(scores::ScoreDiff::is_equal);
    let runs = [first.about.clone(), second.about.clone()];
    Ok(RunDiff { schema: SCHEMA, equal, runs, settings, stream, scores, parameters, notes })
}

/// Returns whether a folder is that of a campaign with merged results.
#[must_use]
pub fn is_campaign(folder: &Path) -> bool {
    octant_campaign::merge::merged(folder, "cases").is_file()
}
