//! Limits of an estimate's claims, and the distribution of its chains.

use super::coverage::Closed;
use octant_random::draws::Draws;
use octant_rare::estimators::estimate::{PlainCount, RareDoubt, RareEstimate, RarePlan, estimate};
use octant_rare::estimators::mixture::NormalMixture;
use octant_rare::estimators::point::RarePoint;
use octant_rare::estimators::slope::slope;
use octant_rare::estimators::subset::{SubsetGoal, SubsetPlan, subset};
use octant_statistics::normal;

fn estimated(dimension: usize, runs: usize, severity: impl Fn(&RarePoint) -> f64) -> RareEstimate {
    let mut bench = Closed { dimension, runs: 0, severity };
    let plan = RarePlan { runs, ..RarePlan::default() };
    let Ok(found) = estimate(&mut bench, SubsetGoal::Above(0.0), &plan);
    assert!(bench.runs <= runs && found.runs == bench.runs, "{} {}", found.runs, bench.runs);
    found
}

fn of_noise(noise: u64) -> f64 {
    Draws::of(noise, "noise of a test", 0).normal()
}

#[test]
fn without_a_failure_only_the_bound_of_plain_samples_is_claimed() {
    // Nothing leads to a failure: the severity is flat.
    let found = estimated(5, 3000, |_| -1.0);
    assert!(found.mean.is_none() && found.most_probable.is_none());
    assert_eq!(found.plain, PlainCount { failures: 0, runs: 3000 });
    // The rule of three: 1 − 0.05^(1/n) is close to 3/n.
    let high = found.plain.interval(0.95)[1];
    assert!((high * 3000.0 - 3.0).abs() < 0.01, "{high}");
    assert!(matches!(found.doubts[..], [RareDoubt::NotReached { reached: 0, replicates: 4 }]));
}

#[test]
fn runs_that_are_not_judged_lead_nowhere_and_do_not_hang() {
    let found = estimated(3, 2000, |_| f64::NEG_INFINITY);
    assert!(found.mean.is_none() && !found.doubts.is_empty());
    let found = estimated(0, 2000, |point| of_noise(point.noise) - 6.0);
    assert!(found.mean.is_none_or(|_| !found.doubts.is_empty()));
}

#[test]
fn a_rare_failure_of_the_noise_alone_is_in_doubt() {
    let beta = -normal::quantile(1e-6);
    let found = estimated(5, 10_000, |point| of_noise(point.noise) - beta);
    assert!(!found.doubts.is_empty(), "{:?}", found.mean);
}

#[test]
fn too_small_a_budget_is_in_doubt() {
    let found = estimated(10, 600, |point| point.u[0] - 4.75);
    assert!(!found.doubts.is_empty(), "{:?}", found.mean);
}

/// The part of the noise in the failures is what theory says: a step that redraws it keeps its distribution.
#[test]
fn chains_keep_the_distribution_of_the_noise() {
    let beta = -normal::quantile(1e-2);
    let half = libm::sqrt(0.5);
    let (mut sum, mut count) = (0.0, 0.0);
    let mut averages = Vec::new();
    for replicate in 0..120 {
        let severity = |point: &RarePoint| half * point.u[0] + half * of_noise(point.noise) - beta;
        let mut bench = Closed { dimension: 1, runs: 0, severity };
        let plan = SubsetPlan { samples: 400, share: 0.1, runs: 4000, seed: 3, replicate };
        let Ok(found) = subset(&mut bench, SubsetGoal::Above(0.0), &plan);
        let noise: Vec<f64> =
            found.beyond.iter().map(|sample| of_noise(sample.point.noise)).collect();
        let average = noise.iter().sum::<f64>() / noise.len() as f64;
        averages.push(average);
        sum += average;
        count += 1.0;
    }
    let mean = sum / count;
    let scatter = averages.iter().map(|a| (a - mean) * (a - mean)).sum::<f64>() / (count - 1.0);
    // E[n | (u + n)/√2 > β] = φ(β)/(√2 P).
    let density = libm::exp(-0.5 * beta * beta) / libm::sqrt(std::f64::consts::TAU);
    let expected = half * density / 1e-2;
    let error = libm::sqrt(scatter / count);
    assert!(error < 0.03 && (mean - expected).abs() < 4.0 * error, "{mean} {expected} {error}");
}

#[test]
fn the_weight_of_a_mixture_is_the_ratio_of_densities() {
    let mixture = NormalMixture::of(&[
        (0.25, &NormalMixture::around(2, 2.0)),
        (0.75, &NormalMixture::plain(2)),
    ]);
    let u: [f64; 2] = [1.5, -0.5];
    let density = |sigma: f64| {
        let squared = (u[0] * u[0] + u[1] * u[1]) / (sigma * sigma);
        libm::exp(-0.5 * squared) / (std::f64::consts::TAU * sigma * sigma)
    };
    let expected = libm::log((0.25 * density(2.0) + 0.75 * density(1.0)) / density(1.0));
    assert!((mixture.log_ratio(&u) - expected).abs() < 1e-12);
}

#[test]
fn a_slope_is_found_through_noise_and_without_a_spread_there_is_none() {
    let mut draws = Draws::of(1, "slope", 0);
    let points: Vec<([f64; 3], f64)> = (0..60)
        .map(|_| {
            let u = [draws.normal(), draws.normal(), draws.normal()];
            (u, 2.0 * u[0] - u[2] + 5.0)
        })
        .collect();
    let data: Vec<(&[f64], f64, f64)> = points.iter().map(|(u, s)| (&u[..], 1.0, *s)).collect();
    let found = slope(&data).unwrap();
    for (found, expected) in found.iter().zip([2.0, 0.0, -1.0]) {
        assert!((found - expected).abs() < 0.02, "{found} {expected}");
    }
    assert_eq!(slope(&[(&[1.0, 2.0][..], 1.0, 3.0); 4]), None);
    assert_eq!(slope(&[]), None);
}
