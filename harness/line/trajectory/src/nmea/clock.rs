//! Times of headings: groups of TAG blocks, days of times of day, cycles of a log.

use super::date::DAY_NS;
use super::framed::Tag;
use super::heading::HeadingSaid;
use crate::point::{PointSigma, TrajectoryPoint};
use std::collections::VecDeque;

/// Cycles that are longer than this many of the one before have a gap.
const GAP_CYCLES: f64 = 1.5;

/// A point, with the quality of its heading.
pub(super) type Ready = (TrajectoryPoint, &'static str);

/// The group of sentences that a TAG block told last.
#[derive(Clone, Debug, Default)]
pub(super) struct Group {
    code: String,
    time_ns: Option<i64>,
}

impl Group {
    /// Time of a TAG block: its own, else that of its group.
    pub(super) fn time_ns(&mut self, tag: &Tag<'_>) -> Option<i64> {
        let Some(code) = tag.group else { return tag.time_ns };
        if code != self.code {
            *self = Self { code: code.to_owned(), time_ns: None };
        }
        self.time_ns = tag.time_ns.or(self.time_ns);
        self.time_ns
    }
}

/// Days of times of day that run forward.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Days {
    day_ns: i64,
    last_of_day_ns: Option<i64>,
}

impl Days {
    /// Days from a first one on, ns since 1970.
    pub(super) fn from(day_ns: i64) -> Self {
        Self { day_ns, last_of_day_ns: None }
    }

    pub(super) fn time_ns(&mut self, of_day_ns: i64, day_ns: Option<i64>) -> i64 {
        let nearest = |last_ns: i64| match of_day_ns - last_ns {
            after if after < -DAY_NS / 2 => self.day_ns + DAY_NS,
            after if after > DAY_NS / 2 => self.day_ns - DAY_NS,
            _ => self.day_ns,
        };
        self.day_ns = day_ns.unwrap_or_else(|| self.last_of_day_ns.map_or(self.day_ns, nearest));
        self.last_of_day_ns = Some(of_day_ns);
        self.day_ns + of_day_ns
    }
}

/// Headings since the last time of day.
#[derive(Clone, Debug, Default)]
pub(super) struct Cycle {
    pub(super) days: Days,
    mark_ns: Option<i64>,
    /// Length of the cycle before, and the time between two of its headings.
    length_ns: Option<i64>,
    spacing_ns: Option<f64>,
    /// Headings in their places; `None`: one that makes no point.
    pub(super) waiting: Vec<Option<HeadingSaid>>,
}

impl Cycle {
    pub(super) fn of(days: Days) -> Self {
        Self { days, ..Self::default() }
    }

    /// Takes the next time of day; returns the number of headings that are left out.
    pub(super) fn mark(&mut self, time_ns: i64, ready: &mut VecDeque<Ready>) -> u64 {
        let Some(mark_ns) = self.mark_ns else {
            self.mark_ns = Some(time_ns);
            let left = self.waiting.iter().flatten().count() as u64;
            self.waiting.clear();
            return left;
        };
        let length_ns = time_ns - mark_ns;
        if length_ns <= 0 {
            return 0;
        }
        let even_ns = length_ns as f64 / self.waiting.len().max(1) as f64;
        let is_gap =
            self.length_ns.is_some_and(|before| length_ns as f64 > GAP_CYCLES * before as f64);
        let spacing_ns = match self.spacing_ns {
            Some(before_ns) if is_gap => before_ns.min(even_ns),
            _ => even_ns,
        };
        self.spread(mark_ns, spacing_ns, ready);
        if !is_gap {
            (self.length_ns, self.spacing_ns) = (Some(length_ns), Some(spacing_ns));
        }
        self.mark_ns = Some(time_ns);
        0
    }

    fn spread(&mut self, mark_ns: i64, spacing_ns: f64, ready: &mut VecDeque<Ready>) {
        for (place, said) in self.waiting.drain(..).enumerate() {
            let Some(said) = said else { continue };
            let time_ns = mark_ns + (place as f64 * spacing_ns).round() as i64;
            ready.push_back(point(time_ns, &said, spacing_ns * 1e-9, None));
        }
    }

    /// Ends with the file; returns the number of headings that are left out.
    pub(super) fn end(&mut self, ready: &mut VecDeque<Ready>) -> u64 {
        if let (Some(mark_ns), Some(spacing_ns)) = (self.mark_ns, self.spacing_ns) {
            self.spread(mark_ns, spacing_ns, ready);
        }
        let left = self.waiting.iter().flatten().count() as u64;
        self.waiting.clear();
        left
    }
}

pub(super) fn point(
    time_ns: i64,
    said: &HeadingSaid,
    doubt_s: f64,
    attitude_rad: Option<[f64; 3]>,
) -> Ready {
    let point = TrajectoryPoint {
        time_ns,
        position: None,
        velocity_mps: None,
        attitude: Some(said.attitude()),
        sigma: PointSigma { attitude_rad, ..PointSigma::default() },
        digit_rad: said.digit_rad,
        attitude_doubt_s: doubt_s,
    };
    (point, said.quality)
}
