//! Talkers, reasons and digits of sentences.

/// Talker of a sentence: the letters before its kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Talker([u8; 5]);

impl Talker {
    pub(super) fn of(letters: &str) -> Self {
        let mut talker = Self::default();
        for (to, from) in talker.0.iter_mut().zip(letters.bytes()) {
            *to = if from.is_ascii_graphic() { from } else { b'?' };
        }
        talker
    }
}

impl std::fmt::Display for Talker {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0
            .iter()
            .filter(|byte| **byte != 0)
            .try_for_each(|byte| write!(f, "{}", char::from(*byte)))
    }
}

// Reasons why a line belongs to no point.
pub(super) const NO_SENTENCE: &str = "lines without a sentence";
pub(super) const DAMAGED: &str = "sentences with a wrong checksum";
pub(super) const UNSUMMED: &str = "sentences without a checksum";
pub(super) const OTHER_KINDS: &str = "sentences of other kinds";
pub(super) const UNREADABLE: &str = "sentences that can't be read";
pub(super) const NO_FIX: &str = "sentences without a valid fix";
pub(super) const NO_MEASUREMENT: &str = "sentences of a simulator or of manual input";

/// Change of a decimal number by one in its last digit.
pub(super) fn last_digit(text: &str) -> f64 {
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len());
    libm::exp10(-(digits as f64))
}
