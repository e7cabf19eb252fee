//! Sentences that were chosen.

use super::heading::ESTIMATED_HEADING;
use super::sentence::Sentence;
use super::words::Talker;
use octant_scenario::trajectory::NmeaChoice;

pub(super) const OTHER_TALKERS: &str = "sentences of other talkers";
pub(super) const ESTIMATED: &str = "sentences with an estimated position, which is no fix";

/// A sentence as far as it was chosen: of another talker the date alone.
pub(super) fn chosen(sentence: Sentence, choice: &NmeaChoice) -> Sentence {
    if sentence.left_out.is_some() || sentence.is_date_alone {
        return sentence;
    }
    let nobody = Talker::default();
    let other = choice
        .talker
        .as_deref()
        .map(Talker::of)
        .is_some_and(|talker| sentence.talker != talker && sentence.talker != nobody);
    if other {
        let date = sentence.day_ns.is_some();
        let sentence = sentence.without(OTHER_TALKERS);
        return Sentence { is_date_alone: date, ..sentence };
    }
    match sentence.heading {
        _ if !(choice.fixes_alone && sentence.is_estimated) => sentence,
        Some(_) => sentence.without(ESTIMATED_HEADING),
        None => sentence.without(ESTIMATED),
    }
}
