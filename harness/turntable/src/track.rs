//! Angles of a table between its looks.

use crate::{TableAxis, TableStatus};
use std::time::{Duration, Instant};

/// Number of points kept for an axis: more than a second at fifty looks a second.
const POINTS: usize = 64;

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
    /// Makes a track with room for all points that are kept.
    #[must_use]
    pub fn new() -> Self {
        let axis = || AxisTrack { points: Vec::with_capacity(POINTS), oldest: 0 };
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
        if self.points.len() < POINTS {
            self.points.push(point);
        } else {
            self.points[self.oldest] = point;
            self.oldest = (self.oldest + 1) % POINTS;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AxisStatus;
    use octant_plant::config::TurntableConfig;
    use octant_plant::table::{self, GimbalTable};
    use proptest::prelude::*;

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    fn status(at: Instant, angles: [f64; 2], rates: [Option<f64>; 2]) -> TableStatus {
        let axis = |index: usize| AxisStatus {
            angle_rad: angles[index],
            rate_radps: rates[index],
            at: Some(at),
            at_within: ms(3),
            ..AxisStatus::default()
        };
        TableStatus { axes: [axis(0), axis(1)] }
    }

    proptest! {
        /// A steady turn is reproduced exactly, at any times of looks, also beyond the last look.
        #[test]
        fn a_steady_turn_is_found_again(
            looks in prop::collection::vec(1u64..50, 2..200),
            when in 0.0f64..1.2,
            rate in -0.5f64..0.5,
            says_rate: bool,
        ) {
            let start = Instant::now();
            let angle = |t: Duration| 1.0 + rate * t.as_secs_f64();
            let mut track = Track::new();
            let mut time = Duration::ZERO;
            let mut times = Vec::new();
            for look in looks {
                time += ms(look);
                times.push(time);
                let said = says_rate.then_some(rate);
                track.add(&status(start + time, [angle(time), -angle(time)], [said, said.map(|r| -r)]));
            }
            let kept = &times[times.len().saturating_sub(POINTS)..];
            let when = time.mul_f64(when);
            match track.at(TableAxis::Roll, start + when) {
                None => prop_assert!(when < kept[0]),
                Some(place) => {
                    prop_assert!(when >= kept[0]);
                    prop_assert!((place.angle_rad + angle(when)).abs() < 1e-9);
                    let nearest = kept.iter().map(|t| t.abs_diff(when)).min().unwrap();
                    prop_assert_eq!(place.age, nearest);
                }
            }
        }
    }

    /// Between looks at an interval h a line deviates from a move with acceleration a by at most
    /// a·h²/8; extrapolation to a time t after the last look deviates by a·t²/2.
    #[test]
    fn a_move_is_missed_by_what_its_acceleration_does_alone() {
        let degrees = f64::to_radians;
        let (rate, acceleration) = (degrees(10.0), degrees(10.0));
        let config = TurntableConfig {
            rate_radps: rate,
            acceleration_radps2: acceleration,
            encoder_sigma_rad: 0.0,
            non_orthogonality_rad: 0.0,
            backlash_rad: 0.0,
        };
        let mut plant = GimbalTable::new(&config);
        plant.go_to(table::GimbalAxis::Azimuth, degrees(30.0), rate, 0);
        let true_at = |ms: u64| plant.motion(table::GimbalAxis::Azimuth, ms * 1_000_000);
        let (start, mut track) = (Instant::now(), Track::new());
        let (mut between, mut beyond) = (0.0f64, 0.0f64);
        for look in 0..250u64 {
            let now = look * 20;
            let motion = true_at(now);
            track.add(&status(
                start + ms(now),
                [motion.angle_rad, 0.0],
                [Some(motion.rate_radps); 2],
            ));
            let missed = |when: u64| {
                let place = track.at(TableAxis::Azimuth, start + ms(when)).unwrap();
                (place.angle_rad - true_at(when).angle_rad).abs()
            };
            beyond = beyond.max(missed(now + 20));
            if look > 0 {
                between = between.max(missed(now - 10));
            }
        }
        let h = 0.02;
        assert!(between <= acceleration * h * h / 8.0 * 1.001 && between > 0.0, "{between}");
        assert!(beyond <= acceleration * h * h / 2.0 * 1.001 && beyond > 0.0, "{beyond}");
    }

    #[test]
    fn nothing_is_known_before_the_table_said_something() {
        let (start, mut track) = (Instant::now() + ms(1000), Track::new());
        assert_eq!(track.at(TableAxis::Roll, start), None);
        track.add(&status(start, [0.5, 0.7], [None; 2]));
        assert_eq!(track.at(TableAxis::Roll, start - ms(1)), None);
        let place = track.at(TableAxis::Roll, start + ms(5)).unwrap();
        assert_eq!(place, TrackPoint { angle_rad: 0.7, age: ms(5), within: ms(3) });
        // A late look, or one without a time, changes nothing.
        track.add(&status(start - ms(10), [9.0, 9.0], [None; 2]));
        track.add(&TableStatus::default());
        assert_eq!(track.at(TableAxis::Roll, start + ms(5)), Some(place));
    }
}
