//! The day of the first sentence with a time of day.

use super::lines::NmeaLines;
use super::problem::NmeaProblem;
use super::sentence::Sentence;
use super::words::UNSUMMED;
use crate::point::SECOND_NS;

pub(super) const DAY_NS: i64 = 86_400 * SECOND_NS;

/// Lines within which a file has to show what it is.
pub(super) const LINES_TO_LOOK_AT: u64 = 10_000;

/// The problem of sentences without checksums.
pub(super) fn all_unsummed(unsummed: u64) -> NmeaProblem {
    NmeaProblem::found(
        format!("{unsummed} sentences without a checksum"),
        "each to end in * and two hexadecimal digits, the exclusive or of the characters between $ and *: have the receiver or \
         the logger write them; without, a damaged sentence can't be told",
    )
}

/// Finds the day of the first point.
pub(super) fn first_day(lines: &mut NmeaLines) -> Result<i64, NmeaProblem> {
    let mut first_ns: Option<i64> = None;
    let (mut sentences, mut unsummed) = (0_u64, 0_u64);
    while lines.advance()? && (sentences > 0 || lines.line <= LINES_TO_LOOK_AT) {
        let sentence = match Sentence::of(&lines.text) {
            Ok(sentence) => sentence,
            Err(reason) => {
                unsummed += u64::from(reason == UNSUMMED);
                continue;
            }
        };
        sentences += 1;
        first_ns = first_ns.or(sentence.of_day_ns);
        if let (Some(day_ns), Some(of_day_ns)) = (sentence.day_ns, sentence.of_day_ns) {
            let first_ns = first_ns.unwrap_or(of_day_ns);
            // Sentences of the evening may come before the first date of the next morning.
            let evening = of_day_ns + DAY_NS / 2 < first_ns;
            return Ok(if evening { day_ns - DAY_NS } else { day_ns });
        }
    }
    Err(if sentences == 0 && unsummed > 0 {
        all_unsummed(unsummed)
    } else if sentences == 0 {
        NmeaProblem::Nothing
    } else {
        NmeaProblem::found(format!("{sentences} sentences and no date"), "an RMC or a ZDA")
    })
}
