//! Sentences of NMEA 0183 (IEC 61162-1): position, speed and course, and the attitude of PASHR.
//!
//! Sentences with the same time of day belong to one point: GGA, GNS, GLL and RMC give the position, RMC and VTG the
//! velocity, PASHR roll, pitch and heading. Of several that say the same the finest counts. The date comes with RMC and
//! ZDA; a ZDA begins no point, since some receivers send that of the next second early. A point without a valid position is
//! left out.
//!
//! A VTG has no time. Receivers send it in every cycle at the same place, before the positions of its time or after them.
//! Which, is learned from the beginning of the file: its velocities are those of the positions around the one or the other.
//!
//! Several talkers may give the same quantity at the same time, as the parts of one receiver do. Where they differ by more
//! than their last digits, they are different instruments, and the file is refused with their names.

mod sentence;

use self::sentence::{Said, Sentence, lacks_checksum};
use super::point::{LINE_BYTES_MAX, Points, SECOND_NS, TimeScale, TrajectoryPoint};
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek};

const DAY_NS: i64 = 86_400 * SECOND_NS;
/// Radius for distances in messages, m.
const EARTH_RADIUS_M: f64 = 6.371e6;

/// Lines within which a file has to show what it is.
const LINES_TO_LOOK_AT: u64 = 10_000;
/// Fewest velocities that tell to which positions they belong.
const VELOCITIES_LEAST: u32 = 5;

pub(crate) struct NmeaReader {
    lines: NmeaLines,
    /// Day of the last sentence with a time, ns since 1970, and its time of day.
    day_ns: i64,
    last_of_day_ns: Option<i64>,
    begun: Option<Begun>,
    /// True if a VTG belongs to the point after it; then the one that waits for it.
    velocity_leads: bool,
    waits: Option<Said<2>>,
    heard_ns: Option<i64>,
}

/// A point whose sentences are still coming.
#[derive(Clone, Copy, Debug, Default)]
struct Begun {
    of_day_ns: i64,
    day_ns: i64,
    position: Option<Said<2>>,
    height_m: Option<Said<1>>,
    velocity_mps: Option<Said<2>>,
    attitude_rad: Option<[f64; 3]>,
}

impl NmeaReader {
    pub(crate) fn new(file: File) -> Result<Self, String> {
        let mut lines = NmeaLines::new(file);
        let first_day_ns = first_day(&mut lines)?;
        let mut file = lines.file.into_inner();
        file.rewind().map_err(|error| error.to_string())?;
        let mut lines = NmeaLines::new(file);
        let velocity_leads = velocity_leads(&mut lines)?;
        let mut file = lines.file.into_inner();
        file.rewind().map_err(|error| error.to_string())?;
        Ok(Self {
            lines: NmeaLines::new(file),
            day_ns: first_day_ns,
            last_of_day_ns: None,
            begun: None,
            velocity_leads,
            waits: None,
            heard_ns: None,
        })
    }

    /// Takes a sentence; returns the point that it ends.
    ///
    /// # Errors
    /// If its talker contradicts another one.
    fn take(&mut self, sentence: &Sentence) -> Result<Option<TrajectoryPoint>, String> {
        let mut ended = None;
        if let Some(of_day_ns) = sentence.of_day_ns {
            let midnight = |last_ns: i64| of_day_ns + DAY_NS / 2 < last_ns;
            self.day_ns = match sentence.day_ns {
                Some(day_ns) => day_ns,
                None if self.last_of_day_ns.is_some_and(midnight) => self.day_ns + DAY_NS,
                None => self.day_ns,
            };
            self.last_of_day_ns = Some(of_day_ns);
            self.heard_ns = self.heard_ns.max(Some(self.day_ns + of_day_ns));
            if sentence.is_date_alone {
                return Ok(None);
            }
            let day_ns = self.day_ns;
            match &mut self.begun {
                Some(begun) if begun.of_day_ns == of_day_ns => begun.day_ns = day_ns,
                begun => {
                    ended = begun.take().and_then(|begun| begun.point());
                    let velocity_mps = self.waits.take();
                    *begun = Some(Begun { of_day_ns, day_ns, velocity_mps, ..Begun::default() });
                }
            }
        } else if self.velocity_leads {
            self.waits = sentence.velocity_mps;
            return Ok(None);
        }
        if let Some(begun) = &mut self.begun {
            Said::keep(&mut begun.position, sentence.position, "positions", |one, other| {
                let [north, east] = [0, 1].map(|axis| one.value[axis] - other.value[axis]);
                let east = east * libm::cos(one.value[0]);
                format!("{:.1} m", libm::hypot(north, east) * EARTH_RADIUS_M)
            })?;
            Said::keep(&mut begun.height_m, sentence.height_m, "heights", |one, other| {
                format!("{:.2} m", (one.value[0] - other.value[0]).abs())
            })?;
            Said::keep(
                &mut begun.velocity_mps,
                sentence.velocity_mps,
                "velocities",
                |one, other| {
                    let [north, east] = [0, 1].map(|axis| one.value[axis] - other.value[axis]);
                    format!("{:.2} m/s", libm::hypot(north, east))
                },
            )?;
            begun.attitude_rad = begun.attitude_rad.or(sentence.attitude_rad);
        }
        Ok(ended)
    }
}

impl Begun {
    /// The point, where it has a position.
    fn point(&self) -> Option<TrajectoryPoint> {
        let [latitude_rad, longitude_rad] = self.position?.value;
        Some(TrajectoryPoint {
            time_ns: self.day_ns + self.of_day_ns,
            latitude_rad,
            longitude_rad,
            height_m: self.height_m.map_or(0.0, |height| height.value[0]),
            velocity_mps: self.velocity_mps.map(|velocity| velocity.value),
            attitude_rad: self.attitude_rad,
        })
    }
}

impl Points for NmeaReader {
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String> {
        loop {
            if !self.lines.advance()? {
                return Ok(self.begun.take().and_then(|begun| begun.point()));
            }
            let text = std::mem::take(&mut self.lines.text);
            let ended = match Sentence::of(&text) {
                Some(sentence) => self
                    .take(&sentence)
                    .map_err(|reason| format!("line {}: {reason}", self.lines.line))?,
                None => None,
            };
            self.lines.text = text;
            if ended.is_some() {
                return Ok(ended);
            }
        }
    }

    fn place(&self) -> String {
        format!("line {}", self.lines.line)
    }

    fn scale(&self) -> TimeScale {
        TimeScale::Utc
    }

    fn heard_ns(&self) -> Option<i64> {
        self.heard_ns
    }

    fn choice(&self) -> Option<&'static str> {
        self.velocity_leads.then_some(
            "each VTG goes to the position after it: its velocities fit the change of position there, not before it",
        )
    }
}

/// Finds the day of the first point.
fn first_day(lines: &mut NmeaLines) -> Result<i64, String> {
    let mut first_ns = None;
    let (mut sentences, mut unsummed) = (0_u64, 0_u64);
    while lines.advance()? && (sentences > 0 || lines.line <= LINES_TO_LOOK_AT) {
        let Some(sentence) = Sentence::of(&lines.text) else {
            unsummed += u64::from(lacks_checksum(&lines.text));
            continue;
        };
        sentences += 1;
        let first_ns = *first_ns.get_or_insert(sentence.of_day_ns.unwrap_or_default());
        if let (Some(day_ns), Some(of_day_ns)) = (sentence.day_ns, sentence.of_day_ns) {
            // Sentences of the evening may come before the first date of the next morning.
            let evening = of_day_ns + DAY_NS / 2 < first_ns;
            return Ok(if evening { day_ns - DAY_NS } else { day_ns });
        }
    }
    Err(if sentences == 0 && unsummed > 0 {
        format!(
            "found {unsummed} sentences without a checksum, expected each to end in * and two hexadecimal digits, the exclusive or of \
             the characters between $ and *: have the receiver or the logger write them; without, a damaged sentence can't be told"
        )
    } else if sentences == 0 {
        "found no sentence of NMEA 0183 with a position, a speed or an attitude, and a right checksum"
            .to_owned()
    } else {
        format!("found {sentences} sentences and no date, expected an RMC or a ZDA")
    })
}

/// Learns whether the velocities without a time belong to the positions after them: those of the positions before and after
/// each tell.
fn velocity_leads(lines: &mut NmeaLines) -> Result<bool, String> {
    let mut points: Vec<(i64, [f64; 2])> = Vec::new();
    // Velocities with the number of points before them.
    let mut velocities: Vec<(usize, [f64; 2])> = Vec::new();
    while lines.advance()? && lines.line <= LINES_TO_LOOK_AT {
        let Some(sentence) = Sentence::of(&lines.text) else { continue };
        match (sentence.of_day_ns, sentence.position, sentence.velocity_mps) {
            (Some(at_ns), Some(position), _)
                if points.last().is_none_or(|(last_ns, _)| *last_ns != at_ns) =>
            {
                points.push((at_ns, position.value));
            }
            (None, _, Some(velocity)) => velocities.push((points.len(), velocity.value)),
            _ => {}
        }
    }
    let moved = |point: usize| {
        let ((from_ns, from), (to_ns, to)) =
            (points.get(point.checked_sub(1)?)?, points.get(point + 1)?);
        let elapsed_s = (to_ns - from_ns) as f64 / SECOND_NS as f64;
        let north_mps = (to[0] - from[0]) * EARTH_RADIUS_M / elapsed_s;
        let east_mps = (to[1] - from[1]) * libm::cos(from[0]) * EARTH_RADIUS_M / elapsed_s;
        (elapsed_s > 0.0).then_some([north_mps, east_mps])
    };
    let (mut before, mut after, mut compared) = (0.0, 0.0, 0);
    for (points_before, velocity) in &velocities {
        let Some(last) = points_before.checked_sub(1) else { continue };
        let (Some(of_last), Some(of_next)) = (moved(last), moved(last + 1)) else { continue };
        let off = |moved: [f64; 2]| {
            let [north, east] = [0, 1].map(|axis| velocity[axis] - moved[axis]);
            north * north + east * east
        };
        (before, after, compared) = (before + off(of_last), after + off(of_next), compared + 1);
    }
    // Without a change of velocity the two say the same.
    Ok(compared >= VELOCITIES_LEAST && after < 0.5 * before)
}

struct NmeaLines {
    file: BufReader<File>,
    text: String,
    line: u64,
    bytes: Vec<u8>,
}

impl NmeaLines {
    fn new(file: File) -> Self {
        let file = BufReader::with_capacity(1 << 16, file);
        Self { file, text: String::new(), line: 0, bytes: Vec::new() }
    }

    /// Reads the next line; `false` at the end. Loggers mix in bytes that aren't text.
    fn advance(&mut self) -> Result<bool, String> {
        self.bytes.clear();
        self.line += 1;
        let read = (&mut self.file).take(LINE_BYTES_MAX).read_until(b'\n', &mut self.bytes);
        let read = read.map_err(|error| format!("line {}: {error}", self.line))?;
        self.text.clear();
        self.text.push_str(&String::from_utf8_lossy(&self.bytes));
        Ok(read > 0)
    }
}
