//! Settling time and settle point.
//!
//! IMO A.821(19), 2.4 and 2.5, in the words of the draft of ISO 22090-1 (about 2000), 3.10 to 3.12: a compass is settled
//! when any three readings at intervals of 30 min are within a band of 0.7°; the settling time is the time from
//! switching on to the third of them. The settle point heading is the mean of ten readings at intervals of 20 min
//! after that, the settle point error its difference from the true heading.

use crate::angle;
use crate::reading::{Reading, Series};
use serde::{Deserialize, Serialize};

/// Interval of the readings that show whether a compass is settled, s.
pub const SETTLED_EVERY_S: f64 = 1800.0;
/// Number of these readings.
pub const SETTLED_READINGS: usize = 3;
/// Band that holds them, deg.
pub const SETTLED_BAND_DEG: f64 = 0.7;
/// Interval of the readings of the settle point, s.
pub const POINT_EVERY_S: f64 = 1200.0;
/// Number of readings of the settle point.
pub const POINT_READINGS: usize = 10;

/// Whether and when a compass settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Settling time, s since switching on; of a compass that isn't settled the earliest time at which it could be: that of
    /// the next reading.
    pub time_s: f64,
    /// True if it settled.
    pub settled: bool,
}

/// Settling of a compass.
///
/// Readings are due 30 min, 60 min, 90 min … after switching on, until `until_s`. `None` if none of them is due, and if one
/// is missing before the compass settles: it may have been settled there.
#[must_use]
pub fn settling(series: &Series, until_s: f64) -> Option<Settling> {
    let mut last: Vec<Reading> = Vec::with_capacity(SETTLED_READINGS);
    let mut due_s = SETTLED_EVERY_S;
    while due_s <= until_s {
        let reading = series.at(due_s)?;
        if last.len() == SETTLED_READINGS {
            last.remove(0);
        }
        if reading.heading_deg.is_some() {
            last.push(*reading);
        } else {
            // The unit has no heading: it isn't settled.
            last.clear();
        }
        if last.len() == SETTLED_READINGS
            && angle::band(&shown(&last)?.headings_deg)? <= SETTLED_BAND_DEG
        {
            return Some(Settling { time_s: due_s, settled: true });
        }
        due_s += SETTLED_EVERY_S;
    }
    (due_s > SETTLED_EVERY_S).then_some(Settling { time_s: due_s, settled: false })
}

/// Headings of some readings, as shown by a unit whose base stays at the mean of its true headings.
struct Shown {
    headings_deg: Vec<f64>,
    /// Mean of the true headings; `None` where one isn't known.
    true_deg: Option<f64>,
}

/// Takes the motion of the true heading off the headings of some readings, where the true heading is known; `None` if the
/// unit has no heading at one of them.
fn shown(readings: &[Reading]) -> Option<Shown> {
    let truth: Option<Vec<f64>> = readings.iter().map(|reading| reading.true_deg).collect();
    let true_deg = truth.and_then(|truth| angle::mean(&truth));
    let headings: Option<Vec<f64>> = match true_deg {
        None => readings.iter().map(|reading| reading.heading_deg).collect(),
        Some(mean) => readings.iter().map(|reading| Some(mean + reading.error_deg()?)).collect(),
    };
    Some(Shown { headings_deg: headings?, true_deg })
}

/// Settle point of one run-up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SettlePoint {
    /// Settle point heading: mean of the ten readings, deg.
    pub heading_deg: f64,
    /// Settle point error: settle point heading − true heading, deg; null if the true heading isn't known.
    pub error_deg: Option<f64>,
    /// Root mean square of the differences of the ten readings from their mean, deg.
    pub readings_rms_deg: f64,
}

/// Settle point from the ten readings that are due 20 min, 40 min … 200 min after a time, s since switching on; `None` if
/// one of them is missing, or the unit has no heading there, or one is due after `until_s`.
///
/// The motion of the true heading on a table that moves is taken off the readings.
#[must_use]
pub fn settle_point(series: &Series, after_s: f64, until_s: f64) -> Option<SettlePoint> {
    let due = |number: usize| after_s + number as f64 * POINT_EVERY_S;
    if due(POINT_READINGS) > until_s {
        return None;
    }
    let readings: Option<Vec<Reading>> =
        (1..=POINT_READINGS).map(|number| series.at(due(number)).copied()).collect();
    let Shown { headings_deg, true_deg } = shown(&readings?)?;
    let heading_deg = angle::mean(&headings_deg)?;
    let squares: f64 =
        headings_deg.iter().map(|heading| angle::difference(*heading, heading_deg).powi(2)).sum();
    Some(SettlePoint {
        heading_deg,
        error_deg: true_deg.map(|true_deg| angle::difference(heading_deg, true_deg)),
        readings_rms_deg: libm::sqrt(squares / POINT_READINGS as f64),
    })
}
