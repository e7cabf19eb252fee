//! Angles of a table between its looks.

use crate::{TableAxis, TableStatus};
use std::time::{Duration, Instant};

/// Angle of an axis at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    at: Instant,
    within: Duration,
    angle_rad: f64,
    rate_radps: Option<f64>,
}

/// Angle of an axis at a requested time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Angle, rad.
    pub angle_rad: f64,
    /// Time from the requested time to the nearest look.
    pub age: Duration,
    /// Uncertainty of the times of the looks.
    pub within: Duration,
}

/// Recent looks at a table, for each axis, in bounded memory.
#[derive(Clone, Debug, Default)]
pub struct Track {
    axes: [AxisTrack; 2],
}

#[derive(Clone, Debug, Default)]
struct AxisTrack {
    /// Ring of points; `oldest` is the index of the oldest.
    points: Vec<Point>,
    oldest: usize,
}

impl Track {
    /// Number of points kept for an axis: more than a second at fifty looks a second.
    pub const POINTS: usize = 64;

    /// Makes a track with room for all points that are kept.
    #[must_use]
    pub fn new() -> Self {
        let axis = || AxisTrack { points: Vec::with_capacity(Track::POINTS), oldest: 0 };
        Self { axes: [axis(), axis()] }
    }

    /// Adds a status. An angle without a time, or not after the last one, is ignored.
    pub fn add(&mut self, status: &TableStatus) {
        for axis in TableAxis::ALL {
            let found = status.of(axis);
            if let Some(at) = found.at {
                let point = Point {
                    at,
                    within: found.at_within,
                    angle_rad: found.angle_rad,
                    rate_radps: found.rate_radps,
                };
                self.axes[axis.index()].add(point);
            }
        }
    }

    /// Angle of an axis at a time: by linear interpolation between the points before and after it;
    /// after the last one, by extrapolation with its rate. `None` before the first.
    #[must_use]
    pub fn at(&self, axis: TableAxis, when: Instant) -> Option<TrackPoint> {
        self.axes[axis.index()].at(when)
    }
}

impl AxisTrack {
    fn add(&mut self, point: Point) {
        if self.newest().is_some_and(|newest| newest.at >= point.at) {
            return;
        }
        if self.points.len() < Track::POINTS {
            self.points.push(point);
        } else {
            self.points[self.oldest] = point;
            self.oldest = (self.oldest + 1) % Track::POINTS;
        }
    }

    /// Point so many steps before the newest.
    fn back(&self, steps: usize) -> Option<Point> {
        let count = self.points.len();
        let index = count.checked_sub(1 + steps)?;
        self.points.get((self.oldest + index) % count).copied()
    }

    fn newest(&self) -> Option<Point> {
        self.back(0)
    }

    fn at(&self, when: Instant) -> Option<TrackPoint> {
        let newest = self.newest()?;
        if when >= newest.at {
            let age = when - newest.at;
            let rate = newest.rate_radps.or_else(|| Some(slope(self.back(1)?, newest)));
            let angle_rad = newest.angle_rad + rate.unwrap_or(0.0) * age.as_secs_f64();
            return Some(TrackPoint { angle_rad, age, within: newest.within });
        }
        let mut after = newest;
        for steps in 1.. {
            let before = self.back(steps)?;
            if before.at <= when {
                let (since, until) = (when - before.at, after.at - when);
                let angle_rad = before.angle_rad + slope(before, after) * since.as_secs_f64();
                let within = before.within.max(after.within);
                return Some(TrackPoint { angle_rad, age: since.min(until), within });
            }
            after = before;
        }
        None
    }
}

/// Rate between two points; the second one is later.
fn slope(from: Point, to: Point) -> f64 {
    (to.angle_rad - from.angle_rad) / (to.at - from.at).as_secs_f64()
}
