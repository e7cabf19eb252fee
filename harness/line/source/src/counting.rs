//! Converts measured quantities of a real instrument into the integer counts of a sample.
//!
//! The time of a row is that of the [`Timeline`], which sees the rows behind it too. Rows may be missing: a gap is not
//! repaired here. The row after it stands for one period, as every other row does, its sample's number is advanced by
//! the missing samples, and the core bridges the gap.

use crate::triads::Triads;
use octant_account::{Account, AccountEntry, ClockAccount, OutsideClock, Weight};
use octant_base::number::{counted, plain};
use octant_instruments::timeline::{AHEAD, Ahead, Misplaced, Placed, SHIFTED, Timeline};
use octant_recorder::event::{BenchReadings, BenchRecord};
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};
use octant_scenario::recorded::{RecordedQuantity, SPLIT_MAX};
use std::collections::VecDeque;

/// One row of a file in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Place in the file: line, or number of the message.
    pub(super) place: u64,
    /// Stamp, ns; `None` where rows have none.
    pub(super) stamp_ns: Option<u64>,
    /// Gyros x y z: rad/s or rad.
    pub(super) gyro: [f64; 3],
    /// Accelerometers x y z: m/s² or m/s.
    pub(super) accel: [f64; 3],
    /// Gimbal azimuth and roll, rad, if the file has them.
    pub(super) gimbal_rad: Option<[f64; 2]>,
    /// Temperature in the unit of the file; not finite if there is none.
    pub(super) temperature: f64,
}

/// More missing rows than one for so many that are there make a file incomplete.
pub(super) const MISSING_MAX: u64 = 10;

/// Words for the rows of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowWords {
    /// Name of a row, singular and plural.
    pub(super) unit: [&'static str; 2],
    /// Word before the place of a row.
    pub(super) at: &'static str,
    /// Words to write for other times than the stamps'.
    pub(super) other_times: &'static str,
}

/// Converts rows into counts and carries the remainder of each axis.
///
/// A row may be split into equal parts of its interval, so that counts can hold faster rates.
#[derive(Clone, Debug)]
pub(super) struct Counting {
    quantity: RecordedQuantity,
    words: RowWords,
    rate_hz: f64,
    timeline: Timeline,
    /// Number of samples per row.
    split: u64,
    /// Rows that were read and have no time yet, and their stamps.
    rows: VecDeque<Measured>,
    stamps: VecDeque<u64>,
    has_ended: bool,
    pending: Option<Pending>,
    last: Option<Measured>,
    sequence: u64,
    triads: Triads,
    /// Places of the first row behind a gap, the first with a stamp off its fit, and the first that was left out.
    firsts: Firsts,
}

#[derive(Clone, Copy, Debug, Default)]
struct Firsts {
    gap: Option<(u64, f64)>,
    shifted: Option<u64>,
    repeated: Option<u64>,
}

/// Row whose parts have not all been delivered.
#[derive(Clone, Copy, Debug)]
struct Pending {
    row: Measured,
    time_ns: u64,
    interval_ns: u64,
    /// Number of parts left.
    left: u64,
}

/// Answer of the counting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Counted {
    /// A sample.
    Sample(Sample),
    /// More rows are needed.
    More,
    /// The rows have ended, and all samples were given.
    End,
}

/// Error at a place of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct CountingError {
    /// Line, or number of the message.
    pub(super) place: u64,
    /// Found and expected content.
    pub(super) reason: String,
}

impl Counting {
    /// Creates the counting of rows at a nominal rate, Hz. `split` is the number of samples made from a row.
    pub(super) fn new(
        quantity: RecordedQuantity,
        rate_hz: f64,
        split: u32,
        words: RowWords,
    ) -> Result<Self, String> {
        if !(rate_hz.is_finite() && (1e-3..=1e8).contains(&rate_hz)) {
            return Err(format!("nominal rate is {rate_hz} Hz, expected 0.001 to 1e8 Hz"));
        }
        if !(1..=SPLIT_MAX).contains(&split) {
            return Err(format!("split is {split}, expected 1 to {SPLIT_MAX}"));
        }
        Ok(Self {
            quantity,
            words,
            rate_hz,
            timeline: Timeline::new(rate_hz),
            split: u64::from(split),
            rows: VecDeque::with_capacity(AHEAD + 1),
            stamps: VecDeque::with_capacity(AHEAD + 1),
            has_ended: false,
            pending: None,
            last: None,
            sequence: 0,
            triads: Triads::default(),
            firsts: Firsts::default(),
        })
    }

    /// Number of samples in which at least one count saturated.
    pub(super) fn saturated(&self) -> u64 {
        self.triads.saturated()
    }

    /// Row of the last sample.
    pub(super) fn row(&self) -> Option<&Measured> {
        self.last.as_ref()
    }

    /// Takes the next row.
    #[inline]
    pub(super) fn push(&mut self, row: Measured) {
        self.stamps.push_back(row.stamp_ns.unwrap_or_default());
        self.rows.push_back(row);
    }

    /// Says that there are no more rows.
    pub(super) fn end(&mut self) {
        self.has_ended = true;
    }

    /// Returns the next sample.
    ///
    /// If the first row would begin before time 0, only its parts that end after time 0 are delivered.
    #[inline]
    pub(super) fn next(&mut self) -> Result<Counted, CountingError> {
        loop {
            if let Some(sample) = self.part() {
                return Ok(Counted::Sample(sample));
            }
            if self.rows.len() <= AHEAD && !self.has_ended {
                return Ok(Counted::More);
            }
            let Some(row) = self.rows.pop_front() else {
                return self.timeline.judge_rate().map(|()| Counted::End).map_err(|misplaced| {
                    let place = self.last.map_or(0, |row| row.place);
                    CountingError { place, reason: self.reason(misplaced) }
                });
            };
            self.stamps.pop_front();
            self.begin(row)?;
        }
    }

    /// Gives a row its time; its parts are delivered then.
    #[inline]
    fn begin(&mut self, row: Measured) -> Result<(), CountingError> {
        let before = *self.timeline.tally();
        let stamps = &self.stamps;
        let ahead = || {
            let (first, second) = stamps.as_slices();
            Ahead::of(first, second)
        };
        let placed = match self.timeline.place(row.stamp_ns, None, ahead) {
            Ok(placed) => placed,
            Err(Misplaced::Repeated) => {
                self.firsts.repeated.get_or_insert(row.place);
                return Ok(());
            }
            Err(misplaced) => {
                return Err(CountingError { place: row.place, reason: self.reason(misplaced) });
            }
        };
        let Placed { number, missing, time_ns, interval_ns } = placed;
        if self.timeline.tally().shifted > before.shifted {
            self.firsts.shifted.get_or_insert(row.place);
        }
        if missing > 0 {
            self.sequence = self.sequence.saturating_add(missing.saturating_mul(self.split));
            self.firsts.gap.get_or_insert((row.place, before_s(self.last.as_ref())));
        }
        if interval_ns < self.split {
            return Err(CountingError {
                place: row.place,
                reason: format!(
                    "stamp {time_ns} ns is {interval_ns} ns after the one before, expected {} ns at least, one for each \
                     part",
                    self.split
                ),
            });
        }
        let mut left = self.split;
        if number == 0 {
            let part_ns = (interval_ns / self.split).max(1);
            left = left.min(time_ns / part_ns + 1);
        }
        self.last = Some(row);
        self.pending = Some(Pending { row, time_ns, interval_ns, left });
        Ok(())
    }

    /// Returns the next part of the current row.
    #[inline]
    fn part(&mut self) -> Option<Sample> {
        let Pending { row, time_ns, interval_ns, left } = self.pending?;
        self.pending = (left > 1).then_some(Pending { left: left - 1, ..self.pending? });
        // Exact integer arithmetic: the parts of an interval differ by a nanosecond at most.
        let until_end = |parts: u64| {
            (u128::from(interval_ns) * u128::from(parts) / u128::from(self.split)) as u64
        };
        let time_ns = time_ns.saturating_sub(until_end(left - 1));
        let part_ns = until_end(left) - until_end(left - 1);
        self.sequence = self.sequence.saturating_add(1);
        let factor = match self.quantity {
            RecordedQuantity::Rates => part_ns as f64 * 1e-9,
            RecordedQuantity::Increments => part_ns as f64 / interval_ns as f64,
        };
        let mut sample = Sample {
            sequence: self.sequence,
            device_time: DeviceTime::from_ns(time_ns),
            ..Sample::default()
        };
        let mut status = self.triads.count(
            &row.gyro.map(|value| value * factor),
            &row.accel.map(|value| value * factor),
            &mut sample.delta_theta,
            &mut sample.delta_velocity,
        );
        match row.gimbal_rad {
            Some([azimuth, roll]) => sample.gimbal = GimbalAngles::from_rad(azimuth, roll),
            None => status |= Status::GIMBAL_INVALID,
        }
        sample.status = status;
        Some(sample)
    }

    /// Describes gaps of which more rows are missing than a file may lack.
    pub(super) fn cut_short(&self, path: &str) -> Option<String> {
        let (missing, placed) = (self.timeline.tally().missing, self.timeline.tally().placed);
        (missing > placed / MISSING_MAX).then(|| {
            let [one, many] = self.words.unit;
            format!("{path} has gaps: {} missing, {placed} there", counted(missing, one, many))
        })
    }

    /// Returns what the manifest says of a file with gaps; `None` without any.
    pub(super) fn bench(&self, path: &str) -> Option<Box<BenchRecord>> {
        let tally = self.timeline.tally();
        let (_, from_s) = self.firsts.gap?;
        let instrument = format!(
            "{path}: {}, {}, the longest {} s, the first after the one of {} s",
            counted(tally.placed, self.words.unit[0], self.words.unit[1]),
            counted(tally.gaps, "gap", "gaps"),
            plain(tally.longest_s, 9),
            plain(from_s, 9),
        );
        let readings = BenchReadings {
            behind: tally.repeated,
            irregular: 0,
            missing: tally.missing.saturating_mul(self.split),
            samples: tally.placed.saturating_mul(self.split),
        };
        Some(Box::new(BenchRecord::of_file(instrument, readings)))
    }

    /// Returns the account of the rows. `outside` is a clock that the stamps are held against.
    pub(super) fn account(&self, path: &str, outside: Option<OutsideClock>) -> Account {
        let RowWords { unit, at, other_times } = self.words;
        let tally = self.timeline.tally();
        let [one, many] = unit;
        let in_place =
            |place: Option<u64>| place.map_or(String::new(), |place| format!("in {at} {place}"));
        let period_ms = 1e3 / self.rate_hz;
        let shifted = AccountEntry::new(
            tally.shifted,
            format!(
                "{} off the fitted time by more than {} ms, and given that time",
                if tally.shifted == 1 { one } else { many },
                plain(SHIFTED * period_ms, 3)
            ),
        )
        .first(in_place(self.firsts.shifted));
        let repeated = AccountEntry::new(tally.repeated, format!("{many} that are there twice"))
            .first(in_place(self.firsts.repeated));
        // Rows that wait when a run ends before its file are not read yet.
        let used = tally.placed - tally.shifted;
        let rest = AccountEntry::fact(
            !self.has_ended || !self.rows.is_empty(),
            "the run ended before the file: the rest is not read",
        );
        let saturated = AccountEntry::new(
            self.saturated(),
            "samples with a value that doesn't fit a count, which the core doesn't believe",
        )
        .remedy("split makes several samples of a row");
        let mut account = Account::new(path, unit)
            .used(used)
            .repaired(shifted)
            .left_out(repeated)
            .missing(self.missing())
            .note(rest)
            .note(saturated)
            .clock(Some(self.clock(outside)));
        if self.timeline.is_blind() {
            let note = AccountEntry::fact(
                true,
                format!("the stamps scatter so much that a missing {one} can't be seen"),
            );
            let remedy = format!("where no {one} is missing, {other_times}");
            account = account.note(note.remedy(remedy).weight(Weight::Doubt));
        }
        account
    }

    fn missing(&self) -> AccountEntry {
        let RowWords { unit: [one, many], at, .. } = self.words;
        let tally = self.timeline.tally();
        let kind = format!(
            "{} in {}, the longest {} s",
            if tally.missing == 1 { one } else { many },
            counted(tally.gaps, "gap", "gaps"),
            plain(tally.longest_s, 4)
        );
        let entry = AccountEntry::new(tally.missing, kind);
        match self.firsts.gap {
            Some((place, from_s)) => entry.first(format!(
                "before {at} {place}, after the one of {} s; the core bridges it",
                plain(from_s, 9)
            )),
            None => entry,
        }
    }

    /// Rate and clock of the rows.
    fn clock(&self, outside: Option<OutsideClock>) -> ClockAccount {
        let rate = self.timeline.rate();
        ClockAccount {
            configured_hz: self.rate_hz,
            measured_hz: rate.map(|rate| rate.hz),
            rate_ppm: rate.map(|rate| rate.ppm),
            rate_sigma_ppm: rate.map(|rate| rate.sigma_ppm),
            scatter_s: rate.map(|rate| rate.scatter_s),
            scatter_max_s: rate.map(|rate| rate.scatter_max_s),
            increments: self.quantity == RecordedQuantity::Increments,
            outside,
        }
    }

    /// Describes why a row has no time, and what to write.
    #[cold]
    fn reason(&self, misplaced: Misplaced) -> String {
        let RowWords { unit: [one, many], other_times, .. } = self.words;
        let other = format!("where no {one} is missing, {other_times}");
        let s = |s: f64| plain(s, 12);
        let hz = |hz: f64| plain(hz, 6);
        match misplaced {
            Misplaced::Repeated => format!("the {one} is there twice"),
            Misplaced::Back { from_s, to_s } if from_s == to_s => format!(
                "the stamps stand still at {} s: they are too coarse for {} Hz; {other}",
                s(to_s),
                hz(self.rate_hz)
            ),
            Misplaced::Back { from_s, to_s } => format!(
                "the clock goes back from {} s to {} s: it was set, or the unit was restarted; {other}",
                s(from_s),
                s(to_s)
            ),
            Misplaced::Ahead { from_s, to_s } => format!(
                "the clock jumps ahead from {} s to {} s, by more than a day: it was set; {other}",
                s(from_s),
                s(to_s)
            ),
            Misplaced::Rate { found_hz, expected_hz, changed: true } => format!(
                "from here on {many} come at {} Hz, before at {} Hz: expected one rate in a file",
                hz(found_hz),
                hz(expected_hz)
            ),
            Misplaced::Rate { found_hz, expected_hz, changed: false } => format!(
                "{many} come at {} Hz by their stamps, expected {} Hz: if the unit of the stamps is right, write \
                 rate = \"{} Hz\"",
                hz(found_hz),
                hz(expected_hz),
                hz(found_hz)
            ),
        }
    }
}

fn before_s(last: Option<&Measured>) -> f64 {
    last.and_then(|row| row.stamp_ns).map_or(f64::NAN, |ns| ns as f64 * 1e-9)
}
