//! Times of navigation messages, and the calendar.

use crate::novatel::WEEK_NS;

const SECOND_NS: i64 = 1_000_000_000;
/// Days of 400 years of the Gregorian calendar.
const ERA_DAYS: i64 = 146_097;

/// Time for which a message is valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NavigationTime {
    /// GPS time, ns since its epoch.
    Gps(u64),
    /// UTC, ns since 1970.
    Utc(i64),
    /// The unit's own clock, ns.
    Own(u64),
}

/// GPS time of a week and its seconds.
pub(super) fn gps(week: u32, seconds: f64) -> Option<NavigationTime> {
    let whole = (0.0..=604_800.0).contains(&seconds).then(|| libm::rint(seconds * 1e9) as u64)?;
    // A week that no clock can reach would overflow.
    (week < 30_000).then(|| NavigationTime::Gps(u64::from(week) * WEEK_NS + whole))
}

/// A date with a time of day.
pub(super) struct Calendar {
    pub(super) year: i64,
    pub(super) month: u8,
    pub(super) day: u8,
    pub(super) hour: u8,
    pub(super) minute: u8,
    /// Second, 60 within a leap second.
    pub(super) second: u8,
    pub(super) ns: u32,
}

impl Calendar {
    /// UTC, ns since 1970. Within a leap second it is that of the second after it.
    pub(super) fn utc_ns(&self) -> Option<i64> {
        let sound = (1970..=2200).contains(&self.year)
            && (1..=12).contains(&self.month)
            && (1..=31).contains(&self.day)
            && self.hour < 24
            && self.minute < 60
            && self.second <= 60
            && self.ns < 1_000_000_000;
        if !sound {
            return None;
        }
        // Years that begin in March have their leap day at the end.
        let (year, month) = match i64::from(self.month) {
            month @ 1..=2 => (self.year - 1, month + 9),
            month => (self.year, month - 3),
        };
        let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
        let of_year = (153 * month + 2) / 5 + i64::from(self.day) - 1;
        let days = era * ERA_DAYS + of_era * 365 + of_era / 4 - of_era / 100 + of_year;
        // 1 March of the year 0 is 719468 days before 1970.
        let seconds = (days - 719_468) * 86_400
            + i64::from(self.hour) * 3600
            + i64::from(self.minute) * 60
            + i64::from(self.second);
        Some(seconds * SECOND_NS + i64::from(self.ns))
    }
}
