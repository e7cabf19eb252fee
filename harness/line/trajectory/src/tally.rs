//! Counts of what became of the units of a file while it is read.

use octant_account::{Account, AccountEntry};
use octant_base::number::plain;

/// Most qualities that are counted apart.
const QUALITIES_MAX: usize = 32;
const OTHER_QUALITIES: &str = "other qualities";

/// Reason of a unit whose time isn't after that of a point before it.
pub(crate) const OUT_OF_ORDER: &str =
    "out of order, of a time that isn't after a point before them";

/// Units of one kind, with the place of the first.
#[derive(Clone, Debug)]
struct Counted {
    kind: &'static str,
    count: u64,
    first: String,
}

/// What a reader did with the units of its file so far: each was used, or left out for a reason.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    used: u64,
    /// Units of the last point, which may yet be left out.
    of_point: u64,
    left_out: Vec<Counted>,
    qualities: Vec<(String, u64)>,
}

impl Tally {
    /// Counts the units that made a point.
    pub(crate) fn point(&mut self, units: u64) {
        self.used += units;
        self.of_point = units;
    }

    /// Counts units that were used, but belong to no point: a date.
    pub(crate) fn used(&mut self, units: u64) {
        self.used += units;
    }

    /// Counts units that belong to no point.
    pub(crate) fn left_out(
        &mut self,
        units: u64,
        kind: &'static str,
        place: impl FnOnce() -> String,
    ) {
        if units == 0 {
            return;
        }
        match self.left_out.iter_mut().find(|counted| counted.kind == kind) {
            Some(counted) => counted.count += units,
            None => self.left_out.push(Counted { kind, count: units, first: place() }),
        }
    }

    /// Takes the last point back.
    pub(crate) fn discard(&mut self, kind: &'static str, place: impl FnOnce() -> String) {
        let units = std::mem::take(&mut self.of_point);
        self.used -= units;
        self.left_out(units, kind, place);
    }

    /// Counts the quality of a point, in the file's own words. From a number of them on all others are one.
    pub(crate) fn quality(&mut self, quality: &str) {
        if let Some((_, count)) = self.qualities.iter_mut().find(|(there, _)| there == quality) {
            *count += 1;
        } else if self.qualities.len() < QUALITIES_MAX {
            self.qualities.push((quality.to_owned(), 1));
        } else if let Some((_, count)) = self.qualities.get_mut(QUALITIES_MAX) {
            *count += 1;
        } else {
            self.qualities.push((OTHER_QUALITIES.to_owned(), 1));
        }
    }

    /// Number of units left out so far for a reason.
    pub(crate) fn count(&self, kind: &str) -> u64 {
        self.left_out.iter().find(|counted| counted.kind == kind).map_or(0, |counted| counted.count)
    }

    /// Number of units left out so far.
    pub(crate) fn left_out_count(&self) -> u64 {
        self.left_out.iter().map(|counted| counted.count).sum()
    }

    /// Place of the first unit that was left out for a reason.
    pub(crate) fn first(&self, kind: &str) -> Option<&str> {
        self.left_out.iter().find(|counted| counted.kind == kind).map(|counted| &*counted.first)
    }

    /// Number of units left out so far for each reason.
    pub(crate) fn reasons(&self) -> impl Iterator<Item = (&'static str, u64)> {
        self.left_out.iter().map(|counted| (counted.kind, counted.count))
    }

    /// The account, with the name of the file and of its units, singular and plural.
    pub(crate) fn account(&self, name: &str, unit: [&str; 2]) -> Account {
        let mut account = Account::new(name, unit).used(self.used);
        for Counted { kind, count, first } in &self.left_out {
            account = account.left_out(AccountEntry::new(*count, *kind).first(first.as_str()));
        }
        let all: u64 = self.qualities.iter().map(|(_, count)| count).sum();
        for (quality, count) in &self.qualities {
            let share = plain(100.0 * *count as f64 / all as f64, 4);
            account =
                account.note(AccountEntry::new(*count, format!("points of {quality}, {share} %")));
        }
        account
    }
}
