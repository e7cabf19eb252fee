//! Gaps of a file or of a comparison: each is named, up to a number of them, and all are summed up.

use octant_account::{Account, AccountEntry};
use octant_base::number::{counted, plain};

/// Longest list of gaps; the longest ones are kept.
const LISTED_MAX: usize = 12;
/// Interval that is a gap, in periods.
const PERIODS: f64 = 1.5;

/// A time without points.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Gap {
    from_ns: i64,
    until_ns: i64,
    missing: u64,
    /// What is known of it.
    cause: String,
}

impl Gap {
    fn length_ns(&self) -> i64 {
        self.until_ns - self.from_ns
    }
}

/// Gaps so far.
#[derive(Clone, Debug)]
pub(crate) struct GapList {
    period_ns: i64,
    listed: Vec<Gap>,
    count: u64,
    total_ns: i64,
    missing: u64,
}

impl GapList {
    /// Gaps between points that are normally a period apart.
    pub(crate) fn new(period_ns: i64) -> Self {
        Self { period_ns, listed: Vec::new(), count: 0, total_ns: 0, missing: 0 }
    }

    /// Takes the times of two points that follow each other; `cause` says what is known of a gap between them.
    pub(crate) fn step(&mut self, from_ns: i64, until_ns: i64, cause: impl FnOnce() -> String) {
        let length_ns = until_ns - from_ns;
        if length_ns as f64 <= PERIODS * self.period_ns as f64 {
            return;
        }
        let periods = (length_ns as f64 / self.period_ns as f64).round().max(2.0);
        let missing = periods as u64 - 1;
        self.count += 1;
        self.total_ns = self.total_ns.saturating_add(length_ns);
        self.missing += missing;
        let gap = || Gap { from_ns, until_ns, missing, cause: cause() };
        if self.listed.len() < LISTED_MAX {
            self.listed.push(gap());
            return;
        }
        let shortest = (0..self.listed.len()).min_by_key(|index| self.listed[*index].length_ns());
        if let Some(shortest) = shortest.filter(|index| self.listed[*index].length_ns() < length_ns)
        {
            // The list stays in the order of time.
            self.listed.remove(shortest);
            self.listed.push(gap());
        }
    }

    /// Adds the gaps to an account of `units`, with times since `zero_ns`.
    pub(crate) fn tell(
        &self,
        mut account: Account,
        [singular, plural]: [&str; 2],
        zero_ns: i64,
    ) -> Account {
        let s = |ns: i64| plain(ns as f64 * 1e-9, 12);
        for Gap { from_ns, until_ns, missing, cause } in &self.listed {
            let length_s = plain((until_ns - from_ns) as f64 * 1e-9, 9);
            let units = if *missing == 1 { singular } else { plural };
            let mut kind =
                format!("{units} in a gap of {length_s} s from {} s", s(from_ns - zero_ns));
            if !cause.is_empty() {
                kind += &format!(" ({cause})");
            }
            account = account.missing(AccountEntry::new(*missing, kind));
        }
        let listed: u64 = self.listed.iter().map(|gap| gap.missing).sum();
        let further = self.count - self.listed.len() as u64;
        let of_listed_ns: i64 = self.listed.iter().map(Gap::length_ns).sum();
        if further > 0 {
            let gaps = counted(further, "further gap", "further gaps");
            let rest_s = plain((self.total_ns - of_listed_ns) as f64 * 1e-9, 9);
            let kind =
                format!("{plural} in {gaps}, {rest_s} s in all, none longer than those listed");
            account = account.missing(AccountEntry::new(self.missing - listed, kind));
        }
        if self.count > 1 {
            let kind = format!(
                "gaps of more than {PERIODS} periods of {} s, {} s in all",
                plain(self.period_ns as f64 * 1e-9, 9),
                plain(self.total_ns as f64 * 1e-9, 9)
            );
            account = account.note(AccountEntry::new(self.count, kind));
        }
        account
    }
}
