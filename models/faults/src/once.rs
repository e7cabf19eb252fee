//! A trigger alone, for what isn't a fault: it comes true once.

use crate::trigger::{Clock, News, Repeat, Scene, Schedule, Trigger};
use octant_random::stream::{Phase, key};
use octant_sample::Output;

/// A trigger that is evaluated before each epoch, and comes true once at most. Signals that need truth have none.
#[derive(Clone, Debug)]
pub struct TriggerOnce {
    clock: Clock,
    before: Option<Scene>,
}

impl TriggerOnce {
    /// Makes it, before the first epoch.
    #[must_use]
    pub fn new(trigger: Trigger) -> Self {
        let schedule = Schedule { trigger, duration: Some(1), recovery: 0, repeat: Repeat::Once };
        // Only random triggers draw, and these come true more than once.
        Self { clock: Clock::new(schedule, key(0, "once", Phase::Calibration)), before: None }
    }

    /// Returns whether it comes true at the epoch of this number, from 1; `output` is the core's answer to the one
    /// before. Has to be called at every epoch until it is true.
    pub fn comes_true(&mut self, epoch: u64, output: &Output) -> bool {
        let scene = Scene::of(output);
        let news = News { epoch, before: self.before, scene, output, truth: None };
        self.before = Some(scene);
        self.clock.look(&news);
        self.clock.tick(epoch).began
    }
}
