//! A solution from a port, while the run goes: sentences are kept with their times of arrival, the operator is asked, power and
//! table are switched, pauses are counted.
//!
//! Nothing is scored here. The file that is written is scored as one that was captured before, by the same code. The time of
//! such a run is that of its bench: it stands while a step between two run-ups waits for its answer, goes on while the unit
//! has no power, and stands where the unit is switched on later than planned.

mod clock;
mod error;
mod steps;
mod unit;

pub use self::error::AcquireError;

use self::clock::BenchClock;
use self::steps::DueSteps;
use self::unit::BenchUnit;
use crate::bench::attended::before_start;
use octant_base::control::Control;
use octant_link::capture::{ArrivalStamp, CaptureCounts, LineCapture};
use octant_link::port::{self, Port};
use octant_recorder::event::PowerRecord;
use octant_scenario::Scenario;
use octant_scenario::trajectory::SolutionLine;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant, SystemTime};

/// Longest wait in one poll of the port, which bounds the reaction to an answer and to Ctrl-C.
const WAIT: Duration = Duration::from_millis(20);
/// Pause between two attempts to open a port that went away.
const OPEN_EVERY: Duration = Duration::from_millis(200);

/// Time for which a solution without run-ups is taken beyond its duration.
const SLACK: Duration = Duration::from_secs(1);

/// End of a run on a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AcquiredEnd {
    /// As planned.
    Planned,
    /// Nothing came for so long.
    Silent(Duration),
    /// Ended from outside.
    Interrupted,
}

/// Bytes and times that were taken from a port.
#[derive(Debug)]
pub struct Acquired {
    /// Times at which the unit was switched on; of a run without run-ups its beginning.
    pub switched_on: Vec<SystemTime>,
    /// How it ended.
    pub end: AcquiredEnd,
    /// Counts of the bytes.
    pub counts: CaptureCounts,
    /// Name under which the unit reaches the port.
    pub reached_at: String,
    /// Switchings of its power, where it was switched.
    pub power: Option<PowerRecord>,
    /// How far the host's clock was set meanwhile, s.
    pub clock_set_s: Option<f64>,
}

/// A port that is open, and the scenario that wants its solution.
#[derive(Debug)]
pub struct Acquisition<'a> {
    scenario: &'a Scenario,
    line: &'a SolutionLine,
    capture: LineCapture,
    clock: BenchClock,
    steps: DueSteps<'a>,
    control: &'a Control,
    /// Time that the run stood, and the time at which it began to stand.
    stood: Duration,
    stands: Option<SystemTime>,
    tried: Instant,
}

/// Times of a plan.
#[derive(Clone, Copy, Debug)]
struct Times {
    run_up: Duration,
    every: Duration,
    run_ups: u32,
}

impl Times {
    fn of(scenario: &Scenario) -> Self {
        let run_up_s = scenario.navigation.as_ref().and_then(|plan| plan.duration_s).unwrap_or(0.0);
        let (run_ups, off_s) =
            scenario.heading_test.as_ref().map_or((1, 0.0), |test| (test.run_ups, test.off_s));
        // A duration counts from the first point on, which comes some bytes later.
        let slack = if scenario.heading_test.is_some() { Duration::ZERO } else { SLACK };
        let run_up = Duration::from_secs_f64(run_up_s) + slack;
        Self { run_up, every: run_up + Duration::from_secs_f64(off_s), run_ups }
    }
}

/// Takes the solution of a scenario from its port into a new file. `begun` is told the times of switching on, after each.
///
/// # Errors
/// If the port can't be opened, or the bench fails.
pub fn acquire(
    scenario: &Scenario,
    file: &Path,
    control: &Control,
    mut begun: impl FnMut(&[SystemTime]),
) -> Result<Acquired, AcquireError> {
    let Some(line) = scenario.solution_line() else {
        return Err(AcquireError::NoLine {
            found: scenario.method_label(octant_scenario::Method::Primary),
        });
    };
    let mut ended = Acquired {
        switched_on: Vec::new(),
        end: AcquiredEnd::Interrupted,
        counts: CaptureCounts::default(),
        reached_at: line.uri.to_string(),
        power: None,
        clock_set_s: None,
    };
    if !before_start(scenario, control)? {
        return Ok(ended);
    }
    let mut unit = BenchUnit::start(scenario)?;
    unit.turn(0, control)?;
    // The port is open before the unit has power: nothing that it sends is missed.
    let port = open(line, control)?;
    let stamp = (!line.rehearsal).then_some(ArrivalStamp::Written);
    let capture = LineCapture::new(port, file, stamp)
        .map_err(|error| AcquireError::File { file: file.to_owned(), error })?;
    ended.reached_at = capture.reached_at();
    let mut run = Acquisition {
        scenario,
        line,
        capture,
        clock: if line.rehearsal { BenchClock::line() } else { BenchClock::host() },
        steps: DueSteps::of(scenario, control),
        control,
        stood: Duration::ZERO,
        stands: None,
        tried: Instant::now(),
    };
    let end = run.run(&mut unit, &mut ended.switched_on, &mut begun);
    let written = run.write(true);
    let unit_ended = unit.end(end.is_err());
    (ended.counts, ended.clock_set_s) = (run.capture.counts(), run.clock.set_s());
    ended.end = end?;
    written?;
    ended.power = unit_ended?;
    Ok(ended)
}

/// Opens the port of a unit, which may come only when it has power.
fn open(line: &SolutionLine, control: &Control) -> Result<Box<dyn port::Bytes>, AcquireError> {
    let begun = Instant::now();
    loop {
        match port::open_instrument(&line.uri) {
            Ok(Port::Bytes(port)) => return Ok(port),
            Ok(Port::Frames(_)) => {
                return Err(AcquireError::NoLine { found: line.uri.to_string() });
            }
            Err(error) => {
                let is_over =
                    begun.elapsed() >= line.silence || control.cancel.load(Ordering::Relaxed);
                if is_over {
                    return Err(error.into());
                }
            }
        }
        std::thread::sleep(OPEN_EVERY);
    }
}

impl Acquisition<'_> {
    /// Takes what comes until the end of the plan.
    fn run(
        &mut self,
        unit: &mut BenchUnit,
        switched_on: &mut Vec<SystemTime>,
        begun: &mut dyn FnMut(&[SystemTime]),
    ) -> Result<AcquiredEnd, AcquireError> {
        let times = Times::of(self.scenario);
        unit.switch(true)?;
        let mut is_on = true;
        // A heading test begins when the unit is switched on, another run with the first byte.
        let is_test = self.scenario.heading_test.is_some();
        let first = loop {
            match self.clock.now() {
                Some(now) if is_test || self.capture.first().is_some() => break now,
                _ => {
                    if let Some(end) = self.take(true)? {
                        return Ok(end);
                    }
                }
            }
        };
        // A supply takes its time to come up: the command counts.
        let by_line = self.line.rehearsal;
        let on = |unit: &BenchUnit, now| unit.switched_at().filter(|_| !by_line).unwrap_or(now);
        let first = if is_test { on(unit, first) } else { first };
        switched_on.push(first);
        begun(switched_on);
        loop {
            // While a step holds the run a person may have cut the power.
            if let Some(end) = self.take(is_on && self.stands.is_none())? {
                return Ok(end);
            }
            let Some(now) = self.clock.now() else { continue };
            let elapsed = |stood: Duration| {
                now.duration_since(first).unwrap_or_default().saturating_sub(stood)
            };
            let number = switched_on.len() as u32;
            let on_again = times.every * number;
            let at = elapsed(self.stood);
            if self.stands.is_none() {
                // A pause that lasts longer than planned isn't time of the run.
                self.steps.ask(if is_on { at } else { at.min(on_again) });
            }
            if self.steps.hold() {
                self.stands.get_or_insert(now);
                continue;
            }
            if let Some(since) = self.stands.take() {
                self.stood += now.duration_since(since).unwrap_or_default();
            }
            let at = elapsed(self.stood);
            if is_on && at >= times.every * (number - 1) + times.run_up {
                if number == times.run_ups {
                    return Ok(AcquiredEnd::Planned);
                }
                unit.switch(false)?;
                unit.turn(number as usize, self.control)?;
                is_on = false;
            }
            if !is_on && at >= on_again {
                unit.switch(true)?;
                self.capture.begin_again();
                is_on = true;
                // A run-up has its whole length, also where a table or a supply took longer than the pause.
                let now = self.clock.now().unwrap_or(now);
                self.stood = now.duration_since(first).unwrap_or_default().saturating_sub(on_again);
                switched_on.push(on(unit, now));
                begun(switched_on);
            }
        }
    }

    /// Takes what comes in a short time; returns the end, if it is one. A unit without power may be silent.
    fn take(&mut self, expects: bool) -> Result<Option<AcquiredEnd>, AcquireError> {
        if self.control.cancel.load(Ordering::Relaxed) {
            return Ok(Some(AcquiredEnd::Interrupted));
        }
        match self.capture.receive(WAIT) {
            Ok(came) => self.clock.take(came),
            // A unit that restarts may take its port along.
            Err(_) => {
                if self.tried.elapsed() >= OPEN_EVERY {
                    self.tried = Instant::now();
                    self.capture.reopen();
                }
                std::thread::sleep(WAIT);
            }
        }
        self.write(false)?;
        // In a rehearsal the line tells the time, also of a unit without power.
        if !expects && !self.line.rehearsal {
            self.capture.expect_from_now();
        }
        let silent = self.capture.silent_for();
        Ok((silent >= self.line.silence).then_some(AcquiredEnd::Silent(silent)))
    }

    /// Writes what came, where it is due or `now`.
    fn write(&mut self, now: bool) -> Result<(), AcquireError> {
        let written = if now { self.capture.write() } else { self.capture.write_if_due() };
        let file = || self.capture.path().to_owned();
        written.map_err(|error| AcquireError::File { file: file(), error })
    }
}
