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
//! than their last digits, they are different instruments, and the file is refused with their names, unless one is chosen.
//!
//! HDT, THS and makers' sentences with a heading have no time, too: the first behind a position, or behind another sentence
//! of its time, is that of the position. [`headings`] reads headings alone, each as a point.
//!
//! Each line is counted: it belongs to a point, or is left out for a reason. A sentence of a time before the present point, as a
//! logger writes it that was late, is left out.

mod choice;
mod clock;
mod date;
mod framed;
mod heading;
mod headings;
mod lines;
mod problem;
mod sentence;
mod velocity;
mod words;

pub use self::framed::tag_time_ns;

use self::choice::chosen;
use self::date::{DAY_NS, LINES_TO_LOOK_AT, first_day};
use self::heading::{HeadingSaid, PsxnQuality};
use self::headings::HeadingReader;
use self::lines::NmeaLines;
use self::problem::NmeaProblem;
use self::sentence::{Said, Sentence};
use self::velocity::velocity_leads;
use super::point::{
    GeodeticPosition, PointAttitude, PointSigma, Points, TimeScale, TrajectoryPoint,
};
use super::tally::{OUT_OF_ORDER, Tally};
use octant_scenario::trajectory::{NmeaChoice, NmeaPoints};
use std::fs::File;

/// Radius for distances in messages, m.
const EARTH_RADIUS_M: f64 = 6.371e6;

pub(crate) struct NmeaReader {
    lines: NmeaLines,
    choice: NmeaChoice,
    /// Day of the last sentence with a time, ns since 1970, and its time of day.
    day_ns: i64,
    last_of_day_ns: Option<i64>,
    begun: Option<Begun>,
    /// Time of the last point that was given.
    given_ns: Option<i64>,
    /// True if a VTG belongs to the point after it; then the one that waits for it.
    velocity_leads: bool,
    waits: Option<Said<2>>,
    heard_ns: Option<i64>,
    /// Time between the last two points: a heading without a time is off by less.
    apart_ns: Option<i64>,
    quality: PsxnQuality,
    tally: Tally,
}

/// A point whose sentences are still coming.
#[derive(Clone, Copy, Debug, Default)]
struct Begun {
    time_ns: i64,
    of_day_ns: i64,
    /// Sentences that said something of it, and the line of the first.
    sentences: u64,
    line: u64,
    position: Option<Said<2>>,
    height_m: Option<Said<1>>,
    velocity_mps: Option<Said<2>>,
    attitude_rad: Option<Said<3>>,
    heading: Option<HeadingSaid>,
    sigma_m: Option<[f64; 2]>,
    attitude_sigma_rad: Option<[f64; 3]>,
    quality: Option<&'static str>,
}

const FURTHER: &str = "velocities without a time, besides the first of their position";
const FURTHER_HEADING: &str = "headings without a time, besides the first behind their position";
const NO_POSITION: &str = "sentences of times without a position";

/// Opens a file: its positions make a point each, or its headings.
///
/// # Errors
/// If it has none, or nothing tells their times.
pub(crate) fn open(file: File, choice: &NmeaChoice) -> Result<Box<dyn Points>, NmeaProblem> {
    let mut lines = NmeaLines::new(file);
    let points = match choice.points {
        Some(points) => points,
        None => points(&mut lines)?.unwrap_or(match choice.heading_time {
            Some(_) => NmeaPoints::Headings,
            None => NmeaPoints::Positions,
        }),
    };
    let file = lines.again()?.into_file();
    if points == NmeaPoints::Headings {
        return Ok(Box::new(HeadingReader::new(file, choice)?));
    }
    if choice.heading_time.is_some() {
        return Err(NmeaProblem::found(
            "positions, each with the heading behind it, and a time for headings alone",
            "points = \"headings\" or no heading_time and no heading_rate",
        ));
    }
    Ok(Box::new(NmeaReader::new(file, choice)?))
}

/// Sentences of a file that make a point each: positions, where it has some. `None`: it has neither positions nor headings.
fn points(lines: &mut NmeaLines) -> Result<Option<NmeaPoints>, NmeaProblem> {
    let mut found = None;
    while lines.advance()? && lines.line <= LINES_TO_LOOK_AT {
        let Ok(sentence) = Sentence::of(&lines.text) else { continue };
        if sentence.tells_position {
            return Ok(Some(NmeaPoints::Positions));
        }
        if sentence.heading_talker.is_some() || sentence.attitude_rad.is_some() {
            found = Some(NmeaPoints::Headings);
        }
    }
    Ok(found)
}

impl NmeaReader {
    pub(crate) fn new(file: File, choice: &NmeaChoice) -> Result<Self, NmeaProblem> {
        let mut lines = NmeaLines::new(file);
        let first_day_ns = first_day(&mut lines)?;
        let mut lines = lines.again()?;
        let velocity_leads = velocity_leads(&mut lines, choice)?;
        Ok(Self {
            lines: lines.again()?,
            choice: choice.clone(),
            day_ns: first_day_ns,
            last_of_day_ns: None,
            begun: None,
            given_ns: None,
            velocity_leads,
            waits: None,
            heard_ns: None,
            apart_ns: None,
            quality: PsxnQuality::default(),
            tally: Tally::default(),
        })
    }

    /// Counts the present line as left out.
    fn leave_out(&mut self, reason: &'static str) {
        let line = self.lines.line;
        self.tally.left_out(1, reason, || format!("line {line}"));
    }

    /// Day of a time of day: that of the sentence, else the one that brings it nearest to the time before.
    fn day_of(&self, sentence: &Sentence, of_day_ns: i64) -> i64 {
        let nearest = |last_ns: i64| match of_day_ns - last_ns {
            after if after < -DAY_NS / 2 => self.day_ns + DAY_NS,
            after if after > DAY_NS / 2 => self.day_ns - DAY_NS,
            _ => self.day_ns,
        };
        sentence.day_ns.unwrap_or_else(|| self.last_of_day_ns.map_or(self.day_ns, nearest))
    }

    /// Takes a sentence; returns the point that it ends.
    ///
    /// # Errors
    /// If its talker contradicts another one.
    fn take(&mut self, sentence: Sentence) -> Result<Option<TrajectoryPoint>, NmeaProblem> {
        let mut sentence = chosen(sentence, &self.choice);
        if let Some(quality) = sentence.heading_quality {
            self.quality.take(quality);
            self.tally.used(1);
            return Ok(None);
        }
        if let Some(said) = sentence.heading {
            match self.quality.judged(said) {
                Ok(said) => sentence.heading = Some(said),
                Err(reason) => sentence = sentence.without(reason),
            }
        }
        let mut ended = None;
        if let Some(of_day_ns) = sentence.of_day_ns {
            let day_ns = self.day_of(&sentence, of_day_ns);
            let time_ns = day_ns + of_day_ns;
            // The point that a position has fixed in time, or the one before.
            let fixed_ns = self.begun.filter(|begun| begun.position.is_some());
            let fixed_ns = fixed_ns.map(|begun| begun.time_ns).or(self.given_ns);
            if let Some(fixed_ns) = fixed_ns.filter(|fixed_ns| time_ns < *fixed_ns) {
                let before_s = (fixed_ns - time_ns) as f64 * 1e-9;
                let line = self.lines.line;
                self.tally.left_out(1, OUT_OF_ORDER, || {
                    format!("line {line}: found a time {before_s:.9} s before the point before it")
                });
                return Ok(None);
            }
            (self.day_ns, self.last_of_day_ns) = (day_ns, Some(of_day_ns));
            self.heard_ns = self.heard_ns.max(Some(time_ns));
            if let Some(reason) = sentence.left_out {
                self.leave_out(reason);
            }
            if sentence.is_date_alone {
                if sentence.left_out.is_none() {
                    self.tally.used(1);
                }
                return Ok(None);
            }
            match &mut self.begun {
                Some(begun) if begun.of_day_ns == of_day_ns => begun.time_ns = time_ns,
                begun => {
                    let last = begun.take();
                    let velocity_mps = self.waits.take();
                    let sentences = u64::from(velocity_mps.is_some());
                    let line = self.lines.line;
                    *begun = Some(Begun {
                        time_ns,
                        of_day_ns,
                        velocity_mps,
                        sentences,
                        line,
                        ..Begun::default()
                    });
                    ended = last.and_then(|last| self.end(&last));
                }
            }
        } else if let Some(reason) = sentence.left_out {
            self.leave_out(reason);
        } else if self.velocity_leads && sentence.velocity_mps.is_some() {
            if self.waits.take().is_some() {
                self.leave_out(NO_POSITION);
            }
            self.waits = sentence.velocity_mps;
            return Ok(None);
        }
        match &mut self.begun {
            _ if sentence.left_out.is_some() => {}
            // A VTG has no time: of those that come more often than positions the first is that of the position.
            Some(begun) if sentence.of_day_ns.is_none() && begun.has_velocity_of(&sentence) => {
                self.leave_out(FURTHER);
            }
            Some(begun) if begun.has_heading_of(&sentence) => self.leave_out(FURTHER_HEADING),
            Some(begun) => begun.take(&sentence)?,
            None => self.leave_out(NO_POSITION),
        }
        Ok(ended)
    }

    /// Counts the sentences of a point that is complete; returns it, where it has a position.
    fn end(&mut self, begun: &Begun) -> Option<TrajectoryPoint> {
        let Some(point) = begun.point() else {
            let line = begun.line;
            self.tally.left_out(begun.sentences, NO_POSITION, || format!("line {line}"));
            return None;
        };
        self.tally.point(begun.sentences);
        self.tally.quality(begun.quality.unwrap_or("no stated mode"));
        self.apart_ns = self.given_ns.map(|given_ns| point.time_ns - given_ns).or(self.apart_ns);
        self.given_ns = Some(point.time_ns);
        // Where within a cycle its instrument measured isn't known.
        let is_timed = begun.heading.is_none() || begun.attitude_rad.is_some();
        let of_cycle_s = || self.apart_ns.unwrap_or(0) as f64 * 1e-9;
        // A heading of another time than its position is off by what the ship turns until then.
        let stated_s = self.choice.heading_delay.map(|by| by.delay_s.abs() + by.uncertainty_s);
        let doubt_s = if is_timed { 0.0 } else { stated_s.unwrap_or_else(of_cycle_s) };
        Some(TrajectoryPoint { attitude_doubt_s: doubt_s, ..point })
    }
}

impl Begun {
    /// Takes what a sentence says.
    ///
    /// # Errors
    /// If another one of this time contradicts it.
    fn take(&mut self, sentence: &Sentence) -> Result<(), NmeaProblem> {
        self.sentences += 1;
        let apart = |one: [f64; 2], other: [f64; 2]| [0, 1].map(|axis| one[axis] - other[axis]);
        Said::keep(&mut self.position, sentence.position, "positions", |one, other| {
            let [north, east] = apart(one.value, other.value);
            let east = east * libm::cos(one.value[0]);
            format!("{:.1} m", libm::hypot(north, east) * EARTH_RADIUS_M)
        })?;
        Said::keep(&mut self.height_m, sentence.height_m, "heights", |one, other| {
            format!("{:.2} m", (one.value[0] - other.value[0]).abs())
        })?;
        Said::keep(&mut self.velocity_mps, sentence.velocity_mps, "velocities", |one, other| {
            let [north, east] = apart(one.value, other.value);
            format!("{:.2} m/s", libm::hypot(north, east))
        })?;
        Said::keep(&mut self.attitude_rad, sentence.attitude_rad, "attitudes", |one, other| {
            let most = (0..3).map(|axis| (one.value[axis] - other.value[axis]).abs());
            format!("{:.3} deg", most.fold(0.0, f64::max).to_degrees())
        })?;
        HeadingSaid::keep(&mut self.heading, sentence.heading)?;
        self.sigma_m = self.sigma_m.or(sentence.sigma_m);
        self.attitude_sigma_rad = self.attitude_sigma_rad.or(sentence.attitude_sigma_rad);
        self.quality = self.quality.or(sentence.quality);
        Ok(())
    }

    /// Returns whether it has a velocity of the same talker and kind.
    fn has_velocity_of(&self, sentence: &Sentence) -> bool {
        let both = self.velocity_mps.zip(sentence.velocity_mps);
        both.is_some_and(|(there, said)| there.is_of_source(&said))
    }

    /// Returns whether it has a heading of the same instrument.
    fn has_heading_of(&self, sentence: &Sentence) -> bool {
        let both = self.heading.zip(sentence.heading);
        both.is_some_and(|(there, said)| {
            there.talker == said.talker && (there.has_mode || !said.has_mode)
        })
    }

    /// The point, where it has a position.
    fn point(&self) -> Option<TrajectoryPoint> {
        let [latitude_rad, longitude_rad] = self.position?.value;
        let height_m = self.height_m.map_or(0.0, |height| height.value[0]);
        // An attitude with a time counts before a heading without one.
        let (attitude, digit_rad) = match (self.attitude_rad, self.heading) {
            (Some(said), _) => (Some(PointAttitude::of(said.value)), said.resolution),
            (None, Some(said)) => (Some(said.attitude()), said.digit_rad),
            (None, None) => (None, [0.0; 3]),
        };
        let sigma = PointSigma {
            position_m: self.sigma_m,
            velocity_mps: None,
            attitude_rad: self.attitude_sigma_rad,
        };
        Some(TrajectoryPoint {
            time_ns: self.time_ns,
            position: Some(GeodeticPosition { latitude_rad, longitude_rad, height_m }),
            velocity_mps: self.velocity_mps.map(|velocity| velocity.value),
            attitude,
            sigma,
            digit_rad,
            attitude_doubt_s: 0.0,
        })
    }
}

impl Points for NmeaReader {
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String> {
        loop {
            if !self.lines.advance().map_err(|problem| problem.to_string())? {
                if self.waits.take().is_some() {
                    self.leave_out(NO_POSITION);
                }
                let last = self.begun.take();
                return Ok(last.and_then(|last| self.end(&last)));
            }
            let text = std::mem::take(&mut self.lines.text);
            let sentence = Sentence::of(&text);
            let is_blank = text.trim().is_empty();
            self.lines.text = text;
            let line = self.lines.line;
            let ended = match sentence {
                Ok(sentence) => {
                    self.take(sentence).map_err(|problem| problem.at(line).to_string())?
                }
                Err(_) if is_blank => None,
                Err(reason) => {
                    self.leave_out(reason);
                    None
                }
            };
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

    fn tally(&self) -> &Tally {
        &self.tally
    }

    fn tally_mut(&mut self) -> &mut Tally {
        &mut self.tally
    }

    fn unit(&self) -> [&'static str; 2] {
        ["line", "lines"]
    }

    fn heard_ns(&self) -> Option<i64> {
        self.heard_ns
    }

    fn looks_ahead(&self) -> bool {
        true
    }

    fn choices(&self) -> Vec<&'static str> {
        let leads = "each VTG goes to the position after it: its velocities fit the change of position there, not before it";
        self.velocity_leads.then_some(leads).into_iter().collect()
    }
}
