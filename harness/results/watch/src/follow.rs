//! Follows a run to its end: its recording, then its verdict.

use super::about::About;
use super::place::RunPlace;
use super::state::RunState;
use super::tail::{PollEnd, Tail, TailError};
use octant_evidence::ended;
use octant_evidence::planned::unplanned;
use octant_evidence::statements::SCENARIO;
use octant_recorder::reader::Item;
use octant_scenario::Scenario;
use octant_score::judge::derive;
use octant_score::rederive;
use octant_score::summary::Summary;
use octant_verdict::Verdict;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Maximum number of messages per poll: takes a moment, however long the recording.
const MESSAGES: usize = 20_000;
/// Wall time over which the speed of a run is averaged.
const SPEED_OVER: Duration = Duration::from_secs(5);

/// Stage of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Stage {
    /// The recording isn't there yet.
    Starting,
    /// The run is in progress. Its recording may be known up to a point only.
    Running,
    /// The recording is complete, and the verdict isn't there yet.
    Recorded,
    /// The run has ended, with this verdict.
    Ended(Box<Summary>),
    /// The recording ends in the middle, and no program writes it any more.
    BrokenOff,
    /// The recording is complete, no program works on the run any more, and its folder isn't whole: it has no verdict.
    Unjudged,
}

impl Stage {
    /// Returns whether nothing more will come.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        matches!(self, Self::Ended(_) | Self::BrokenOff | Self::Unjudged)
    }
}

/// Follows a run.
pub struct Follow {
    /// Place of the run.
    pub place: RunPlace,
    /// State of the run.
    pub state: RunState,
    /// Stage of the run.
    pub stage: Stage,
    tail: Tail,
    has_head: bool,
    /// True if the last poll found no writer, and no verdict.
    is_left: bool,
    /// Wall time and run time, the oldest first.
    marks: VecDeque<(Instant, u64)>,
}

impl Follow {
    /// Creates a follower of the run at this place.
    #[must_use]
    pub fn new(place: RunPlace) -> Self {
        Self {
            tail: Tail::new(place.clone()),
            place,
            state: RunState::default(),
            stage: Stage::Starting,
            has_head: false,
            is_left: false,
            marks: VecDeque::new(),
        }
    }

    /// Reads the messages that are there, and passes each to `each` after it was taken. Returns
    /// true if more are there already.
    ///
    /// # Errors
    /// If the recording can't be read, is damaged, or was replaced by another one.
    pub fn look(&mut self, mut each: impl FnMut(&RunState, u64, &Item)) -> Result<bool, TailError> {
        if self.stage.is_over() {
            return Ok(false);
        }
        // Checked before the poll: a program that has released the run by now has written
        // everything.
        let is_written = self.place.is_written();
        let (state, has_head, place) = (&mut self.state, &mut self.has_head, &self.place);
        let reached = self.tail.look(MESSAGES, |info, time_ns, item| {
            if !*has_head {
                *has_head = true;
                *state = RunState::new(About::of(info, place.folder()));
            }
            state.take(time_ns, &item);
            each(state, time_ns, &item);
        })?;
        self.head();
        if reached != PollEnd::More {
            self.mark();
        }
        let was_left = std::mem::take(&mut self.is_left);
        self.stage = match reached {
            PollEnd::More => Stage::Running,
            PollEnd::Present if is_written && self.has_head => Stage::Running,
            PollEnd::Present if is_written => Stage::Starting,
            // An interrupted run has a verdict too. As long as a program writes the run, nothing in its folder is final.
            PollEnd::End if is_written => Stage::Recorded,
            _ => match self.summary() {
                Some(summary) => Stage::Ended(Box::new(summary)),
                // A run that is being renamed has its verdict at the next poll.
                None if !was_left => {
                    self.is_left = true;
                    if self.has_head { Stage::Running } else { Stage::Starting }
                }
                None if reached == PollEnd::End => Stage::Unjudged,
                None => Stage::BrokenOff,
            },
        };
        Ok(reached == PollEnd::More)
    }

    /// Reads the head of a run without messages.
    fn head(&mut self) {
        if self.has_head {
            return;
        }
        if let Some(info) = self.tail.info().filter(|info| !info.scenario.is_empty()) {
            self.state = RunState::new(About::of(info, self.place.folder()));
            self.has_head = true;
        }
    }

    fn mark(&mut self) {
        let now = Instant::now();
        if self.marks.back().is_none_or(|(_, ns)| *ns != self.state.time_ns) {
            self.marks.push_back((now, self.state.time_ns));
        }
        while self.marks.len() > 2
            && self.marks.get(1).is_some_and(|(at, _)| now.duration_since(*at) > SPEED_OVER)
        {
            self.marks.pop_front();
        }
    }

    /// Returns the recent ratio of run time to wall time; `None` if it isn't known.
    #[must_use]
    pub fn speed(&self) -> Option<f64> {
        let ((start, from_ns), (end, to_ns)) = (self.marks.front()?, self.marks.back()?);
        let wall_s = end.duration_since(*start).as_secs_f64();
        let run_s = to_ns.checked_sub(*from_ns)? as f64 * 1e-9;
        (wall_s > 0.5 && self.stage == Stage::Running).then(|| run_s / wall_s)
    }

    /// Returns the remaining wall time at this speed, s.
    #[must_use]
    pub fn left_s(&self) -> Option<f64> {
        let length_ns = self.state.about.length_ns?;
        let speed = if self.state.about.by_clock { 1.0 } else { self.speed()? };
        Some(length_ns.saturating_sub(self.state.time_ns) as f64 * 1e-9 / speed)
            .filter(|left_s| left_s.is_finite())
    }

    /// Reads the verdict, once the folder is whole.
    fn summary(&self) -> Option<Summary> {
        // Files that are being written can't be read yet, and are read again.
        let mut summary = ended::summary(self.place.folder()).ok()??;
        // A verdict that contradicts the summary's numbers isn't shown.
        let mut found = rederive::contradictions(&summary);
        if let Ok(scenario) = Scenario::load(&self.place.folder().join(SCENARIO), &[]) {
            found.extend(unplanned(&scenario, &summary));
        }
        if !found.is_empty() {
            summary.verdict = derive(&summary).verdict.worst(Verdict::Error);
            let told =
                found.into_iter().map(|what| format!("summary.json contradicts itself: {what}"));
            summary.reasons = told.collect();
        }
        Some(summary)
    }
}
