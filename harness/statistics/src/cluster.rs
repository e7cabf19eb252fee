//! Independent draws among the rows of a design.
//!
//! The unit of inference is the draw: an instrument with its noise. Rows of one draw (its combinations with
//! the factors of a grid) share it, and rows of two draws that came to the same stream of samples are one
//! draw told twice. A bound that counts rows as if each were a draw promises what it doesn't keep; a draw
//! that counts as passed only if all of its rows passed makes Clopper's and Pearson's bound hold however
//! the rows of a draw depend on each other.

use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::hash::Hash;

/// The draw that each row is of, as numbers from 0 in the order of the first rows. Rows with the same seed
/// are of one draw, and so are rows with the same stream, over any number of steps.
#[must_use]
pub fn draws<S: Hash + Eq, H: Hash + Eq>(
    rows: impl IntoIterator<Item = (S, Option<H>)>,
) -> Vec<usize> {
    let (mut by_seed, mut by_stream) = (HashMap::new(), HashMap::new());
    // Each row points to one of its draw that is not behind it; the first of a draw to itself.
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

/// How many draws came to what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Draws {
    /// All rows passed.
    pub passed: u64,
    /// A row didn't pass: it failed, or came to nothing.
    pub not_passed: u64,
    /// A row has no result yet, and none of the others didn't pass.
    pub open: u64,
    /// Rows of all of them.
    pub rows: u64,
}

impl Draws {
    /// Counts draws. Of each row its draw, and whether it passed; `None`: it has no result yet.
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

    /// Draws of which it is known.
    #[must_use]
    pub const fn known(&self) -> u64 {
        self.passed + self.not_passed
    }

    /// All draws.
    #[must_use]
    pub const fn all(&self) -> u64 {
        self.passed + self.not_passed + self.open
    }
}

/// Draws that come one by one, each with all of its rows: what [`draws`] and [`Draws::of`] say of all that
/// have come, without looking at them again.
#[derive(Clone, Debug, Default)]
pub struct Growing<H> {
    by_stream: HashMap<H, usize>,
    /// Each points to the one that it was joined with; to itself if it stands for a draw.
    joined: Vec<usize>,
    passed: Vec<bool>,
    counts: Draws,
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

    /// What they come to so far.
    #[must_use]
    pub const fn counts(&self) -> Draws {
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
