//! A run from now to its end: its recording, then its verdict.

use super::about::About;
use super::place::Place;
use super::state::State;
use super::tail::{Reached, Tail, TailError};
use octant_recorder::reader::Item;
use octant_requirements::Verdict;
use octant_score::judge::derive;
use octant_score::rederive;
use octant_score::summary::Summary;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Messages that one look takes at most: a moment for people, however long the recording.
const MESSAGES: usize = 20_000;
/// Wall time over which the speed of a run is taken.
const SPEED_OVER: Duration = Duration::from_secs(5);

/// How far a run is.
#[derive(Clone, Debug, PartialEq)]
pub enum Stage {
    /// Its recording isn't there yet.
    Starting,
    /// It goes on. Its recording may be known up to a point only.
    Running,
    /// Everything is recorded, and the verdict isn't there yet.
    Recorded,
    /// It has ended, with this verdict.
    Ended(Box<Summary>),
    /// Its recording ends in the middle, and nobody writes it any more.
    BrokenOff,
    /// Its recording is whole, nobody works on it any more, and it has no verdict.
    Unjudged,
}

impl Stage {
    /// Nothing more will come.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        matches!(self, Self::Ended(_) | Self::BrokenOff | Self::Unjudged)
    }
}

/// Follows a run.
pub struct Follow {
    /// Where it is.
    pub place: Place,
    /// What is known of it.
    pub state: State,
    /// How far it is.
    pub stage: Stage,
    tail: Tail,
    has_head: bool,
    /// The last look found nobody who writes, and no verdict.
    is_left: bool,
    /// Wall and run time, the oldest first.
    marks: VecDeque<(Instant, u64)>,
}

impl Follow {
    /// Of the run at this place.
    #[must_use]
    pub fn new(place: Place) -> Self {
        Self {
            tail: Tail::new(place.clone()),
            place,
            state: State::default(),
            stage: Stage::Starting,
            has_head: false,
            is_left: false,
            marks: VecDeque::new(),
        }
    }

    /// Takes what is there, and gives every message to `each` after it was taken. True where more
    /// is there already.
    ///
    /// # Errors
    /// If the recording can't be read, is damaged, or another one has taken its place.
    pub fn look(&mut self, mut each: impl FnMut(&State, u64, &Item)) -> Result<bool, TailError> {
        if self.stage.is_over() {
            return Ok(false);
        }
        // Asked before the look: who has let go of the run has written everything that it will.
        let is_written = self.place.is_written();
        let (state, has_head, place) = (&mut self.state, &mut self.has_head, &self.place);
        let reached = self.tail.look(MESSAGES, |info, time_ns, item| {
            if !*has_head {
                *has_head = true;
                *state = State::new(About::of(info, place.folder()));
            }
            state.take(time_ns, &item);
            each(state, time_ns, &item);
        })?;
        self.head();
        if reached != Reached::More {
            self.mark();
        }
        let was_left = std::mem::take(&mut self.is_left);
        self.stage = match reached {
            Reached::More => Stage::Running,
            Reached::Present if is_written && self.has_head => Stage::Running,
            Reached::Present if is_written => Stage::Starting,
            // A run that was interrupted has a verdict too.
            _ => match self.summary() {
                Some(summary) => Stage::Ended(Box::new(summary)),
                None if is_written => Stage::Recorded,
                // A run that gets its name just now has its verdict at the next look.
                None if !was_left => {
                    self.is_left = true;
                    if self.has_head { Stage::Running } else { Stage::Starting }
                }
                None if reached == Reached::End => Stage::Unjudged,
                None => Stage::BrokenOff,
            },
        };
        Ok(reached == Reached::More)
    }

    /// A run without a message has a head, too.
    fn head(&mut self) {
        if self.has_head {
            return;
        }
        if let Some(info) = self.tail.info().filter(|info| !info.scenario.is_empty()) {
            self.state = State::new(About::of(info, self.place.folder()));
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

    /// Run time over wall time of late; `None` where it isn't known.
    #[must_use]
    pub fn speed(&self) -> Option<f64> {
        let ((start, from_ns), (end, to_ns)) = (self.marks.front()?, self.marks.back()?);
        let wall_s = end.duration_since(*start).as_secs_f64();
        let run_s = to_ns.checked_sub(*from_ns)? as f64 * 1e-9;
        (wall_s > 0.5 && self.stage == Stage::Running).then(|| run_s / wall_s)
    }

    /// Wall time that is left at this speed, s.
    #[must_use]
    pub fn left_s(&self) -> Option<f64> {
        let length_ns = self.state.about.length_ns?;
        let speed = if self.state.about.by_clock { 1.0 } else { self.speed()? };
        Some(length_ns.saturating_sub(self.state.time_ns) as f64 * 1e-9 / speed)
            .filter(|left_s| left_s.is_finite())
    }

    /// The verdict, once it is written whole.
    fn summary(&self) -> Option<Summary> {
        let path = self.place.file("summary.json")?;
        // A file that is being written is no JSON yet, and is looked at again.
        let mut summary: Summary = serde_json::from_slice(&std::fs::read(path).ok()?).ok()?;
        // What it says of itself isn't shown where its numbers come to something else.
        let found = rederive::contradictions(&summary);
        if !found.is_empty() {
            summary.verdict = derive(&summary).verdict.worst(Verdict::Error);
            let told =
                found.into_iter().map(|what| format!("summary.json contradicts itself: {what}"));
            summary.reasons = told.collect();
        }
        Some(summary)
    }
}
