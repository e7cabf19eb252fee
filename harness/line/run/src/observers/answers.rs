//! The unit's answers: whether they keep the rules and follow their input, and whether the bench kept its own limits.

use super::follow::RunFollower;
use octant_endpoint::Tells;
use octant_endpoint::answer::{AnswerCheck, Misbehaviour};
use octant_sample::Output;
use octant_sample::parameters::ParameterEstimate;
use octant_source::Epoch;

/// First violation of a real-time limit by the bench.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchBroke {
    /// Time of the source, s.
    pub at_s: f64,
    /// Violation, in plain words.
    pub reason: String,
}

/// Checks of the answers of a run.
#[derive(Clone, Debug)]
pub struct Answers {
    check: AnswerCheck,
    follow: RunFollower,
    /// First rule that the unit's answers broke, which ended the run.
    pub misbehaved: Option<Misbehaviour>,
    /// First real-time limit that the bench violated: nothing after it counts.
    pub bench_broke: Option<BenchBroke>,
}

impl Answers {
    /// Creates the checks for a unit that reports these quantities; `None`: its solution isn't checked.
    pub(super) fn new(tells: Option<Tells>) -> Self {
        Self {
            check: AnswerCheck::new(),
            follow: RunFollower::new(tells),
            misbehaved: None,
            bench_broke: None,
        }
    }

    /// Begins anew after a restart of the unit.
    pub(super) fn restarted(&mut self) {
        self.check.restarted();
        self.follow.altered();
    }

    /// Notes a violation of a real-time limit at a time of the source: later answers aren't judged.
    #[cold]
    pub fn bench_broke(&mut self, at_ns: u64, reason: String) {
        self.bench_broke.get_or_insert(BenchBroke { at_s: at_ns as f64 * 1e-9, reason });
    }

    /// True if nothing more is judged.
    pub(super) fn are_over(&self) -> bool {
        self.misbehaved.is_some() || self.bench_broke.is_some()
    }

    /// Checks the answer to an epoch; true if it may count.
    #[inline]
    pub(super) fn answer(&mut self, sent: &Epoch, output: &Output) -> bool {
        if self.are_over() {
            return false;
        }
        if let Err(misbehaviour) = self.check.answer(&sent.sample, output) {
            self.misbehaved = Some(misbehaviour);
            return false;
        }
        true
    }

    /// Compares an answer to an unaltered epoch with those before it, with the time of its sample, ns.
    #[inline]
    pub(super) fn follow(&mut self, now_ns: u64, sent: &Epoch, output: &Output) {
        self.follow.epoch(now_ns, output, Some(&sent.sample));
    }

    /// Notes an answer to an altered epoch, or an epoch without an answer: answers around it aren't compared.
    #[inline]
    pub(super) fn altered(&mut self) {
        self.follow.altered();
    }

    /// Number of steps of the solution where a correction was at work.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.follow.steps()
    }

    /// Checks parameters that came with an answer; true if they may count.
    pub(super) fn parameters(&mut self, output: &Output, estimate: &ParameterEstimate) -> bool {
        if self.are_over() {
            return false;
        }
        if let Err(misbehaviour) = self.check.parameters(output.sequence, estimate) {
            self.misbehaved = Some(misbehaviour);
            return false;
        }
        true
    }

    /// Returns whether the answers are to be computed from the samples of the run.
    #[must_use]
    pub(crate) fn has_to_follow(&self) -> bool {
        self.follow.has_to()
    }

    /// Describes the answers that don't follow the unit's input.
    #[must_use]
    pub(crate) fn do_not_follow(&self) -> Vec<String> {
        self.follow.reasons()
    }
}
