//! Intervals of probabilities whose true value is known.

use octant_random::draws::Draws;
use octant_rare::estimate::{RareEstimate, RarePlan, estimate};
use octant_rare::point::{RareBench, RarePoint, RareStage};
use octant_rare::subset::SubsetGoal;
use octant_statistics::normal;
use std::convert::Infallible;

/// A severity that is a closed form.
struct Closed<F> {
    dimension: usize,
    runs: usize,
    severity: F,
}

impl<F: Fn(&RarePoint) -> f64> RareBench for Closed<F> {
    type Error = Infallible;
    fn dimension(&self) -> usize {
        self.dimension
    }
    fn severities(&mut self, points: &[RarePoint], _: RareStage) -> Result<Vec<f64>, Infallible> {
        self.runs += points.len();
        Ok(points.iter().map(&self.severity).collect())
    }
}

fn estimated(
    dimension: usize,
    seed: u64,
    severity: impl Fn(&RarePoint) -> f64,
) -> RareEstimate {
    let mut bench = Closed { dimension, runs: 0, severity };
    let plan = RarePlan { seed, ..RarePlan::default() };
    let Ok(found) = estimate(&mut bench, SubsetGoal::Above(0.0), &plan);
    assert_eq!(found.runs, bench.runs);
    assert!(found.runs <= plan.runs, "{}", found.runs);
    found
}

/// How often intervals held the true value.
#[derive(Default)]
struct Tally {
    tried: usize,
    held: usize,
    doubted: usize,
    runs: usize,
    error: f64,
    below: usize,
    bias: f64,
}

fn covered(
    name: &str,
    repetitions: u64,
    dimension: usize,
    truth: f64,
    severity: impl Fn(&RarePoint) -> f64,
) -> Tally {
    let mut tally = Tally::default();
    for seed in 0..repetitions {
        let found = estimated(dimension, seed, &severity);
        tally.tried += 1;
        tally.runs += found.runs;
        if !found.doubts.is_empty() {
            if std::env::var("SHOW").is_ok() { println!("{:?} {:?}", found.doubts, found.mean); }
            tally.doubted += 1;
            continue;
        }
        let mean = found.mean.unwrap();
        tally.error += mean.error;
        tally.bias += mean.probability / truth - 1.0;
        tally.held += usize::from(mean.interval[0] <= truth && truth <= mean.interval[1]);
        tally.below += usize::from(mean.interval[1] < truth);
    }
    let shown = (tally.tried - tally.doubted).max(1);
    println!(
        "{name:34} {:5.1} % of {shown}, {} below, {} doubted, {} runs, error {:.3}, bias {:+.4}",
        100.0 * tally.held as f64 / shown as f64,
        tally.below,
        tally.doubted,
        tally.runs / tally.tried,
        tally.error / shown as f64,
        tally.bias / shown as f64
    );
    tally
}

/// Unit vector of a dimension that favours no axis.
fn direction(dimension: usize) -> Vec<f64> {
    let mut draws = Draws::of(5, "direction", dimension as u64);
    let raw: Vec<f64> = (0..dimension).map(|_| draws.normal()).collect();
    let norm = raw.iter().map(|x| x * x).sum::<f64>().sqrt();
    raw.into_iter().map(|x| x / norm).collect()
}

fn along(direction: &[f64], point: &RarePoint) -> f64 {
    direction.iter().zip(&point.u).map(|(a, u)| a * u).sum()
}

fn study(repetitions: u64) -> Vec<(String, Tally)> {
    let mut all = Vec::new();
    for dimension in [2, 10, 75] {
        for probability in [1e-3, 1e-4, 1e-6] {
            let beta = -normal::quantile(probability);
            let a = direction(dimension);
            let name = format!("linear, {dimension} components, {probability:e}");
            let tally = covered(&name, repetitions, dimension, probability, |point| along(&a, point) - beta);
            all.push((name, tally));
        }
        let beta = -normal::quantile(5e-6);
        let a = direction(dimension);
        let name = format!("two regions, {dimension} components, 1e-5");
        let tally = covered(&name, repetitions, dimension, 1e-5, |point| along(&a, point).abs() - beta);
        all.push((name, tally));
    }
    all
}

#[test]
#[ignore = "minutes"]
fn intervals_cover_as_stated() {
    let repetitions = std::env::var("REPETITIONS").map_or(300, |n| n.parse().unwrap());
    for (name, tally) in study(repetitions) {
        let shown = tally.tried - tally.doubted;
        let share = tally.held as f64 / shown as f64;
        assert!((0.92..=0.98).contains(&share), "{name}: {share}");
    }
}
