//! Changes of a parameter: their tests are normal where nothing changes, and their sizes are those put in.

use crate::linear::Linear;
use octant_calibration::covariance::PARAMETERS;
use octant_smoother::backward::smooth;
use octant_smoother::constancy::{ConstancyFinding, ParameterChange, test_parameter};

const COUNT: usize = 200;
const NODE: usize = 5;
/// The parameter that changes.
const CHANGES: usize = 4;

fn findings(
    seed: u64,
    alter: impl FnMut(usize, &mut octant_smoother::StateVector),
) -> Vec<ConstancyFinding> {
    let system = Linear::new(0.0);
    let (mut store, _) = system.run(seed, COUNT, NODE, alter);
    let mut all = Vec::new();
    let smoothed = smooth(&mut store).unwrap();
    test_parameter(&smoothed, &system.prior, CHANGES, &mut |found| all.push(found));
    all
}

fn of(
    all: &[ConstancyFinding],
    change: ParameterChange,
    between_s: Option<(f64, f64)>,
) -> ConstancyFinding {
    let is = |found: &&ConstancyFinding| {
        found.change == change && between_s.is_none_or(|between_s| found.between_s == between_s)
    };
    *all.iter().find(is).unwrap()
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt())
}

/// The courses whose size is known: at 100 s, to 150 s.
const COURSES: [(ParameterChange, (f64, f64)); 3] = [
    (ParameterChange::Jump, (100.0, 200.0)),
    (ParameterChange::Pulse, (100.0, 150.0)),
    (ParameterChange::Ramp, (100.0, 150.0)),
];

#[test]
fn sizes_are_unbiased_and_scatter_as_they_say() {
    const SIZE: f64 = 0.5;
    for (change, between_s) in COURSES {
        let mut sizes = Vec::new();
        let mut sigma = 0.0;
        for seed in 0..80 {
            let all = findings(seed, |k, truth| {
                // Step k goes from second k − 1 to k.
                let at = |k: usize| match change {
                    ParameterChange::Jump => f64::from(u8::from(k > 100)),
                    ParameterChange::Pulse => f64::from(u8::from(k > 100 && k <= 150)),
                    // The ramp that is tested has its changes at the nodes.
                    _ => (((k as f64 - 101.0) / 5.0).floor() + 1.0).clamp(0.0, 10.0) / 10.0,
                };
                truth[PARAMETERS + CHANGES] += SIZE * (at(k) - at(k - 1));
            });
            let found = of(&all, change, Some(between_s));
            sizes.push(found.size);
            sigma = found.size_sigma.unwrap();
        }
        let (mean, scatter) = moments(&sizes);
        // σ of the mean is a ninth of the scatter, that of the scatter 8 %.
        assert!((mean - SIZE).abs() < 0.35 * sigma, "{change:?}: {mean} ± {sigma}");
        assert!((scatter / sigma - 1.0).abs() < 0.24, "{change:?}: {scatter}, expected {sigma}");
    }
}

#[test]
fn without_a_change_every_test_is_normal_and_every_tail_uniform() {
    let mut squares = [0.0; 3];
    let mut tails: Vec<f64> = Vec::new();
    let seeds = 150;
    for seed in 1000..1000 + seeds {
        let all = findings(seed, |_, _| {});
        for (square, (change, between_s)) in squares.iter_mut().zip(COURSES) {
            *square += of(&all, change, Some(between_s)).sigmas.powi(2) / seeds as f64;
        }
        let walk = of(&all, ParameterChange::Walk, None);
        tails.push(libm::erfc(walk.sigmas / std::f64::consts::SQRT_2));
    }
    for square in squares {
        // σ of the mean of 150 squares is 0.12.
        assert!((square - 1.0).abs() < 0.35, "{squares:?}");
    }
    for level in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let below = tails.iter().filter(|tail| **tail < level).count() as f64 / seeds as f64;
        assert!((below - level).abs() < 0.12, "{below} of the tails are below {level}");
    }
}

#[test]
fn a_random_walk_and_a_wandering_are_seen_and_measured() {
    // Per step; the test knows them per √s.
    const WALK: f64 = 0.1;
    let (mut squares, mut seen) = (Vec::new(), 0);
    for seed in 0..80 {
        let noise = octant_random::stream::Triad::new(seed, "walk");
        let all = findings(seed, |k, truth| {
            truth[PARAMETERS + CHANGES] += WALK * noise.at(k as u64)[0];
        });
        let walk = of(&all, ParameterChange::Walk, None);
        squares.push(walk.size * walk.size);
        seen += u32::from(walk.sigmas > 3.0);
    }
    let (mean, scatter) = moments(&squares);
    let error = scatter / (squares.len() as f64).sqrt();
    // Within the nodes the walk goes on: that and the estimates that are cut at zero make it no better than 15 %.
    assert!((mean / (WALK * WALK) - 1.0).abs() < 0.15 + 3.0 * error / (WALK * WALK), "{mean}");
    assert!(seen > 50, "{seen}");
    // A Gauss-Markov process with a third of the time as correlation time.
    let tau = COUNT as f64 * (1.0 / 3.0);
    let (sigma, decay) = (0.6, f64::exp(-1.0 / tau));
    let mut squares = Vec::new();
    for seed in 0..80 {
        let noise = octant_random::stream::Triad::new(seed, "wander");
        let mut level = sigma * noise.initial()[0];
        let mut last = 0.0;
        let all = findings(seed, |k, truth| {
            truth[PARAMETERS + CHANGES] += level - last;
            last = level;
            level = decay * level + sigma * (1.0 - decay * decay).sqrt() * noise.at(k as u64)[0];
        });
        let found = of(&all, ParameterChange::Wander { correlation_time_s: tau }, None);
        squares.push(found.size * found.size);
    }
    let (mean, scatter) = moments(&squares);
    let error = scatter / (squares.len() as f64).sqrt();
    assert!((mean / (sigma * sigma) - 1.0).abs() < 0.1 + 3.0 * error / (sigma * sigma), "{mean}");
}
