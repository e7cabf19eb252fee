//! Independent draws among the rows of a design.
//!
//! The unit of inference is the draw: an instrument with its noise. Rows of one draw (its combinations
//! with the factors of a grid) share it, and two draws whose rows have the same stream of samples are
//! one draw counted twice. A bound that counts rows as if each were a draw is too optimistic. If a draw
//! counts as passed only when all of its rows passed, Clopper's and Pearson's bound holds for any
//! dependence between the rows of a draw.

use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;

/// Draw of each row, as numbers from 0 in the order of the first rows. Rows with the same seed belong
/// to one draw, and so do rows with the same stream, also over several steps.
#[must_use]
pub fn draws<S: Ord, H: Ord>(rows: impl IntoIterator<Item = (S, Option<H>)>) -> Vec<u32> {
    let (seeds, streams): (Vec<S>, Vec<Option<H>>) = rows.into_iter().unzip();
    let mut order: Vec<u32> = (0..).take(seeds.len()).collect();
    let (seeds, streams) = (|row: u32| &seeds[row as usize], |row: u32| &streams[row as usize]);
    // Each row points to a row of its draw that isn't after it; the first row of a draw points to
    // itself.
    let mut first = order.clone();
    // Sorted lists: maps of millions of rows would take several times the memory.
    order.sort_unstable_by_key(|row| seeds(*row));
    for same in order.chunk_by(|a, b| seeds(*a) == seeds(*b)) {
        join(&mut first, same);
    }
    order.retain(|row| streams(*row).is_some());
    order.sort_unstable_by_key(|row| streams(*row));
    for same in order.chunk_by(|a, b| streams(*a) == streams(*b)) {
        join(&mut first, same);
    }
    let mut next = 0;
    let mut numbers = order;
    numbers.clear();
    for row in (0..).take(first.len()) {
        let root = root(&mut first, row);
        numbers.push(if root == row { next } else { numbers[root as usize] });
        next += u32::from(root == row);
    }
    numbers
}

fn root(first: &mut [u32], mut row: u32) -> u32 {
    while first[row as usize] != row {
        first[row as usize] = first[first[row as usize] as usize];
        row = first[row as usize];
    }
    row
}

/// Makes rows one draw.
fn join(first: &mut [u32], rows: &[u32]) {
    for pair in rows.windows(2) {
        let (a, b) = (root(first, pair[0]), root(first, pair[1]));
        first[a.max(b) as usize] = a.min(b);
    }
}

/// Result of a row, or of a draw: the worst of its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RowResult {
    /// It passed.
    Passed,
    /// It has not run.
    Open,
    /// It ran and came to nothing: it doesn't show that the requirement is kept, and not that it is broken.
    Unknown,
    /// It failed.
    Failed,
}

impl RowResult {
    /// Result of a row that either passed or failed; `None`: it has not run.
    #[must_use]
    pub fn of(passed: Option<bool>) -> Self {
        passed.map_or(Self::Open, |passed| if passed { Self::Passed } else { Self::Failed })
    }
}

/// Results of draws whose rows come one by one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DrawTally {
    /// Result of each draw by its number: `None` if it has no row.
    dense: Vec<Option<RowResult>>,
    /// Draws whose numbers are far beyond the number of rows.
    sparse: BTreeMap<usize, RowResult>,
    rows: u64,
}

/// Length by which the list of draws grows at most for one row.
const GROWTH: usize = 1 << 12;

impl DrawTally {
    /// Adds a row of a draw with its result.
    pub fn add(&mut self, draw: usize, result: RowResult) {
        self.rows += 1;
        if draw >= self.dense.len() && draw - self.dense.len() < GROWTH {
            let more = self.dense.len()..=draw;
            self.dense.extend(more.map(|draw| self.sparse.remove(&draw)));
        }
        let all = match self.dense.get_mut(draw) {
            Some(all) => all.get_or_insert(RowResult::Passed),
            None => self.sparse.entry(draw).or_insert(RowResult::Passed),
        };
        *all = result.max(*all);
    }

    /// Returns the result of each draw, in the order of their numbers.
    pub fn results(&self) -> impl Iterator<Item = RowResult> {
        self.dense.iter().copied().flatten().chain(self.sparse.values().copied())
    }

    /// Counts the draws.
    #[must_use]
    pub fn counts(&self) -> DrawCounts {
        let mut counts = DrawCounts { rows: self.rows, ..DrawCounts::default() };
        for result in self.results() {
            counts.count(result, 1);
        }
        counts
    }
}

/// Numbers of draws by result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DrawCounts {
    /// Draws whose rows all passed.
    pub passed: u64,
    /// Draws with a row that didn't pass: it failed or was inconclusive.
    pub not_passed: u64,
    /// Draws among these with no row that failed: they count against a claim that a requirement is kept, and not for one
    /// that it is broken.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub unknown: u64,
    /// Draws with a row without a result, and with none that didn't pass.
    pub open: u64,
    /// Number of rows of all draws.
    pub rows: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
const fn is_zero(count: &u64) -> bool {
    *count == 0
}

impl DrawCounts {
    /// Counts draws. Each row has its draw and its result.
    #[must_use]
    pub fn of(rows: impl IntoIterator<Item = (usize, RowResult)>) -> Self {
        let mut tally = DrawTally::default();
        rows.into_iter().for_each(|(draw, result)| tally.add(draw, result));
        tally.counts()
    }

    /// Adds to the number of draws with a result.
    const fn count(&mut self, result: RowResult, by: i64) {
        let count = match result {
            RowResult::Passed => &mut self.passed,
            RowResult::Open => &mut self.open,
            RowResult::Unknown | RowResult::Failed => &mut self.not_passed,
        };
        *count = count.saturating_add_signed(by);
        if matches!(result, RowResult::Unknown) {
            self.unknown = self.unknown.saturating_add_signed(by);
        }
    }

    /// Number of draws that failed: they show that a requirement is broken.
    #[must_use]
    pub const fn failed(&self) -> u64 {
        self.not_passed - self.unknown
    }

    /// Number of draws with a result.
    #[must_use]
    pub const fn known(&self) -> u64 {
        self.passed + self.not_passed
    }

    /// Number of all draws.
    #[must_use]
    pub const fn all(&self) -> u64 {
        self.passed + self.not_passed + self.open
    }
}

/// Draws that are added one by one, each with all of its rows. It gives the counts of [`draws`] and
/// [`DrawCounts::of`] for all draws so far, without processing them again.
#[derive(Clone, Debug, Default)]
pub struct Growing<H> {
    by_stream: HashMap<H, usize>,
    /// Index of the entry that each was joined with; its own index if it stands for a draw.
    joined: Vec<usize>,
    results: Vec<RowResult>,
    counts: DrawCounts,
}

impl<H: Hash + Eq> Growing<H> {
    /// Adds the rows of one seed: the result of each, and its stream.
    pub fn add(&mut self, rows: impl IntoIterator<Item = (RowResult, Option<H>)>) {
        let new = self.joined.len();
        self.joined.push(new);
        self.results.push(RowResult::Passed);
        self.counts.passed += 1;
        for (result, stream) in rows {
            self.counts.rows += 1;
            if let Some(stream) = stream {
                let mut other = *self.by_stream.entry(stream).or_insert(new);
                while self.joined[other] != other {
                    other = self.joined[other];
                }
                if other != new {
                    self.joined[other] = new;
                    self.counts.count(self.results[other], -1);
                    self.set(new, self.results[other]);
                }
            }
            self.set(new, result);
        }
    }

    /// Counts so far.
    #[must_use]
    pub const fn counts(&self) -> DrawCounts {
        self.counts
    }

    fn set(&mut self, draw: usize, result: RowResult) {
        self.counts.count(self.results[draw], -1);
        self.results[draw] = self.results[draw].max(result);
        self.counts.count(self.results[draw], 1);
    }
}
