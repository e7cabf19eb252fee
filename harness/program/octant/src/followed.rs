//! Ends of runs that are watched or served.

use crate::failure::Failure;
use octant_verdict::Verdict;
use octant_watch::follow::{Follow, Stage};
use octant_watch::plain;

/// Reports an unreadable recording as bad input.
pub(crate) fn unreadable(error: impl std::fmt::Display) -> Failure {
    Failure::input(format!("failed to {error}"))
}

/// Returns the verdict of a run that has ended; pass for one still in progress when it was left.
pub(crate) fn verdict(follow: &Follow) -> Result<Verdict, Failure> {
    match &follow.stage {
        Stage::Ended(summary) => Ok(summary.verdict),
        Stage::Starting | Stage::Running | Stage::Recorded => Ok(Verdict::Pass),
        Stage::BrokenOff | Stage::Unjudged => {
            let folder = follow.place.folder().display();
            Err(Failure::bench(format!("{folder}: {}", plain::stage(follow))))
        }
    }
}
