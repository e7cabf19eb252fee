//! Draws of factors: their dependencies and distributions.

use octant_statistics::draw::{
    Correlations, Distribution, DrawError, DrawnFactor, Factor, FactorCorrelation, latin_hypercube,
    monte_carlo,
};
use octant_statistics::{normal, rank, sample};

fn factors() -> Vec<Factor> {
    vec![
        Factor::new("bias", Distribution::Normal { mean: 1.0, sigma: 2.0 }),
        Factor::new("scale", Distribution::Uniform { low: -30.0, high: 30.0 }),
        Factor::new("walk", Distribution::LogNormal { median: 7e-4, sigma_ln: 0.5 }),
        Factor::new("site", Distribution::Choice { weights: vec![1.0, 0.0, 3.0] }),
        Factor::new("tilt", Distribution::Normal { mean: 0.0, sigma: 1.0 }).truncated(-0.5, 2.0),
    ]
}

fn pair(first: &str, second: &str, value: f64) -> FactorCorrelation {
    FactorCorrelation { first: first.to_owned(), second: second.to_owned(), value }
}

fn column(draws: &[Vec<DrawnFactor>], at: usize) -> Vec<f64> {
    draws.iter().map(|row| row[at].number()).collect()
}

fn draws(factors: &[Factor], correlations: &[FactorCorrelation], n: u64) -> Vec<Vec<DrawnFactor>> {
    (0..n).map(|i| monte_carlo(factors, correlations, 11, i).unwrap()).collect()
}

/// Kolmogorov's distance of probabilities from the uniform distribution, times √n.
fn distance(mut units: Vec<f64>) -> f64 {
    units.sort_by(f64::total_cmp);
    let n = units.len() as f64;
    let at = |(i, u): (usize, &f64)| (u - i as f64 / n).abs().max((u - (i + 1) as f64 / n).abs());
    units.iter().enumerate().map(at).fold(0.0, f64::max) * n.sqrt()
}

#[test]
fn a_draw_depends_on_seed_name_and_number_alone() {
    let all = factors();
    let whole = draws(&all, &[], 20);
    // Fewer factors, in another order, and only the later runs give the same numbers.
    let some = vec![all[4].clone(), all[0].clone()];
    for i in (5..20).rev() {
        let row = monte_carlo(&some, &[], 11, i).unwrap();
        assert_eq!(row, [whole[i as usize][4], whole[i as usize][0]]);
    }
    assert_ne!(monte_carlo(&all, &[], 12, 0).unwrap(), whole[0]);
    // A correlation of two others changes no third factor, and not the first one of the two.
    let with = draws(&all, &[pair("bias", "walk", 0.8)], 20);
    for (row, plain) in with.iter().zip(&whole) {
        assert_eq!([row[0], row[1], row[3], row[4]], [plain[0], plain[1], plain[3], plain[4]]);
        assert_ne!(row[2], plain[2]);
    }
    // Frozen: these bits determine the ids of cases.
    let DrawnFactor::Number(first) = whole[0][0] else { panic!() };
    assert_eq!(first.to_bits(), FIRST_BIAS_BITS, "{:#x} {first}", first.to_bits());
}

/// Bits of the bias of draw 0 with seed 11.
const FIRST_BIAS_BITS: u64 = 0x4007_03db_ec7a_ffd3;

#[test]
fn draws_are_distributed_as_they_say() {
    let drawn = draws(&factors(), &[], 20_000);
    let units =
        |at: usize, cdf: &dyn Fn(f64) -> f64| column(&drawn, at).into_iter().map(cdf).collect();
    // Limit: Kolmogorov's 0.1 % point.
    assert!(distance(units(0, &|x| normal::cdf((x - 1.0) / 2.0))) < 1.95);
    assert!(distance(units(1, &|x| (x + 30.0) / 60.0)) < 1.95);
    assert!(distance(units(2, &|x| normal::cdf((x / 7e-4).ln() / 0.5))) < 1.95);
    let (low, high) = (normal::cdf(-0.5), normal::cdf(2.0));
    assert!(distance(units(4, &|x| (normal::cdf(x) - low) / (high - low))) < 1.95);
    let sites = column(&drawn, 3);
    let count = |which: f64| sites.iter().filter(|s| **s == which).count() as f64;
    // Three standard deviations of a binomial: 61.
    assert!((count(0.0) - 5000.0).abs() < 3.0 * 61.3 && count(1.0) == 0.0, "{}", count(0.0));
    assert!(column(&drawn, 4).iter().all(|x| (-0.5..=2.0).contains(x)));
}

#[test]
fn a_latin_hypercube_has_one_draw_in_each_part() {
    let all = factors();
    for correlations in [vec![], vec![pair("bias", "scale", 0.7), pair("scale", "walk", -0.5)]] {
        let drawn = latin_hypercube(&all, &correlations, 3, 200).unwrap();
        for (at, cdf) in [
            (0, Box::new(|x: f64| normal::cdf((x - 1.0) / 2.0)) as Box<dyn Fn(f64) -> f64>),
            (1, Box::new(|x| (x + 30.0) / 60.0)),
            (2, Box::new(|x: f64| normal::cdf((x / 7e-4).ln() / 0.5))),
        ] {
            let mut parts: Vec<usize> =
                column(&drawn, at).into_iter().map(|x| (cdf(x) * 200.0) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..200).collect::<Vec<_>>());
        }
        // Exactly a quarter, up to the part at the boundary.
        let sites = column(&drawn, 3).iter().filter(|s| **s == 0.0).count();
        assert_eq!(sites, 50);
    }
    // The draws of one factor don't depend on the others.
    let alone = latin_hypercube(&all[1..2], &[], 3, 200).unwrap();
    assert_eq!(column(&alone, 0), column(&latin_hypercube(&all, &[], 3, 200).unwrap(), 1));
}

#[test]
fn correlations_are_those_asked_for() {
    let all = factors();
    let wanted = [pair("bias", "walk", 0.8), pair("bias", "tilt", -0.3), pair("walk", "tilt", 0.1)];
    let runs = 4000;
    let drawn = draws(&all, &wanted, runs);
    let cube = latin_hypercube(&all, &wanted, 3, runs as usize).unwrap();
    // Limit: five standard errors of a chance correlation.
    let chance = 5.0 / (runs as f64).sqrt();
    for (a, b, r) in [(0, 2, 0.8), (0, 4, -0.3), (2, 4, 0.1), (0, 1, 0.0), (1, 4, 0.0)] {
        // Spearman's ρ of a Gaussian copula is 6/π asin(r/2).
        let expected = 6.0 / std::f64::consts::PI * (r / 2.0f64).asin();
        let found = rank::spearman(&column(&drawn, a), &column(&drawn, b)).unwrap().rho;
        assert!((found - expected).abs() < chance, "{a} {b} {r} {found}");
        // The hypercube has the correlation of the normal scores themselves, except for the rounding of
        // scores to those of ranks; factors without a requested correlation are left to chance.
        let found = scores(&column(&cube, a), &column(&cube, b));
        let within = if r == 0.0 { chance } else { 0.01 };
        assert!((found - r).abs() < within, "{a} {b} {r} {found}");
    }
}

/// An option without weight is never drawn, however weights are rounded.
#[test]
fn a_choice_without_weight_is_never_drawn() {
    for count in 1..50 {
        for weight in [0.1, 0.3, 0.7, 1.0 / 3.0] {
            let mut weights = vec![weight; count];
            weights.push(0.0);
            let factor = Factor::new("choice", Distribution::Choice { weights });
            for u in [f64::MIN_POSITIVE, 0.5, 1.0 - f64::EPSILON / 2.0] {
                let DrawnFactor::Choice(drawn) = factor.at(u).unwrap() else { panic!("no choice") };
                assert!(drawn < count, "{count} of {weight}");
            }
        }
    }
}

/// A distribution has no value at 0 and 1, and correlated draws reach neither.
#[test]
fn correlated_draws_stay_inside() {
    let all = factors();
    let together = Correlations::new(&all, &[pair("bias", "walk", 0.6)]).unwrap();
    let near_one = 1.0 - f64::EPSILON / 2.0;
    for extreme in [f64::MIN_POSITIVE, near_one] {
        let mut units = vec![extreme; all.len()];
        together.apply(&mut units);
        assert!(
            units.iter().all(|unit| (f64::MIN_POSITIVE..=near_one).contains(unit)),
            "{units:?}"
        );
    }
}

/// Correlation of normal scores.
fn scores(x: &[f64], y: &[f64]) -> f64 {
    let of = |values: &[f64]| -> Vec<f64> {
        let n = values.len() as f64 + 1.0;
        sample::ranks(values).into_iter().map(|rank| normal::quantile(rank / n)).collect()
    };
    let (x, y) = (of(x), of(y));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(&x, &y) / (dot(&x, &x) * dot(&y, &y)).sqrt()
}

#[test]
fn what_can_not_be_drawn_is_told() {
    let all = factors();
    let message = |factors: &[Factor], correlations: &[FactorCorrelation]| {
        monte_carlo(factors, correlations, 1, 0).unwrap_err().to_string()
    };
    let normal = |sigma| Factor::new("x", Distribution::Normal { mean: 0.0, sigma });
    assert_eq!(message(&[normal(0.0)], &[]), "draw x: sigma is 0, expected more than 0");
    assert_eq!(
        message(&[normal(1.0).truncated(50.0, 60.0)], &[]),
        "draw x: nothing of the distribution is between 50 and 60"
    );
    assert_eq!(
        message(&[normal(1.0).truncated(2.0, 1.0)], &[]),
        "draw x: nothing of the distribution is between 2 and 1"
    );
    assert_eq!(
        message(&[normal(1.0), normal(2.0)], &[]),
        "draw x: there are two factors of this name"
    );
    let choice = Factor::new("c", Distribution::Choice { weights: vec![0.0] });
    assert_eq!(
        message(&[choice], &[]),
        "draw c: the sum of the weights is 0, expected more than 0"
    );
    let even = Factor::new("u", Distribution::Uniform { low: 1.0, high: 1.0 });
    assert_eq!(message(&[even], &[]), "draw u: it is even from 1 to 1: there is nothing between");
    for (correlation, expected) in [
        (pair("bias", "none", 0.1), "correlate bias with none: there is no factor none"),
        (
            pair("bias", "site", 0.1),
            "correlate bias with site: site is a choice, which has no order",
        ),
        (pair("bias", "bias", 0.1), "correlate bias with bias: a factor is correlated with itself"),
        (
            pair("bias", "walk", 1.0),
            "correlate bias with walk: found 1, expected more than -1 and less than 1",
        ),
    ] {
        assert_eq!(message(&all, &[correlation]), expected);
    }
    let twice = [pair("bias", "walk", 0.1), pair("walk", "bias", 0.1)];
    assert_eq!(message(&all, &twice), "correlate walk with bias: it is there a second time");
    let impossible =
        [pair("bias", "walk", 0.9), pair("walk", "tilt", 0.9), pair("bias", "tilt", -0.9)];
    let error = monte_carlo(&all, &impossible, 1, 0).unwrap_err();
    let expected = DrawError::NotPositiveDefinite {
        factors: ["bias", "walk", "tilt"].map(str::to_owned).into(),
        breaks_at: "tilt".to_owned(),
    };
    assert_eq!(error, expected);
    assert!(error.to_string().starts_with("correlate bias, walk, tilt: no quantities"), "{error}");
    let few = latin_hypercube(&all, &[pair("bias", "walk", 0.9)], 1, 3).unwrap_err();
    assert_eq!(few, DrawError::Runs { found: 3, expected: 4 });
    assert_eq!(latin_hypercube(&all, &[], 1, 0), Err(DrawError::Runs { found: 0, expected: 1 }));
}
