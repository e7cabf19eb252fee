//! The probability of a rare failure: subset simulation finds where failures are, weighted samples say how probable.
//!
//! 1. Independent replicates of [subset simulation](mod@crate::estimators::subset) end with samples of the failures.
//! 2. A [mixture of normal distributions](mod@crate::estimators::mixture) is fitted to them, and a pilot of weighted samples chooses
//!    the [proposal](mod@crate::estimators::proposal).
//! 3. The estimate is the mean of weight × failure over new samples of that proposal, which is fixed by then: it is
//!    unbiased, and its variance is that of the terms over their number. The interval is that of the logarithm, by the
//!    delta method. Neither the pilot nor the chains enter it.
//!
//! The noise of a sample is drawn from its own distribution, so that the weight has the components u alone.
//!
//! The interval knows nothing of a region of failures that no sample met. [Doubts](RareDoubt) check the estimate against
//! the failures of the chains and of the plain samples. With one of them nothing is shown.

use crate::estimators::mixture::NormalMixture;
use crate::estimators::point::{RareBench, RarePoint, RareSample, RareStage};
use crate::estimators::proposal::{Explored, WeightedSample, chosen};
use crate::estimators::subset::{Stepped, SubsetFound, SubsetGoal, SubsetPlan, run, subset, worse};
use octant_statistics::normal;
use octant_statistics::proportion::{success_lower_bound, success_upper_bound};
use octant_statistics::sample::{deviation, mean};

/// Weighted failures, as if their weights were equal, that an interval takes at least.
pub const EFFECTIVE_MIN: f64 = 50.0;
/// Weighted samples at least.
const FINAL_MIN: usize = 400;
/// Share of the budget that subset simulation may have.
const EXPLORING: f64 = 0.65;
/// A failure of the chains whose weight is this many times the probability isn't covered by the proposal.
const UNCOVERED_WEIGHT: f64 = 1000.0;
/// Share of such failures from which on an estimate is in doubt.
const UNCOVERED_SHARE: f64 = 0.02;
/// Ratio of predicted and shown mean squares from which on an estimate is in doubt.
const VARIANCE_MAX: f64 = 3.0;
/// Share of accepted steps below which chains didn't move.
const ACCEPTED_MIN: f64 = 0.05;

/// Settings of an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RarePlan {
    /// Runs at most.
    pub runs: usize,
    /// Independent subset simulations.
    pub replicates: usize,
    /// Samples of each of their levels.
    pub samples: usize,
    /// Samples of the pilot.
    pub pilot: usize,
    /// Relative standard error at which it is enough.
    pub error: f64,
    /// Confidence of the interval.
    pub confidence: f64,
    /// Seed.
    pub seed: u64,
}

impl Default for RarePlan {
    fn default() -> Self {
        Self {
            runs: 10_000,
            replicates: 4,
            samples: 200,
            pilot: 1000,
            error: 0.05,
            confidence: 0.95,
            seed: 1,
        }
    }
}

impl RarePlan {
    /// The plan for a number of runs: samples of a level and of the pilot in proportion, so that subset simulation has
    /// room for the levels of one in a million.
    #[must_use]
    pub fn of_runs(runs: usize) -> Self {
        let samples = (runs / 50).clamp(20, 2000);
        Self { runs, samples, pilot: (runs / 10).max(100), ..Self::default() }
    }

    /// The subset simulation of a replicate.
    #[must_use]
    pub fn subset(&self, replicate: usize) -> SubsetPlan {
        let runs = (EXPLORING * self.runs as f64 / self.replicates.max(1) as f64) as usize;
        let samples = self.samples.min(runs.max(1));
        SubsetPlan { samples, share: 0.1, runs, seed: self.seed, replicate }
    }
}

/// Reason why an estimate isn't taken for shown.
#[derive(Clone, Debug, PartialEq)]
pub enum RareDoubt {
    /// Some replicates found no failure within their share of the runs.
    NotReached {
        /// Those that found one.
        reached: usize,
        /// All.
        replicates: usize,
    },
    /// Too few failures among the weighted samples.
    FewFailures {
        /// Failures, as if their weights were equal.
        effective: f64,
    },
    /// Failures that the chains met where the proposal has hardly any sample.
    Uncovered {
        /// Their share of the failures of the chains.
        share: f64,
    },
    /// The failures of the chains predict a much larger variance than the weighted samples show.
    Variance {
        /// Ratio of the two.
        ratio: f64,
    },
    /// The replicates contradict the estimate.
    Replicates {
        /// Probability by subset simulation.
        subset: f64,
        /// Its standard error.
        error: f64,
    },
    /// The plain samples contradict the estimate.
    Plain {
        /// Interval of the probability by plain samples, 99.9 %.
        interval: [f64; 2],
    },
    /// Chains of the last level hardly moved.
    NotMixed {
        /// Share of accepted steps.
        accepted: f64,
    },
}

/// Failures among samples of the inputs' own distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlainCount {
    /// Failures.
    pub failures: u64,
    /// Samples.
    pub runs: u64,
}

impl PlainCount {
    /// Interval of the probability by Clopper and Pearson, each end with this confidence.
    #[must_use]
    pub fn interval(self, one_sided: f64) -> [f64; 2] {
        [
            1.0 - success_upper_bound(self.failures, self.runs, one_sided),
            1.0 - success_lower_bound(self.failures, self.runs, one_sided),
        ]
    }
}

/// Mean of weighted failures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedMean {
    /// Probability.
    pub probability: f64,
    /// Its standard error, as a share of it.
    pub error: f64,
    /// Interval of the probability.
    pub interval: [f64; 2],
    /// Failures.
    pub failures: usize,
    /// Failures, as if their weights were equal: (Σw)²/Σw².
    pub effective: f64,
}

/// Result of an estimate.
#[derive(Clone, Debug)]
pub struct RareEstimate {
    /// The probability; `None` if no failure was among the weighted samples, or there were none.
    pub mean: Option<WeightedMean>,
    /// Reasons to doubt it.
    pub doubts: Vec<RareDoubt>,
    /// Severity above which a run counts.
    pub severity: f64,
    /// Plain samples.
    pub plain: PlainCount,
    /// The subset simulations.
    pub found: Vec<SubsetFound>,
    /// Weighted samples of the estimate.
    pub weighted: Vec<WeightedSample>,
    /// Samples of the pilot.
    pub pilot: usize,
    /// Runs in all.
    pub runs: usize,
    /// The failure with the largest density of its components.
    pub most_probable: Option<RareSample>,
    /// The worst sample where nothing failed.
    pub worst: Option<RareSample>,
}

/// Estimates the probability that the severity is above the goal's.
///
/// # Errors
/// If the bench can't go on.
pub fn estimate<B: RareBench>(
    bench: &mut B,
    goal: SubsetGoal,
    plan: &RarePlan,
) -> Result<RareEstimate, B::Error> {
    let mut found = Vec::new();
    for replicate in 0..plan.replicates {
        found.push(subset(bench, goal, &plan.subset(replicate))?);
    }
    let mut out = RareEstimate {
        mean: None,
        doubts: Vec::new(),
        severity: severity_of(goal, &found),
        plain: PlainCount::default(),
        weighted: Vec::new(),
        pilot: 0,
        runs: found.iter().map(|found| found.runs).sum(),
        most_probable: None,
        worst: found.iter().fold(None, |worst, found| worse(worst, found.worst.as_ref())),
        found,
    };
    out.count_plain();
    let mut draws = Stepped { seed: plan.seed, stream: "rare weighted".to_owned(), step: 0 };
    let reached = out.found.iter().filter(|found| found.probability.is_some()).count();
    match Explored::of(&out.found, &mut draws) {
        Some(explored) => out.weigh(bench, &explored, plan, &mut draws)?,
        // Plain samples are all that shows anything now.
        None => out.more_plain(bench, plan, &mut draws)?,
    }
    if reached < plan.replicates {
        out.doubts.push(RareDoubt::NotReached { reached, replicates: plan.replicates });
    }
    out.doubt();
    out.nearest();
    Ok(out)
}

/// Severity of a goal: that of a probability is the mean over the replicates.
fn severity_of(goal: SubsetGoal, found: &[SubsetFound]) -> f64 {
    match goal {
        SubsetGoal::Above(severity) => severity,
        SubsetGoal::Probability(_) => {
            let reached = found.iter().filter(|found| found.probability.is_some());
            let severities: Vec<f64> = reached.map(|found| found.severity).collect();
            mean(&severities).unwrap_or(f64::INFINITY)
        }
    }
}

impl RareEstimate {
    fn count_plain(&mut self) {
        let plain = self.found.iter().flat_map(|found| &found.plain);
        self.plain = counted(plain, self.severity);
    }

    fn more_plain<B: RareBench>(
        &mut self,
        bench: &mut B,
        plan: &RarePlan,
        draws: &mut Stepped,
    ) -> Result<(), B::Error> {
        let left = plan.runs.saturating_sub(self.runs);
        let points = (0..left).map(|_| RarePoint::drawn(bench.dimension(), &mut draws.next()));
        let samples = run(bench, points.collect(), RareStage::Plain)?;
        let more = counted(samples.iter(), self.severity);
        self.plain.failures += more.failures;
        self.plain.runs += more.runs;
        self.runs += left;
        for sample in &samples {
            if self.worst.as_ref().is_none_or(|worst| sample.severity > worst.severity) {
                self.worst = Some(sample.clone());
            }
        }
        Ok(())
    }

    /// The pilot, the choice, and the estimate.
    fn weigh<B: RareBench>(
        &mut self,
        bench: &mut B,
        explored: &Explored,
        plan: &RarePlan,
        draws: &mut Stepped,
    ) -> Result<(), B::Error> {
        let left = plan.runs.saturating_sub(self.runs);
        let wide = explored.of_pilot();
        self.pilot = plan.pilot.min(left / 2);
        let pilot = weighted(bench, &wide, self.pilot, draws)?;
        let (proposal, count) = match chosen(explored, &self.found, &pilot, self.severity) {
            Some((proposal, variance)) => {
                // A fifth more than the pilot predicts, which knows its variance roughly.
                let needed = 1.2 * variance / (plan.error * plan.error);
                (proposal, needed.clamp(FINAL_MIN as f64, 1e9) as usize)
            }
            None => (wide, usize::MAX),
        };
        let count = count.min(left - self.pilot);
        self.weighted = weighted(bench, &proposal, count, draws)?;
        self.runs += self.pilot + count;
        self.mean = self.above(self.severity, plan.confidence);
        let covered = |sample: &&RareSample| {
            let weight = libm::exp(-proposal.log_ratio(&sample.point.u));
            self.mean.is_some_and(|mean| weight <= UNCOVERED_WEIGHT * mean.probability)
        };
        let beyond: Vec<&RareSample> = self.found.iter().flat_map(|found| &found.beyond).collect();
        let uncovered = beyond.iter().filter(|sample| !covered(sample)).count();
        let share = uncovered as f64 / beyond.len().max(1) as f64;
        if share > UNCOVERED_SHARE {
            self.doubts.push(RareDoubt::Uncovered { share });
        }
        // The mean square of weight × failure is the probability times the mean weight of a failure, which the
        // chains' failures give without the weighted samples.
        let weights: f64 = beyond.iter().map(|s| libm::exp(-proposal.log_ratio(&s.point.u))).sum();
        if let Some(mean) = self.mean {
            let predicted = weights / beyond.len().max(1) as f64 / mean.probability;
            let shown = 1.0 + mean.error * mean.error * self.weighted.len() as f64;
            if predicted > VARIANCE_MAX * shown {
                self.doubts.push(RareDoubt::Variance { ratio: predicted / shown });
            }
        }
        Ok(())
    }

    /// The probability of severities above one, by the weighted samples.
    #[must_use]
    pub fn above(&self, severity: f64, confidence: f64) -> Option<WeightedMean> {
        let (mut sum, mut squares, mut failures) = (0.0, 0.0, 0);
        for sample in self.weighted.iter().filter(|sample| sample.sample.severity > severity) {
            sum += sample.weight;
            squares += sample.weight * sample.weight;
            failures += 1;
        }
        if !(sum > 0.0) {
            return None;
        }
        let count = self.weighted.len() as f64;
        let probability = sum / count;
        let variance = (squares / count - probability * probability).max(0.0) / (count - 1.0);
        let error = libm::sqrt(variance) / probability;
        let z = normal::quantile(0.5 + 0.5 * confidence);
        let interval =
            [probability * libm::exp(-z * error), (probability * libm::exp(z * error)).min(1.0)];
        let effective = sum * sum / squares;
        Some(WeightedMean { probability, error, interval, failures, effective })
    }

    fn doubt(&mut self) {
        let mut doubts = Vec::new();
        if self.weighted.is_empty() {
            return;
        }
        let effective = self.mean.map_or(0.0, |mean| mean.effective);
        if effective < EFFECTIVE_MIN {
            doubts.push(RareDoubt::FewFailures { effective });
        }
        let Some(mean) = self.mean else {
            self.doubts.append(&mut doubts);
            return;
        };
        doubts.extend(self.replicates_against());
        let interval = self.plain.interval(0.9995);
        if mean.interval[1] < interval[0] || mean.interval[0] > interval[1] {
            doubts.push(RareDoubt::Plain { interval });
        }
        let last = self.found.iter().filter_map(|found| found.levels.last());
        let accepted = last.map(|level| level.accepted).fold(f64::INFINITY, f64::min);
        if accepted < ACCEPTED_MIN {
            doubts.push(RareDoubt::NotMixed { accepted });
        }
        self.doubts.append(&mut doubts);
    }

    /// Compares the estimate with the replicates' own, in logarithms. These scatter by what the replicates show, or by
    /// what theory says of chains that resemble their seeds, if that is more: few replicates may agree by chance. The
    /// logarithm of an unbiased number lies below that of its mean by half of its variance.
    fn replicates_against(&self) -> Option<RareDoubt> {
        // For a goal that is a probability each replicate has a severity of its own.
        let against = |found: &SubsetFound| {
            let weighted = self.above(found.severity, 0.5)?.probability;
            let own = found.probability?;
            Some([libm::log(own / weighted), own, found.variance()])
        };
        let all: Vec<[f64; 3]> = self.found.iter().filter_map(against).collect();
        let column = |index: usize| all.iter().map(|row| row[index]).collect::<Vec<f64>>();
        let (average, scatter) = (mean(&column(0))?, deviation(&column(0))?);
        let variance = mean(&column(2))?.max(scatter * scatter);
        let error = libm::sqrt(variance / all.len() as f64);
        let apart = (average + 0.5 * variance).abs();
        let subset = mean(&column(1))?;
        (apart > 4.0 * error + 0.5 * variance).then_some(RareDoubt::Replicates { subset, error })
    }

    /// Finds the most probable failure among all samples.
    fn nearest(&mut self) {
        let chains = self.found.iter().flat_map(|found| found.beyond.iter().chain(&found.plain));
        let weighted = self.weighted.iter().map(|weighted| &weighted.sample);
        let failures = chains.chain(weighted).filter(|sample| sample.severity > self.severity);
        self.most_probable =
            failures.min_by(|a, b| a.point.radius().total_cmp(&b.point.radius())).cloned();
    }

    /// Interval of the severity that is exceeded with a probability, and the severity itself. An end that the samples
    /// don't show is infinite.
    #[must_use]
    pub fn level(&self, probability: f64, confidence: f64) -> Option<[f64; 3]> {
        let mut severities: Vec<f64> = (self.weighted.iter())
            .map(|sample| sample.sample.severity)
            .filter(|severity| severity.is_finite())
            .collect();
        severities.sort_by(f64::total_cmp);
        let first = |is_past: &dyn Fn(&WeightedMean) -> bool| {
            let at = severities.partition_point(|severity| {
                !self.above(*severity, confidence).is_none_or(|mean| is_past(&mean))
            });
            severities.get(at).copied()
        };
        let low = first(&|mean| mean.interval[0] <= probability)?;
        let level = first(&|mean| mean.probability <= probability)?;
        let high =
            first(&|mean| mean.interval[1] < probability && mean.effective >= EFFECTIVE_MIN.sqrt());
        let last = severities.last().copied()?;
        let high = high.filter(|high| *high < last).unwrap_or(f64::INFINITY);
        Some([low, level, high])
    }
}

fn counted<'a>(samples: impl Iterator<Item = &'a RareSample>, severity: f64) -> PlainCount {
    samples.fold(PlainCount::default(), |count, sample| PlainCount {
        failures: count.failures + u64::from(sample.severity > severity),
        runs: count.runs + 1,
    })
}

fn weighted<B: RareBench>(
    bench: &mut B,
    proposal: &NormalMixture,
    count: usize,
    draws: &mut Stepped,
) -> Result<Vec<WeightedSample>, B::Error> {
    let points = (0..count).map(|_| proposal.draw(&mut draws.next())).collect();
    let samples = run(bench, points, RareStage::Weighted)?;
    let weigh = |sample: RareSample| {
        let weight = libm::exp(-proposal.log_ratio(&sample.point.u));
        WeightedSample { sample, weight }
    };
    Ok(samples.into_iter().map(weigh).collect())
}
