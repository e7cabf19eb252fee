//! Intervals of probabilities whose true value is known.

use octant_random::draws::Draws;
use octant_rare::estimators::estimate::{RareEstimate, RarePlan, estimate};
use octant_rare::estimators::point::{RareBench, RarePoint, RareStage};
use octant_rare::estimators::subset::SubsetGoal;
use octant_statistics::normal;
use std::convert::Infallible;

/// A severity that is a closed form.
pub(crate) struct Closed<F> {
    pub(crate) dimension: usize,
    pub(crate) runs: usize,
    pub(crate) severity: F,
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

fn estimated(dimension: usize, seed: u64, severity: impl Fn(&RarePoint) -> f64) -> RareEstimate {
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
    /// Intervals below the true value.
    below: usize,
    bias: f64,
}

/// Share of repetitions that may end in doubt.
const DOUBTED_MAX: f64 = 0.05;

impl Tally {
    /// Asserts that intervals of 95 % hold the true value in 92 to 98 % of the repetitions, and that few are in doubt.
    fn holds(&self, name: &str) {
        let shown = self.tried - self.doubted;
        let share = self.held as f64 / shown as f64;
        if std::env::var("REPORT").is_ok() {
            return;
        }
        assert!((0.92..=0.98).contains(&share), "{name}: {share}");
        assert!(self.doubted as f64 <= DOUBTED_MAX * self.tried as f64, "{name}: {}", self.doubted);
    }

    /// Asserts that few repetitions claim an interval that doesn't hold the true value, however many are in doubt.
    fn claims_little(&self, name: &str) {
        let wrong = self.tried - self.doubted - self.held;
        if std::env::var("REPORT").is_ok() {
            return;
        }
        assert!(wrong as f64 <= 0.08 * self.tried as f64, "{name}: {wrong} of {}", self.tried);
    }
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
            if std::env::var("SHOW").is_ok() {
                println!("{:?} {:?}", found.doubts, found.mean);
            }
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

fn repetitions() -> u64 {
    std::env::var("REPETITIONS").map_or(300, |n| n.parse().unwrap())
}

fn linear(dimension: usize) {
    for probability in [1e-3, 1e-4, 1e-6] {
        let beta = -normal::quantile(probability);
        let a = direction(dimension);
        let name = format!("linear, {dimension} components, {probability:e}");
        let severity = |point: &RarePoint| along(&a, point) - beta;
        covered(&name, repetitions(), dimension, probability, severity).holds(&name);
    }
}

fn two_regions(dimension: usize) {
    let beta = -normal::quantile(5e-6);
    let a = direction(dimension);
    let name = format!("two regions, {dimension} components, 1e-5");
    let severity = |point: &RarePoint| along(&a, point).abs() - beta;
    covered(&name, repetitions(), dimension, 1e-5, severity).holds(&name);
}

#[test]
#[ignore = "takes minutes: docs/testing.md has the command"]
fn linear_of_2() {
    linear(2);
    two_regions(2);
}

#[test]
#[ignore = "takes minutes: docs/testing.md has the command"]
fn linear_of_10() {
    linear(10);
    two_regions(10);
}

#[test]
#[ignore = "takes minutes: docs/testing.md has the command"]
fn linear_of_75() {
    linear(75);
}

#[test]
#[ignore = "takes minutes: docs/testing.md has the command"]
fn two_regions_of_75() {
    two_regions(75);
}

/// P(v + c w² > b) of two independent standard normals, by the trapezoidal rule over w.
fn curved_probability(c: f64, b: f64) -> f64 {
    let step = 1e-3;
    let density = |w: f64| (-0.5 * w * w).exp() / std::f64::consts::TAU.sqrt();
    (-10_000..=10_000)
        .map(|k| f64::from(k) * step)
        .map(|w| step * density(w) * normal::cdf(c * w * w - b))
        .sum()
}

#[test]
#[ignore = "takes minutes: docs/testing.md has the command"]
fn curved_surfaces() {
    for (c, b) in [(0.15, 5.0), (-0.3, 4.5)] {
        let truth = curved_probability(c, b);
        let name = format!("curved by {c}, 10 components, {truth:.1e}");
        let severity = |point: &RarePoint| point.u[0] + c * point.u[1] * point.u[1] - b;
        covered(&name, repetitions(), 10, truth, severity).holds(&name);
    }
    // Failures all around: the distance from the middle is Rayleigh's.
    let severity = |point: &RarePoint| point.radius() - libm::sqrt(-2.0 * libm::log(1e-5));
    let name = "a ring, 2 components, 1e-5";
    covered(name, repetitions(), 2, 1e-5, severity).holds(name);
}

/// A standard normal number of a seed.
fn of_noise(noise: u64) -> f64 {
    Draws::of(noise, "noise of a test", 0).normal()
}

#[test]
#[ignore = "takes minutes: docs/testing.md has the command"]
fn noise_has_a_part_in_the_failures() {
    for (share, probability) in [(0.05, 1e-6), (0.2, 1e-4), (0.2, 1e-6), (0.5, 1e-3), (1.0, 0.05)] {
        let a = direction(10);
        let beta = -normal::quantile(probability);
        let name = format!("noise has {share} of the variance, {probability:e}");
        let severity = |point: &RarePoint| {
            libm::sqrt(1.0 - share) * along(&a, point) + libm::sqrt(share) * of_noise(point.noise)
                - beta
        };
        let tally = covered(&name, repetitions(), 10, probability, severity);
        if share < 0.1 {
            tally.holds(&name);
        }
        tally.claims_little(&name);
    }
}

#[test]
fn intervals_of_a_linear_case_cover() {
    let a = direction(10);
    let beta = -normal::quantile(1e-4);
    let tally = covered("quick", 60, 10, 1e-4, |point| along(&a, point) - beta);
    // At 95 % fewer than 51 of 60 have a probability of 0.2 %.
    assert!(tally.held >= 51 && tally.doubted <= 3, "{} {}", tally.held, tally.doubted);
    // Unbiased: the mean of 60 with an error of 5 % each.
    assert!(tally.bias.abs() / 60.0 < 4.0 * 0.05 / libm::sqrt(60.0), "{}", tally.bias);
}

/// Level that a normal error exceeds with a probability, against its quantile.
fn levels(repetitions: u64, dimension: usize, risk: f64) -> (usize, usize) {
    let a = direction(dimension);
    let truth = -normal::quantile(0.5 * risk);
    let (mut held, mut shown) = (0, 0);
    for seed in 0..repetitions {
        let severity = |point: &RarePoint| along(&a, point).abs();
        let mut bench = Closed { dimension, runs: 0, severity };
        let plan = RarePlan { seed, ..RarePlan::default() };
        let Ok(found) = estimate(&mut bench, SubsetGoal::Probability(risk), &plan);
        if !found.doubts.is_empty() {
            continue;
        }
        shown += 1;
        let [low, level, high] = found.level(risk, 0.95).unwrap();
        assert!(low <= level && level <= high, "{low} {level} {high}");
        held += usize::from(low <= truth && truth <= high);
    }
    println!("levels, {dimension} components, {risk:e}: {held} of {shown}, {repetitions} tried");
    (held, shown)
}

#[test]
#[ignore = "takes minutes: docs/testing.md has the command"]
fn levels_cover_as_stated() {
    for dimension in [2, 10, 30] {
        for risk in [1e-3, 1e-5] {
            let (held, shown) = levels(repetitions(), dimension, risk);
            let share = held as f64 / shown as f64;
            assert!((0.92..=0.98).contains(&share), "{dimension} {risk}: {share}");
            assert!(shown as f64 >= 0.95 * repetitions() as f64, "{shown}");
        }
    }
}

#[test]
fn levels_of_a_linear_case_cover() {
    let (held, shown) = levels(40, 10, 1e-4);
    assert!(shown >= 38 && held >= 33, "{held} of {shown}");
}
