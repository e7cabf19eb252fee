//! Progress of a run as one line.

use super::style::{ACTS, ALERT, GOOD};
use crate::follow::{Follow, Stage};
use crate::plain;
use octant_base::number::significant;
use octant_verdict::Verdict;
use ratatui::style::{Modifier, Style};

/// Describes the progress of the run, with its speed or its verdict.
pub(super) fn stage(follow: &Follow) -> (String, Style) {
    let text = plain::stage(follow);
    match &follow.stage {
        Stage::Ended(summary) => {
            let style = match summary.verdict {
                Verdict::None => Style::new(),
                Verdict::Pass => GOOD,
                Verdict::Inconclusive => ACTS,
                Verdict::Fail | Verdict::Error => ALERT,
            };
            (text, style.add_modifier(Modifier::BOLD))
        }
        Stage::BrokenOff => (text, ALERT),
        Stage::Running => {
            let speed = match follow.speed() {
                _ if follow.state.about.by_clock => ", by the clock".to_owned(),
                Some(speed) => format!(", {} times real time", significant(speed, 2)),
                None => String::new(),
            };
            let left = follow.left_s().map_or_else(String::new, |left_s| {
                format!(", {} left", plain::time((left_s * 1e9) as u64))
            });
            (format!("{text}{speed}{left}"), Style::new())
        }
        Stage::Starting | Stage::Recorded | Stage::Unjudged => (text, ACTS),
    }
}
