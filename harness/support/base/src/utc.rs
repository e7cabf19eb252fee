//! Times of the host as text of RFC 3339, in UTC, and back.

use chrono::{DateTime, SecondsFormat, Utc};
use std::time::SystemTime;

/// A text that is no time of RFC 3339.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(transparent)]
pub struct TimeTextError(#[from] chrono::ParseError);

/// Time to the second, such as `2027-03-31T08:00:00Z`.
#[must_use]
pub fn seconds(time: SystemTime) -> String {
    text(time, SecondsFormat::Secs)
}

/// Time to the millisecond.
#[must_use]
pub fn millis(time: SystemTime) -> String {
    text(time, SecondsFormat::Millis)
}

/// Time to the nanosecond.
#[must_use]
pub fn nanos(time: SystemTime) -> String {
    text(time, SecondsFormat::Nanos)
}

fn text(time: SystemTime, to: SecondsFormat) -> String {
    DateTime::<Utc>::from(time).to_rfc3339_opts(to, true)
}

/// Reads a time with its offset from UTC.
///
/// # Errors
/// If the text is no time of RFC 3339, or the calendar has no such day.
pub fn parse(text: &str) -> Result<SystemTime, TimeTextError> {
    Ok(DateTime::parse_from_rfc3339(text)?.into())
}

#[cfg(test)]
mod tests {
    use super::{millis, nanos, parse, seconds};
    use std::time::{Duration, UNIX_EPOCH};

    #[test]
    fn times_are_those_of_the_calendar() {
        // `date -u -d @1806480000.123456789`
        let time = UNIX_EPOCH + Duration::new(1_806_480_000, 123_456_789);
        assert_eq!(seconds(time), "2027-03-31T08:00:00Z");
        assert_eq!(millis(time), "2027-03-31T08:00:00.123Z");
        assert_eq!(nanos(time), "2027-03-31T08:00:00.123456789Z");
        for text in [nanos(time), "2027-03-31T10:00:00.123456789+02:00".to_owned()] {
            assert_eq!(parse(&text), Ok(time));
        }
        assert_eq!(millis(UNIX_EPOCH), "1970-01-01T00:00:00.000Z");
    }

    #[test]
    fn a_day_that_is_none_is_refused() {
        for text in ["2027-02-29T00:00:00Z", "2027-13-01T00:00:00Z", "2027-03-31", "", "now"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
