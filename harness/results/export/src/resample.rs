//! A coarser time step: which rows of a table are kept.

/// Grid on which rows are kept.
///
/// The first row is kept, then the first at or after each multiple of the period, with its own time: the rule of
/// the recorder. Nothing is interpolated, and a period shorter than that of the recording adds no rows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Grid {
    period_ns: Option<u64>,
    next_ns: u64,
}

impl Grid {
    /// Creates the grid of a period; `None` keeps every row.
    #[must_use]
    pub const fn new(period_ns: Option<u64>) -> Self {
        Self { period_ns, next_ns: 0 }
    }

    /// Returns whether the row of a time is kept. Times don't run back.
    pub fn keeps(&mut self, time_ns: u64) -> bool {
        let Some(period_ns) = self.period_ns.filter(|period_ns| *period_ns > 0) else {
            return true;
        };
        if time_ns < self.next_ns {
            return false;
        }
        self.next_ns = (time_ns / period_ns).saturating_add(1).saturating_mul(period_ns);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(period_ns: Option<u64>, times: &[u64]) -> Vec<u64> {
        let mut grid = Grid::new(period_ns);
        times.iter().copied().filter(|time| grid.keeps(*time)).collect()
    }

    #[test]
    fn the_first_row_at_or_after_each_multiple_is_kept_with_its_time() {
        assert_eq!(kept(Some(10), &[3, 5, 9, 11, 12, 20, 29, 45, 50]), [3, 11, 20, 45, 50]);
    }

    #[test]
    fn without_a_period_and_with_a_finer_one_every_row_is_kept() {
        assert_eq!(kept(None, &[0, 1, 1, 2]), [0, 1, 1, 2]);
        assert_eq!(kept(Some(1), &[0, 5, 10]), [0, 5, 10]);
    }

    #[test]
    fn the_largest_time_ends_nothing() {
        assert_eq!(kept(Some(u64::MAX), &[0, 7, u64::MAX]), [0, u64::MAX]);
    }
}
