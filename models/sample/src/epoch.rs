//! One epoch: a sample and, when one is due, the aiding that goes with it.

use crate::{Aiding, Sample};

/// What the source delivers in one step, and what the core steps on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Epoch {
    /// The inertial sample.
    pub sample: Sample,
    /// The reference, when one is due.
    pub aiding: Option<Aiding>,
}

impl Epoch {
    /// Bit for bit the same: NaN is equal to itself and zero differs from minus zero.
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

    /// Takes what was found; `false` if that is nothing.
    pub fn take(&mut self, found: Option<Self>) -> bool {
        found.map(|found| *self = found).is_some()
    }
}
