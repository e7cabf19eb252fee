//! What a file holds, from one pass through it.

use super::point::{TimeScale, TrajectoryPoint};
use super::reader::{TrajectoryError, TrajectoryReader};
use octant_scenario::trajectory::TrajectoryFormat;
use std::path::Path;

/// Share of the points that have to have a velocity, or an attitude, for the file to have one.
const SHARE: f64 = 0.99;

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectorySurvey {
    /// Scale of its times.
    pub scale: TimeScale,
    /// The first point.
    pub first: TrajectoryPoint,
    /// Times of the first and the last point, ns; of the last message, where the points end before.
    pub span_ns: (i64, i64),
    /// Number of points, two or more.
    pub points: u64,
    /// The most common time between two points, ns.
    pub period_ns: i64,
    /// True if points have a velocity.
    pub velocity: bool,
    /// True if points have an attitude.
    pub attitude: bool,
}

impl TrajectorySurvey {
    /// Reads a file from its beginning to its end.
    ///
    /// # Errors
    /// If it can't be read, is damaged, or has fewer than two points.
    pub fn of(path: &Path, format: &TrajectoryFormat) -> Result<Self, TrajectoryError> {
        let mut reader = TrajectoryReader::open(path, format)?;
        let mut span_ns: Option<(i64, i64)> = None;
        let mut first = None;
        let (mut points, mut velocities, mut attitudes) = (0_u64, 0_u64, 0_u64);
        // By the majority vote of Boyer and Moore, which needs no memory: a time between two points that more
        // than half of them have is found.
        let (mut period_ns, mut votes) = (0, 0_u64);
        while let Some(point) = reader.next()? {
            points += 1;
            first.get_or_insert(point);
            velocities += u64::from(point.velocity_mps.is_some());
            attitudes += u64::from(point.attitude_rad.is_some());
            if let Some((_, last_ns)) = span_ns {
                let apart_ns = rounded(point.time_ns - last_ns);
                if votes == 0 {
                    period_ns = apart_ns;
                }
                votes = if apart_ns == period_ns { votes + 1 } else { votes.saturating_sub(1) };
            }
            let first_ns = span_ns.map_or(point.time_ns, |(first_ns, _)| first_ns);
            span_ns = Some((first_ns, point.time_ns));
        }
        let (Some(span_ns), Some(first), true) = (span_ns, first, points > 1) else {
            let reason = format!("found {points} points with a position, expected two or more");
            return Err(TrajectoryError::new(path, reason));
        };
        // A unit that sends on without a solution hasn't ended where its last point is.
        let heard_ns = reader.heard_ns().filter(|heard_ns| heard_ns - span_ns.1 > period_ns.max(1));
        let span_ns = (span_ns.0, heard_ns.unwrap_or(span_ns.1));
        let most = |count: u64| count as f64 >= SHARE * points as f64;
        Ok(Self {
            scale: reader.scale(),
            first,
            span_ns,
            points,
            period_ns: period_ns.max(1),
            velocity: most(velocities),
            attitude: most(attitudes),
        })
    }
}

/// Time between two points, to three digits: stamps jitter.
fn rounded(ns: i64) -> i64 {
    let mut step = 1;
    while ns / step >= 1000 {
        step *= 10;
    }
    (ns + step / 2) / step * step
}
