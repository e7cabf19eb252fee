//! Equipment of the bench with which a run was measured, and the validity of its certificates.
//!
//! A certificate is compared with the day on which the run ended, from its manifest: so the result
//! stays the same when the run is judged again years later.

use serde::{Deserialize, Serialize};
use std::time::SystemTime;

/// A day, UTC: `2027-03-31`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Day(String);

/// Reason why a text is no day.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DayError {
    /// The text has another form.
    #[error("found {found:?}, expected a day such as 2027-03-31")]
    Day {
        /// Text found.
        found: String,
    },
    /// The calendar has no such day.
    #[error("found {found:?}, expected a day such as 2027-03-31: {error}")]
    NotInCalendar {
        /// Text found.
        found: String,
        /// Reason.
        error: octant_base::utc::TimeTextError,
    },
    /// The text is no time of RFC 3339.
    #[error("found {found:?}, expected a time of RFC 3339: {error}")]
    Time {
        /// Text found.
        found: String,
        /// Reason.
        error: octant_base::utc::TimeTextError,
    },
}

impl Day {
    /// Parses a day.
    ///
    /// # Errors
    /// If the calendar has no such day.
    pub fn parse(text: &str) -> Result<Self, DayError> {
        let found = || text.to_owned();
        let is_form = text.len() == 10
            && text.bytes().enumerate().all(|(place, byte)| match place {
                4 | 7 => byte == b'-',
                _ => byte.is_ascii_digit(),
            });
        if !is_form {
            return Err(DayError::Day { found: found() });
        }
        let at_midnight = octant_base::utc::parse(&format!("{text}T00:00:00Z"));
        at_midnight.map_err(|error| DayError::NotInCalendar { found: found(), error })?;
        Ok(Self(text.to_owned()))
    }

    /// Day of a time of the host.
    #[must_use]
    pub fn of(time: SystemTime) -> Self {
        let text = octant_base::utc::seconds(time);
        Self(text.get(..10).unwrap_or_default().to_owned())
    }

    /// Day of a time of a manifest, RFC 3339.
    ///
    /// # Errors
    /// If it is no such time.
    pub fn of_text(text: &str) -> Result<Self, DayError> {
        let time = octant_base::utc::parse(text)
            .map_err(|error| DayError::Time { found: text.to_owned(), error })?;
        Ok(Self::of(time))
    }
}

impl TryFrom<String> for Day {
    type Error = DayError;

    fn try_from(text: String) -> Result<Self, DayError> {
        Self::parse(&text)
    }
}

impl From<Day> for String {
    fn from(day: Day) -> Self {
        day.0
    }
}

impl std::fmt::Display for Day {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// A piece of equipment: a turntable, a reference, a counter.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Equipment {
    /// Name.
    pub name: String,
    /// Serial number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial: Option<String>,
    /// Number of the certificate of calibration.
    pub certificate: String,
    /// Last day on which the certificate is valid.
    pub expires: Day,
}

impl Equipment {
    /// Name with the serial number.
    #[must_use]
    pub fn named(&self) -> String {
        match &self.serial {
            Some(serial) => format!("{} (serial number {serial})", self.name),
            None => self.name.clone(),
        }
    }
}
