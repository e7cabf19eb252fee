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
pub const CORNERS: usize = 128;

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
        // Stamps since 1980 in ns are no numbers that f64 has: the difference is taken first.
        let since = (i128::from(stamp_ns) - i128::from(self.origin_ns)) as f64;
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

    /// Number of corners that are kept at present, [`CORNERS`] at most.
    #[must_use]
    pub const fn corners(&self) -> usize {
        self.corners
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
            offset_ns: (i128::from(origin_ns) + first_behind) as f64 + behind_ns,
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
