//! One sentence of NMEA 0183, and what talkers say of one quantity.

use super::framed::Framed;
use super::heading::{HeadingSaid, Heard, unscored};
use super::problem::NmeaProblem;
use super::words::{NO_FIX, NO_MEASUREMENT, OTHER_KINDS, Talker, UNREADABLE, UNSUMMED, last_digit};
use crate::point::SECOND_NS;
use octant_base::decimal::decimal_ns;
use octant_earth::units::NAUTICAL_MILE_M;

const KNOT_MPS: f64 = NAUTICAL_MILE_M / 3600.0;

/// A quantity as a talker gave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Said<const N: usize> {
    pub(super) value: [f64; N],
    /// Change of the values by one in their last digits.
    pub(super) resolution: [f64; N],
    talker: Talker,
    kind: Talker,
}

impl<const N: usize> Said<N> {
    /// Index of a value in which another talker, or another sentence of this kind, differs by more than the last digits
    /// of both.
    fn differs(&self, other: &Self) -> Option<usize> {
        if self.talker == other.talker && self.kind != other.kind {
            return None;
        }
        (0..N).find(|&index| {
            let most = self.resolution[index] + other.resolution[index];
            (self.value[index] - other.value[index]).abs() > most
        })
    }

    /// Returns whether another one is of the same talker and kind.
    pub(super) fn is_of_source(&self, other: &Self) -> bool {
        self.talker == other.talker && self.kind == other.kind
    }

    /// Keeps the finest that was said of a point, of equal ones the first.
    ///
    /// # Errors
    /// If two talkers differ; `amount` gives the difference in words.
    pub(super) fn keep(
        kept: &mut Option<Self>,
        said: Option<Self>,
        quantity: &str,
        amount: impl Fn(&Self, &Self) -> String,
    ) -> Result<(), NmeaProblem> {
        let Some(said) = said else { return Ok(()) };
        let Some(first) = kept else {
            *kept = Some(said);
            return Ok(());
        };
        match first.differs(&said) {
            None => {
                let finer = (0..N).all(|index| said.resolution[index] <= first.resolution[index]);
                if finer && said.resolution != first.resolution {
                    *first = said;
                }
                Ok(())
            }
            Some(_) => {
                let (one, other, amount) = (first.talker, said.talker, amount(first, &said));
                let (what, expected) = if one == other {
                    let kind = said.kind;
                    (
                        format!(
                            "two {other}{kind} of the same time disagree: their {quantity} are {amount} apart"
                        ),
                        "one instrument, and times with the digits of its rate".to_owned(),
                    )
                } else {
                    (
                        format!(
                            "talkers {one} and {other} disagree: their {quantity} at the same time are {amount} apart"
                        ),
                        format!(
                            "one instrument: say which one with the key talker, such as talker = \"{other}\""
                        ),
                    )
                };
                Err(NmeaProblem::Contradiction { line: None, what, expected })
            }
        }
    }
}

/// What a sentence says.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sentence {
    pub(super) talker: Talker,
    pub(super) of_day_ns: Option<i64>,
    pub(super) day_ns: Option<i64>,
    /// True for a ZDA.
    pub(super) is_date_alone: bool,
    pub(super) position: Option<Said<2>>,
    pub(super) height_m: Option<Said<1>>,
    pub(super) velocity_mps: Option<Said<2>>,
    pub(super) attitude_rad: Option<Said<3>>,
    /// Heading of a sentence without a time.
    pub(super) heading: Option<HeadingSaid>,
    /// Talker of a sentence that has a heading, also of one that isn't valid.
    pub(super) heading_talker: Option<Talker>,
    /// Quality of the headings of PSXN,23 behind it.
    pub(super) heading_quality: Option<u8>,
    /// Standard deviations of latitude and longitude, m, and of the attitude, rad.
    pub(super) sigma_m: Option<[f64; 2]>,
    pub(super) attitude_sigma_rad: Option<[f64; 3]>,
    /// Quality of a position, in the words of the standard.
    pub(super) quality: Option<&'static str>,
    /// True for a sentence of a position, also of one that isn't valid.
    pub(super) tells_position: bool,
    /// True for a position or heading of dead reckoning.
    pub(super) is_estimated: bool,
    /// Reason why nothing of it but its time counts.
    pub(super) left_out: Option<&'static str>,
}

/// What the mode letters of a sentence say: the best of several systems.
enum Mode {
    Fix(&'static str),
    Estimated(&'static str),
    LeftOut(&'static str),
}

impl Mode {
    /// Mode of the field with the quality of a GGA.
    fn of_quality(field: &str) -> Self {
        match field {
            "1" => Self::Fix("quality 1 (GNSS)"),
            "2" => Self::Fix("quality 2 (differential)"),
            "3" => Self::Fix("quality 3 (PPS)"),
            "4" => Self::Fix("quality 4 (RTK, fixed)"),
            "5" => Self::Fix("quality 5 (RTK, float)"),
            "6" => Self::Estimated("quality 6 (estimated, dead reckoning)"),
            "7" | "8" => Self::LeftOut(NO_MEASUREMENT),
            // Some receivers have numbers of their own above these.
            _ if field.parse::<u8>().is_ok_and(|number| number > 8) => Self::Fix("another quality"),
            _ => Self::LeftOut(NO_FIX),
        }
    }

    /// Mode of letters, one for each system; a field that isn't there says nothing.
    fn of_letters(field: &str) -> Self {
        let has = |letters: &[u8]| field.bytes().any(|letter| letters.contains(&letter));
        if field.is_empty() {
            Self::Fix("no stated mode")
        } else if has(b"RF") {
            Self::Fix("mode R or F (RTK)")
        } else if has(b"DP") {
            Self::Fix("mode D or P (differential, precise)")
        } else if has(b"A") {
            Self::Fix("mode A (autonomous)")
        } else if has(b"E") {
            Self::Estimated("mode E (estimated, dead reckoning)")
        } else if has(b"MS") {
            Self::LeftOut(NO_MEASUREMENT)
        } else {
            Self::LeftOut(NO_FIX)
        }
    }
}

impl Sentence {
    /// Reads a line.
    ///
    /// # Errors
    /// The reason why it has no sentence that counts here.
    pub(super) fn of(line: &str) -> Result<Self, &'static str> {
        // Loggers write stamps of their own before a sentence.
        let framed = Framed::of(line)?;
        let found = Self::of_body(framed.body);
        match found {
            // Only what would count is worth a checksum.
            Ok(_) | Err(UNREADABLE) if !framed.summed => Err(UNSUMMED),
            found => found,
        }
    }

    fn of_body(body: &str) -> Result<Self, &'static str> {
        let (name, fields) = body.split_once(',').ok_or(OTHER_KINDS)?;
        let fields: Vec<&str> = fields.split(',').collect();
        let (talker, kind) = match name {
            "PASHR" => ("", name),
            _ => name
                .len()
                .checked_sub(3)
                .and_then(|at| name.split_at_checked(at))
                .ok_or(OTHER_KINDS)?,
        };
        let kinds = ["GGA", "GNS", "GLL", "RMC", "ZDA", "VTG", "GST", "PASHR"];
        if !kinds.contains(&kind) {
            return match Heard::of(name, &fields) {
                Some(Ok(heard)) => Ok(Self::of_heading(name, talker, heard)),
                Some(Err(reason)) => Err(reason),
                None => Err(unscored(name)),
            };
        }
        let sentence = Self::of_fields(Talker::of(talker), kind, &fields).ok_or(UNREADABLE)?;
        // A sentence with a time that can't be read must not go to the point before it.
        let needs_time = kind != "VTG";
        let tells_position = matches!(kind, "GGA" | "GNS" | "GLL" | "RMC");
        let sentence = Self { tells_position, ..sentence };
        if needs_time && sentence.of_day_ns.is_none() { Err(UNREADABLE) } else { Ok(sentence) }
    }

    fn of_heading(name: &str, letters: &str, heard: Heard) -> Self {
        let is_own = name.starts_with('P');
        // A maker's sentence has no talker.
        let talker = if is_own { Talker::default() } else { Talker::of(letters) };
        let said = Self {
            talker,
            heading_talker: Some(if is_own { Talker::of(name) } else { talker }),
            ..Self::default()
        };
        match heard {
            Heard::Heading(heading) => {
                Self { heading: Some(heading), is_estimated: heading.is_estimated, ..said }
            }
            Heard::Quality(quality) => Self { heading_quality: Some(quality), ..said },
            Heard::LeftOut(reason) => Self { left_out: Some(reason), ..said },
        }
    }

    fn of_fields(talker: Talker, kind: &str, fields: &[&str]) -> Option<Self> {
        let field = |index: usize| fields.get(index).copied().unwrap_or_default();
        let number = |index: usize| field(index).parse::<f64>().ok().filter(|x| x.is_finite());
        let named = Talker::of(kind);
        let position = |at: usize| {
            let value = [angle(field(at), field(at + 1))?, angle(field(at + 2), field(at + 3))?];
            let resolution = [at, at + 2].map(|at| (last_digit(field(at)) / 60.0).to_radians());
            Some(Said { value, resolution, talker, kind: named })
        };
        let velocity = |speed: usize, course: usize| {
            let speed_mps = number(speed)? * KNOT_MPS;
            // At rest there is no course.
            let course_deg = number(course).or((speed_mps == 0.0).then_some(0.0))?;
            let (sine, cosine) = libm::sincos(course_deg.to_radians());
            let turned_mps = speed_mps.abs() * last_digit(field(course)).to_radians();
            let resolution = [last_digit(field(speed)) * KNOT_MPS + turned_mps; 2];
            let value = [speed_mps * cosine, speed_mps * sine];
            Some(Said { value, resolution, talker, kind: named })
        };
        let at = |index: usize| Self { talker, of_day_ns: of_day(field(index)), ..Self::default() };
        Some(match kind {
            "GGA" | "GNS" => {
                let mode = match kind {
                    "GGA" => Mode::of_quality(field(5)),
                    // Without a mode there is no fix.
                    _ if field(5).is_empty() => Mode::LeftOut(NO_FIX),
                    _ => Mode::of_letters(field(5)),
                };
                let separation = if kind == "GGA" { 10 } else { 9 };
                let height_m = number(8).zip(number(separation)).map(|(above_geoid, geoid)| Said {
                    value: [above_geoid + geoid],
                    resolution: [last_digit(field(8)) + last_digit(field(separation))],
                    talker,
                    kind: named,
                });
                Self { position: position(1), height_m, ..at(0) }.with(mode)
            }
            "GLL" => {
                let mode = match field(5) {
                    "A" => Mode::of_letters(field(6)),
                    _ => Mode::LeftOut(NO_FIX),
                };
                Self { position: position(0), ..at(4) }.with(mode)
            }
            "RMC" => {
                let mode = match field(1) {
                    "A" => Mode::of_letters(field(11)),
                    _ => Mode::LeftOut(NO_FIX),
                };
                let day_ns = short_date(field(8));
                let velocity_mps = velocity(6, 7);
                Self { day_ns, position: position(2), velocity_mps, ..at(0) }.with(mode)
            }
            "ZDA" => {
                let day = |index: usize| field(index).parse::<i64>().ok();
                let day_ns = date(day(3)?, day(2)?, day(1)?);
                Self { day_ns, is_date_alone: true, ..at(0) }
            }
            "VTG" => {
                let velocity_mps = Some(velocity(4, 0)?);
                let found = Self { talker, velocity_mps, ..Self::default() };
                found.with(Mode::of_letters(field(8)))
            }
            "GST" => Self { sigma_m: Some([number(5)?, number(6)?]), ..at(0) },
            _ => {
                let value = [number(3)?, number(4)?, number(1)?].map(f64::to_radians);
                let resolution = [3, 4, 1].map(|index| last_digit(field(index)).to_radians());
                let sigma = number(6).zip(number(7)).zip(number(8));
                let attitude_sigma_rad = sigma
                    .map(|((roll, pitch), heading)| [roll, pitch, heading].map(f64::to_radians));
                let attitude_rad = Some(Said { value, resolution, talker, kind: named });
                Self { attitude_rad, attitude_sigma_rad, ..at(0) }
            }
        })
    }

    /// The sentence, with as much as its mode allows.
    fn with(self, mode: Mode) -> Self {
        let has_position = self.position.is_some();
        match mode {
            Mode::Fix(quality) => Self { quality: has_position.then_some(quality), ..self },
            Mode::Estimated(quality) => {
                let quality = has_position.then_some(quality);
                Self { quality, is_estimated: true, ..self }
            }
            Mode::LeftOut(reason) => self.without(reason),
        }
    }

    /// The time of the sentence alone, and the reason.
    pub(super) fn without(self, reason: &'static str) -> Self {
        let Self { talker, of_day_ns, day_ns, is_date_alone, .. } = self;
        let left_out = Some(reason);
        Self { talker, of_day_ns, day_ns, is_date_alone, left_out, ..Self::default() }
    }
}

/// An angle of degrees and minutes with a letter, rad.
fn angle(text: &str, letter: &str) -> Option<f64> {
    let point = text.find('.').unwrap_or(text.len());
    let (degrees, minutes) = text.split_at_checked(point.checked_sub(2)?)?;
    let degrees: f64 = if degrees.is_empty() { 0.0 } else { degrees.parse().ok()? };
    let minutes: f64 = minutes.parse().ok().filter(|minutes| (0.0..60.0).contains(minutes))?;
    let sign = match letter {
        "N" | "E" => 1.0,
        "S" | "W" => -1.0,
        _ => return None,
    };
    Some((sign * (degrees + minutes / 60.0)).to_radians())
}

/// Time of day of `hhmmss.ss`, ns.
fn of_day(text: &str) -> Option<i64> {
    let whole = |range: std::ops::Range<usize>| text.get(range)?.parse::<u8>().ok();
    let (hours, minutes) = (whole(0..2)?, whole(2..4)?);
    let seconds_ns = i64::try_from(decimal_ns(text.get(4..)?, 9)?).ok()?;
    // A leap second is the 61st.
    let sound = hours < 24 && minutes < 60 && seconds_ns < 61 * SECOND_NS;
    sound.then(|| (i64::from(hours) * 3600 + i64::from(minutes) * 60) * SECOND_NS + seconds_ns)
}

/// Day of `ddmmyy`, ns since 1970.
fn short_date(text: &str) -> Option<i64> {
    let part = |range: std::ops::Range<usize>| text.get(range)?.parse::<i64>().ok();
    let (day, month, year) = (part(0..2)?, part(2..4)?, part(4..6)?);
    // Two digits: GPS began in 1980.
    date(if year >= 80 { 1900 + year } else { 2000 + year }, month, day)
}

fn date(year: i64, month: i64, day: i64) -> Option<i64> {
    let text = format!("{year:04}-{month:02}-{day:02}T00:00:00Z");
    let since = octant_base::utc::parse(&text).ok()?.duration_since(std::time::UNIX_EPOCH).ok()?;
    i64::try_from(since.as_nanos()).ok()
}

#[cfg(test)]
mod tests {
    use super::super::words::DAMAGED;
    use super::*;

    #[test]
    fn sentences_are_read_as_the_standard_has_them() {
        // Checksums by `printf %s … | xor`, values by hand.
        let gga = "$GPGGA,092750.000,5321.6802,N,00630.3372,W,1,8,1.03,61.7,M,55.2,M,,*76";
        let found = Sentence::of(gga).unwrap();
        assert_eq!(found.of_day_ns, Some((9 * 3600 + 27 * 60 + 50) * SECOND_NS));
        let [latitude, longitude] = found.position.unwrap().value.map(f64::to_degrees);
        assert!((latitude - (53.0 + 21.6802 / 60.0)).abs() < 1e-12);
        assert!((longitude + (6.0 + 30.3372 / 60.0)).abs() < 1e-12);
        assert!((found.height_m.unwrap().value[0] - 116.9).abs() < 1e-12);
        let rmc = "$GPRMC,092750.000,A,5321.6802,N,00630.3372,W,0.02,31.66,280511,,,A*43";
        let found = Sentence::of(rmc).unwrap();
        // 28 May 2011.
        assert_eq!(found.day_ns, Some(1_306_540_800 * SECOND_NS));
        let [north, east] = found.velocity_mps.unwrap().value;
        let speed = 0.02 * 1852.0 / 3600.0;
        assert!((libm::hypot(north, east) - speed).abs() < 1e-15 && east > 0.0);
        assert!(
            Sentence::of(&gga.replace("*76", "*77")).err() == Some(DAMAGED),
            "a wrong checksum"
        );
        assert!(Sentence::of(&format!("2011-05-28 09:27:51 {gga}")).is_ok(), "a logger's stamp");
    }

    #[test]
    fn angles_and_times_that_are_none_are_refused() {
        assert_eq!(angle("5361.0", "N"), None);
        assert_eq!(angle("1", "N"), None);
        assert_eq!(angle("5321.0", "X"), None);
        assert_eq!(of_day("246060"), None);
        assert_eq!(of_day("2359"), None);
        assert_eq!(short_date("320111"), None);
    }
}
