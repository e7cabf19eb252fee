//! Series of bounded length that keep every extreme, for the plots of a run.

/// Largest number of stretches by default; when they are full, neighbours are merged. A day at 1 Hz has
/// stretches of 43 to 86 s.
pub const STRETCHES_MAX: usize = 2000;
/// Columns of a row.
pub const COLUMNS: usize = 5;

/// Smallest and largest values in a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stretch {
    hours: f64,
    low: [f64; COLUMNS],
    high: [f64; COLUMNS],
}

/// Errors of attitude and velocity over a part of a run, as extremes of equal stretches of time. Memory
/// doesn't grow with its length.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionSeries {
    stretches: Vec<Stretch>,
    most: usize,
    per_stretch: u64,
    in_last: u64,
}

impl Default for SolutionSeries {
    fn default() -> Self {
        Self::of_stretches(STRETCHES_MAX)
    }
}

impl SolutionSeries {
    /// Creates a series of at most this number of stretches, an even one.
    #[must_use]
    pub fn of_stretches(most: usize) -> Self {
        Self { stretches: Vec::new(), most, per_stretch: 0, in_last: 0 }
    }

    /// Takes the errors at one time: heading, pitch and roll of the case, arcmin, and velocity north and
    /// east, m/s; NaN where they aren't known. `hours` is the time since the start of the series.
    pub fn push(&mut self, hours: f64, errors: [f64; COLUMNS]) {
        if self.in_last < self.per_stretch
            && let Some(last) = self.stretches.last_mut()
        {
            for (column, error) in errors.into_iter().enumerate() {
                last.low[column] = last.low[column].min(error);
                last.high[column] = last.high[column].max(error);
            }
            self.in_last += 1;
            return;
        }
        if self.stretches.len() == self.most {
            self.halve();
        }
        if self.stretches.is_empty() {
            self.stretches.reserve_exact(self.most);
            self.per_stretch = 1;
        }
        self.stretches.push(Stretch { hours, low: errors, high: errors });
        self.in_last = 1;
    }

    /// Merges every second stretch with the one before it.
    fn halve(&mut self) {
        for i in 0..self.most / 2 {
            let (mut merged, later) = (self.stretches[2 * i], self.stretches[2 * i + 1]);
            for column in 0..COLUMNS {
                merged.low[column] = merged.low[column].min(later.low[column]);
                merged.high[column] = merged.high[column].max(later.high[column]);
            }
            self.stretches[i] = merged;
        }
        self.stretches.truncate(self.most / 2);
        self.per_stretch *= 2;
    }

    /// Points of a column, in the order of [`Self::push`]: time, h, and error; empty if none is known.
    #[must_use]
    pub fn points(&self, column: usize) -> Vec<[f64; 2]> {
        let mut points = Vec::with_capacity(2 * self.stretches.len());
        for stretch in &self.stretches {
            let (low, high) = (stretch.low[column], stretch.high[column]);
            if low.is_finite() && high.is_finite() {
                points.push([stretch.hours, low]);
                if high > low {
                    points.push([stretch.hours, high]);
                }
            }
        }
        points
    }
}
