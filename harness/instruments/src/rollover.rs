//! Counters that roll over.

/// Continues a counter that rolls over.
///
/// A step of less than half of the range is forward. A longer one is backward: a repetition, or a unit
/// that was restarted. A gap of more than half of the range can't be detected.
#[derive(Clone, Copy, Debug)]
pub struct Rollover {
    /// Largest value.
    mask: u64,
    last: Option<u64>,
}

impl Rollover {
    /// Makes a counter of this many bits, 1 to 64.
    #[must_use]
    pub const fn new(bits: u32) -> Self {
        let unused = 64u32.saturating_sub(bits);
        Self { mask: u64::MAX >> unused, last: None }
    }

    /// Value that the counter was continued to last.
    #[must_use]
    pub(crate) const fn last(&self) -> Option<u64> {
        self.last
    }

    /// Value of the continued counter.
    #[inline]
    pub fn continued(&mut self, counter: u64) -> u64 {
        let next = match self.last {
            None => counter,
            Some(last) => {
                let ahead = counter.wrapping_sub(last) & self.mask;
                if ahead <= self.mask / 2 {
                    last.saturating_add(ahead)
                } else {
                    // A step back beyond the beginning means that the counter was restarted.
                    last.checked_sub((self.mask - ahead).saturating_add(1)).unwrap_or(counter)
                }
            }
        };
        self.last = Some(next);
        next
    }
}
