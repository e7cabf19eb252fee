//! Times of headings: groups of TAG blocks, days of times of day, cycles of a log.

use super::date::DAY_NS;
use super::framed::Tag;
use super::heading::HeadingSaid;
use crate::point::{PointSigma, TrajectoryPoint};
use octant_scenario::trajectory::HeadingDelay;
use std::collections::VecDeque;

/// Cycles that are longer than this many of the one before have a gap.
const GAP_CYCLES: f64 = 1.5;

/// A point, with the quality of its heading.
pub(super) type Ready = (TrajectoryPoint, &'static str);

/// Quality of an answer without a heading.
const WITHOUT: &str = "no heading: the instrument calls it invalid";

/// A sentence of the instrument, in its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Answer {
    /// A heading.
    Heading(HeadingSaid),
    /// None yet, where that is told from silence.
    Without,
    /// One that makes no point, and was counted as left out.
    LeftOut,
}

impl Answer {
    /// True if it makes a point.
    pub(super) fn is_point(&self) -> bool {
        !matches!(self, Self::LeftOut)
    }

    /// The point at a time, which is off by as much as `doubt_s`; `None`: it makes none.
    pub(super) fn point(
        &self,
        time_ns: i64,
        doubt_s: f64,
        sigma_rad: Option<[f64; 3]>,
    ) -> Option<Ready> {
        let (attitude, digit_rad, quality) = match self {
            Self::Heading(said) => (Some(said.attitude()), said.digit_rad, said.quality),
            Self::Without => (None, [0.0; 3], WITHOUT),
            Self::LeftOut => return None,
        };
        let point = TrajectoryPoint {
            time_ns,
            position: None,
            velocity_mps: None,
            attitude,
            sigma: PointSigma { attitude_rad: sigma_rad, ..PointSigma::default() },
            digit_rad,
            attitude_doubt_s: doubt_s,
        };
        Some((point, quality))
    }
}

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
    /// Sentences in their places.
    pub(super) waiting: Vec<Answer>,
    /// Place of the first one behind the time of day, where it is known.
    delay: Option<HeadingDelay>,
}

impl Cycle {
    pub(super) fn of(days: Days, delay: Option<HeadingDelay>) -> Self {
        Self { days, delay, ..Self::default() }
    }

    /// Takes the next time of day; returns the number of headings that are left out.
    pub(super) fn mark(&mut self, time_ns: i64, ready: &mut VecDeque<Ready>) -> u64 {
        let Some(mark_ns) = self.mark_ns else {
            self.mark_ns = Some(time_ns);
            return self.leave_out();
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
        let delay = self.delay;
        let delay_ns = delay.map_or(0.0, |delay| delay.delay_s * 1e9);
        let doubt_s = delay.map_or(spacing_ns * 1e-9, |delay| delay.uncertainty_s);
        for (place, answer) in self.waiting.drain(..).enumerate() {
            let time_ns = mark_ns + (delay_ns + place as f64 * spacing_ns).round() as i64;
            ready.extend(answer.point(time_ns, doubt_s, None));
        }
    }

    /// Leaves out what waits; returns its number.
    fn leave_out(&mut self) -> u64 {
        let left = self.waiting.iter().filter(|answer| answer.is_point()).count() as u64;
        self.waiting.clear();
        left
    }

    /// Ends with the file; returns the number of headings that are left out.
    pub(super) fn end(&mut self, ready: &mut VecDeque<Ready>) -> u64 {
        if let (Some(mark_ns), Some(spacing_ns)) = (self.mark_ns, self.spacing_ns) {
            self.spread(mark_ns, spacing_ns, ready);
        }
        self.leave_out()
    }
}
