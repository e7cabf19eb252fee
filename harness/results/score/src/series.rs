//! A series of bounded length that keeps all of its extremes.

/// Most buckets; when they are full, neighbours are merged. Each gives up to four points.
pub const BUCKETS_MAX: usize = 500;

/// One point: hours, latitude error, longitude error.
pub type ErrorPoint = [f64; 3];

/// Extremes in a stretch of time.
#[derive(Clone, Copy, Debug)]
struct Bucket {
    /// Points with the smallest and largest latitude error, smallest and largest longitude error.
    extremes: [ErrorPoint; 4],
}

impl Bucket {
    fn new(point: ErrorPoint) -> Self {
        Self { extremes: [point; 4] }
    }

    fn take(&mut self, point: ErrorPoint) {
        for (slot, (column, sign)) in [(1, -1.0), (1, 1.0), (2, -1.0), (2, 1.0)].iter().enumerate()
        {
            if sign * point[*column] > sign * self.extremes[slot][*column] {
                self.extremes[slot] = point;
            }
        }
    }

    fn merge(mut self, later: &Self) -> Self {
        for point in later.extremes {
            self.take(point);
        }
        self
    }
}

/// Errors over time for plots, in bounded memory.
#[derive(Clone, Debug)]
pub struct ErrorSeries {
    first: Option<ErrorPoint>,
    last: Option<ErrorPoint>,
    buckets: Vec<Bucket>,
    per_bucket: u64,
    in_last: u64,
}

impl Default for ErrorSeries {
    fn default() -> Self {
        Self::new()
    }
}

impl ErrorSeries {
    /// Creates an empty series.
    #[must_use]
    pub fn new() -> Self {
        Self {
            first: None,
            last: None,
            buckets: Vec::with_capacity(BUCKETS_MAX),
            per_bucket: 1,
            in_last: 0,
        }
    }

    /// Takes the next point.
    pub fn push(&mut self, point: ErrorPoint) {
        self.first.get_or_insert(point);
        self.last = Some(point);
        if self.in_last < self.per_bucket
            && let Some(bucket) = self.buckets.last_mut()
        {
            bucket.take(point);
            self.in_last += 1;
            return;
        }
        if self.buckets.len() == BUCKETS_MAX {
            for i in 0..BUCKETS_MAX / 2 {
                self.buckets[i] = self.buckets[2 * i].merge(&self.buckets[2 * i + 1]);
            }
            self.buckets.truncate(BUCKETS_MAX / 2);
            self.per_bucket *= 2;
        }
        self.buckets.push(Bucket::new(point));
        self.in_last = 1;
    }

    /// Points in order of time, including the first and the last, rounded to a millionth of an hour and
    /// of an arcminute (2 mm), so that the file of a day stays small.
    #[must_use]
    pub fn points(&self) -> Vec<ErrorPoint> {
        let mut points: Vec<ErrorPoint> = self.buckets.iter().flat_map(|b| b.extremes).collect();
        points.extend(self.first);
        points.extend(self.last);
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        points.dedup_by(|a, b| a[0] == b[0]);
        let rounded = |x: f64| {
            let x = libm::round(x * 1e6) / 1e6;
            if x == 0.0 { 0.0 } else { x }
        };
        points.into_iter().map(|p| p.map(rounded)).collect()
    }
}
