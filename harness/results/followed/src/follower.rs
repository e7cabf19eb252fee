//! Takes the comparisons of a run with the truth as they come.

use crate::interval::{Errors, Interval, Told};
use crate::score::{FollowedScore, KnownNoise, Material};
use crate::window::{Past, Windows};
use octant_sample::{Navigation, NoiseIntegral, Truth};

/// Lengths of the windows, s: short ones say most of a small noise, long ones of coarse, slow and late answers.
const LENGTHS_S: [usize; 4] = [2, 10, 30, 60];
/// Longest time between two comparisons, ns: a longer one is a break.
const BREAK_NS: u64 = 2_500_000_000;

/// An answer of a navigation with the truth at it and the noise in the samples so far.
#[derive(Clone, Copy, Debug)]
pub struct Compared<'a> {
    /// Time, ns.
    pub now_ns: u64,
    /// The answer.
    pub answer: &'a Navigation,
    /// The truth.
    pub truth: &'a Truth,
    /// The noise; `None`: it isn't known.
    pub noise: Option<NoiseIntegral>,
}

/// The state at the comparison before.
#[derive(Clone, Copy, Debug)]
struct Before {
    now_ns: u64,
    answer: Navigation,
    truth: Truth,
    noise: NoiseIntegral,
}

/// Follows one run, without allocating memory after it was made.
#[derive(Clone, Debug)]
pub struct Follower {
    told: Told,
    known: KnownNoise,
    before: Option<Before>,
    broken: bool,
    state: Box<State>,
}

/// Large part of the state.
#[derive(Clone, Debug)]
struct State {
    past: Past,
    windows: [Windows; LENGTHS_S.len()],
    compared: u64,
    breaks: u64,
    unknown: u64,
    nonlinear: u64,
    turned: u64,
}

impl Follower {
    /// Creates the test of a unit that tells these quantities, with what the noise is that is known.
    #[must_use]
    pub fn new(told: Told, known: KnownNoise) -> Self {
        // The noise of an instrument is large: half an hour of the shortest windows and a part of the rest is enough.
        let is_sparse = |length_s| known == KnownNoise::Simulated && length_s < 10;
        let windows = LENGTHS_S.map(|length_s| Windows::of(length_s, is_sparse(length_s)));
        let state = State {
            past: Past::default(),
            windows,
            compared: 0,
            breaks: 0,
            unknown: 0,
            nonlinear: 0,
            turned: 0,
        };
        Self { told, known, before: None, broken: false, state: Box::new(state) }
    }

    /// Notes that the navigation isn't free, or isn't compared, between the comparisons before and after.
    #[inline]
    pub fn interrupt(&mut self) {
        self.broken = true;
    }

    /// Takes a comparison.
    #[inline(never)]
    pub fn compare(&mut self, compared: &Compared<'_>) {
        let Compared { now_ns, answer, truth, noise } = *compared;
        self.state.compared += 1;
        let broken = std::mem::take(&mut self.broken);
        let Some(noise) = noise else {
            self.state.unknown += 1;
            return self.forget();
        };
        let Some(errors) = Errors::of(answer, truth, self.told) else {
            self.state.nonlinear += 1;
            return self.forget();
        };
        let now = Before { now_ns, answer: *answer, truth: *truth, noise };
        let before = self.before.replace(now);
        let connected = before.filter(|before| {
            !broken && before.now_ns < now_ns && now_ns - before.now_ns < BREAK_NS
        });
        self.state.breaks += u64::from(connected.is_none());
        let Some(before) = connected else { return self.state.interrupt() };
        let dt_s = (now_ns - before.now_ns) as f64 * 1e-9;
        let noises = [&before.noise, &noise];
        let Some(interval) = Interval::between(&before.truth, truth, noises, dt_s) else {
            self.state.turned += 1;
            return self.state.interrupt();
        };
        let is_new = !self.is_same(&before.answer, answer);
        self.state.take(&interval, is_new.then_some(&errors));
    }

    /// Returns whether an answer is the one before.
    fn is_same(&self, before: &Navigation, now: &Navigation) -> bool {
        let velocity = before.velocity_mps == now.velocity_mps;
        let attitude = before.q_nb == now.q_nb;
        (velocity || !self.told.velocity) && (attitude || !self.told.attitude)
    }

    fn forget(&mut self) {
        self.before = None;
        self.state.interrupt();
    }

    /// Derives the result.
    #[must_use]
    pub fn score(&self) -> FollowedScore {
        let State { windows, compared, breaks, unknown, nonlinear, turned, .. } = &*self.state;
        FollowedScore::of(&Material {
            told: self.told,
            known: self.known,
            windows,
            compared: *compared,
            breaks: *breaks,
            unknown: *unknown,
            nonlinear: *nonlinear,
            turned: *turned,
        })
    }
}

impl State {
    /// Begins anew: an answer may have been held, so that the first window begins with the next new one.
    fn interrupt(&mut self) {
        self.past.clear();
        self.windows.iter_mut().for_each(Windows::interrupt);
    }

    fn take(&mut self, interval: &Interval, answered: Option<&Errors>) {
        self.past.push(interval);
        let effects = interval.effects();
        for windows in &mut self.windows {
            windows.carry(interval, &effects);
            if let Some(errors) = answered {
                windows.answer(errors, &self.past);
            }
        }
    }
}
