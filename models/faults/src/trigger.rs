//! Onset, duration, fading and repetition of a fault.
//!
//! Times are epochs of the source, numbered from 1. A fault that sets in at time t first alters the
//! sample of the interval that begins at t: epoch `t / period + 1`. Triggers that depend on the
//! core are decided on its answer to the epoch before.

use alloc::string::String;
use octant_random::normal::{uniform, words};
use octant_random::philox::StreamKey;
use octant_sample::{Health, Mode, Output, Truth};
use octant_state::StateError;

/// Trigger, duration and repetition of a fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Trigger of the onset.
    pub trigger: Trigger,
    /// Duration, epochs; `None`: to the end of the run. An instant lasts one epoch.
    pub duration: Option<u64>,
    /// Epochs over which it fades.
    pub recovery: u64,
    /// Repetition.
    pub repeat: Repeat,
}

/// Trigger of a fault.
#[derive(Clone, Debug, PartialEq)]
pub enum Trigger {
    /// An epoch of the source, from 1.
    Epoch(u64),
    /// A delay after the core has arrived at a stop, in a mode.
    Position {
        /// The stop, from 0, over all passes.
        stop: u16,
        /// Calibrating or navigating.
        mode: Mode,
        /// Epochs after the arrival.
        delay: u64,
    },
    /// A delay after the core has set out for a stop, in a mode.
    Move {
        /// The stop, from 0, over all passes.
        stop: u16,
        /// Calibrating or navigating.
        mode: Mode,
        /// Epochs after the start.
        delay: u64,
    },
    /// A delay after the core has entered a mode.
    Mode {
        /// The mode.
        mode: Mode,
        /// Epochs after the entry.
        delay: u64,
    },
    /// A delay after a signal has crossed a value.
    Condition {
        /// Signal.
        signal: Signal,
        /// Above or below.
        comparison: ThresholdSide,
        /// The value, SI.
        value: f64,
        /// Epochs after the crossing.
        delay: u64,
    },
    /// Periodic onsets.
    Periodic {
        /// First epoch.
        first: u64,
        /// Distance of the onsets, epochs.
        period: u64,
        /// No onset after this epoch.
        last: Option<u64>,
    },
    /// Random onsets: the waiting time from the end of one to the onset of the next is exponential.
    Poisson {
        /// No onset before this epoch.
        first: u64,
        /// No onset after this epoch.
        last: Option<u64>,
        /// Mean waiting time, epochs.
        mean: f64,
    },
    /// A delay after another fault has ended.
    After {
        /// Id of the other fault.
        fault: String,
        /// Epochs after its end.
        delay: u64,
    },
    /// By hand: [`crate::Station::fire`].
    Manual,
    /// A delay after a condition has come true that the caller evaluates: on connections, where
    /// there is no core; see [`crate::connection::ConnectionStation::begin`].
    Outside {
        /// Epochs after the condition.
        delay: u64,
    },
}

/// Repetition of a fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Repeat {
    /// No repetition (triggers that repeat by themselves still do).
    #[default]
    Once,
    /// A number of onsets, at this distance.
    Times {
        /// Onsets in all.
        times: u32,
        /// Distance of the onsets, epochs.
        every: u64,
    },
    /// Again whenever the trigger comes true.
    EveryTime,
}

/// Signal of a condition. All values are those of the epoch before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// NIS of the last measurement.
    Nis,
    /// Any of these health flags: 1 if one is set, else 0.
    Health(Health),
    /// Velocity of the navigation solution: 0 north, 1 east, 2 down, m/s.
    Velocity(usize),
    /// Magnitude of the latitude error of the navigation solution, rad.
    LatitudeError,
    /// Magnitude of the longitude error of the navigation solution, rad.
    LongitudeError,
    /// True gimbal angle: 0 azimuth, 1 roll, rad.
    TrueGimbal(usize),
    /// True velocity: 0 north, 1 east, 2 down, m/s.
    TrueVelocity(usize),
}

impl Signal {
    /// Returns whether the signal needs truth, which only a simulated source has.
    #[must_use]
    pub const fn needs_truth(self) -> bool {
        matches!(
            self,
            Self::LatitudeError
                | Self::LongitudeError
                | Self::TrueGimbal(_)
                | Self::TrueVelocity(_)
        )
    }

    /// Value of the signal; NaN if there is none.
    fn value(self, output: &Output, truth: Option<&Truth>) -> f64 {
        let of = |f: fn(&Truth) -> f64| truth.map_or(f64::NAN, f);
        match self {
            Self::Nis => output.nis,
            Self::Health(flags) => f64::from(u8::from(output.health.intersects(flags))),
            Self::Velocity(axis) => output.navigation.velocity_mps[axis % 3],
            Self::LatitudeError => {
                (output.navigation.latitude_rad - of(|truth| truth.latitude_rad)).abs()
            }
            Self::LongitudeError => {
                (output.navigation.longitude_rad - of(|truth| truth.longitude_rad)).abs()
            }
            Self::TrueGimbal(0) => of(|truth| truth.gimbal_rad[0]),
            Self::TrueGimbal(_) => of(|truth| truth.gimbal_rad[1]),
            Self::TrueVelocity(axis) => truth.map_or(f64::NAN, |t| t.velocity_mps[axis % 3]),
        }
    }
}

/// Side of the value on which a condition is true.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThresholdSide {
    /// Above it.
    Above,
    /// Below it.
    Below,
}

impl Trigger {
    /// First epoch at which the trigger can come true, if time alone decides.
    #[must_use]
    pub fn earliest(&self) -> Option<u64> {
        match self {
            Self::Epoch(first) | Self::Periodic { first, .. } | Self::Poisson { first, .. } => {
                Some(*first)
            }
            _ => None,
        }
    }
}

/// State of the core at the epoch before, as far as triggers depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Scene {
    mode: Mode,
    stop: u16,
    moving: bool,
}

impl Scene {
    #[inline]
    pub(crate) fn of(output: &Output) -> Self {
        Self { mode: output.mode, stop: output.stop, moving: output.moving }
    }

    /// Packs the scene into one word, to be compared in one step.
    #[inline]
    pub(crate) fn packed(self) -> u32 {
        1 << 31 | (self.mode as u32) << 17 | u32::from(self.moving) << 16 | u32::from(self.stop)
    }
}

/// Input of the triggers at an epoch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct News<'a> {
    pub(crate) epoch: u64,
    /// The scene before and now.
    pub(crate) before: Option<Scene>,
    pub(crate) scene: Scene,
    pub(crate) output: &'a Output,
    pub(crate) truth: Option<&'a Truth>,
}

/// Stage in the life of a fault.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) enum State {
    /// Waits for its trigger.
    Waiting,
    /// Waits for a known epoch.
    Pending(u64),
    /// Acts, from its onset until before an epoch.
    Active { onset: u64, until: u64 },
    /// Fades.
    Fading { onset: u64, from: u64, until: u64 },
    /// Won't come back.
    Spent,
}

/// The clock of one fault.
#[derive(Clone, Debug)]
pub(crate) struct Clock {
    schedule: Schedule,
    /// Key of the random numbers of a Poisson trigger, one for each onset.
    key: StreamKey,
    pub(crate) state: State,
    pub(crate) firings: u32,
    /// True if the condition held at the epoch before.
    held: bool,
}

octant_state::state! { Clock { values: state, firings, held; parts: ; kept: schedule, key } }

/// Result of a clock at an epoch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ticked {
    pub(crate) began: bool,
    pub(crate) ended: bool,
}

impl Clock {
    pub(crate) fn new(schedule: Schedule, key: StreamKey) -> Self {
        let mut clock = Self { schedule, key, state: State::Waiting, firings: 0, held: false };
        clock.state = match clock.schedule.trigger {
            Trigger::Epoch(first) | Trigger::Periodic { first, .. } => State::Pending(first.max(1)),
            Trigger::Poisson { first, last, .. } => {
                clock.up_to(last, first.max(1).saturating_add(clock.waiting()))
            }
            _ => State::Waiting,
        };
        clock
    }

    /// Checks that a loaded clock is possible after an epoch.
    pub(crate) fn check(&self, epoch: u64) -> Result<(), StateError> {
        octant_state::check_below("firings", self.firings.into(), 1 << 31)?;
        let (onset, until) = match self.state {
            State::Active { onset, until } => (onset, until),
            State::Fading { onset, from, until } => {
                octant_state::check_below("from", from, epoch)?;
                (onset, until)
            }
            State::Waiting | State::Pending(_) | State::Spent => return Ok(()),
        };
        octant_state::check_below("onset", onset, epoch)?;
        let first = self.schedule.trigger.earliest().unwrap_or(0);
        octant_state::check_below("first onset", first, onset)?;
        if until <= epoch {
            let problem = alloc::format!("{until} was found, more than {epoch} is expected");
            return Err(StateError::value("until", problem));
        }
        Ok(())
    }

    pub(crate) fn trigger(&self) -> &Trigger {
        &self.schedule.trigger
    }

    /// Returns whether the trigger has to be evaluated in every epoch.
    pub(crate) fn has_condition(&self) -> bool {
        matches!(self.schedule.trigger, Trigger::Condition { .. })
    }

    pub(crate) fn needs_truth(&self) -> bool {
        matches!(&self.schedule.trigger, Trigger::Condition { signal, .. } if signal.needs_truth())
    }

    /// The next epoch at which time alone changes something.
    pub(crate) fn wake(&self) -> u64 {
        match self.state {
            State::Pending(at) => at,
            State::Active { until, .. } | State::Fading { until, .. } => until,
            State::Waiting | State::Spent => u64::MAX,
        }
    }

    /// Strength at an epoch: 1 while the fault lasts, then falling linearly.
    pub(crate) fn strength(&self, epoch: u64) -> f64 {
        match self.state {
            State::Active { .. } => 1.0,
            State::Fading { from, until, .. } => (until - epoch) as f64 / (until - from + 1) as f64,
            _ => 0.0,
        }
    }

    /// Onset of the present firing.
    pub(crate) fn onset(&self) -> Option<u64> {
        match self.state {
            State::Active { onset, .. } | State::Fading { onset, .. } => Some(onset),
            _ => None,
        }
    }

    /// Lets the fault set in at an epoch, if it waits.
    pub(crate) fn fire(&mut self, epoch: u64) -> bool {
        let waits = matches!(self.state, State::Waiting);
        if waits {
            self.state = State::Pending(epoch);
        }
        waits
    }

    /// Ends the fault at an epoch, if it lasts; if it would set in then, it doesn't.
    pub(crate) fn cut(&mut self, epoch: u64) -> bool {
        match &mut self.state {
            State::Active { until, .. } => *until = epoch,
            State::Pending(_) => self.state = State::Waiting,
            State::Waiting | State::Fading { .. } | State::Spent => return false,
        }
        true
    }

    /// Takes note that another fault has ended at an epoch.
    pub(crate) fn other_ended(&mut self, epoch: u64) {
        if let (State::Waiting, Trigger::After { delay, .. }) = (self.state, &self.schedule.trigger)
        {
            self.state = State::Pending(epoch.saturating_add(*delay));
        }
    }

    /// Evaluates the trigger.
    pub(crate) fn look(&mut self, news: &News<'_>) {
        let Some(delay) = self.comes_true(news) else { return };
        if self.state == State::Waiting {
            self.state = State::Pending(news.epoch.saturating_add(delay));
        }
    }

    /// Returns whether the fault sets in with this news, and changes nothing.
    pub(crate) fn sets_in(&self, news: &News<'_>) -> bool {
        // These two wait for what another fault or a person does.
        let waits_for_others =
            matches!(self.schedule.trigger, Trigger::After { .. } | Trigger::Manual);
        if waits_for_others && self.state == State::Waiting {
            return false;
        }
        let mut next = self.clone();
        next.look(news);
        next.tick(news.epoch).began
    }

    /// Takes note whether the condition held that the caller evaluates.
    pub(crate) fn look_outside(&mut self, epoch: u64, holds: bool) {
        let held = core::mem::replace(&mut self.held, holds);
        let crossed = holds && !held;
        if let (true, State::Waiting, Trigger::Outside { delay }) =
            (crossed, self.state, &self.schedule.trigger)
        {
            self.state = State::Pending(epoch.saturating_add(*delay));
        }
    }

    fn comes_true(&mut self, news: &News<'_>) -> Option<u64> {
        let edge = |holds: fn(&Scene, u16) -> bool, mode: Mode, stop: u16| {
            let in_it = |scene: &Scene| scene.mode == mode && holds(scene, stop);
            in_it(&news.scene) && !news.before.as_ref().is_some_and(in_it)
        };
        match self.schedule.trigger {
            Trigger::Position { stop, mode, delay } => {
                edge(|scene, stop| scene.stop == stop && !scene.moving, mode, stop).then_some(delay)
            }
            Trigger::Move { stop, mode, delay } => {
                edge(|scene, stop| scene.stop == stop && scene.moving, mode, stop).then_some(delay)
            }
            Trigger::Mode { mode, delay } => edge(|_, _| true, mode, 0).then_some(delay),
            Trigger::Condition { signal, comparison, value, delay } => {
                let found = signal.value(news.output, news.truth);
                if found.is_nan() {
                    // Without a measurement the earlier result is neither confirmed nor refuted.
                    return None;
                }
                let holds = match comparison {
                    ThresholdSide::Above => found > value,
                    ThresholdSide::Below => found < value,
                };
                let crossed = holds && !self.held;
                self.held = holds;
                crossed.then_some(delay)
            }
            _ => None,
        }
    }

    /// Advances to an epoch.
    pub(crate) fn tick(&mut self, epoch: u64) -> Ticked {
        let mut ticked = Ticked::default();
        // Each turn advances by one state; a life has three of them.
        for _ in 0..4 {
            match self.state {
                State::Pending(at) if epoch >= at && !ticked.ended => {
                    let until =
                        self.schedule.duration.map_or(u64::MAX, |n| epoch.saturating_add(n));
                    self.state = State::Active { onset: epoch, until };
                    self.firings += 1;
                    ticked.began = true;
                }
                State::Active { onset, until } if epoch >= until => {
                    if self.schedule.recovery > 0 {
                        let until = epoch.saturating_add(self.schedule.recovery);
                        self.state = State::Fading { onset, from: epoch, until };
                    } else {
                        self.state = self.next(onset, epoch);
                        ticked.ended = true;
                    }
                }
                State::Fading { onset, until, .. } if epoch >= until => {
                    self.state = self.next(onset, epoch);
                    ticked.ended = true;
                }
                _ => break,
            }
        }
        ticked
    }

    /// State after an end.
    fn next(&self, onset: u64, epoch: u64) -> State {
        match (&self.schedule.trigger, self.schedule.repeat) {
            (Trigger::Periodic { first, period, last }, _) => {
                // Counted from the first onset, so that no error accumulates.
                let periods = (onset - (*first).max(1)) / period.max(&1) + 1;
                self.up_to(*last, (*first).max(1).saturating_add(periods.saturating_mul(*period)))
            }
            (Trigger::Poisson { last, .. }, _) => {
                self.up_to(*last, epoch.saturating_add(self.waiting()))
            }
            (_, Repeat::Times { times, every }) if self.firings < times => {
                State::Pending(onset.saturating_add(every).max(epoch))
            }
            (_, Repeat::EveryTime) => State::Waiting,
            _ => State::Spent,
        }
    }

    fn up_to(&self, last: Option<u64>, at: u64) -> State {
        if last.is_some_and(|last| at > last) { State::Spent } else { State::Pending(at) }
    }

    /// Exponential waiting time of the next onset, epochs.
    fn waiting(&self) -> u64 {
        let Trigger::Poisson { mean, .. } = self.schedule.trigger else { return 0 };
        let [word, ..] = words(self.key, u64::from(self.firings));
        let wait = -mean * libm::log(uniform(word));
        // May lie beyond any run; the cast saturates.
        wait as u64
    }
}
