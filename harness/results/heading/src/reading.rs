//! Readings of a heading over a run-up.

use crate::angle;

/// Longest time between the time at which a reading is due and the reading, s.
const TOLERANCE_S: f64 = 1.0;

/// Heading at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Time since the unit was switched on, s.
    pub t_s: f64,
    /// Heading that the unit shows, deg; `None`: it answers and has no heading yet.
    pub heading_deg: Option<f64>,
    /// True heading, deg; `None`: it isn't known.
    pub true_deg: Option<f64>,
    /// True while the table moves.
    pub moving: bool,
}

impl Reading {
    /// Error of the heading, shown − true, within ±180°.
    #[must_use]
    pub fn error_deg(&self) -> Option<f64> {
        Some(angle::difference(self.heading_deg?, self.true_deg?))
    }
}

/// Readings of one run-up, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    readings: Vec<Reading>,
}

impl Series {
    /// Adds a reading; one that isn't later than the last one is left out.
    pub fn push(&mut self, reading: Reading) {
        if self.readings.last().is_none_or(|last| reading.t_s > last.t_s) {
            self.readings.push(reading);
        }
    }

    /// All readings.
    #[must_use]
    pub fn readings(&self) -> &[Reading] {
        &self.readings
    }

    /// Time of the last reading, s; 0 without one.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.readings.last().map_or(0.0, |last| last.t_s)
    }

    /// Reading that is due at a time: the nearest one within a second; `None` if there is a gap.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Option<&Reading> {
        let after = self.readings.partition_point(|reading| reading.t_s < t_s);
        let near = |reading: &&Reading| (reading.t_s - t_s).abs();
        let (before, after) = (after.checked_sub(1), Some(after));
        [before, after]
            .into_iter()
            .filter_map(|index| self.readings.get(index?))
            .min_by(|a, b| near(a).total_cmp(&near(b)))
            .filter(|reading| near(reading) <= TOLERANCE_S)
    }

    /// Readings from one time to another, both included.
    #[must_use]
    pub fn between(&self, from_s: f64, to_s: f64) -> &[Reading] {
        let from = self.readings.partition_point(|reading| reading.t_s < from_s);
        let to = self.readings.partition_point(|reading| reading.t_s <= to_s);
        &self.readings[from..to.max(from)]
    }
}

impl FromIterator<Reading> for Series {
    fn from_iter<I: IntoIterator<Item = Reading>>(readings: I) -> Self {
        let mut series = Self::default();
        readings.into_iter().for_each(|reading| series.push(reading));
        series
    }
}
