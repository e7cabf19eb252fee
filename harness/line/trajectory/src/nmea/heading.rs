//! Sentences with a heading and without a time, each with its maker's convention of order, sign and unit.
//!
//! | sentence | fields that are read | source |
//! |---|---|---|
//! | `HDT` | true heading, deg, `T` | JRC JLR-30 manual, appendix 2-2; Seapath format of the R/V Langseth |
//! | `THS` | true heading, deg; mode A autonomous, E estimated, M manual, S simulator, V invalid | JRC JLR-30 manual, appendix 2-2; go-nmea `ths.go` |
//! | `PSXN,23` | roll, port side up, pitch, bow up, true heading: deg | Kongsberg Seapath 320 Installation Manual, M300-62 rev. 2, p. 95 |
//! | `PSXN,20` | quality of the heading, then of roll and pitch: 0 normal, 1 reduced, 2 invalid | there |
//! | `PRDID` | pitch, roll, heading: deg; the heading counts | Applanix POS MV V5 Guide, p. 3-12 |
//! | `PFEC,GPatt` | true heading, pitch, roll: deg; the heading counts | Furuno SC-120 manual, p. A-6; pynmea2's `FECGPatt` |
//!
//! Roll and pitch of PRDID come as Tait-Bryan or as TSS angles, and the sentence doesn't say which. The signs of PFEC and of PIXSE
//! (roll, pitch) were found in no public text. None of these is scored.

use crate::point::PointAttitude;
use std::f64::consts::{PI, TAU};

use super::problem::NmeaProblem;
use super::words::{NO_MEASUREMENT, OTHER_KINDS, Talker, UNREADABLE, last_digit};

/// Reason of a heading that its instrument calls invalid.
pub(super) const INVALID: &str = "headings that the instrument calls invalid";
/// Reason of a heading that is estimated, where fixes alone count.
pub(super) const ESTIMATED_HEADING: &str = "headings that are estimated (dead reckoning)";

/// Sentences that say something of the ship's motion and aren't scored.
const UNSCORED: [(&str, &str); 11] = [
    ("ROT", "ROT sentences: a rate of turn isn't scored"),
    ("VBW", "VBW sentences: speed along and across the ship isn't scored"),
    (
        "VHW",
        "VHW sentences: speed through the water, and a heading that the log repeats, aren't scored",
    ),
    ("HDG", "HDG sentences: a magnetic heading isn't scored"),
    ("HDM", "HDM sentences: a magnetic heading isn't scored"),
    ("OSD", "OSD sentences: the heading that a radar repeats isn't scored"),
    ("PSXN", "PSXN sentences besides 20 and 23 aren't scored"),
    ("PIXSE", "PIXSE sentences aren't scored: the heading of such a unit comes as HDT"),
    ("PFEC", "PFEC sentences besides GPatt aren't scored"),
    ("PASHR", "PASHR sentences without a time and an attitude aren't scored"),
    ("PRDID", "PRDID sentences without a heading aren't scored"),
];

/// Heading of one sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeadingSaid {
    /// Letters of the talker, or the name of a maker's sentence.
    pub(super) talker: Talker,
    /// True for THS, which HDT repeats without a mode.
    pub(super) has_mode: bool,
    /// Heading, rad.
    pub(super) heading_rad: f64,
    /// Roll and pitch, rad.
    pub(super) tilt_rad: Option<[f64; 2]>,
    /// Change of roll, pitch and heading by one in their last digits, rad.
    pub(super) digit_rad: [f64; 3],
    /// True for a heading of dead reckoning.
    pub(super) is_estimated: bool,
    /// Mode in the words of the sentence.
    pub(super) quality: &'static str,
}

impl HeadingSaid {
    /// The attitude, as far as it is known.
    pub(super) const fn attitude(&self) -> PointAttitude {
        PointAttitude { heading_rad: self.heading_rad, tilt_rad: self.tilt_rad }
    }

    /// Keeps a heading of a point: the first one, and THS before HDT of the same talker.
    ///
    /// # Errors
    /// If two instruments differ by more than their last digits.
    pub(super) fn keep(kept: &mut Option<Self>, said: Option<Self>) -> Result<(), NmeaProblem> {
        let Some(said) = said else { return Ok(()) };
        let Some(first) = kept else {
            *kept = Some(said);
            return Ok(());
        };
        if first.talker == said.talker {
            *first = said;
            return Ok(());
        }
        let apart_rad = (said.heading_rad - first.heading_rad + PI).rem_euclid(TAU) - PI;
        if apart_rad.abs() <= first.digit_rad[2] + said.digit_rad[2] {
            return Ok(());
        }
        let [one, other] = [first.talker, said.talker];
        let apart_deg = apart_rad.abs().to_degrees();
        Err(NmeaProblem::Contradiction {
            line: None,
            what: format!(
                "{one} and {other} disagree: their headings behind one position are {apart_deg:.3} deg apart"
            ),
            expected: format!(
                "one instrument: say which one with the key talker, such as talker = \"{one}\", or have headings alone, \
                 points = \"headings\""
            ),
        })
    }
}

/// Heading in a sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Heard {
    Heading(HeadingSaid),
    /// Quality of the headings of PSXN,23 that follow: 0, 1 or 2, the worse one of heading and of roll and pitch.
    Quality(u8),
    /// No heading, for this reason.
    LeftOut(&'static str),
}

/// Quality that PSXN,20 told last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PsxnQuality(u8);

impl PsxnQuality {
    pub(super) fn take(&mut self, quality: u8) {
        self.0 = quality;
    }

    /// A heading with its quality.
    ///
    /// # Errors
    /// If it is invalid.
    pub(super) fn judged(self, said: HeadingSaid) -> Result<HeadingSaid, &'static str> {
        match self.0 {
            _ if said.talker != Talker::of("PSXN") => Ok(said),
            0 => Ok(HeadingSaid { quality: "quality 0 (normal) or not stated", ..said }),
            1 => Ok(HeadingSaid { quality: "quality 1 (reduced performance)", ..said }),
            _ => Err(INVALID),
        }
    }
}

impl Heard {
    /// Reads a sentence by its whole name; `None`: it is another one.
    pub(super) fn of(name: &str, fields: &[&str]) -> Option<Result<Self, &'static str>> {
        let field = |index: usize| fields.get(index).copied().unwrap_or_default();
        let talker = Talker::of(name.get(..name.len().saturating_sub(3)).unwrap_or_default());
        let own = Talker::of(name);
        let one = |talker, index, has_mode| heading(talker, field(index), has_mode);
        let found = match (name, field(0)) {
            ("PSXN", "23") => one(own, 3, false).and_then(|said| {
                let (roll, pitch) = (angle_rad(field(1), 180.0)?, angle_rad(field(2), 90.0)?);
                let [roll_digit, pitch_digit] = [1, 2].map(|at| last_digit(field(at)).to_radians());
                let digit_rad = [roll_digit, pitch_digit, said.digit_rad[2]];
                Some(HeadingSaid { tilt_rad: Some([roll, pitch]), digit_rad, ..said })
            }),
            ("PSXN", "20") => {
                let worst = [3, 4].map(|at| field(at).parse::<u8>().ok());
                let worst = worst[0].zip(worst[1]).map(|(heading, tilt)| heading.max(tilt));
                return Some(
                    worst.filter(|worst| *worst <= 2).map(Self::Quality).ok_or(UNREADABLE),
                );
            }
            ("PRDID", _) if fields.len() >= 3 => one(own, 2, false),
            ("PFEC", "GPatt") => one(own, 1, false),
            _ if name.starts_with('P') => return None,
            _ if name.ends_with("HDT") => one(talker, 0, false).filter(|_| field(1) == "T"),
            _ if name.ends_with("THS") => match field(1) {
                "A" => one(talker, 0, true)
                    .map(|said| HeadingSaid { quality: "mode A (autonomous)", ..said }),
                "E" => one(talker, 0, true).map(|said| HeadingSaid {
                    quality: "mode E (estimated, dead reckoning)",
                    is_estimated: true,
                    ..said
                }),
                "M" | "S" => return Some(Ok(Self::LeftOut(NO_MEASUREMENT))),
                "V" => return Some(Ok(Self::LeftOut(INVALID))),
                _ => None,
            },
            _ => return None,
        };
        // An instrument without a heading sends an empty field.
        if found.is_none() && fields.iter().any(|field| field.is_empty()) {
            return Some(Ok(Self::LeftOut(INVALID)));
        }
        Some(found.map(Self::Heading).ok_or(UNREADABLE))
    }
}

/// The reason why a sentence of another kind belongs to no point.
pub(super) fn unscored(name: &str) -> &'static str {
    let standard = name.get(name.len().saturating_sub(3)..).unwrap_or_default();
    let kind = if name.starts_with('P') { name } else { standard };
    UNSCORED.iter().find(|(of, _)| *of == kind).map_or(OTHER_KINDS, |(_, reason)| reason)
}

fn heading(talker: Talker, text: &str, has_mode: bool) -> Option<HeadingSaid> {
    Some(HeadingSaid {
        talker,
        has_mode,
        heading_rad: angle_rad(text, 360.0)?,
        tilt_rad: None,
        digit_rad: [0.0, 0.0, last_digit(text).to_radians()],
        is_estimated: false,
        quality: "no stated mode",
    })
}

/// An angle of degrees, rad; `None` if it is no number within a limit, deg.
fn angle_rad(text: &str, most: f64) -> Option<f64> {
    // Digits, one sign and one point: "inf" and exponents are no angles.
    let plain =
        text.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'+' | b'-'));
    let value: f64 = text.parse().ok().filter(|_| plain)?;
    (value.abs() <= most).then(|| value.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nmea::framed::Framed;

    fn heard(line: &str) -> Option<Result<Heard, &'static str>> {
        let framed = Framed::of(line).unwrap();
        assert!(framed.summed, "{line}");
        let (name, fields) = framed.body.split_once(',').unwrap();
        Heard::of(name, &fields.split(',').collect::<Vec<_>>())
    }

    fn said(line: &str) -> HeadingSaid {
        match heard(line) {
            Some(Ok(Heard::Heading(said))) => said,
            other => panic!("{line}: {other:?}"),
        }
    }

    fn degrees(said: &HeadingSaid) -> (f64, Option<[f64; 2]>) {
        let round = |rad: f64| (rad.to_degrees() * 1e6).round() / 1e6;
        (round(said.heading_rad), said.tilt_rad.map(|tilt| tilt.map(round)))
    }

    /// Sentences of public logs and of the tests of other programs, with their values by hand.
    #[test]
    fn each_kind_is_read_with_its_order_and_sign() {
        for (line, heading, tilt, digit) in [
            // R/V archives of NOAA; Seapath 330 of OpenRVDAS; pynmea2's tests; go-nmea's tests.
            ("$GPHDT,104.68,T*0E", 104.68, None, 0.01),
            ("$INHDT,235.18,T*18", 235.18, None, 0.01),
            ("$INTHS,123.456,A*20", 123.456, None, 0.001),
            ("$PSXN,23,-2.82,1.00,235.18,-1.66*3D", 235.18, Some([-2.82, 1.0]), 0.01),
            ("$PSXN,23,1.28,1.93,104.68,-0.24*18", 104.68, Some([1.28, 1.93]), 0.01),
            ("$PFEC,GPatt,294.7,-02.5,+00.4*45", 294.7, None, 0.1),
            ("$PRDID,-4.44,2.12,154.25*56", 154.25, None, 0.01),
        ] {
            let said = said(line);
            assert_eq!(degrees(&said), (heading, tilt), "{line}");
            assert!((said.digit_rad[2].to_degrees() - digit).abs() < 1e-12, "{line}");
        }
    }

    #[test]
    fn modes_and_qualities_that_are_no_heading_are_told() {
        assert!(said("$HETHS,359.95,E*1A").is_estimated);
        for (line, expected) in [
            ("$HETHS,100.0,V*3B", Heard::LeftOut(INVALID)),
            ("$HETHS,,V*14", Heard::LeftOut(INVALID)),
            ("$HETHS,100.0,M*20", Heard::LeftOut(NO_MEASUREMENT)),
            ("$HETHS,100.0,S*3E", Heard::LeftOut(NO_MEASUREMENT)),
            ("$HEHDT,,T*01", Heard::LeftOut(INVALID)),
            ("$PSXN,20,1,0,0,0*3A", Heard::Quality(0)),
            ("$PSXN,20,1,0,1,0*3B", Heard::Quality(1)),
            ("$PSXN,20,0,0,0,2*39", Heard::Quality(2)),
        ] {
            assert_eq!(heard(line), Some(Ok(expected)), "{line}");
        }
        // A magnetic heading in a true one's place, a mode that isn't one, and a number that isn't one.
        for line in
            ["$HEHDT,100.0,M*37", "$HETHS,100.0,X*35", "$HEHDT,inf,T*60", "$HEHDT,361.0,T*2B"]
        {
            assert_eq!(heard(line), Some(Err(UNREADABLE)), "{line}");
        }
    }

    #[test]
    fn other_sentences_have_their_kind_in_the_account() {
        for (name, word) in [
            ("HEROT", "ROT"),
            ("VDVBW", "VBW"),
            ("IIVHW", "VHW"),
            ("PIXSE", "PIXSE"),
            ("PSXN", "PSXN"),
        ] {
            assert!(unscored(name).starts_with(word), "{name}");
        }
        assert_eq!(unscored("GPGSV"), OTHER_KINDS);
        assert_eq!(heard("$PIXSE,ATITUD,-1.641,-0.490*6D"), None);
    }
}
