//! Statement on all requirements of a campaign together.

use octant_statistics::cluster::DrawCounts;
use serde::Serialize;
use std::fmt::Write as _;

/// Statement on all requirements together, beside those on each.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointStatement {
    /// Number of requirements.
    pub requirements: usize,
    /// Draws that pass if all of their checks of all requirements do.
    pub draws: DrawCounts,
    /// Confidence of the bound, one-sided: the largest that a requirement asks for.
    pub confidence: f64,
    /// Lower bound of the probability that a draw passes all of its checks, by the way in which the campaign is looked at;
    /// null without a result.
    pub lower_bound: Option<f64>,
    /// Claims on single requirements that ask for a probability.
    pub claims: usize,
    /// Confidence with which all of these claims hold together, at least (Bonferroni).
    pub together: f64,
}

impl JointStatement {
    /// Renders it as sentences.
    #[must_use]
    pub fn in_words(&self) -> String {
        let Self { requirements, draws, confidence, lower_bound, claims, together } = self;
        let mut text = match lower_bound {
            None => "no draw has a result".to_owned(),
            Some(lower) => format!(
                "{} of {} independent draws passed every check of {requirements} requirement{}: with {:.2} % confidence \
                 a draw passes all of them with a probability of at least {:.2} %",
                draws.passed,
                draws.known(),
                if *requirements == 1 { "" } else { "s" },
                100.0 * confidence,
                (1e4 * lower).floor() / 1e2
            ),
        };
        if *claims > 1 {
            _ = write!(
                text,
                "; the {claims} claims on single requirements hold together with a confidence of at least {:.2} %",
                100.0 * together
            );
        }
        text
    }
}
