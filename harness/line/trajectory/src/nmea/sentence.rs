//! One sentence of NMEA 0183, and what talkers say of one quantity.

use crate::point::SECOND_NS;
use octant_base::decimal::decimal_ns;
use octant_earth::units::NAUTICAL_MILE_M;

const KNOT_MPS: f64 = NAUTICAL_MILE_M / 3600.0;

/// A quantity as a talker gave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Said<const N: usize> {
    pub(super) value: [f64; N],
    /// Change of the values by one in their last digits.
    resolution: [f64; N],
    talker: Talker,
}

impl<const N: usize> Said<N> {
    /// Index of a value in which another talker differs by more than the last digits of both.
    fn differs(&self, other: &Self) -> Option<usize> {
        if self.talker == other.talker {
            return None;
        }
        (0..N).find(|&index| {
            let most = self.resolution[index] + other.resolution[index];
            (self.value[index] - other.value[index]).abs() > most
        })
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
    ) -> Result<(), String> {
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
            Some(_) => Err(format!(
                "talkers {} and {} disagree: their {quantity} at the same time are {} apart, expected one instrument: \
                 write the sentences of each talker into a file of its own, and name the one to use",
                first.talker,
                said.talker,
                amount(first, &said)
            )),
        }
    }
}

/// Talker of a sentence: the letters before its kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Talker([u8; 4]);

impl Talker {
    fn of(letters: &str) -> Self {
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

/// Returns whether a line has a sentence that would count if it had a checksum.
pub(super) fn lacks_checksum(line: &str) -> bool {
    let Some((_, body)) = line.trim_end().rsplit_once('$') else { return false };
    if body.contains('*') {
        return false;
    }
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    Sentence::of(&format!("${body}*{sum:02X}")).is_some()
}

/// What a sentence says.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sentence {
    pub(super) of_day_ns: Option<i64>,
    pub(super) day_ns: Option<i64>,
    /// True for a ZDA.
    pub(super) is_date_alone: bool,
    pub(super) position: Option<Said<2>>,
    pub(super) height_m: Option<Said<1>>,
    pub(super) velocity_mps: Option<Said<2>>,
    pub(super) attitude_rad: Option<[f64; 3]>,
}

impl Sentence {
    /// Reads a line; `None` if it has no sentence that counts here, or a damaged one.
    pub(super) fn of(line: &str) -> Option<Self> {
        // Loggers write stamps of their own before a sentence.
        let body = &line[line.rfind('$')? + 1..];
        let (body, checksum) = body.trim_end().rsplit_once('*')?;
        let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
        if u8::from_str_radix(checksum, 16).ok()? != sum {
            return None;
        }
        let (kind, fields) = body.split_once(',')?;
        let fields: Vec<&str> = fields.split(',').collect();
        let (talker, kind) = match kind {
            "PASHR" => ("P", kind),
            _ => kind.split_at_checked(kind.len().checked_sub(3)?)?,
        };
        let talker = Talker::of(talker);
        let field = |index: usize| fields.get(index).copied().unwrap_or_default();
        let number = |index: usize| field(index).parse::<f64>().ok().filter(|x| x.is_finite());
        let position = |at: usize| {
            let value = [angle(field(at), field(at + 1))?, angle(field(at + 2), field(at + 3))?];
            let resolution = [at, at + 2].map(|at| (last_digit(field(at)) / 60.0).to_radians());
            Some(Said { value, resolution, talker })
        };
        let of_day_ns = |index: usize| of_day(field(index));
        let velocity = |speed: usize, course: usize| {
            let speed_mps = number(speed)? * KNOT_MPS;
            // At rest there is no course.
            let course_deg = number(course).or((speed_mps == 0.0).then_some(0.0))?;
            let (sine, cosine) = libm::sincos(course_deg.to_radians());
            let turned_mps = speed_mps.abs() * last_digit(field(course)).to_radians();
            let resolution = [last_digit(field(speed)) * KNOT_MPS + turned_mps; 2];
            Some(Said { value: [speed_mps * cosine, speed_mps * sine], resolution, talker })
        };
        let none = Self::default();
        let sentence = match kind {
            "GGA" | "GNS" => {
                let is_fix = match kind {
                    "GGA" => number(5).is_some_and(|quality| quality > 0.0),
                    _ => field(5).bytes().any(|mode| mode != b'N'),
                };
                let separation = if kind == "GGA" { 10 } else { 9 };
                let height_m = number(8).zip(number(separation)).map(|(above_geoid, geoid)| Said {
                    value: [above_geoid + geoid],
                    resolution: [last_digit(field(8)) + last_digit(field(separation))],
                    talker,
                });
                let position = position(1).filter(|_| is_fix);
                Self { of_day_ns: of_day_ns(0), position, height_m, ..none }
            }
            "GLL" => {
                let position = position(0).filter(|_| field(5) == "A");
                Self { of_day_ns: of_day_ns(4), position, ..none }
            }
            "RMC" => {
                let valid = field(1) == "A";
                Self {
                    of_day_ns: of_day_ns(0),
                    day_ns: short_date(field(8)),
                    position: position(2).filter(|_| valid),
                    velocity_mps: velocity(6, 7).filter(|_| valid),
                    ..none
                }
            }
            "ZDA" => {
                let day = |index: usize| field(index).parse::<i64>().ok();
                let day_ns = date(day(3)?, day(2)?, day(1)?);
                Self { of_day_ns: of_day_ns(0), day_ns, is_date_alone: true, ..none }
            }
            "VTG" => {
                let valid = !matches!(field(8), "N");
                Self { velocity_mps: velocity(4, 0).filter(|_| valid), ..none }
            }
            "PASHR" => {
                let [heading, roll, pitch] = [number(1)?, number(3)?, number(4)?];
                let attitude_rad = Some([roll, pitch, heading].map(f64::to_radians));
                Self { of_day_ns: of_day_ns(0), attitude_rad, ..none }
            }
            _ => return None,
        };
        // A sentence with a time that can't be read must not go to the point before it.
        let needs_time = kind != "VTG";
        (!needs_time || sentence.of_day_ns.is_some()).then_some(sentence)
    }
}

/// Change of a decimal number by one in its last digit.
fn last_digit(text: &str) -> f64 {
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len());
    libm::exp10(-(digits as f64))
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
        assert!(Sentence::of(&gga.replace("*76", "*77")).is_none(), "a wrong checksum");
        assert!(Sentence::of(&format!("2011-05-28 09:27:51 {gga}")).is_some(), "a logger's stamp");
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
