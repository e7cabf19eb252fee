//! The choice of the distribution that the weighted samples are drawn from.

use crate::estimators::mixture::{NormalMixture, Weighted};
use crate::estimators::point::RareSample;
use crate::estimators::subset::{Stepped, SubsetFound};
use octant_statistics::sample::mean;

/// Components that are tried.
const PARTS_MAX: usize = 16;
/// Components without a better likelihood after which no more are tried.
const PATIENCE: usize = 2;
/// Dimensions up to which a wide component guards against directions that no chain met.
const GUARDED_DIMENSIONS: usize = 4;
/// Its share.
const GUARD: f64 = 0.1;
/// Factors on the means that are tried.
const FACTORS: [f64; 7] = [1.0, 0.85, 0.7, 0.55, 0.4, 0.2, 0.0];
/// Samples of a chain that count as one independent sample in a fit: neighbours resemble each other.
const CHAINED: f64 = 6.0;
/// Failures in a pilot, at least, for it to choose by.
const FAILURES_MIN: usize = 10;

/// A sample with its weight: the density of the inputs over that of the proposal.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightedSample {
    /// The sample.
    pub sample: RareSample,
    /// Its weight.
    pub weight: f64,
}

/// Fits a mixture to the failures of subset simulations. The number of components is the one with the best likelihood
/// of a replicate by the fit to the others: replicates don't depend on each other, samples of a chain do.
fn fitted(found: &[SubsetFound], draws: &mut Stepped) -> Option<NormalMixture> {
    let beyond: Vec<Weighted<'_>> = found
        .iter()
        .map(|found| of_samples(&found.beyond))
        .filter(|data| !data.points.is_empty())
        .collect();
    let all = joined(beyond.iter());
    if all.points.is_empty() {
        return None;
    }
    let mut best = (f64::NEG_INFINITY, 1);
    for count in 1..=PARTS_MAX {
        let mut sum = 0.0;
        for (left, held) in beyond.iter().enumerate() {
            let others = beyond.iter().enumerate().filter(|(index, _)| *index != left);
            let others = joined(others.map(|(_, data)| data));
            if others.points.is_empty() {
                break;
            }
            let fit = NormalMixture::fitted(&others, count, &mut draws.next());
            sum += fit.likelihood(held);
        }
        // Per replicate, in nats of a sample.
        if sum > best.0 + 0.05 * beyond.len() as f64 {
            best = (sum, count);
        } else if count >= best.1 + PATIENCE {
            break;
        }
    }
    Some(NormalMixture::fitted(&all, best.1, &mut draws.next()))
}

fn of_samples(samples: &[RareSample]) -> Weighted<'_> {
    Weighted { points: samples.iter().map(|sample| (sample.point.u.as_slice(), 1.0)).collect() }
}

fn joined<'a, 'b: 'a>(data: impl Iterator<Item = &'a Weighted<'b>>) -> Weighted<'b> {
    Weighted { points: data.flat_map(|data| data.points.iter().copied()).collect() }
}

/// Findings of the chains: the fit to their failures, and the same with its means on the lines of growing severity. Both
/// have a mirror image of every component: a limit on a magnitude fails on both sides, and a few chains may have met one
/// alone. The pilot tells whether there is anything on the other side.
#[derive(Clone, Debug)]
pub(crate) struct Explored {
    full: NormalMixture,
    projected: NormalMixture,
    /// Where there are few components.
    guard: Option<NormalMixture>,
}

impl Explored {
    /// `None` without a failure.
    pub(crate) fn of(found: &[SubsetFound], draws: &mut Stepped) -> Option<Self> {
        let full = fitted(found, draws)?;
        let projected = full.projected(&tried(found, &[]));
        let [full, projected] = [full, projected]
            .map(|fit| NormalMixture::of(&[(0.5, &fit), (0.5, &fit.nearer(-1.0))]));
        let dimension = full.parts.first().map_or(0, |part| part.mean.len());
        let radii: Vec<f64> =
            found.iter().flat_map(|found| &found.beyond).map(|s| s.point.radius()).collect();
        let sigma = mean(&radii).unwrap_or(1.0) / libm::sqrt(dimension.max(1) as f64);
        let guard = (1..=GUARDED_DIMENSIONS).contains(&dimension);
        let guard = guard.then(|| NormalMixture::around(dimension, sigma.max(1.0)));
        Some(Self { full, projected, guard })
    }

    /// The mixture that a pilot is drawn from: the failures' with shares nearer to the inputs, so that the choice after
    /// it can compare them.
    pub(crate) fn of_pilot(&self) -> NormalMixture {
        let dimension = self.full.parts.first().map_or(0, |part| part.mean.len());
        let (near, plain) = (self.projected.nearer(0.6), NormalMixture::plain(dimension));
        let parts = [(0.3, &self.full), (0.4, &self.projected), (0.2, &near), (0.1, &plain)];
        self.guarded(&NormalMixture::of(&parts))
    }

    fn guarded(&self, proposal: &NormalMixture) -> NormalMixture {
        match &self.guard {
            Some(guard) => NormalMixture::of(&[(1.0 - GUARD, proposal), (GUARD, guard)]),
            None => proposal.clone(),
        }
    }

    /// A fit with its means nearer by a factor, and a tenth of it nearer still: failures between it and the inputs keep
    /// weights that are not large.
    fn with(&self, fit: &NormalMixture, factor: f64) -> NormalMixture {
        let near = fit.nearer(0.6 * factor);
        self.guarded(&NormalMixture::of(&[(0.9, &fit.nearer(factor)), (0.1, &near)]))
    }
}

/// Runs of the chains and of a pilot with a severity.
fn tried<'a>(found: &'a [SubsetFound], pilot: &'a [WeightedSample]) -> Vec<(&'a [f64], f64)> {
    let chains = found.iter().flat_map(|found| &found.tried);
    let all = chains.chain(pilot.iter().map(|sample| &sample.sample));
    // A run that counts as a failure without a measure has the largest number, which no slope explains.
    all.filter(|sample| sample.severity.is_finite() && sample.severity < f64::MAX)
        .map(|sample| (sample.point.u.as_slice(), sample.severity))
        .collect()
}

/// The proposal of the estimate with the variance that the pilot predicts: that of the weight of a failure, relative
/// to the square of the probability. The proposal is chosen among fits, each with its means nearer to the inputs by
/// several factors. A fit to one half of the pilot is judged by the other half.
pub(crate) fn chosen(
    explored: &Explored,
    found: &[SubsetFound],
    pilot: &[WeightedSample],
    severity: f64,
) -> Option<(NormalMixture, f64)> {
    let failures: Vec<&WeightedSample> =
        pilot.iter().filter(|sample| sample.sample.severity > severity).collect();
    if failures.len() < FAILURES_MIN {
        return None;
    }
    let count = pilot.len() as f64;
    let probability = failures.iter().map(|sample| sample.weight).sum::<f64>() / count;
    let tried = tried(found, pilot);
    let halves: Vec<Vec<&WeightedSample>> =
        (0..2).map(|half| failures.iter().skip(half).step_by(2).copied().collect()).collect();
    let fits = |failures: &[&WeightedSample]| -> [NormalMixture; 4] {
        let full = refitted(&explored.full, found, failures);
        let projected = full.projected(&tried);
        [explored.full.clone(), explored.projected.clone(), full, projected]
    };
    let of_halves = [fits(&halves[0]), fits(&halves[1])];
    let mut best: Option<(f64, usize, f64)> = None;
    for factor in FACTORS {
        for fit in 0..of_halves[0].len() {
            let judged = |half: usize| {
                let proposal = explored.with(&of_halves[1 - half][fit], factor);
                second_moment(&proposal, &halves[half])
            };
            let second = judged(0) + judged(1);
            let variance = second / count / (probability * probability) - 1.0;
            if best.is_none_or(|best| variance < best.0) {
                best = Some((variance, fit, factor));
            }
        }
    }
    let (variance, fit, factor) = best?;
    Some((explored.with(&fits(&failures)[fit], factor), variance))
}

fn second_moment(proposal: &NormalMixture, failures: &[&WeightedSample]) -> f64 {
    let of = |sample: &&WeightedSample| {
        sample.weight * libm::exp(-proposal.log_ratio(&sample.sample.point.u))
    };
    failures.iter().map(of).sum()
}

/// Fits the components again, to failures of the pilot by their weights and to those of the chains.
fn refitted(
    explored: &NormalMixture,
    found: &[SubsetFound],
    failures: &[&WeightedSample],
) -> NormalMixture {
    let total: f64 = failures.iter().map(|sample| sample.weight).sum();
    let squares: f64 = failures.iter().map(|sample| sample.weight * sample.weight).sum();
    let effective = if squares > 0.0 { total * total / squares } else { 0.0 };
    let mut points: Vec<(&[f64], f64)> = (failures.iter())
        .map(|sample| (sample.sample.point.u.as_slice(), effective * sample.weight / total))
        .collect();
    points.extend(found.iter().flat_map(|found| {
        found.beyond.iter().map(|sample| (sample.point.u.as_slice(), 1.0 / CHAINED))
    }));
    explored.refitted(&Weighted { points })
}
