//! Counters that roll over.

/// Continues a counter that rolls over.
///
/// A step of less than half of the range is forward. A longer one is backward: a repetition, or a unit
/// that was restarted. A gap of more than half of the range can't be detected.
#[derive(Clone, Copy, Debug)]
pub struct Rollover {
    /// Largest value.
    largest: u64,
    last: Option<u64>,
}

impl Rollover {
    /// Makes a counter of this many bits, 1 to 64.
    #[must_use]
    pub const fn new(bits: u32) -> Self {
        let unused = 64u32.saturating_sub(bits);
        Self { largest: u64::MAX >> unused, last: None }
    }

    /// Makes a counter that goes from 0 to `modulo` − 1, two values at least.
    #[must_use]
    pub const fn modulo(modulo: u64) -> Self {
        let modulo = if modulo < 2 { 2 } else { modulo };
        Self { largest: modulo - 1, last: None }
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
                let ahead = self.ahead(counter, last);
                if ahead <= self.largest / 2 {
                    last.saturating_add(ahead)
                } else {
                    // A step back beyond the beginning means that the counter was restarted.
                    last.checked_sub((self.largest - ahead).saturating_add(1)).unwrap_or(counter)
                }
            }
        };
        self.last = Some(next);
        next
    }

    /// Steps forward from the continued value `last` to the counter's value.
    #[inline]
    fn ahead(&self, counter: u64, last: u64) -> u64 {
        if self.largest & self.largest.wrapping_add(1) == 0 {
            return counter.wrapping_sub(last) & self.largest;
        }
        // Not all of 64 bits, which the case above has: the range itself is a number.
        let range = self.largest + 1;
        let (now, before) = (counter % range, last % range);
        if now >= before { now - before } else { range - (before - now) }
    }
}
