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

/// Largest part of a period by which the mean of intervals that scatter may be off.
const SCATTER_MAX: f64 = 0.03;
/// Number of intervals from which the period of such a file is known.
const INTERVALS_MAX: usize = 4096;

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
        // Points, and the answers without a heading among them.
        let (mut points, mut without) = (0_u64, 0_u64);
        // Positions, velocities, headings, tilts.
        let mut counts = [0_u64; 4];
        // By the majority vote of Boyer and Moore, which needs no memory: a time between two points that more
        // than half of them have is found.
        let (mut period_ns, mut votes) = (0, 0_u64);
        // Where no time has a majority, as with times of arrival: the first intervals.
        let mut first_intervals_ns: Vec<i64> = Vec::new();
        // Intervals that are about that, and their sum.
        let (mut alike, mut alike_ns) = (0_i64, 0_i64);
        while let Some(point) = reader.next()? {
            points += 1;
            if point.is_without() {
                without += 1;
            } else {
                first.get_or_insert(point);
            }
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
                if first_intervals_ns.len() < INTERVALS_MAX {
                    first_intervals_ns.push(exactly_ns);
                }
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
        let found = points - without;
        let (Some(span_ns), Some(first), true) = (span_ns, first, found > 1) else {
            let reason =
                format!("found {found} points with a position or a heading, expected two or more");
            return Err(TrajectoryError::new(path, reason));
        };
        // A unit that sends on without a solution hasn't ended where its last point is.
        let heard_ns = reader.heard_ns().filter(|heard_ns| heard_ns - span_ns.1 > period_ns.max(1));
        let span_ns = (span_ns.0, heard_ns.unwrap_or(span_ns.1));
        let mean_ns = alike_ns as f64 / alike.max(1) as f64;
        let has_majority = 2 * alike.unsigned_abs() + 1 >= points - 1;
        let of_majority_ns = has_majority.then(|| whole_rate(period_ns, mean_ns)).flatten();
        let period_ns = of_majority_ns
            .or_else(|| scattered(&mut first_intervals_ns, has_majority))
            .unwrap_or_else(|| mean_ns.round() as i64);
        let most = |count: u64| count as f64 >= SHARE * found as f64;
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

/// The period of intervals that scatter, as times of arrival do: that of the whole rate that is as near to the mean of those
/// about their median as their scatter leaves open; where none is and `is_known` is false, the mean. `None`: it isn't found.
fn scattered(intervals_ns: &mut [i64], is_known: bool) -> Option<i64> {
    intervals_ns.sort_unstable();
    let middle_ns = *intervals_ns.get(intervals_ns.len() / 2)?;
    let is_near = |ns: &&i64| 2 * (**ns - middle_ns).abs() < middle_ns;
    let near: Vec<i64> = intervals_ns.iter().filter(is_near).copied().collect();
    let (first_ns, last_ns) = (near.first()?, near.last()?);
    let count = near.len() as f64;
    let mean_ns = near.iter().sum::<i64>() as f64 / count;
    // The mean of successive intervals is off by the jitter of the first and the last stamp alone.
    let off_ns = (4.0 * (last_ns - first_ns) as f64 / count).min(SCATTER_MAX * mean_ns);
    let whole_ns = 1e9 / (1e9 / mean_ns).round().max(1.0);
    if (mean_ns - whole_ns).abs() <= off_ns {
        return Some(whole_ns.round() as i64);
    }
    (!is_known).then(|| mean_ns.round() as i64)
}

/// The period that intervals with this mean have, which are about `about_ns`: that of a whole rate or a round time, if
/// they are as near to it as stamps jitter; `None`: neither.
fn whole_rate(about_ns: i64, mean_ns: f64) -> Option<i64> {
    let near = |ns: f64| (mean_ns - ns).abs() <= JITTER * mean_ns;
    let rate_hz = (1e9 / mean_ns).round().max(1.0);
    if near(about_ns as f64) {
        Some(about_ns)
    } else if near(1e9 / rate_hz) {
        Some((1e9 / rate_hz).round() as i64)
    } else {
        None
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
