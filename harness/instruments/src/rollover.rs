//! Counters that roll over.

/// Continues a counter that rolls over.
///
/// A step of less than half of the range is forward. A longer one is backward: a repetition, or a unit
/// that was restarted. A gap of more than half of the range can't be detected.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rollover {
    /// Largest value.
    mask: u64,
    last: Option<u64>,
}

impl Rollover {
    /// Makes a counter of this many bits, 1 to 64.
    pub(crate) const fn new(bits: u32) -> Self {
        let unused = 64u32.saturating_sub(bits);
        Self { mask: u64::MAX >> unused, last: None }
    }

    /// Value of the continued counter.
    #[inline]
    pub(crate) fn continued(&mut self, counter: u64) -> u64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_is_continued_across_its_end_and_goes_back_when_it_does() {
        let mut counter = Rollover::new(16);
        let raw = [65_534, 65_535, 0, 1, 1, 0, 40_000, 65_000, 3];
        let continued = raw.map(|raw| counter.continued(raw));
        assert_eq!(
            continued,
            [65_534, 65_535, 65_536, 65_537, 65_537, 65_536, 40_000, 65_000, 65_539]
        );
        let mut anew = Rollover::new(32);
        assert_eq!(anew.continued(5), 5);
        assert_eq!(anew.continued(u32::MAX.into()), u64::from(u32::MAX));
        let mut whole = Rollover::new(64);
        for counter in [3, 1 << 62, 7] {
            assert_eq!(whole.continued(counter), counter);
        }
    }
}
