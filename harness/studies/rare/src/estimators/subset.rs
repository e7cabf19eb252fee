//! Subset simulation: finds the region of failures level by level.
//!
//! Au and Beck, "Estimation of small failure probabilities in high dimensions by subset simulation", Probabilistic
//! Engineering Mechanics 16, 2001. Each level is a quantile of the severities before; chains that start from the
//! samples beyond it fill the level again. The steps of a chain are those of the conditional sampling of Papaioannou,
//! Betz, Zwirglmaier and Straub, "MCMC algorithms for subset simulation", Probabilistic Engineering Mechanics 41,
//! 2015, whose width follows the share of accepted steps.
//!
//! # The noise keeps its distribution
//!
//! A point is (u, s): normal components u with density φ, and the seed s of the noise with its uniform distribution ν.
//! A step proposes, independently of each other,
//!
//! - u′ = ρ u + √(1 − ρ²) ξ with ξ standard normal: φ(u) K(u, u′) is symmetric in u and u′, a normal density of the
//!   pair with correlation ρ;
//! - s′ = s with probability 1 − q, else a new draw of ν: ν(s) [(1 − q) δ(s, s′) + q ν(s′)] is symmetric in s and s′.
//!
//! The product is symmetric in (u, s) and (u′, s′). The step is taken if (u′, s′) is in the level L, else the chain
//! stays. For two different points of L the flow φν(x) K(x, x′) 1(x in L) 1(x′ in L) is the same in both directions:
//! detailed balance with φν restricted to L, which therefore is the chain's stationary distribution, whatever q and ρ.

use crate::estimators::point::{RareBench, RarePoint, RareSample, RareStage, noise_seed};
use octant_random::draws::Draws;
use serde::{Deserialize, Serialize};

/// Probability that a step draws the noise anew.
const REDRAWN: f64 = 0.5;
/// Share of accepted steps that the width of the steps is steered to.
const ACCEPTED: f64 = 0.44;
/// Levels at most: 0.1^15 is beyond any budget.
const LEVELS_MAX: usize = 15;

/// Goal of a subset simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SubsetGoal {
    /// Severities above this one.
    Above(f64),
    /// The severity that is exceeded with this probability.
    Probability(f64),
}

/// Settings of a subset simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubsetPlan {
    /// Samples of a level.
    pub samples: usize,
    /// Share of them that is beyond the next level.
    pub share: f64,
    /// Runs at most; a level that doesn't fit is not begun.
    pub runs: usize,
    /// Seed.
    pub seed: u64,
    /// Number of the replicate.
    pub replicate: usize,
}

/// A level with the chains that filled it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SubsetLevel {
    /// Severity from which on a sample belongs to it.
    pub severity: f64,
    /// Probability of the level, given the one before.
    pub share: f64,
    /// Share of the steps in it that were accepted.
    pub accepted: f64,
    /// Share of the steps with new noise that were accepted.
    pub accepted_noise: f64,
    /// Standard deviation of the last steps, as a share of that of the inputs.
    pub width: f64,
}

/// Result of a subset simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct SubsetFound {
    /// Samples of the inputs' own distribution, with which it began.
    pub plain: Vec<RareSample>,
    /// Levels, the first first.
    pub levels: Vec<SubsetLevel>,
    /// Probability of the goal; `None` if it wasn't reached.
    pub probability: Option<f64>,
    /// Severity of the goal.
    pub severity: f64,
    /// Samples beyond the goal, of the last level.
    pub beyond: Vec<RareSample>,
    /// Runs of the last two levels, accepted or not.
    pub tried: Vec<RareSample>,
    /// The sample that came nearest to the goal, or the worst.
    pub worst: Option<RareSample>,
    /// Runs that it took.
    pub runs: usize,
}

/// Chains of a level: the state of each, and its steps.
struct Chains {
    level: f64,
    states: Vec<RareSample>,
    sigma: Vec<f64>,
    width: f64,
    steps: [usize; 2],
    accepted: [usize; 2],
    tried: Vec<RareSample>,
}

/// Runs a subset simulation.
///
/// # Errors
/// If the bench can't go on.
pub fn subset<B: RareBench>(
    bench: &mut B,
    goal: SubsetGoal,
    plan: &SubsetPlan,
) -> Result<SubsetFound, B::Error> {
    let mut draws = Stepped::of_replicate(plan);
    let points = plain_points(bench.dimension(), plan, &mut draws);
    let mut samples = run(bench, points, RareStage::Plain)?;
    let mut found = SubsetFound {
        plain: samples.clone(),
        levels: Vec::new(),
        probability: None,
        severity: f64::INFINITY,
        beyond: Vec::new(),
        tried: samples.clone(),
        worst: None,
        runs: samples.len(),
    };
    let mut probability = 1.0;
    let mut width = 1.0;
    let mut last_tried = found.tried.len();
    loop {
        samples.sort_by(|a, b| b.severity.total_cmp(&a.severity));
        found.worst = worse(found.worst.take(), samples.first());
        if reached(&mut found, &samples, goal, probability, plan.share) {
            break;
        }
        let seeds = ((plan.share * samples.len() as f64) as usize).clamp(1, samples.len());
        let level = samples[seeds - 1].severity;
        let seeds = samples.iter().filter(|sample| sample.severity >= level).count();
        // A severity that is the same everywhere, or that most runs don't have, leads nowhere.
        let is_flat = 2 * seeds > samples.len() || level == f64::NEG_INFINITY;
        if is_flat || found.levels.len() == LEVELS_MAX || found.runs + plan.samples > plan.runs {
            break;
        }
        let share = seeds as f64 / samples.len() as f64;
        probability *= share;
        samples.truncate(seeds);
        let mut chains = Chains::new(level, samples, width);
        samples = chains.filled(bench, plan.samples, &mut draws)?;
        found.runs += plan.samples - seeds;
        width = chains.width;
        found.tried.drain(..found.tried.len() - last_tried);
        last_tried = chains.tried.len();
        found.tried.append(&mut chains.tried);
        found.levels.push(chains.told(share));
    }
    Ok(found)
}

fn plain_points(dimension: usize, plan: &SubsetPlan, draws: &mut Stepped) -> Vec<RarePoint> {
    (0..plan.samples).map(|_| RarePoint::drawn(dimension, &mut draws.next())).collect()
}

/// The plain samples with which a subset simulation begins, whatever its goal.
#[must_use]
pub fn beginning(dimension: usize, plan: &SubsetPlan) -> Vec<RarePoint> {
    plain_points(dimension, plan, &mut Stepped::of_replicate(plan))
}

/// Takes the samples beyond the goal, if there are enough of them.
fn reached(
    found: &mut SubsetFound,
    sorted: &[RareSample],
    goal: SubsetGoal,
    probability: f64,
    share: f64,
) -> bool {
    let count = sorted.len() as f64;
    let beyond = match goal {
        SubsetGoal::Above(severity) => {
            found.severity = severity;
            sorted.iter().filter(|sample| sample.severity > severity).count()
        }
        SubsetGoal::Probability(goal) => {
            let beyond = (goal / probability * count) as usize;
            found.severity = sorted.get(beyond).map_or(f64::NEG_INFINITY, |sample| sample.severity);
            sorted.iter().filter(|sample| sample.severity > found.severity).count()
        }
    };
    if (beyond as f64) < share * count || found.severity == f64::NEG_INFINITY {
        return false;
    }
    found.probability = Some(probability * beyond as f64 / count);
    found.beyond = sorted[..beyond].to_vec();
    true
}

impl SubsetFound {
    /// Variance of the logarithm of the probability, by Au and Beck, with six samples of a chain for one.
    pub(crate) fn variance(&self) -> f64 {
        let samples = self.plain.len() as f64;
        let of = |share: f64, chained: f64| chained * (1.0 - share) / (share * samples);
        let last = self.beyond.len() as f64 / samples;
        let levels = self.levels.iter().enumerate();
        let before =
            levels.map(|(level, of_level)| of(of_level.share, if level == 0 { 1.0 } else { 6.0 }));
        before.sum::<f64>()
            + of(last.max(1.0 / samples), if self.levels.is_empty() { 1.0 } else { 6.0 })
    }
}

impl Chains {
    fn new(level: f64, states: Vec<RareSample>, width: f64) -> Self {
        let dimension = states.first().map_or(0, |state| state.point.u.len());
        let sigma = (0..dimension).map(|component| spread(&states, component)).collect();
        Self { level, states, sigma, width, steps: [0; 2], accepted: [0; 2], tried: Vec::new() }
    }

    /// Steps all chains together until there are enough samples.
    fn filled<B: RareBench>(
        &mut self,
        bench: &mut B,
        samples: usize,
        draws: &mut Stepped,
    ) -> Result<Vec<RareSample>, B::Error> {
        let mut all = self.states.clone();
        let mut round = 0.0;
        while all.len() < samples {
            round += 1.0;
            let moving = self.states.len().min(samples - all.len());
            let (points, anew): (Vec<RarePoint>, Vec<bool>) =
                (0..moving).map(|chain| self.proposed(chain, &mut draws.next())).unzip();
            let proposed = run(bench, points, RareStage::Chain)?;
            self.tried.extend(proposed.iter().cloned());
            let mut accepted = 0;
            for (chain, (sample, anew)) in proposed.into_iter().zip(anew).enumerate() {
                self.steps[usize::from(anew)] += 1;
                if sample.severity >= self.level {
                    self.accepted[usize::from(anew)] += 1;
                    accepted += 1;
                    self.states[chain] = sample;
                }
                all.push(self.states[chain].clone());
            }
            let share = f64::from(accepted) / moving as f64;
            self.width *= libm::exp((share - ACCEPTED) / libm::sqrt(round));
            self.width = self.width.clamp(1e-3, 4.0);
        }
        Ok(all)
    }

    fn proposed(&self, chain: usize, draws: &mut Draws) -> (RarePoint, bool) {
        let old = &self.states[chain].point;
        let u = old.u.iter().zip(&self.sigma).map(|(u, sigma)| {
            let step = (self.width * sigma).min(1.0);
            libm::sqrt(1.0 - step * step) * u + step * draws.normal()
        });
        let u = u.collect();
        let anew = draws.unit() < REDRAWN;
        let noise = if anew { noise_seed(draws) } else { old.noise };
        (RarePoint { u, noise }, anew)
    }

    fn told(&self, share: f64) -> SubsetLevel {
        let [kept, anew] = self.steps;
        let of = |accepted: usize, steps: usize| accepted as f64 / steps.max(1) as f64;
        SubsetLevel {
            severity: self.level,
            share,
            accepted: of(self.accepted[0] + self.accepted[1], kept + anew),
            accepted_noise: of(self.accepted[1], anew),
            width: self.width,
        }
    }
}

/// Standard deviation of a component, at most that of the inputs.
fn spread(states: &[RareSample], component: usize) -> f64 {
    let values: Vec<f64> = states.iter().map(|state| state.point.u[component]).collect();
    octant_statistics::sample::deviation(&values).unwrap_or(1.0).clamp(0.05, 1.0)
}

/// Draws of one step after the other.
pub(crate) struct Stepped {
    pub(crate) seed: u64,
    pub(crate) stream: String,
    pub(crate) step: u64,
}

impl Stepped {
    fn of_replicate(plan: &SubsetPlan) -> Self {
        let stream = format!("rare subset {}", plan.replicate);
        Self { seed: plan.seed, stream, step: 0 }
    }

    pub(crate) fn next(&mut self) -> Draws {
        self.step += 1;
        Draws::of(self.seed, &self.stream, self.step)
    }
}

/// Runs points and keeps them with their severities.
pub(crate) fn run<B: RareBench>(
    bench: &mut B,
    points: Vec<RarePoint>,
    stage: RareStage,
) -> Result<Vec<RareSample>, B::Error> {
    let severities = bench.severities(&points, stage)?;
    let samples = points.into_iter().zip(severities);
    Ok(samples.map(|(point, severity)| RareSample { point, severity }).collect())
}

/// The worse of two samples.
pub(crate) fn worse(a: Option<RareSample>, b: Option<&RareSample>) -> Option<RareSample> {
    match (a, b) {
        (Some(a), Some(b)) if a.severity >= b.severity => Some(a),
        (a, None) => a,
        (_, Some(b)) => Some(b.clone()),
    }
}
