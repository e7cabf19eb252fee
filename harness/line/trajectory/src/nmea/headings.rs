//! Headings alone: each sentence with one makes a point.
//!
//! HDT, THS and makers' sentences have no time. It comes from the TAG block or the logger's stamp before each sentence, from
//! the cycle of the log, or from a rate that the user gives. In a cycle the sentences behind a time of day, up to the next
//! time, are spread evenly between both: where in a cycle an instrument measures isn't known, and each heading is in doubt by
//! the time from one to the next. After a gap the spacing of the cycle before holds.
//!
//! Headings that are invalid make no point, and keep their places.

use super::choice::OTHER_TALKERS;
use super::clock::{Answer, Cycle, Days, Group, Ready};
use super::date::{LINES_TO_LOOK_AT, all_unsummed, first_day};
use super::framed::{DAMAGED_TAG, Framed};
use super::heading::{ESTIMATED_HEADING, HeadingSaid, INVALID, PsxnQuality};
use super::lines::NmeaLines;
use super::problem::NmeaProblem;
use super::sentence::Sentence;
use super::words::{Talker, UNREADABLE, UNSUMMED};
use crate::point::{Points, SECOND_NS, TimeScale, TrajectoryPoint};
use crate::tally::Tally;
use octant_scenario::trajectory::{HeadingTime, NmeaChoice};
use std::collections::VecDeque;
use std::fs::File;

/// Most headings between two times of day.
const CYCLE_MAX: usize = 100_000;

const BEFORE_TIME: &str = "headings before the first time of day";
const BEHIND_TIME: &str = "headings behind the only time of day";
const NO_TAG_TIME: &str = "headings without a time in their TAG block";
const NO_STAMP: &str = "headings without a stamp of the logger";
const REPEATED: &str = "HDT sentences: the headings of THS beside them, without their mode";
const BESIDES: &str = "sentences of positions and speeds: headings alone are scored";

/// Reads the headings of one instrument.
pub(crate) struct HeadingReader {
    lines: NmeaLines,
    by: Source,
    fixes_alone: bool,
    /// True if an answer without a heading makes a point, too.
    tells_none: bool,
    clock: Clock,
    quality: PsxnQuality,
    ready: VecDeque<Ready>,
    tally: Tally,
    heard_ns: Option<i64>,
}

/// Which sentences are the headings, and which ones the clock.
#[derive(Clone, Copy, Debug)]
struct Source {
    talker: Talker,
    /// True if the instrument sends THS, which says the same as HDT with its mode.
    has_mode: bool,
    /// Talker of the sentences whose time of day counts.
    clock: Option<(Talker, bool)>,
    time: HeadingTime,
}

/// Source of the times of headings.
#[derive(Debug)]
enum Clock {
    Tag(Group),
    Stamp,
    Cycle(Box<Cycle>),
    Rate {
        period_ns: f64,
        start_ns: i64,
        count: u64,
    },
    /// Sentences with times of their own: PASHR.
    Own(Days),
}

/// Headings of one talker at the beginning of a file, and what tells their times.
#[derive(Clone, Copy, Debug)]
struct Found {
    talker: Talker,
    is_maker: bool,
    count: u64,
    has_mode: bool,
    /// Sentences with a time of their own, with one in their TAG block, and with a stamp before them.
    own: u64,
    tags: u64,
    stamps: u64,
}

impl Found {
    fn take(&mut self, sentence: &Sentence, framed: &Framed<'_>, has_mode: bool) {
        let tag = framed.tag().ok().flatten().and_then(|tag| tag.time_ns);
        self.count += 1;
        self.has_mode |= has_mode;
        self.own += u64::from(sentence.of_day_ns.is_some());
        self.tags += u64::from(tag.is_some());
        self.stamps += u64::from(framed.stamp_ns().is_some());
    }
}

/// The instrument of a file: the one that is chosen. A maker's sentence has no talker, and counts where the talker has none.
fn instrument(all: &[Found], chosen: Option<Talker>, unsummed: u64) -> Result<Found, NmeaProblem> {
    let named: Vec<Found> = match chosen {
        None => all.to_vec(),
        Some(chosen) => {
            let of = |found: &&Found| found.talker == chosen;
            let makers = || all.iter().filter(|found| found.is_maker).copied().collect();
            Some(all.iter().filter(of).copied().collect::<Vec<_>>())
                .filter(|named| !named.is_empty())
                .unwrap_or_else(makers)
        }
    };
    match named[..] {
        [one] => Ok(one),
        [] if unsummed > 0 => Err(all_unsummed(unsummed)),
        [] => {
            let of = chosen.map_or_else(String::new, |talker| format!(" of talker {talker}"));
            Err(NmeaProblem::found(
                format!("no sentence with a heading{of} and a right checksum"),
                "HDT, THS, PASHR, PSXN, PRDID or PFEC",
            ))
        }
        [one, other, ..] => Err(NmeaProblem::found(
            format!("headings of {} and of {}", one.talker, other.talker),
            format!(
                "one instrument: say which one with the key talker, such as talker = \"{}\"",
                one.talker
            ),
        )),
    }
}

/// Finds which sentences are the headings of a file, and what tells their times.
fn sources(lines: &mut NmeaLines, choice: &NmeaChoice) -> Result<Source, NmeaProblem> {
    let mut all: Vec<Found> = Vec::new();
    let mut clock: Option<(Talker, bool)> = None;
    let mut unsummed = 0_u64;
    while lines.advance()? && (lines.line <= LINES_TO_LOOK_AT || all.is_empty()) {
        let Ok(framed) = Framed::of(&lines.text) else { continue };
        let sentence = match Sentence::of(&lines.text) {
            Ok(sentence) => sentence,
            Err(reason) => {
                unsummed += u64::from(reason == UNSUMMED);
                continue;
            }
        };
        if let Some((talker, has_mode)) = heading_of(&sentence) {
            let is_maker = sentence.talker == Talker::default();
            let new = Found { talker, is_maker, count: 0, has_mode, own: 0, tags: 0, stamps: 0 };
            let place = all.iter().position(|found| found.talker == talker);
            let place = place.unwrap_or_else(|| {
                all.push(new);
                all.len() - 1
            });
            all[place].take(&sentence, &framed, has_mode);
        } else if sentence.of_day_ns.is_some() {
            // A ZDA is there to tell the time.
            let is_better = clock.is_none_or(|(_, is_date)| sentence.is_date_alone && !is_date);
            if is_better {
                clock = Some((sentence.talker, sentence.is_date_alone));
            }
        }
    }
    let found = instrument(&all, choice.talker.as_deref().map(Talker::of), unsummed)?;
    let Found { talker, count, has_mode, own, tags, stamps, .. } = found;
    let has_cycle = clock.is_some() || own > 0;
    let time = match choice.heading_time {
        Some(time) => time,
        None if own > 0 => HeadingTime::Cycle,
        None if tags > 0 => HeadingTime::Tag,
        None if stamps > 0 => HeadingTime::Stamp,
        None if has_cycle => HeadingTime::Cycle,
        None => {
            return Err(NmeaProblem::found(
                format!("{count} headings of {talker} and nothing that tells their times"),
                "a ZDA in the log, TAG blocks with c: or the stamps of a logger; of a log without, say the rate, such as \
                 heading_rate = \"10 Hz\", and the time of the first one, heading_start = \"2027-03-31T08:00:00Z\"",
            ));
        }
    };
    let needs = match time {
        HeadingTime::Tag if tags == 0 => Some("a TAG block with c: before the headings"),
        HeadingTime::Stamp if stamps == 0 => {
            Some("a date and time of day before the headings, such as 2027-03-31T08:00:00.5Z")
        }
        HeadingTime::Cycle if !has_cycle => Some("sentences with a time of day, such as ZDA"),
        _ => None,
    };
    match needs {
        Some(needs) => Err(NmeaProblem::found(format!("{count} headings of {talker}"), needs)),
        None => Ok(Source { talker, has_mode, clock, time }),
    }
}

/// Talker of the heading of a sentence, and whether it has a mode.
fn heading_of(sentence: &Sentence) -> Option<(Talker, bool)> {
    match (&sentence.heading, &sentence.attitude_rad) {
        (Some(heading), _) => Some((heading.talker, heading.has_mode)),
        (None, Some(_)) => Some((Talker::of("PASHR"), false)),
        _ => None,
    }
}

impl HeadingReader {
    pub(crate) fn new(file: File, choice: &NmeaChoice) -> Result<Self, NmeaProblem> {
        let mut lines = NmeaLines::new(file);
        let by = sources(&mut lines, choice)?;
        let mut lines = lines.again()?;
        let is_own = by.talker == Talker::of("PASHR");
        let mut day = || {
            let day_ns = first_day(&mut lines)?;
            Ok::<_, NmeaProblem>(Days::from(day_ns))
        };
        let clock = match by.time {
            HeadingTime::Tag => Clock::Tag(Group::default()),
            HeadingTime::Stamp => Clock::Stamp,
            HeadingTime::Cycle if is_own => Clock::Own(day()?),
            HeadingTime::Cycle => Clock::Cycle(Box::new(Cycle::of(day()?, choice.heading_delay))),
            HeadingTime::Rate(rate_hz, start_ns) => Clock::Rate {
                period_ns: SECOND_NS as f64 / rate_hz,
                start_ns: start_ns.unwrap_or(0),
                count: 0,
            },
        };
        let lines = lines.again()?;
        Ok(Self {
            lines,
            by,
            fixes_alone: choice.fixes_alone,
            tells_none: choice.tells_none,
            clock,
            quality: PsxnQuality::default(),
            ready: VecDeque::new(),
            tally: Tally::default(),
            heard_ns: None,
        })
    }

    fn leave_out(&mut self, reason: &'static str) {
        let line = self.lines.line;
        self.tally.left_out(1, reason, || format!("line {line}"));
    }

    /// Takes the present line.
    fn take(&mut self) -> Result<(), NmeaProblem> {
        let text = std::mem::take(&mut self.lines.text);
        let taken = self.take_text(&text);
        self.lines.text = text;
        taken
    }

    fn take_text(&mut self, text: &str) -> Result<(), NmeaProblem> {
        let sentence = match Sentence::of(text) {
            Ok(sentence) => sentence,
            Err(_) if text.trim().is_empty() => return Ok(()),
            Err(reason) => {
                self.leave_out(reason);
                return Ok(());
            }
        };
        if let Some(quality) = sentence.heading_quality {
            self.quality.take(quality);
            self.tally.used(1);
            return Ok(());
        }
        let answer = match heading_of(&sentence) {
            Some((talker, _)) if talker != self.by.talker => {
                self.leave_out(OTHER_TALKERS);
                return Ok(());
            }
            Some((_, mode)) if self.by.has_mode && !mode => {
                self.leave_out(REPEATED);
                return Ok(());
            }
            Some(_) => match self.judged(&sentence) {
                Ok(said) => Answer::Heading(said),
                Err(reason) => self.without(reason),
            },
            // A THS without a heading keeps its place.
            None if sentence.heading_talker == Some(self.by.talker) => {
                self.without(sentence.left_out.unwrap_or(INVALID))
            }
            None => return self.take_other(&sentence),
        };
        self.take_heading(text, &sentence, answer)
    }

    /// A sentence of the instrument without a heading that counts.
    fn without(&mut self, reason: &'static str) -> Answer {
        if self.tells_none && reason == INVALID {
            return Answer::Without;
        }
        self.leave_out(reason);
        Answer::LeftOut
    }

    /// The heading of a sentence, with its quality.
    fn judged(&self, sentence: &Sentence) -> Result<HeadingSaid, &'static str> {
        let said = match sentence.heading {
            Some(said) => self.quality.judged(said)?,
            None => {
                let attitude = sentence.attitude_rad.ok_or(INVALID)?;
                let [roll, pitch, heading_rad] = attitude.value;
                HeadingSaid {
                    talker: self.by.talker,
                    has_mode: false,
                    heading_rad,
                    tilt_rad: Some([roll, pitch]),
                    digit_rad: attitude.resolution,
                    is_estimated: false,
                    quality: "no stated mode",
                }
            }
        };
        if self.fixes_alone && said.is_estimated { Err(ESTIMATED_HEADING) } else { Ok(said) }
    }

    /// Takes a sentence without a heading of the instrument.
    fn take_other(&mut self, sentence: &Sentence) -> Result<(), NmeaProblem> {
        let is_clock = sentence.of_day_ns.is_some()
            && self.by.clock == Some((sentence.talker, sentence.is_date_alone));
        match (&mut self.clock, sentence.of_day_ns) {
            (Clock::Cycle(cycle), Some(of_day_ns)) if is_clock => {
                let time_ns = cycle.days.time_ns(of_day_ns, sentence.day_ns);
                self.heard_ns = self.heard_ns.max(Some(time_ns));
                let left = cycle.mark(time_ns, &mut self.ready);
                let line = self.lines.line;
                self.tally.left_out(left, BEFORE_TIME, || format!("before line {line}"));
                self.tally.used(1);
            }
            (Clock::Own(days), Some(of_day_ns)) if sentence.day_ns.is_some() => {
                days.time_ns(of_day_ns, sentence.day_ns);
                self.tally.used(1);
            }
            _ => self.leave_out(BESIDES),
        }
        Ok(())
    }

    /// Gives a heading its time, as soon as it is known.
    fn take_heading(
        &mut self,
        text: &str,
        sentence: &Sentence,
        answer: Answer,
    ) -> Result<(), NmeaProblem> {
        let line = self.lines.line;
        let time_ns = match &mut self.clock {
            Clock::Tag(group) => match Framed::of(text).and_then(|framed| framed.tag()) {
                Ok(Some(tag)) => group.time_ns(&tag).ok_or(NO_TAG_TIME),
                Ok(None) => Err(NO_TAG_TIME),
                Err(_) => Err(DAMAGED_TAG),
            },
            Clock::Stamp => {
                Framed::of(text).ok().and_then(|framed| framed.stamp_ns()).ok_or(NO_STAMP)
            }
            Clock::Rate { period_ns, start_ns, count } => {
                let time_ns = *start_ns + (*count as f64 * *period_ns).round() as i64;
                *count += 1;
                Ok(time_ns)
            }
            Clock::Own(days) => match sentence.of_day_ns {
                Some(of_day_ns) => Ok(days.time_ns(of_day_ns, sentence.day_ns)),
                None => Err(UNREADABLE),
            },
            Clock::Cycle(cycle) => {
                if cycle.waiting.len() == CYCLE_MAX {
                    let problem = NmeaProblem::found(
                        format!("{CYCLE_MAX} headings behind one time of day"),
                        "the times of a clock that runs",
                    );
                    return Err(problem.at(line));
                }
                cycle.waiting.push(answer);
                return Ok(());
            }
        };
        match time_ns {
            Ok(time_ns) => {
                self.heard_ns = self.heard_ns.max(Some(time_ns));
                self.ready.extend(answer.point(time_ns, 0.0, sentence.attitude_sigma_rad));
            }
            // Left out already, for a reason of its own.
            Err(_) if !answer.is_point() => {}
            Err(reason) => self.leave_out(reason),
        }
        Ok(())
    }
}

impl Points for HeadingReader {
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String> {
        loop {
            if let Some((point, quality)) = self.ready.pop_front() {
                self.tally.point(1);
                self.tally.quality(quality);
                return Ok(Some(point));
            }
            let taken = match self.lines.advance() {
                Ok(true) => self.take().map(|()| true),
                read => read,
            };
            if taken.map_err(|problem| problem.to_string())? {
                continue;
            }
            if let Clock::Cycle(cycle) = &mut self.clock {
                let left = cycle.end(&mut self.ready);
                self.tally.left_out(left, BEHIND_TIME, || "the end of the file".to_owned());
            }
            if self.ready.is_empty() {
                return Ok(None);
            }
        }
    }

    fn place(&self) -> String {
        format!("line {}", self.lines.line)
    }

    fn scale(&self) -> TimeScale {
        match self.by.time {
            HeadingTime::Rate(_, None) => TimeScale::Own,
            _ => TimeScale::Utc,
        }
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
        vec![match (&self.clock, self.by.time) {
            (Clock::Own(_), _) => "each heading has its own time",
            (_, HeadingTime::Tag) => "each heading has the time of its TAG block",
            (_, HeadingTime::Stamp) => "each heading has the stamp of the logger",
            (_, HeadingTime::Cycle) => {
                "headings are spread evenly from the time of day before them to the next one"
            }
            (_, HeadingTime::Rate(..)) => {
                "headings are spread evenly by the rate that was given: missing ones can't be seen"
            }
        }]
    }
}
