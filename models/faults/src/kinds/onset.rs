//! The first call of each onset.

use crate::rule::Context;

/// Tells the first epoch that a fault sees of an onset from those after it. (`since_onset` alone
/// doesn't: several epochs can come in one step, and none at the onset.)
#[derive(Clone, Debug, Default)]
pub(crate) struct Onset {
    firing: Option<u32>,
}

impl Onset {
    /// This is the first call since the fault set in.
    pub(crate) fn is_new(&mut self, now: &Context<'_>) -> bool {
        let new = self.firing != Some(now.firing);
        self.firing = Some(now.firing);
        new
    }
}
