//! Types of XML Schema, as far as the standards use them.

/// Type of an attribute's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeType {
    /// `xs:string`.
    Text,
    /// `xs:normalizedString`.
    Line,
    /// `xs:double`.
    Double,
    /// `xs:float`.
    Float,
    /// `xs:boolean`.
    Boolean,
    /// A whole number between two limits, both included.
    Whole(i128, i128),
    /// `xs:dateTime`.
    DateTime,
    /// `xs:hexBinary`.
    Hex,
    /// A list of values, separated by blanks.
    List(&'static Self),
    /// One of a list of words.
    Word(&'static [&'static str]),
    /// `3.0`, `3.1.2-beta`.
    Version3,
}

impl AttributeType {
    /// `xs:byte`.
    pub const BYTE: Self = Self::Whole(i8::MIN as i128, i8::MAX as i128);
    /// `xs:unsignedByte`.
    pub const UNSIGNED_BYTE: Self = Self::Whole(0, u8::MAX as i128);
    /// `xs:short`.
    pub const SHORT: Self = Self::Whole(i16::MIN as i128, i16::MAX as i128);
    /// `xs:unsignedShort`.
    pub const UNSIGNED_SHORT: Self = Self::Whole(0, u16::MAX as i128);
    /// `xs:int`.
    pub const INT: Self = Self::Whole(i32::MIN as i128, i32::MAX as i128);
    /// `xs:unsignedInt`.
    pub const UNSIGNED_INT: Self = Self::Whole(0, u32::MAX as i128);
    /// `xs:long`.
    pub const LONG: Self = Self::Whole(i64::MIN as i128, i64::MAX as i128);
    /// `xs:unsignedLong`.
    pub const UNSIGNED_LONG: Self = Self::Whole(0, u64::MAX as i128);
    /// `xs:nonNegativeInteger`: the upper limit is far beyond any size.
    pub const NON_NEGATIVE: Self = Self::Whole(0, i128::MAX);

    /// Returns whether the text is of the type.
    pub fn allows(self, text: &str) -> bool {
        match self {
            Self::Text => true,
            Self::Line => !text.contains(['\n', '\r', '\t']),
            Self::Double => is_double(text.trim()),
            // A value that is too large becomes infinite, which the schema allows.
            Self::Float => is_double(text.trim()),
            Self::Boolean => matches!(text.trim(), "true" | "false" | "1" | "0"),
            Self::Whole(min, max) => {
                text.trim().parse::<i128>().is_ok_and(|number| (min..=max).contains(&number))
            }
            Self::DateTime => is_date_time(text.trim()),
            Self::Hex => {
                let text = text.trim();
                text.len().is_multiple_of(2) && text.bytes().all(|b| b.is_ascii_hexdigit())
            }
            Self::List(of) => text.split_ascii_whitespace().all(|one| of.allows(one)),
            Self::Word(words) => words.contains(&text),
            Self::Version3 => is_version_3(text),
        }
    }
}

impl std::fmt::Display for AttributeType {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text => f.write_str("a text"),
            Self::Line => f.write_str("a text of one line"),
            Self::Double | Self::Float => f.write_str("a number, INF, -INF or NaN"),
            Self::Boolean => f.write_str("true, false, 1 or 0"),
            Self::Whole(0, i128::MAX) => f.write_str("a whole number from 0"),
            Self::Whole(min, max) => write!(f, "a whole number from {min} to {max}"),
            Self::DateTime => f.write_str("a date and time such as 2009-12-08T14:33:22Z"),
            Self::Hex => f.write_str("bytes in hexadecimal"),
            Self::List(of) => write!(f, "a list, each {of}"),
            Self::Word(words) => match words {
                [one] => f.write_str(one),
                _ => write!(f, "one of {}", words.join(", ")),
            },
            Self::Version3 => f.write_str("3.0, or another version 3"),
        }
    }
}

/// Checks `xs:double`, which is narrower than Rust's format: no `inf`, `infinity`, `nan`.
fn is_double(text: &str) -> bool {
    matches!(text, "INF" | "-INF" | "+INF" | "NaN")
        || (text.parse::<f64>().is_ok()
            && text.bytes().all(|b| !b.is_ascii_alphabetic() || b | 32 == b'e'))
}

/// Checks `YYYY-MM-DDThh:mm:ss`, with a fraction and a zone.
fn is_date_time(text: &str) -> bool {
    let number = |text: &str, digits: usize, min: u32, max: u32| {
        text.len() == digits
            && text.bytes().all(|b| b.is_ascii_digit())
            && text.parse().is_ok_and(|number: u32| (min..=max).contains(&number))
    };
    let Some((date, time)) = text.split_once('T') else { return false };
    let date: Vec<&str> = date.split('-').collect();
    let [year, month, day] = date[..] else { return false };
    let zone = time.find(['Z', '+', '-']).unwrap_or(time.len());
    let (time, zone) = time.split_at(zone);
    let zone = match zone {
        "" | "Z" => true,
        _ => zone[1..]
            .split_once(':')
            .is_some_and(|(hour, minute)| number(hour, 2, 0, 14) && number(minute, 2, 0, 59)),
    };
    let time: Vec<&str> = time.split(':').collect();
    let [hour, minute, second] = time[..] else { return false };
    let (second, fraction) = second.split_once('.').unwrap_or((second, "0"));
    number(year, 4, 0, 9999)
        && number(month, 2, 1, 12)
        && number(day, 2, 1, 31)
        && number(hour, 2, 0, 24)
        && number(minute, 2, 0, 59)
        && number(second, 2, 0, 59)
        && !fraction.is_empty()
        && fraction.bytes().all(|b| b.is_ascii_digit())
        && zone
}

fn is_version_3(text: &str) -> bool {
    let (numbers, suffix) = match text.split_once('-') {
        Some((numbers, suffix)) => (numbers, Some(suffix)),
        None => (text, None),
    };
    let parts: Vec<&str> = numbers.split('.').collect();
    let number = |text: &&str| {
        !text.is_empty()
            && text.bytes().all(|b| b.is_ascii_digit())
            && (*text == "0" || !text.starts_with('0'))
    };
    parts[0] == "3"
        && (2..=3).contains(&parts.len())
        && parts[1..].iter().all(number)
        && suffix.is_none_or(|suffix| !suffix.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_told_apart() {
        for (of, yes, no) in [
            (AttributeType::Line, &["a b", ""][..], &["a\nb", "\t"][..]),
            (
                AttributeType::Double,
                &["1", "-1.5e-3", " 1 ", "INF", "-INF", "NaN", ".5", "5.", "+1E+2"],
                &["", "inf", "nan", "Infinity", "1,5", "0x10", "1 2", "1f", "e", "1e"],
            ),
            (AttributeType::Boolean, &["true", "false", "1", "0"], &["True", "yes", ""]),
            (AttributeType::BYTE, &["-128", "127", "+5", "007"], &["128", "-129", "1.0", ""]),
            (
                AttributeType::UNSIGNED_LONG,
                &["18446744073709551615"],
                &["18446744073709551616", "-1"],
            ),
            (
                AttributeType::DateTime,
                &["2009-12-08T14:33:22Z", "2024-02-29T00:00:00.125+01:00", "2024-02-29T00:00:00"],
                &[
                    "2009-12-08",
                    "2009-12-08 14:33:22",
                    "2009-13-08T14:33:22Z",
                    "2009-12-08T14:33Z",
                    "2009-12-08T14:33:22.Z",
                ],
            ),
            (AttributeType::Hex, &["", "0aFF"], &["0", "0g"]),
            (AttributeType::List(&AttributeType::UNSIGNED_INT), &["", "1 2  3"], &["1,2", "-1"]),
            (AttributeType::Word(&["a", "b"]), &["a", "b"], &["c", "A", ""]),
            (
                AttributeType::Version3,
                &["3.0", "3.1", "3.0.2", "3.0-beta.1"],
                &["3", "2.0", "3.01", "3.0-", "3.0.0.0", "3."],
            ),
        ] {
            for text in yes {
                assert!(of.allows(text), "{text:?} is {of}");
            }
            for text in no {
                assert!(!of.allows(text), "{text:?} is not {of}");
            }
        }
    }
}
