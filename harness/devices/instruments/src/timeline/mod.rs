//! Time of readings: the one place where stamps, counters and a nominal rate become intervals.
//!
//! Stamps are fitted on the count of readings by a line with a memory of [`MEMORY`] readings, and a reading's time is
//! that of the line: jitter of stamps is no jitter of the samples. A missing reading is known by the counter where there is one,
//! else by the stamps: a stamp that is late by more than half a period, and whose followers stay late, follows a gap.
//! Where the followers return to the line, the stamp alone was late.
//!
//! | what is found | what is made of it |
//! |---|---|
//! | stamps that jitter, come in bursts, or are of few digits | the fitted time ([`Tally::shifted`]) |
//! | missing readings | a gap: numbers go on behind it, and the reading stands for one period |
//! | a reading twice | left out ([`Misplaced::Repeated`]) |
//! | a clock that goes back or jumps by more than a day, another rate | no time: [`Misplaced::Back`], [`Misplaced::Ahead`], [`Misplaced::Rate`] |
//!
//! Units: ns, and s where it is in the name. The fit is a Kalman filter of phase and period with stamps of unit variance
//! (Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, 6.3.2, the alpha-beta
//! tracker): its gains depend on the counts alone.

mod line;
mod regression;

pub use line::{AHEAD, MEMORY};
pub use regression::StampRate;

use line::Line;
use regression::Regression;

/// Distance from the fit, as a share of the period, from which a stamp counts as off.
pub const SHIFTED: f64 = 0.05;
/// Largest jump ahead of a clock, ns: a day. A longer one is no gap.
const JUMP_MAX_NS: f64 = 86_400e9;
/// Largest difference of the rate by the stamps from the configured one, as a share.
const RATE_TOLERANCE: f64 = 0.05;
/// Number of readings after which the rate is judged.
const RATE_JUDGED: u64 = 64;
/// Number of gaps of one length, reading after reading, that are another rate.
const STRAYS: u32 = 8;
/// Number of readings before which stamps say nothing: the fit is still on its way.
const FEW: u64 = 10;
/// Scatter of stamps, as a share of the period, from which a single missing reading can't be seen by them.
const BLIND: f64 = 1.2;

/// Time of one reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Number of readings since the first one, missing ones included.
    pub number: u64,
    /// Number of readings that are missing before this one.
    pub missing: u64,
    /// End of the interval on the clock of the stamps, ns.
    pub time_ns: u64,
    /// Length of the interval, ns: behind a gap, one fitted period.
    pub interval_ns: u64,
}

/// Reason why a reading has no time of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Misplaced {
    /// The reading is there twice, or late: it is left out.
    Repeated,
    /// The clock, or the counter, goes back by so many seconds, and its followers go on from there.
    Back {
        /// Stamp before, s.
        from_s: f64,
        /// Stamp of this reading, s.
        to_s: f64,
    },
    /// The clock jumps ahead by more than a day.
    Ahead {
        /// Stamp before, s.
        from_s: f64,
        /// Stamp of this reading, s.
        to_s: f64,
    },
    /// The readings come at another rate than before, or than configured.
    Rate {
        /// Rate by the stamps, Hz.
        found_hz: f64,
        /// Rate that was expected, Hz.
        expected_hz: f64,
        /// True where the rate changed within the readings.
        changed: bool,
    },
}

/// Counts of a timeline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Number of gaps.
    pub gaps: u64,
    /// Number of readings missing in all of them.
    pub missing: u64,
    /// Longest gap, s.
    pub longest_s: f64,
    /// Ordinal of the first reading behind a gap, from 1; 0 without a gap.
    pub first_gap: u64,
    /// Stamp before the first gap, s.
    pub first_gap_s: f64,
    /// Number of readings whose stamp is off the fit by more than [`SHIFTED`] of a period.
    pub shifted: u64,
    /// Ordinal of the first of them; 0 without one.
    pub first_shifted: u64,
    /// Number of readings that were left out.
    pub repeated: u64,
    /// Ordinal of the first of them; 0 without one.
    pub first_repeated: u64,
    /// Number of readings whose stamps and counters disagree by more than half a period.
    pub disagreeing: u64,
    /// Number of readings that got a time.
    pub placed: u64,
}

/// Makes times of readings.
#[derive(Clone, Copy, Debug)]
pub struct Timeline {
    /// Configured period, ns: not rounded, so that rates as 60 Hz have their own.
    nominal_ns: f64,
    state: Option<State>,
    tally: Tally,
    read: u64,
}

#[derive(Clone, Copy, Debug)]
struct State {
    line: Line,
    regression: Regression,
    /// Last stamp, and last counter.
    stamp: Option<u64>,
    counter: Option<u64>,
    number: u64,
    time_ns: u64,
    /// Gaps of one length, reading after reading.
    strays: (u64, u32),
}

impl Timeline {
    /// Creates a timeline for a configured rate, Hz.
    #[must_use]
    pub fn new(rate_hz: f64) -> Self {
        Self { nominal_ns: 1e9 / rate_hz, state: None, tally: Tally::default(), read: 0 }
    }

    /// Counts so far.
    #[must_use]
    pub fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Returns rate and scatter of the stamps; `None` without stamps, or with fewer than three.
    #[must_use]
    pub fn rate(&self) -> Option<StampRate> {
        let state = self.state.as_ref()?;
        state.regression.rate(self.nominal_ns, state.line.scatter_max_ns())
    }

    /// Returns whether the stamps scatter so much that a single missing reading can't be seen, and there is no counter.
    #[must_use]
    pub fn is_blind(&self) -> bool {
        let blind = |state: &State| {
            state.counter.is_none()
                && state.stamp.is_some()
                && state.line.scatter_ns() > BLIND * self.nominal_ns
        };
        self.state.as_ref().is_some_and(blind)
    }

    /// Gives a reading its time. `ahead` has the stamps of the readings that follow it, as many as are known, [`AHEAD`] at
    /// most.
    ///
    /// # Errors
    /// If it has none: see [`Misplaced`]. All but [`Misplaced::Repeated`] end the timeline.
    #[inline]
    pub fn place<'a>(
        &mut self,
        stamp: Option<u64>,
        counter: Option<u64>,
        ahead: impl Fn() -> Ahead<'a>,
    ) -> Result<Placed, Misplaced> {
        self.read += 1;
        let Some(state) = &mut self.state else {
            return Ok(self.first(stamp, counter, &ahead()));
        };
        let steps = match (counter, state.counter) {
            (Some(now), Some(before)) if now > before => now - before,
            (Some(now), Some(before)) => {
                let is_repeated = now == before || before - now < 3;
                return Err(self.odd(is_repeated, before, now, self.nominal_ns * 1e-9));
            }
            _ => 0,
        };
        let Some(now) = stamp else { return Ok(self.by_count(steps.max(1), counter)) };
        let Some(before) = state.stamp else { return Ok(self.by_count(steps.max(1), counter)) };
        let counted = steps.max(1);
        let off_ns = state.line.off_ns(now, counted);
        let half_ns = 0.5 * state.line.period_ns();
        if off_ns.abs() <= half_ns {
            return self.take(now, counter, counted);
        }
        if steps > 0 {
            // The counter decides how many are missing; a stamp that disagrees is told.
            self.tally.disagreeing += 1;
            if off_ns.abs() > JUMP_MAX_NS {
                return Err(jump(before, now));
            }
            return self.take(now, counter, counted);
        }
        self.without_counter(now, before, off_ns, &ahead())
    }

    /// Decides about a stamp that is off by more than half a period, without a counter.
    #[cold]
    #[inline(never)]
    fn without_counter(
        &mut self,
        now: u64,
        before: u64,
        off_ns: f64,
        ahead: &Ahead<'_>,
    ) -> Result<Placed, Misplaced> {
        let Some(state) = &mut self.state else { return Err(Misplaced::Repeated) };
        let period_ns = state.line.period_ns();
        if off_ns > JUMP_MAX_NS {
            return Err(jump(before, now));
        }
        let spacing = ahead.spacing_ns(now).map(|spacing_ns| (spacing_ns, spacing_ns / period_ns));
        let is_regular = spacing.is_some_and(|(_, ratio)| (ratio - 1.0).abs() <= 0.25);
        if let Some((spacing_ns, _)) = spacing
            && !is_regular
            && off_ns.abs() < 4.0 * spacing_ns.max(period_ns)
        {
            let changed = self.tally.placed >= FEW;
            let expected_ns = if changed { period_ns } else { self.nominal_ns };
            return Err(Misplaced::Rate {
                found_hz: 1e9 / spacing_ns,
                expected_hz: 1e9 / expected_ns,
                changed,
            });
        }
        let (mut least, mut most, mut sum, mut n) = (off_ns, off_ns, off_ns, 1.0);
        for (step, stamp) in ahead.stamps().enumerate() {
            let off = state.line.off_ns(stamp, 2 + step as u64);
            (least, most) = (least.min(off), most.max(off));
            (sum, n) = (sum + off, n + 1.0);
        }
        let mean = sum / n;
        let scatter_ns = state.line.scatter_ns();
        // Stamps behind it that are regular show a gap by themselves; behind others the mean counts.
        let is_sharp = is_regular || (state.line.is_settled() && scatter_ns < 0.2 * period_ns);
        // Four standard errors of the mean of the stamps looked at.
        let seen_ns = (0.6 * period_ns).max(4.0 * scatter_ns / libm::sqrt(n));
        if off_ns > 0.0 {
            let late_ns = if is_sharp { least } else { mean };
            let stays = if is_sharp { least > 0.5 * period_ns } else { mean > seen_ns };
            let missing = if stays { libm::round(late_ns / period_ns).max(1.0) as u64 } else { 0 };
            return self.take(now, None, 1 + missing);
        }
        let early_ns = if is_sharp { most } else { mean };
        let stays = if is_sharp { early_ns < -0.5 * period_ns } else { mean < -seen_ns };
        if !stays || now > before {
            return self.take(now, None, 1);
        }
        // One too many: the same reading again, or one that comes late. A clock that goes back stays back.
        let is_repeated = early_ns > -1.5 * period_ns;
        Err(self.odd(is_repeated, before, now, 1e-9))
    }

    /// Counts a reading that is left out, or says that the clock goes back.
    #[cold]
    fn odd(&mut self, is_repeated: bool, before: u64, now: u64, unit_s: f64) -> Misplaced {
        if !is_repeated {
            return Misplaced::Back { from_s: before as f64 * unit_s, to_s: now as f64 * unit_s };
        }
        self.tally.repeated += 1;
        if self.tally.first_repeated == 0 {
            self.tally.first_repeated = self.read;
        }
        Misplaced::Repeated
    }

    #[cold]
    fn first(&mut self, stamp: Option<u64>, counter: Option<u64>, ahead: &Ahead<'_>) -> Placed {
        let interval_ns = (libm::round(self.nominal_ns) as u64).max(1);
        let time_ns = stamp.unwrap_or(interval_ns);
        let own_ns = stamp.and_then(|now| ahead.period_ns(now));
        let near = |period_ns: &f64| (period_ns / self.nominal_ns - 1.0).abs() <= RATE_TOLERANCE;
        let begin_ns = own_ns.filter(near).unwrap_or(self.nominal_ns);
        let mut line = Line::new(time_ns, begin_ns);
        if stamp.is_some() && counter.is_none() && ahead.spacing_ns(time_ns).is_none() {
            line.settle(ahead.stamps());
        }
        let mut regression = Regression::default();
        if let Some(now) = stamp {
            regression.add(0.0, now, line.origin_ns(), self.nominal_ns);
        }
        let time_ns = line.time_ns();
        self.state =
            Some(State { line, regression, stamp, counter, number: 0, time_ns, strays: (0, 0) });
        self.tally.placed += 1;
        Placed { number: 0, missing: 0, time_ns, interval_ns }
    }

    /// Places a reading without a stamp by its count.
    fn by_count(&mut self, steps: u64, counter: Option<u64>) -> Placed {
        let read = self.read;
        let nominal_ns = self.nominal_ns;
        // Called with a state alone.
        let Some(state) = &mut self.state else { return self.first(None, counter, &Ahead::NONE) };
        let number = state.number.saturating_add(steps);
        // A reading without a stamp among others follows the line of the stamps.
        let (time_ns, period_ns) = if state.stamp.is_some() {
            state.line.skip(steps);
            (state.line.time_ns(), state.line.period_ns())
        } else {
            let since_ns = libm::round(number as f64 * nominal_ns) as u64;
            (state.line.origin_ns().saturating_add(since_ns), nominal_ns)
        };
        let placed = placed(state, number, steps, time_ns, period_ns);
        state.counter = counter.or(state.counter);
        note_gap(&mut self.tally, read, &placed, nominal_ns, None);
        self.tally.placed += 1;
        placed
    }

    /// Places a reading so many steps behind the last one.
    #[inline]
    fn take(&mut self, now: u64, counter: Option<u64>, steps: u64) -> Result<Placed, Misplaced> {
        let read = self.read;
        let Some(state) = &mut self.state else { return Err(Misplaced::Repeated) };
        let steps = steps.saturating_add(state.line.owed());
        let off_ns = state.line.take(now, steps, counter.is_none());
        let period_ns = state.line.period_ns();
        if off_ns.abs() > SHIFTED * period_ns && state.number >= FEW {
            self.tally.shifted += 1;
            if self.tally.first_shifted == 0 {
                self.tally.first_shifted = read;
            }
        }
        let number = state.number.saturating_add(steps);
        state.regression.add(number as f64, now, state.line.origin_ns(), self.nominal_ns);
        let fitted = state.line.time_ns();
        let before_ns = state.stamp;
        let placed = placed(state, number, steps, fitted, period_ns);
        state.stamp = Some(now);
        state.counter = counter.or(state.counter);
        self.tally.placed += 1;
        if steps > 1 || state.strays.1 > 0 {
            note_gap(&mut self.tally, read, &placed, period_ns, before_ns);
            let alike = if state.strays.0 == steps { state.strays.1 + 1 } else { 1 };
            state.strays = if steps > 1 { (steps, alike) } else { (0, 0) };
            if counter.is_none() && alike >= STRAYS {
                let changed = self.tally.placed >= FEW + u64::from(STRAYS);
                let expected_ns = if changed { period_ns } else { self.nominal_ns };
                return Err(Misplaced::Rate {
                    found_hz: 1e9 / (steps as f64 * period_ns),
                    expected_hz: 1e9 / expected_ns,
                    changed,
                });
            }
        }
        if self.tally.placed == RATE_JUDGED {
            self.judge_rate()?;
        }
        Ok(placed)
    }

    /// Compares the rate by the stamps with the configured one; a few readings say nothing.
    ///
    /// # Errors
    /// If it is another one.
    #[cold]
    pub fn judge_rate(&self) -> Result<(), Misplaced> {
        let Some(rate) = self.rate().filter(|_| self.tally.placed >= FEW) else { return Ok(()) };
        if rate.ppm.abs() <= RATE_TOLERANCE * 1e6 + 4.0 * rate.sigma_ppm {
            return Ok(());
        }
        Err(Misplaced::Rate {
            found_hz: rate.hz,
            expected_hz: 1e9 / self.nominal_ns,
            changed: false,
        })
    }
}

fn jump(before: u64, now: u64) -> Misplaced {
    Misplaced::Ahead { from_s: before as f64 * 1e-9, to_s: now as f64 * 1e-9 }
}

/// Notes the gap before a reading.
#[cold]
fn note_gap(tally: &mut Tally, read: u64, placed: &Placed, period_ns: f64, before_ns: Option<u64>) {
    if placed.missing == 0 {
        return;
    }
    if tally.gaps == 0 {
        tally.first_gap = read;
        tally.first_gap_s = before_ns.map_or(f64::NAN, |ns| ns as f64 * 1e-9);
    }
    tally.gaps += 1;
    tally.missing = tally.missing.saturating_add(placed.missing);
    tally.longest_s = tally.longest_s.max(placed.missing as f64 * period_ns * 1e-9);
}

/// Moves the state on to a reading, whose time is later than that of the one before.
#[inline]
fn placed(state: &mut State, number: u64, steps: u64, time_ns: u64, period_ns: f64) -> Placed {
    let missing = steps - 1;
    let skipped_ns = libm::round(missing as f64 * period_ns) as u64;
    let from_ns = state.time_ns.saturating_add(skipped_ns);
    let time_ns = time_ns.max(from_ns.saturating_add(1));
    (state.number, state.time_ns) = (number, time_ns);
    Placed { number, missing, time_ns, interval_ns: time_ns - from_ns }
}

/// Stamps of the readings that follow, in a ring.
#[derive(Clone, Copy, Debug)]
pub struct Ahead<'a> {
    parts: [&'a [u64]; 2],
}

impl<'a> Ahead<'a> {
    /// No reading is known yet: of a live unit.
    pub const NONE: Ahead<'static> = Ahead { parts: [&[], &[]] };

    /// Makes one of the two parts of a ring.
    #[must_use]
    pub const fn of(first: &'a [u64], second: &'a [u64]) -> Self {
        Self { parts: [first, second] }
    }

    fn stamps(&self) -> impl Iterator<Item = u64> + '_ {
        self.parts.iter().flat_map(|part| part.iter().copied()).take(AHEAD)
    }

    /// Mean distance of the stamps, the first of them from `now`, where there are [`AHEAD`] and all are regular, ns.
    fn period_ns(&self, now: u64) -> Option<f64> {
        let median = self.spacing_ns(now)?;
        let mut before = now;
        for stamp in self.stamps() {
            if ((stamp as f64 - before as f64) - median).abs() > 0.1 * median {
                return None;
            }
            before = stamp;
        }
        Some((before - now) as f64 / AHEAD as f64)
    }

    /// Median distance of the stamps, the first of them from `now`, where there are [`AHEAD`] and most are regular, ns.
    fn spacing_ns(&self, now: u64) -> Option<f64> {
        let mut apart = [0.0; AHEAD];
        let (mut before, mut n) = (now, 0);
        for stamp in self.stamps() {
            apart[n] = stamp as f64 - before as f64;
            (before, n) = (stamp, n + 1);
        }
        if n < AHEAD {
            return None;
        }
        apart.sort_by(f64::total_cmp);
        let median = apart[AHEAD / 2];
        let is_regular = |d: &&f64| (**d - median).abs() <= 0.1 * median;
        (median > 0.0 && apart.iter().filter(is_regular).count() >= AHEAD * 3 / 4).then_some(median)
    }
}
