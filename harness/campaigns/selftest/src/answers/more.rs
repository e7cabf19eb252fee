//! Power, ratios, distances in the plane, hypercubes and correlated draws.

use super::numbers::Found;
use octant_statistics::draw::{
    Distribution, Factor, FactorCorrelation, latin_hypercube, monte_carlo,
};
use octant_statistics::radius::Plane;
use octant_statistics::{paired, position, power, sample};
use std::hint::black_box;

pub(super) fn found() -> Result<Found, String> {
    all().ok_or_else(|| "compute further statistics".to_owned())
}

fn all() -> Option<Found> {
    let mut all = Found::new();
    let mut put = |name: &str, value: f64| all.insert(name.to_owned(), value);
    let first: Vec<f64> =
        (0..12).map(|i| 1.0 + 0.1 * f64::from(i) * if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let second: Vec<f64> =
        first.iter().zip(0..).map(|(x, i)| 0.7 * x + 0.02 * f64::from(i % 5)).collect();
    let improvement = paired::improvement(&first, &second, 0.9)?;
    put("improvement", improvement.value);
    put("improvement low", improvement.low);
    put("improvement high", improvement.high);
    put("improvement detectable", improvement.detectable?);
    put("shift of 20 pairs", power::signed_rank_shift(20, 0.05, 0.9)?);
    put("shift of 100 pairs", power::signed_rank_shift(100, 0.05, 0.9)?);
    put("shift of 25 values", power::mean_shift(25, 0.95, 0.9)?);
    let (below, above) = power::sigma_ratios(25, 0.95, 0.9)?;
    put("ratio below", below);
    put("ratio above", above);
    let (below, above) = sample::deviation_factors(24, 0.95)?;
    put("factor below", below);
    put("factor above", above);
    put("turning of 50", power::turning(50, 0.05, 0.9)?);
    let plane = Plane { mean: [0.3, -0.2], variances: [1.2, 0.4], covariance: 0.3 };
    put("within 1.1", black_box(plane).within(1.1));
    put("radius of 0.5", plane.quantile(0.5));
    put("radius of 0.95", plane.quantile(0.95));
    put("cep50", position::cep50(black_box(1.3), 0.9));
    let even = [Factor::new("x", Distribution::Uniform { low: 0.0, high: 1.0 })];
    for (i, row) in latin_hypercube(&even, &[], 3, 24).ok()?.into_iter().enumerate() {
        put(&format!("hypercube {i}"), row.first()?.number());
    }
    let normal = |name, mean, sigma| Factor::new(name, Distribution::Normal { mean, sigma });
    let factors = [normal("a", 10.0, 2.0), normal("b", 5.0, 1.0)];
    let pair = FactorCorrelation { first: "a".to_owned(), second: "b".to_owned(), value: 0.6 };
    for i in 0..6 {
        let row = monte_carlo(&factors, std::slice::from_ref(&pair), 3, i).ok()?;
        put(&format!("correlated {i} a"), row.first()?.number());
        put(&format!("correlated {i} b"), row.get(1)?.number());
    }
    Some(all)
}
