//! When a rule starts afresh.

use crate::rule::Context;

/// Knows whether the fault has set in anew. It goes by the number of the firing, not by the first
/// epoch: that one may have been lost on the way to the rule.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Onset {
    firing: Option<u32>,
}

impl Onset {
    /// True at the first epoch that the rule sees of a firing.
    pub(crate) fn is_new(&mut self, now: &Context<'_>) -> bool {
        self.firing.replace(now.firing) != Some(now.firing)
    }
}
