//! Detection of a new onset by a rule.

use crate::rule::Context;

/// Detects a new onset. The detector compares the number of the firing and doesn't wait for the
/// first epoch, which may have been lost on the way to the rule.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Onset {
    firing: Option<u32>,
}

impl Onset {
    /// Returns true at the first epoch of a firing that the rule sees.
    pub(crate) fn is_new(&mut self, now: &Context<'_>) -> bool {
        self.firing.replace(now.firing) != Some(now.firing)
    }
}
