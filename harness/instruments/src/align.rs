//! Alignment of a unit's clock with that of the host, from one-way traffic alone.
//!
//! A reading with the stamp `s` arrives at `a = s·(1 + skew) + offset + delay`, and the delay is never
//! less than the least that the line takes. So the points (s, a − s) lie above a line, and some of them
//! touch it: the lower envelope. The estimator keeps the corners of the lower convex hull of all
//! points. The hull's edge below the middle of the points is the line: of all lines below all points,
//! the closest one. Late readings, be it one or a thousand, don't move it.
//!
//! A clock whose rate changes (with its temperature) has no such line: use a new [`ClockAlignment`] for each
//! stretch of time in which it is steady.
//!
//! The least delay itself can't be measured one-way: it is part of the offset. On a serial line it is
//! the time of a frame plus the time that the unit takes to make it.

/// Number of corners kept. A steady clock with jitter has about twenty.
const CORNERS: usize = 128;

/// A point of the hull: seconds since the first stamp, and delay of the arrival after the stamp, less
/// that of the first reading, in ns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Point {
    at_s: f64,
    behind_ns: f64,
}

/// Estimate of a unit's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitClockEstimate {
    /// Stamp that the offset refers to: the first one.
    pub origin_ns: u64,
    /// Host time at that stamp, including the least delay, ns.
    pub offset_ns: f64,
    /// Relative rate by which host time is fast against the unit's: 1e-6 is a microsecond a second.
    /// `None` until there are two points far enough apart.
    pub skew: Option<f64>,
    /// Time between the first and the last stamp, s.
    pub span_s: f64,
    /// Mean lateness of readings against the line, ns. `late_sigma_ns` is its standard deviation.
    pub late_mean_ns: f64,
    /// Standard deviation of the lateness, ns.
    pub late_sigma_ns: f64,
    /// Readings accepted.
    pub readings: u64,
    /// Readings rejected because their stamp wasn't after the one before.
    pub behind: u64,
}

impl UnitClockEstimate {
    /// Host time of a stamp, ns: the earliest time at which its reading could have arrived.
    #[must_use]
    pub fn host_ns(&self, stamp_ns: u64) -> f64 {
        let since = stamp_ns as f64 - self.origin_ns as f64;
        self.offset_ns + since * (1.0 + self.skew.unwrap_or(0.0))
    }
}

/// Estimates offset and skew of a unit's clock, without allocating.
#[derive(Clone, Debug)]
pub struct ClockAlignment {
    /// First stamp, and the delay of its arrival.
    origin: Option<(u64, i128)>,
    last_ns: u64,
    /// Corners of the lower hull, from left to right.
    hull: [Point; CORNERS],
    corners: usize,
    /// Sums over all points: time, time squared, delay, delay squared, their product; s and ns.
    sum_s: f64,
    sum_s2: f64,
    sum_ns: f64,
    sum_ns2: f64,
    sum_s_ns: f64,
    readings: u64,
    behind: u64,
}

impl Default for ClockAlignment {
    fn default() -> Self {
        Self::new()
    }
}

impl ClockAlignment {
    /// Makes an estimator without readings.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            origin: None,
            last_ns: 0,
            hull: [Point { at_s: 0.0, behind_ns: 0.0 }; CORNERS],
            corners: 0,
            sum_s: 0.0,
            sum_s2: 0.0,
            sum_ns: 0.0,
            sum_ns2: 0.0,
            sum_s_ns: 0.0,
            readings: 0,
            behind: 0,
        }
    }

    /// Adds a stamp of the unit with the host's time of its arrival.
    pub fn add(&mut self, stamp_ns: u64, arrival_ns: u64) {
        let behind = i128::from(arrival_ns) - i128::from(stamp_ns);
        if self.origin.is_some() && stamp_ns <= self.last_ns {
            self.behind += 1;
            return;
        }
        let (first_ns, first_behind) = *self.origin.get_or_insert((stamp_ns, behind));
        self.last_ns = stamp_ns;
        self.readings += 1;
        // Differences are small enough to be exact in f64.
        let at_s = (stamp_ns - first_ns) as f64 * 1e-9;
        let point = Point { at_s, behind_ns: (behind - first_behind) as f64 };
        self.sum_s += at_s;
        self.sum_s2 += at_s * at_s;
        self.sum_ns += point.behind_ns;
        self.sum_ns2 += point.behind_ns * point.behind_ns;
        self.sum_s_ns += at_s * point.behind_ns;
        while self.corners >= 2
            && !turns_up(self.hull[self.corners - 2], self.hull[self.corners - 1], point)
        {
            self.corners -= 1;
        }
        if self.corners == CORNERS {
            self.drop_a_corner();
        }
        self.hull[self.corners] = point;
        self.corners += 1;
    }

    /// Drops the corner whose loss changes the hull least.
    fn drop_a_corner(&mut self) {
        let mut least = (f64::INFINITY, 1);
        for index in 1..self.corners - 1 {
            let [a, b, c] = [self.hull[index - 1], self.hull[index], self.hull[index + 1]];
            let area = (b.at_s - a.at_s) * (c.behind_ns - a.behind_ns)
                - (c.at_s - a.at_s) * (b.behind_ns - a.behind_ns);
            if area < least.0 {
                least = (area, index);
            }
        }
        self.hull.copy_within(least.1 + 1..self.corners, least.1);
        self.corners -= 1;
    }

    /// Present estimate; `None` before the first reading.
    #[must_use]
    pub fn estimate(&self) -> Option<UnitClockEstimate> {
        let (origin_ns, first_behind) = self.origin?;
        let hull = &self.hull[..self.corners];
        let middle_s = self.sum_s / self.readings as f64;
        let edge = hull.windows(2).find(|edge| edge[1].at_s >= middle_s);
        let (skew, behind_ns) = match edge {
            Some([from, to]) => {
                let slope = (to.behind_ns - from.behind_ns) / (to.at_s - from.at_s);
                // The slope is in ns a second.
                (Some(slope * 1e-9), from.behind_ns - slope * from.at_s)
            }
            _ => (None, hull.first()?.behind_ns),
        };
        // Lateness of all points above the line a + b·t, from the sums alone.
        let (n, a, b) = (self.readings as f64, behind_ns, skew.unwrap_or(0.0) * 1e9);
        let [t, t2, d, d2, td] =
            [self.sum_s, self.sum_s2, self.sum_ns, self.sum_ns2, self.sum_s_ns].map(|s| s / n);
        let late_mean_ns = d - a - b * t;
        let variance = (d2 - d * d) - 2.0 * b * (td - t * d) + b * b * (t2 - t * t);
        Some(UnitClockEstimate {
            late_mean_ns,
            late_sigma_ns: libm::sqrt(variance.max(0.0)),
            origin_ns,
            offset_ns: origin_ns as f64 + first_behind as f64 + behind_ns,
            skew,
            span_s: (self.last_ns - origin_ns) as f64 * 1e-9,
            readings: self.readings,
            behind: self.behind,
        })
    }
}

/// True if the path from `a` over `b` to `c` turns up.
fn turns_up(a: Point, b: Point, c: Point) -> bool {
    (b.at_s - a.at_s) * (c.behind_ns - a.behind_ns)
        > (c.at_s - a.at_s) * (b.behind_ns - a.behind_ns)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OFFSET_NS: i64 = 7_000_000_123;
    const LEAST_NS: i64 = 850_000;

    /// Aligns readings at 200 Hz of a clock that is slow by `skew`, with `delay` beyond the least one.
    fn align(skew: f64, seconds: u64, delay: impl Fn(u64) -> i64) -> ClockAlignment {
        let mut alignment = ClockAlignment::new();
        for number in 0..seconds * 200 {
            let stamp = 1_000_000_000 + number * 5_000_000;
            let drift = (skew * (number * 5_000_000) as f64) as i64;
            let arrival = stamp as i64 + OFFSET_NS + drift + LEAST_NS + delay(number);
            alignment.add(stamp, arrival as u64);
        }
        alignment
    }

    fn check(estimate: UnitClockEstimate, skew: f64, offset_within_ns: f64, skew_within: f64) {
        let expected = (1_000_000_000 + OFFSET_NS + LEAST_NS) as f64;
        let off = estimate.offset_ns - expected;
        assert!(off.abs() <= offset_within_ns, "offset off by {off} ns");
        let off = estimate.skew.unwrap() - skew;
        assert!(off.abs() <= skew_within, "skew off by {off}");
    }

    #[test]
    fn without_jitter_it_is_the_line_itself() {
        for skew in [0.0, 25e-6, -100e-6] {
            // Nanoseconds are truncated: the error is a nanosecond over the span.
            let estimate = align(skew, 600, |_| 0).estimate().unwrap();
            check(estimate, skew, 2.0, 2e-9 / 100.0);
            let stamp = 1_000_000_000 + 500_000_000_000;
            let host = estimate.host_ns(stamp);
            let expected = stamp as f64 * 1.0 + (OFFSET_NS + LEAST_NS) as f64 + skew * 500e9;
            assert!((host - expected).abs() < 10.0, "{host} {expected}");
        }
    }

    /// One reading in seven has the least delay, the others up to 30 ms more, and for one second every
    /// reading is late by 100 ms: the line stays the same.
    #[test]
    fn what_is_late_does_not_move_it() {
        let late = |number: u64| {
            let jitter = (number.wrapping_mul(2_654_435_761) >> 7) % 30_000_000;
            let stalled = (20_000..20_200).contains(&number);
            match (stalled, number % 7) {
                (true, _) => 100_000_000,
                (_, 0) => 0,
                _ => jitter as i64,
            }
        };
        let estimate = align(40e-6, 300, late).estimate().unwrap();
        check(estimate, 40e-6, 2.0, 1e-10);
        assert_eq!((estimate.readings, estimate.behind), (60_000, 0));
        assert!((estimate.span_s - 299.995).abs() < 1e-9);
    }

    /// The delay is up to a millisecond, and the least of many is small. The line stays below all
    /// points, also if the clock isn't steady and there are more corners than are kept.
    #[test]
    fn it_is_below_all_points() {
        let jitter = |number: u64| ((number.wrapping_mul(2_654_435_761) >> 9) % 1_000_000) as i64;
        let alignment = align(-10e-6, 120, jitter);
        let estimate = alignment.estimate().unwrap();
        check(estimate, -10e-6, 20_000.0, 2e-7);
        for number in 0..24_000u64 {
            let stamp = 1_000_000_000 + number * 5_000_000;
            let drift = (-10e-6 * (number * 5_000_000) as f64) as i64;
            let arrival = stamp as i64 + OFFSET_NS + drift + LEAST_NS + jitter(number);
            assert!(estimate.host_ns(stamp) <= arrival as f64 + 1.0);
        }
    }

    /// One reading in three has no delay, one is a millisecond late and one two milliseconds.
    #[test]
    fn it_says_how_late_readings_come() {
        let late = |number: u64| [0, 1_000_000, 2_000_000][(number % 3) as usize];
        let estimate = align(30e-6, 600, late).estimate().unwrap();
        assert!((estimate.late_mean_ns - 1e6).abs() < 10.0, "{estimate:?}");
        let sigma = libm::sqrt(2.0 / 3.0) * 1e6;
        assert!((estimate.late_sigma_ns - sigma).abs() < 1e3, "{estimate:?}");
        let estimate = align(30e-6, 600, |_| 0).estimate().unwrap();
        assert!(estimate.late_mean_ns.abs() < 2.0 && estimate.late_sigma_ns < 1e3, "{estimate:?}");
    }

    #[test]
    fn at_the_beginning_there_is_an_offset_alone() {
        let mut alignment = ClockAlignment::new();
        assert_eq!(alignment.estimate(), None);
        alignment.add(5_000, 9_000);
        let estimate = alignment.estimate().unwrap();
        assert_eq!((estimate.offset_ns, estimate.skew), (9_000.0, None));
        // A second reading gives a skew: 2 µs less, a millisecond later.
        alignment.add(1_005_000, 1_007_000);
        let estimate = alignment.estimate().unwrap();
        assert_eq!(estimate.offset_ns, 9_000.0);
        assert!((estimate.skew.unwrap() + 2e-3).abs() < 1e-12);
        alignment.add(4_000, 9_000);
        assert_eq!(alignment.estimate().unwrap().behind, 1);
    }

    #[test]
    fn more_corners_than_are_kept() {
        let mut alignment = ClockAlignment::new();
        // On a parabola every point is a corner.
        for number in 0..1000u64 {
            alignment.add(number * 1_000_000_000, number * 1_000_000_000 + number * number);
        }
        let estimate = alignment.estimate().unwrap();
        // Slope of the tangent in the middle: 2·499.5 ns a second.
        assert!((estimate.skew.unwrap() - 999e-9).abs() < 20e-9, "{estimate:?}");
        assert_eq!(alignment.corners, CORNERS);
    }
}
