//! The choice of the distribution that the weighted samples are drawn from.

use crate::mixture::{NormalMixture, Weighted};
use crate::point::RareSample;
use crate::subset::{Stepped, SubsetFound};

/// Components that are tried.
const PARTS_MAX: usize = 6;
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
pub(crate) fn explored(found: &[SubsetFound], draws: &mut Stepped) -> Option<NormalMixture> {
    let beyond: Vec<Weighted<'_>> =
        found.iter().map(|found| of_samples(&found.beyond)).filter(|data| !data.points.is_empty()).collect();
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
        if !(sum > best.0 + 0.5 * beyond.len() as f64 * 0.1) {
            break;
        }
        best = (sum, count);
    }
    Some(NormalMixture::fitted(&all, best.1, &mut draws.next()))
}

fn of_samples(samples: &[RareSample]) -> Weighted<'_> {
    Weighted { points: samples.iter().map(|sample| (sample.point.u.as_slice(), 1.0)).collect() }
}

fn joined<'a, 'b: 'a>(data: impl Iterator<Item = &'a Weighted<'b>>) -> Weighted<'b> {
    Weighted { points: data.flat_map(|data| data.points.iter().copied()).collect() }
}

/// The mixture that a pilot is drawn from: the failures' with shares nearer to the inputs, so that the choice after it
/// can compare them.
pub(crate) fn of_pilot(explored: &NormalMixture) -> NormalMixture {
    let dimension = explored.parts.first().map_or(0, |(_, mean)| mean.len());
    let (near, plain) = (explored.nearer(0.6), NormalMixture::plain(dimension));
    NormalMixture::of(&[(0.6, explored), (0.3, &near), (0.1, &plain)])
}

/// The proposal of the estimate with the variance that the pilot predicts: that of the weight of a failure, relative
/// to the square of the probability. The proposal is chosen among fits, each with its means nearer to the inputs by
/// several factors. A fit to one half of the pilot is judged by the other half.
pub(crate) fn chosen(
    explored: &NormalMixture,
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
    let halves: Vec<Vec<&WeightedSample>> = (0..2)
        .map(|half| failures.iter().skip(half).step_by(2).copied().collect())
        .collect();
    let refits: Vec<NormalMixture> =
        halves.iter().map(|half| refitted(explored, found, half)).collect();
    let mut best: Option<(f64, bool, f64)> = None;
    for factor in FACTORS {
        for is_refitted in [false, true] {
            let mut second = 0.0;
            for (half, judged) in halves.iter().enumerate() {
                let fit = if is_refitted { &refits[1 - half] } else { explored };
                second += second_moment(&fit_with(fit, factor), judged);
            }
            let variance = second / count / (probability * probability) - 1.0;
            if best.is_none_or(|best| variance < best.0) {
                best = Some((variance, is_refitted, factor));
            }
        }
    }
    let (variance, is_refitted, factor) = best?;
    let fit = if is_refitted { refitted(explored, found, &failures) } else { explored.clone() };
    Some((fit_with(&fit, factor), variance))
}

/// A fit with its means nearer by a factor, and a tenth of it nearer still: failures between it and the inputs keep
/// weights that are not large.
fn fit_with(fit: &NormalMixture, factor: f64) -> NormalMixture {
    NormalMixture::of(&[(0.9, &fit.nearer(factor)), (0.1, &fit.nearer(0.6 * factor))])
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
