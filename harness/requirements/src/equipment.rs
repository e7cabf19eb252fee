//! Equipment of the bench: what a run was measured with, and until when its certificate holds.
//!
//! A certificate is held against the day on which the run ended, which stands in its manifest: judged again years
//! later, the run comes to the same.

use serde::{Deserialize, Serialize};
use std::time::SystemTime;

/// A day, UTC: `2027-03-31`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Day(String);

impl Day {
    /// Reads a day.
    ///
    /// # Errors
    /// In words, if it isn't one that the calendar has.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || format!("found {text:?}, expected a day such as 2027-03-31");
        let is_form = text.len() == 10
            && text.bytes().enumerate().all(|(place, byte)| match place {
                4 | 7 => byte == b'-',
                _ => byte.is_ascii_digit(),
            });
        if !is_form {
            return Err(wrong());
        }
        let at_midnight = humantime::parse_rfc3339(&format!("{text}T00:00:00Z"));
        let time = at_midnight.map_err(|error| format!("{}: {error}", wrong()))?;
        // What isn't in the calendar comes back as another day.
        if Self::of(time).0 == text { Ok(Self(text.to_owned())) } else { Err(wrong()) }
    }

    /// The day of a time of the host.
    #[must_use]
    pub fn of(time: SystemTime) -> Self {
        let text = humantime::format_rfc3339_seconds(time).to_string();
        Self(text.get(..10).unwrap_or_default().to_owned())
    }

    /// The day of a time as a manifest has it, RFC 3339.
    ///
    /// # Errors
    /// In words, if it isn't one.
    pub fn of_text(text: &str) -> Result<Self, String> {
        let time = humantime::parse_rfc3339(text)
            .map_err(|error| format!("found {text:?}, expected a time of RFC 3339: {error}"))?;
        Ok(Self::of(time))
    }
}

impl TryFrom<String> for Day {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
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
    /// Its name.
    pub name: String,
    /// Its serial number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial: Option<String>,
    /// Number of its certificate of calibration.
    pub certificate: String,
    /// The last day on which the certificate holds.
    pub expires: Day,
}

impl Equipment {
    /// It with its serial number.
    #[must_use]
    pub fn named(&self) -> String {
        match &self.serial {
            Some(serial) => format!("{} (serial number {serial})", self.name),
            None => self.name.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_is_one_that_the_calendar_has() {
        for day in ["2027-03-31", "2028-02-29", "1999-12-31"] {
            assert_eq!(Day::parse(day).unwrap().to_string(), day);
        }
        for bad in
            ["2027-02-29", "2027-13-01", "2027-00-10", "2027-3-31", "31.03.2027", "", "2027-03-31 "]
        {
            assert!(Day::parse(bad).unwrap_err().contains("2027-03-31"), "{bad}");
        }
        assert!(Day::parse("2027-03-31").unwrap() < Day::parse("2027-04-01").unwrap());
        let midnight = Day::of_text("2027-03-31T23:59:59.999Z").unwrap();
        assert_eq!(midnight, Day::parse("2027-03-31").unwrap());
    }
}
