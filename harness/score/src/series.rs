//! A series of bounded length that keeps all of its extremes.

/// Most buckets; when they are full, neighbours are merged. Each gives up to four points.
const BUCKETS_MAX: usize = 500;

/// One point: hours, latitude error, longitude error.
type Point = [f64; 3];

/// Extremes in a stretch of time.
#[derive(Clone, Copy, Debug)]
struct Bucket {
    /// Points with the smallest and largest latitude error, smallest and largest longitude error.
    extremes: [Point; 4],
}

impl Bucket {
    fn new(point: Point) -> Self {
        Self { extremes: [point; 4] }
    }

    fn take(&mut self, point: Point) {
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

/// Series for plots, in bounded memory.
#[derive(Clone, Debug)]
pub(super) struct Series {
    first: Option<Point>,
    last: Option<Point>,
    buckets: Vec<Bucket>,
    per_bucket: u64,
    in_last: u64,
}

impl Series {
    pub(super) fn new() -> Self {
        Self {
            first: None,
            last: None,
            buckets: Vec::with_capacity(BUCKETS_MAX),
            per_bucket: 1,
            in_last: 0,
        }
    }

    pub(super) fn push(&mut self, point: Point) {
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
    pub(super) fn points(&self) -> Vec<Point> {
        let mut points: Vec<Point> = self.buckets.iter().flat_map(|b| b.extremes).collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_of_a_million_points_stays_short_and_keeps_its_extremes() {
        let mut series = Series::new();
        for k in 0..1_000_000u32 {
            let t = f64::from(k) / 3600.0;
            let spike = if k == 777_777 { 9.0 } else { 0.0 };
            series.push([t, libm::sin(t), libm::cos(3.0 * t) - spike]);
        }
        let points = series.points();
        assert!(points.len() <= 2002, "{}", points.len());
        assert_eq!(points[0][0], 0.0);
        assert_eq!(points[points.len() - 1][0], 277.7775);
        assert!(points.iter().any(|p| p[2] < -8.0), "the spike is lost");
        assert!(points.windows(2).all(|w| w[0][0] < w[1][0]));
    }

    #[test]
    fn a_short_series_is_kept_whole() {
        let mut series = Series::new();
        for k in 0..100u32 {
            series.push([f64::from(k), 0.0, f64::from(k)]);
        }
        assert_eq!(series.points().len(), 100);
    }

    #[test]
    fn extremes_of_every_bucket_survive_its_merging() {
        // The first merge comes with the next point after the last bucket.
        for extreme in [0, 1, 250, 251, BUCKETS_MAX - 2, BUCKETS_MAX - 1] {
            let mut series = Series::new();
            for k in 0..=BUCKETS_MAX {
                let latitude = if k == extreme { 5.0 } else { 0.0 };
                series.push([k as f64, latitude, 0.0]);
            }
            assert!(series.points().contains(&[extreme as f64, 5.0, 0.0]), "{extreme}");
        }
    }
}
