//! A sentence within its line: the header of a datagram, a TAG block, a logger's stamp, the checksum.
//!
//! IEC 61162-450 sends sentences as datagrams that begin with `UdPbC` and a zero byte; each sentence has a TAG block
//! before it, `\s:HE0001,c:1604000000123*hh\`, with a checksum of its own: the exclusive or of the characters between
//! the backslashes and the asterisk. Its parameter `c` is a UNIX time in seconds or milliseconds, `g` the number of the
//! sentence in a group, the size of the group and its code; a group may have the time at its first sentence alone.
//! Public text: gpsd, "AIVDM/AIVDO protocol decoding", NMEA tag blocks; the header: rietman.wordpress.com, "NemaStudio now supports
//! the NMEA 0183 TAG block", 2016.

use super::words::{DAMAGED, NO_SENTENCE};
use octant_base::decimal::decimal_ns;
use octant_base::utc;

/// Reason of a sentence whose TAG block isn't what was sent.
pub(super) const DAMAGED_TAG: &str = "sentences with a damaged TAG block";
/// UNIX times above this are milliseconds: as seconds it is the year 5138.
const SECONDS_MAX: i64 = 100_000_000_000;

/// A line with a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Framed<'a> {
    /// Everything between `$` and the checksum.
    pub(super) body: &'a str,
    /// True if it has a checksum, which is right.
    pub(super) summed: bool,
    /// Everything before the `$`.
    before: &'a str,
}

impl<'a> Framed<'a> {
    /// Splits a line.
    ///
    /// # Errors
    /// The reason why it has no sentence that can be read.
    pub(super) fn of(line: &'a str) -> Result<Self, &'static str> {
        let at = line.rfind('$').ok_or(NO_SENTENCE)?;
        let (before, text) = (&line[..at], &line[at + 1..]);
        let Some((body, checksum)) = text.trim_end().rsplit_once('*') else {
            return Ok(Self { body: text.trim_end(), summed: false, before });
        };
        if sum(body) != u8::from_str_radix(checksum, 16).ok() {
            return Err(DAMAGED);
        }
        Ok(Self { body, summed: true, before })
    }

    /// Reads the TAG block; `None`: it has none.
    ///
    /// # Errors
    /// If it is damaged.
    pub(super) fn tag(&self) -> Result<Option<Tag<'a>>, &'static str> {
        let Some(inner) = self.before.trim_end().strip_suffix('\\') else { return Ok(None) };
        let block = inner.rsplit('\\').next().filter(|block| block.len() < inner.len());
        let (fields, checksum) =
            block.and_then(|block| block.rsplit_once('*')).ok_or(DAMAGED_TAG)?;
        if sum(fields) != u8::from_str_radix(checksum, 16).ok() {
            return Err(DAMAGED_TAG);
        }
        let field = |name: &str| fields.split(',').find_map(|field| field.strip_prefix(name));
        let time_ns = match field("c:") {
            None => None,
            Some(text) => Some(unix_ns(text).ok_or(DAMAGED_TAG)?),
        };
        let group = field("g:").and_then(|group| group.rsplit('-').next());
        Ok(Some(Tag { time_ns, group }))
    }

    /// Date and time that a logger wrote before the sentence, ns since 1970, UTC where it says nothing else.
    pub(super) fn stamp_ns(&self) -> Option<i64> {
        let mut words = self
            .before
            .split(|letter: char| letter.is_whitespace() || matches!(letter, ',' | ';'))
            .filter(|word| !word.is_empty())
            .peekable();
        while let Some(word) = words.next() {
            // Some loggers write an underscore or a colon between the date and the time of day.
            let found = utc::written(word, words.peek().copied());
            if let Some(time) = found {
                return Some(time.since_1970_ns);
            }
        }
        None
    }
}

/// Time of the TAG block before the sentence of a line, ns since 1970, UTC; `None`: it has none, or is damaged.
#[must_use]
pub fn tag_time_ns(line: &str) -> Option<i64> {
    let framed = Framed::of(line).ok().filter(|framed| framed.summed)?;
    framed.tag().ok()??.time_ns
}

/// Parameters of a TAG block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tag<'a> {
    /// Its time, ns since 1970, UTC.
    pub(super) time_ns: Option<i64>,
    /// Code of its group.
    pub(super) group: Option<&'a str>,
}

/// Exclusive or of the characters; `None` without any.
fn sum(text: &str) -> Option<u8> {
    text.bytes().reduce(|sum, byte| sum ^ byte)
}

/// A UNIX time in seconds or milliseconds, ns.
fn unix_ns(text: &str) -> Option<i64> {
    let whole: i64 = text.split('.').next()?.parse().ok()?;
    let exponent = if whole > SECONDS_MAX { 6 } else { 9 };
    i64::try_from(decimal_ns(text, exponent)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn framed(line: &str) -> Framed<'_> {
        Framed::of(line).unwrap()
    }

    #[test]
    fn tag_blocks_are_read_with_and_without_the_header_of_a_datagram() {
        // Checksums by an exclusive or in Python.
        let line = "UdPbC\0\\s:HE0001,n:17,c:1604000000123*7D\\$HEHDT,123.4,T*2B\r\n";
        let tag = framed(line).tag().unwrap().unwrap();
        assert_eq!(tag.time_ns, Some(1_604_000_000_123_000_000));
        assert_eq!(framed(line).body, "HEHDT,123.4,T");
        let seconds = "\\g:1-2-34,c:1604000000*2F\\$HEHDT,123.4,T*2B";
        let tag = framed(seconds).tag().unwrap().unwrap();
        assert_eq!((tag.time_ns, tag.group), (Some(1_604_000_000_000_000_000), Some("34")));
        let damaged = line.replace("n:17", "n:18");
        assert_eq!(framed(&damaged).tag(), Err(DAMAGED_TAG));
        assert_eq!(framed("$HEHDT,123.4,T*2B").tag(), Ok(None));
        // The block of an example of gpsd.
        let theirs = "\\g:1-2-73874,n:157036,s:r003669945,c:1241544035*4A\\$HEHDT,119.9,T*2F";
        let tag = framed(theirs).tag().unwrap().unwrap();
        assert_eq!(tag.time_ns, Some(1_241_544_035_000_000_000));
        assert_eq!(tag.group, Some("73874"));
    }

    #[test]
    fn stamps_of_loggers_are_found_before_the_sentence() {
        // As in the archives of NOAA and of OpenRVDAS.
        let noaa = "ins_seapath_position  2014-12-11T22:09:32.8229Z  $GPHDT,104.68,T*0E";
        let other = "s330 2017-11-04T05:12:20.495430Z $INHDT,235.18,T*18";
        assert_eq!(framed(noaa).stamp_ns(), Some(1_418_335_772_822_900_000));
        assert_eq!(framed(other).stamp_ns(), Some(1_509_772_340_495_430_000));
        assert_eq!(framed("$GPHDT,104.68,T*0E").stamp_ns(), None);
    }
}
