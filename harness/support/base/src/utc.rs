//! Times of the host as text of RFC 3339, in UTC, and back.

use chrono::{DateTime, NaiveDate, SecondsFormat, Utc};
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

/// A date with a time of day, as loggers write it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenTime {
    /// Time since 1970, UTC, ns.
    pub since_1970_ns: i64,
    /// True if it says its offset from UTC; else it is taken as UTC.
    pub zoned: bool,
}

/// Reads a time of ISO 8601, with `T`, a blank or an underscore before the time of day, and with or without an offset
/// from UTC. The time of day may be `next`, where `text` is a date alone; dates may have slashes after the year.
/// `None`: the text is none.
#[must_use]
pub fn written(text: &str, next: Option<&str>) -> Option<WrittenTime> {
    let text = text.trim();
    let (date, rest) = text.split_at_checked(10)?;
    let separated = |place: usize| matches!(date.as_bytes()[place], b'-' | b'/');
    if !(separated(4) && separated(7)) {
        return None;
    }
    let date = NaiveDate::from_ymd_opt(
        whole(date.get(..4)?)? as i32,
        whole(date.get(5..7)?)?,
        whole(date.get(8..)?)?,
    )?;
    let time = match rest.strip_prefix(['T', 't', ' ', '_']) {
        Some(time) => time,
        None if rest.is_empty() => next?,
        None => return None,
    };
    let time = time.trim();
    let end = time.find(|c: char| !(c.is_ascii_digit() || matches!(c, ':' | '.' | ',')));
    let (of_day, zone) = time.split_at(end.unwrap_or(time.len()));
    let mut parts = of_day.splitn(3, ':');
    let (hour, minute) = (whole(parts.next()?)?, whole(parts.next()?)?);
    let (second, fraction) = match parts.next() {
        None => ("0", ""),
        Some(seconds) => seconds.split_once(['.', ',']).unwrap_or((seconds, "")),
    };
    let date_time = date.and_hms_opt(hour, minute, whole(second)?)?;
    let zone = zone.trim();
    let ahead_s = match zone {
        "" | "Z" | "z" | "UTC" | "utc" => 0,
        _ => {
            let sign = match zone.as_bytes().first()? {
                b'+' => 1,
                b'-' => -1,
                _ => return None,
            };
            let hours = whole(zone.get(1..3)?)?;
            let rest = zone.get(3..)?;
            let rest = rest.strip_prefix(':').unwrap_or(rest);
            let minutes = if rest.is_empty() { 0 } else { whole(rest)? };
            (hours < 24 && minutes < 60).then_some(sign * 60 * i64::from(60 * hours + minutes))?
        }
    };
    let since_1970_ns = (date_time.and_utc().timestamp() - ahead_s)
        .checked_mul(1_000_000_000)?
        .checked_add(fraction_ns(fraction)?)?;
    Some(WrittenTime { since_1970_ns, zoned: !zone.is_empty() })
}

/// Reads a number of digits alone.
fn whole(text: &str) -> Option<u32> {
    text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok())?
}

/// Nanoseconds of the digits after the point of a second; those beyond are cut.
fn fraction_ns(digits: &str) -> Option<i64> {
    let digit = |place: usize| {
        digits
            .as_bytes()
            .get(place)
            .map_or(Some(0), |byte| byte.is_ascii_digit().then(|| i64::from(byte - b'0')))
    };
    let ns = (0..9).try_fold(0, |ns, place| Some(10 * ns + digit(place)?));
    ns.filter(|_| digits.bytes().all(|byte| byte.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::{WrittenTime, millis, nanos, parse, seconds, written};
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

    #[test]
    fn times_of_loggers_are_read_as_they_write_them() {
        // `date -u -d '2027-03-31 08:00:00' +%s`: 1806480000.
        let at = |ns: i64, zoned| {
            Some(WrittenTime { since_1970_ns: 1_806_480_000_000_000_000 + ns, zoned })
        };
        for (text, expected) in [
            ("2027-03-31T08:00:00.25Z", at(250_000_000, true)),
            ("2027-03-31 08:00:00.25", at(250_000_000, false)),
            ("2027-03-31 08:00:00.123456789 UTC", at(123_456_789, true)),
            ("2027/03/31_08:00:00", at(0, false)),
            ("2027-03-31T10:00:00+02:00", at(0, true)),
            ("2027-03-31 10:30:00,5+0230", at(500_000_000, true)),
            ("2027-03-31 03:00-05", at(0, true)),
            (" 2027-03-31t08:00:00z ", at(0, true)),
        ] {
            assert_eq!(written(text, None), expected, "{text}");
        }
        assert_eq!(written("2027-03-31", Some("08:00:00.5")), at(500_000_000, false));
        for text in [
            "2027-02-29 00:00:00",
            "2027-03-31",
            "1806480000.5",
            "08:00:00",
            "2027-03-31X08:00:00",
            "",
            "é027-03-31",
        ] {
            assert_eq!(written(text, None), None, "{text}");
        }
        assert_eq!(written("2027-03-31", Some("17.5")), None);
    }
}
