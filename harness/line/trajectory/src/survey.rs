//! What a file holds, from one pass through it.

use super::point::{TimeScale, TrajectoryPoint};
use super::reader::{TrajectoryError, TrajectoryReader};
use super::tally::OUT_OF_ORDER;
use octant_account::{Account, AccountEntry};
use octant_scenario::trajectory::TrajectoryFormat;
use std::path::Path;

/// Share of the points that have to have a velocity, or an attitude, for the file to have one.
const SHARE: f64 = 0.99;
/// Largest share of points that are left out because their time isn't after that of the one before.
const OUT_OF_ORDER_SHARE: f64 = 0.1;
/// Part of a period by which the mean of many jittering stamps may be off.
const JITTER: f64 = 1e-4;

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
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
    /// True if points have a position.
    pub position: bool,
    /// True if points have a velocity.
    pub velocity: bool,
    /// True if points have a heading.
    pub attitude: bool,
    /// True if points have roll and pitch, too.
    pub tilt: bool,
    /// What became of each unit of the file.
    pub account: Account,
}

impl TrajectorySurvey {
    /// Reads a file from its beginning to its end.
    ///
    /// # Errors
    /// If it can't be read, is damaged, or has fewer than two points.
    pub fn of(path: &Path, format: &TrajectoryFormat) -> Result<Self, TrajectoryError> {
        Self::of_role(path, format, "solution")
    }

    /// Reads a file as [`Self::of`] does; `role` names it in its account: `solution`, `reference`.
    ///
    /// # Errors
    /// As there.
    pub fn of_role(
        path: &Path,
        format: &TrajectoryFormat,
        role: &str,
    ) -> Result<Self, TrajectoryError> {
        let mut reader = TrajectoryReader::open(path, format)?;
        let mut span_ns: Option<(i64, i64)> = None;
        let mut first = None;
        let mut points = 0_u64;
        // Positions, velocities, headings, tilts.
        let mut counts = [0_u64; 4];
        // By the majority vote of Boyer and Moore, which needs no memory: a time between two points that more
        // than half of them have is found.
        let (mut period_ns, mut votes) = (0, 0_u64);
        // Intervals that are about that, and their sum.
        let (mut alike, mut alike_ns) = (0_i64, 0_i64);
        while let Some(point) = reader.next()? {
            points += 1;
            first.get_or_insert(point);
            let has = [
                point.position.is_some(),
                point.velocity_mps.is_some(),
                point.attitude.is_some(),
                point.attitude_rad().is_some(),
            ];
            for (count, has) in counts.iter_mut().zip(has) {
                *count += u64::from(has);
            }
            if let Some((_, last_ns)) = span_ns {
                let exactly_ns = point.time_ns - last_ns;
                let apart_ns = rounded(exactly_ns);
                if votes == 0 && apart_ns != period_ns {
                    (period_ns, alike, alike_ns) = (apart_ns, 0, 0);
                }
                // Stamps with few digits have one of two values; over a gap nothing is told.
                if 2 * (exactly_ns - period_ns).abs() < period_ns {
                    (alike, alike_ns) = (alike + 1, alike_ns + exactly_ns);
                }
                votes = if apart_ns == period_ns { votes + 1 } else { votes.saturating_sub(1) };
            }
            let first_ns = span_ns.map_or(point.time_ns, |(first_ns, _)| first_ns);
            span_ns = Some((first_ns, point.time_ns));
        }
        let tally = reader.tally();
        let late = tally.count(OUT_OF_ORDER);
        if late as f64 > OUT_OF_ORDER_SHARE * points as f64
            && let Some(first) = tally.first(OUT_OF_ORDER)
        {
            return Err(TrajectoryError::new(
                path,
                format!(
                    "{first}, and {late} are out of order in all, expected times that run forward"
                ),
            ));
        }
        let (Some(span_ns), Some(first), true) = (span_ns, first, points > 1) else {
            let reason =
                format!("found {points} points with a position or a heading, expected two or more");
            return Err(TrajectoryError::new(path, reason));
        };
        // A unit that sends on without a solution hasn't ended where its last point is.
        let heard_ns = reader.heard_ns().filter(|heard_ns| heard_ns - span_ns.1 > period_ns.max(1));
        let span_ns = (span_ns.0, heard_ns.unwrap_or(span_ns.1));
        let period_ns = whole_rate(period_ns, alike_ns as f64 / alike.max(1) as f64);
        let most = |count: u64| count as f64 >= SHARE * points as f64;
        let mut account = reader.account(role);
        let [position, velocity, attitude, tilt] = counts.map(most);
        // An attitude lacks nothing that was counted already.
        let named = if tilt || counts[3] > 0 { "attitude" } else { "heading" };
        for (count, name) in [(counts[0], "position"), (counts[1], "velocity"), (counts[2], named)]
        {
            if !most(count) {
                let kind = format!("points with a {name}, too few for it to count");
                account = account.note(AccountEntry::new(count, kind));
            }
        }
        Ok(Self {
            scale: reader.scale(),
            first,
            span_ns,
            points,
            period_ns: period_ns.max(1),
            position,
            velocity,
            attitude,
            tilt,
            account,
        })
    }
}

/// The period that intervals with this mean have, which are about `about_ns`: that of a whole rate or a round time, if
/// they are as near to it as stamps jitter.
fn whole_rate(about_ns: i64, mean_ns: f64) -> i64 {
    let near = |ns: f64| (mean_ns - ns).abs() <= JITTER * mean_ns;
    let rate_hz = (1e9 / mean_ns).round().max(1.0);
    if near(about_ns as f64) {
        about_ns
    } else if near(1e9 / rate_hz) {
        (1e9 / rate_hz).round() as i64
    } else {
        mean_ns.round() as i64
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
