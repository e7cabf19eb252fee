//! Progress of many cases on a terminal: rate, time left, slow cases and failures as they come.

use crate::progress_bar::ProgressBar;
use octant_base::control::SetAtEnd;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Interval of the redrawing while no case ends.
const TICK: Duration = Duration::from_millis(250);
/// A case is slow from this multiple of the mean time on.
const SLOW_FACTOR: f64 = 4.0;
/// Shortest time after which a case is slow, s.
const SLOW_S: f64 = 10.0;
/// Cases that must have ended before others count as slow.
const ENDED_LEAST: usize = 3;

/// Progress of cases, with the time given by the caller.
#[derive(Debug)]
pub struct CaseProgress {
    /// What is run: the start of the line.
    stage: String,
    /// Cases of this work, and whether a stopping rule may leave some out.
    total: usize,
    may_stop: bool,
    /// Cases run at a time.
    jobs: usize,
    begun: Instant,
    /// Cases that had results already: no measure of the speed.
    before: usize,
    /// Cases that ended in this work, and those of them that failed.
    ended: usize,
    failed: usize,
    /// Total time of the ended cases whose beginning is known, their number, and the longest, s.
    took_s: f64,
    timed: usize,
    longest_s: f64,
    /// Begin of each running case, by its place; true if it was reported as slow.
    running: BTreeMap<usize, (Instant, bool)>,
}

impl CaseProgress {
    /// Begins the progress of `total` cases, `jobs` of them at a time; a stopping rule may leave some out
    /// where `may_stop` is true.
    #[must_use]
    pub fn new(stage: &str, total: usize, jobs: usize, may_stop: bool, begun: Instant) -> Self {
        Self {
            stage: stage.to_owned(),
            total,
            may_stop,
            jobs: jobs.max(1),
            begun,
            before: 0,
            ended: 0,
            failed: 0,
            took_s: 0.0,
            timed: 0,
            longest_s: 0.0,
            running: BTreeMap::new(),
        }
    }

    /// Counts cases that have results already.
    pub fn there(&mut self, count: usize) {
        self.before += count;
    }

    /// Notes that a case has begun, by its place.
    pub fn begun(&mut self, index: usize, now: Instant) {
        self.running.insert(index, (now, false));
    }

    /// Notes the end of a case; its place is unknown where its beginning wasn't noted.
    pub fn ended(&mut self, index: Option<usize>, has_failed: bool, now: Instant) {
        self.ended += 1;
        self.failed += usize::from(has_failed);
        if let Some((begun, _)) = index.and_then(|index| self.running.remove(&index)) {
            let took_s = (now - begun).as_secs_f64();
            self.took_s += took_s;
            self.timed += 1;
            self.longest_s = self.longest_s.max(took_s);
        }
    }

    /// Mean time of a case, s; `None` before the first one has ended.
    fn mean_s(&self, now: Instant) -> Option<f64> {
        if self.timed > 0 {
            return Some(self.took_s / self.timed as f64);
        }
        // Without the beginnings, by the throughput.
        let elapsed_s = (now - self.begun).as_secs_f64();
        (self.ended > 0).then(|| elapsed_s * self.jobs as f64 / self.ended as f64)
    }

    /// Time until the end, s, from the mean time of a case. `None` while no case of this work has
    /// ended, or if the last cases take longer than any before.
    #[must_use]
    pub fn left_s(&self, now: Instant) -> Option<f64> {
        let mean_s = self.mean_s(now)?;
        let waiting =
            self.total.saturating_sub(self.before + self.ended + self.running.len()) as f64;
        let rests_s = || {
            let ages_s = self.running.values().map(|(begun, _)| (now - *begun).as_secs_f64());
            ages_s.map(|age_s| {
                // A case beyond the mean is expected to take as long as the longest one.
                if age_s < mean_s { mean_s - age_s } else { (self.longest_s - age_s).max(0.0) }
            })
        };
        let all_late = !self.running.is_empty() && rests_s().all(|rest_s| rest_s <= 0.0);
        if waiting == 0.0 && all_late {
            return None;
        }
        let work_s = waiting * mean_s + rests_s().sum::<f64>();
        // No case is divided among processors.
        Some(rests_s().fold(work_s / self.jobs as f64, f64::max))
    }

    /// Renders the words after the bar.
    #[must_use]
    pub fn words(&self, now: Instant) -> String {
        let done = self.before + self.ended;
        let mut words = format!("{done} of {} cases", self.total);
        if !self.stage.is_empty() {
            words = format!("{}: {words}", self.stage);
        }
        if self.failed > 0 {
            words += &format!(", {} failed", self.failed);
        }
        if done >= self.total {
            return words;
        }
        if self.ended > 0 {
            let per_s = self.ended as f64 / (now - self.begun).as_secs_f64().max(1e-3);
            words += &match per_s {
                1.0.. => format!(", {per_s:.1} per second"),
                _ => format!(", {:.1} per minute", 60.0 * per_s),
            };
        }
        let most = if self.may_stop { "at most " } else { "" };
        match self.left_s(now) {
            Some(left_s) => words += &format!(", {most}{} left", duration(left_s)),
            None => words += ", time left unknown",
        }
        words
    }

    /// Lists the cases that have become slow since the last call: place and time, s.
    pub fn slow(&mut self, now: Instant) -> Vec<(usize, f64)> {
        let Some(mean_s) = self.mean_s(now).filter(|_| self.ended >= ENDED_LEAST) else {
            return Vec::new();
        };
        let limit_s = (SLOW_FACTOR * mean_s).max(SLOW_S);
        let mut slow = Vec::new();
        for (index, (begun, told)) in &mut self.running {
            let age_s = (now - *begun).as_secs_f64();
            if age_s > limit_s && !std::mem::replace(told, true) {
                slow.push((*index, age_s));
            }
        }
        slow
    }
}

/// Writes a time for people, rounded up: never "0 s".
#[must_use]
pub fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).ceil().max(1.0) as u64;
    let minutes = whole.div_ceil(60);
    match whole {
        0..=99 => format!("{whole} s"),
        100..=5940 => format!("{minutes} min"),
        _ => format!("{} h {:02} min", minutes / 60, minutes % 60),
    }
}

/// Bar over the cases of one piece of work, which threads may share.
#[derive(Debug)]
pub(crate) struct CaseBar {
    bar: ProgressBar,
    progress: Mutex<CaseProgress>,
    done: AtomicBool,
}

impl CaseBar {
    /// Makes a bar over `total` cases, of which a stopping rule may leave some out.
    pub(crate) fn new(stage: &str, total: usize, jobs: usize, may_stop: bool) -> Self {
        let progress = CaseProgress::new(stage, total, jobs, may_stop, Instant::now());
        Self {
            bar: ProgressBar::new(Some(total as u64), |progress| progress.message.clone()),
            progress: Mutex::new(progress),
            done: AtomicBool::new(false),
        }
    }

    /// Shows the bar while `work` goes on; `name` gives the name of a case by its place.
    pub(crate) fn during<T>(
        &self,
        name: &(dyn Fn(usize) -> String + Sync),
        work: impl FnOnce() -> T,
    ) -> T {
        let result = std::thread::scope(|scope| {
            let ticker = self.bar.is_shown().then(|| {
                scope.spawn(|| {
                    while !self.done.load(Ordering::Relaxed) {
                        self.tick(name);
                        std::thread::park_timeout(TICK);
                    }
                })
            });
            let done = SetAtEnd(&self.done);
            let result = work();
            drop(done);
            if let Some(ticker) = ticker {
                ticker.thread().unpark();
            }
            result
        });
        self.bar.finish();
        result
    }

    /// Counts cases that have results already.
    pub(crate) fn there(&self, count: usize) {
        self.change(|progress, _| progress.there(count));
    }

    /// Notes that a case has begun.
    pub(crate) fn begun(&self, index: usize) {
        self.change(|progress, now| progress.begun(index, now));
    }

    /// Notes that a case has ended; its place is unknown where its beginning wasn't noted.
    pub(crate) fn ended(&self, index: Option<usize>, has_failed: bool) {
        self.change(|progress, now| progress.ended(index, has_failed, now));
    }

    /// Prints a line above the bar.
    pub(crate) fn note(&self, line: &str) {
        self.bar.note(line);
    }

    fn tick(&self, name: &(dyn Fn(usize) -> String + Sync)) {
        let mut slow = Vec::new();
        self.change(|progress, now| slow = progress.slow(now));
        for (index, age_s) in slow {
            self.bar.note(&format!("case {}: slow, running for {}", name(index), duration(age_s)));
        }
    }

    fn change(&self, change: impl FnOnce(&mut CaseProgress, Instant)) {
        let now = Instant::now();
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut progress, now);
        let (done, message) = (progress.before + progress.ended, progress.words(now));
        self.bar.update(|bar| {
            bar.done = done as u64;
            bar.message = message;
        });
    }
}
