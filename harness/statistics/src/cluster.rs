//! Independent draws among the rows of a design.
//!
//! The unit of inference is the draw: an instrument with its noise. Rows of one draw (its combinations
//! with the factors of a grid) share it, and two draws whose rows have the same stream of samples are
//! one draw counted twice. A bound that counts rows as if each were a draw is too optimistic. If a draw
//! counts as passed only when all of its rows passed, Clopper's and Pearson's bound holds for any
//! dependence between the rows of a draw.

use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::hash::Hash;

/// Draw of each row, as numbers from 0 in the order of the first rows. Rows with the same seed belong
/// to one draw, and so do rows with the same stream, also over several steps.
#[must_use]
pub fn draws<S: Hash + Eq, H: Hash + Eq>(
    rows: impl IntoIterator<Item = (S, Option<H>)>,
) -> Vec<usize> {
    let (mut by_seed, mut by_stream) = (HashMap::new(), HashMap::new());
    // Each row points to a row of its draw that isn't after it; the first row of a draw points to
    // itself.
    let mut first: Vec<usize> = Vec::new();
    fn root(first: &mut [usize], mut row: usize) -> usize {
        while first[row] != row {
            first[row] = first[first[row]];
            row = first[row];
        }
        row
    }
    for (row, (seed, stream)) in rows.into_iter().enumerate() {
        first.push(row);
        let of_seed = *by_seed.entry(seed).or_insert(row);
        let of_stream = stream.map_or(row, |stream| *by_stream.entry(stream).or_insert(row));
        for other in [of_seed, of_stream] {
            let (a, b) = (root(&mut first, row), root(&mut first, other));
            let (low, high) = (a.min(b), a.max(b));
            first[high] = low;
        }
    }
    let mut numbers = HashMap::new();
    (0..first.len())
        .map(|row| {
            let next = numbers.len();
            *numbers.entry(root(&mut first, row)).or_insert(next)
        })
        .collect()
}

/// Numbers of draws by result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DrawCounts {
    /// Draws whose rows all passed.
    pub passed: u64,
    /// Draws with a row that didn't pass: it failed or was inconclusive.
    pub not_passed: u64,
    /// Draws with a row without a result, and with none that didn't pass.
    pub open: u64,
    /// Number of rows of all draws.
    pub rows: u64,
}

impl DrawCounts {
    /// Counts draws. Each row has its draw, and whether it passed; `None`: no result yet.
    #[must_use]
    pub fn of(rows: impl IntoIterator<Item = (usize, Option<bool>)>) -> Self {
        let mut draws: HashMap<usize, Option<bool>> = HashMap::new();
        let mut counts = Self::default();
        for (draw, passed) in rows {
            counts.rows += 1;
            let all = draws.entry(draw).or_insert(Some(true));
            *all = match (*all, passed) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (None, _) | (_, None) => None,
                (Some(true), Some(true)) => Some(true),
            };
        }
        for passed in draws.into_values() {
            *match passed {
                Some(true) => &mut counts.passed,
                Some(false) => &mut counts.not_passed,
                None => &mut counts.open,
            } += 1;
        }
        counts
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
    passed: Vec<bool>,
    counts: DrawCounts,
}

impl<H: Hash + Eq> Growing<H> {
    /// Adds the rows of one seed: whether each passed, and its stream.
    pub fn add(&mut self, rows: impl IntoIterator<Item = (bool, Option<H>)>) {
        let new = self.joined.len();
        self.joined.push(new);
        self.passed.push(true);
        self.counts.passed += 1;
        for (passed, stream) in rows {
            self.counts.rows += 1;
            if let Some(stream) = stream {
                let mut other = *self.by_stream.entry(stream).or_insert(new);
                while self.joined[other] != other {
                    other = self.joined[other];
                }
                if other != new {
                    self.joined[other] = new;
                    self.count(other, -1);
                    self.set(new, self.passed[other]);
                }
            }
            self.set(new, passed);
        }
    }

    /// Counts so far.
    #[must_use]
    pub const fn counts(&self) -> DrawCounts {
        self.counts
    }

    fn set(&mut self, draw: usize, passed: bool) {
        self.count(draw, -1);
        self.passed[draw] &= passed;
        self.count(draw, 1);
    }

    fn count(&mut self, draw: usize, by: i64) {
        let counts = &mut self.counts;
        let count = if self.passed[draw] { &mut counts.passed } else { &mut counts.not_passed };
        *count = count.saturating_add_signed(by);
    }
}
