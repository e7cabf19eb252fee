//! One epoch: a sample and, when one is due, the aiding that goes with it.

use crate::{Aiding, Sample};

/// One step of the source, and one step of the core.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Epoch {
    /// The inertial sample.
    pub sample: Sample,
    /// The reference, when one is due.
    pub aiding: Option<Aiding>,
}

impl Epoch {
    /// Compares bit for bit: NaN is equal to itself and zero differs from minus zero.
    #[must_use]
    #[inline]
    pub fn same_bits(&self, other: &Self) -> bool {
        self.sample == other.sample
            && match (&self.aiding, &other.aiding) {
                (None, None) => true,
                (Some(a), Some(b)) => a.same_bits(b),
                _ => false,
            }
    }

    /// Replaces the epoch by `found`; returns `false`, and changes nothing, if `found` is `None`.
    pub fn take(&mut self, found: Option<Self>) -> bool {
        found.map(|found| *self = found).is_some()
    }
}
