//! Counters that begin anew.

/// Continues a counter of `BITS` bits that rolls over.
///
/// A step of less than half of its range is forward. A longer one is backward: what came again, or a
/// unit that was switched on anew. Nobody can tell a gap of more than half of the range.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rollover<const BITS: u32> {
    last: Option<u64>,
}

impl<const BITS: u32> Rollover<BITS> {
    /// The continued counter.
    #[inline]
    pub(crate) fn continued(&mut self, counter: u32) -> u64 {
        let raw = u64::from(counter);
        let next = match self.last {
            None => raw,
            Some(last) => {
                let mask = (1 << BITS) - 1;
                let ahead = raw.wrapping_sub(last) & mask;
                if ahead <= mask / 2 {
                    last + ahead
                } else {
                    // Before its beginning there is nothing: it began anew.
                    last.checked_sub(mask + 1 - ahead).unwrap_or(raw)
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
        let mut counter = Rollover::<16>::default();
        let raw = [65_534, 65_535, 0, 1, 1, 0, 40_000, 65_000, 3];
        let continued = raw.map(|raw| counter.continued(raw));
        assert_eq!(
            continued,
            [65_534, 65_535, 65_536, 65_537, 65_537, 65_536, 40_000, 65_000, 65_539]
        );
        let mut anew = Rollover::<32>::default();
        assert_eq!(anew.continued(5), 5);
        assert_eq!(anew.continued(u32::MAX), u64::from(u32::MAX));
    }
}
