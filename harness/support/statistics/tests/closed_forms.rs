//! Comparison with closed forms.

use octant_statistics::envelope::{EnvelopeError, envelope, resampled};
use octant_statistics::outlier::{LIMIT, OutlierScale, outliers};
use octant_statistics::radius::Plane;
use octant_statistics::rate::{RadialSample, radial_rate_nmi_per_h, time_rms_nmi};
use octant_statistics::{
    convergence, normal, paired, position, power, quantile, rank, rate, sample,
};

/// Standard normal numbers of a stream.
fn normals(seed: u64, name: &str, n: u64) -> Vec<f64> {
    use octant_random::normal::Ziggurat;
    use octant_random::stream::{Phase, key};
    let key = key(seed, name, Phase::Draw);
    (0..n).map(|i| Ziggurat::shared().three(key, i)[0]).collect()
}

#[test]
fn the_circle_of_a_round_gaussian() {
    // Radial errors are Rayleigh: median σ √(2 ln 2), 95 % at σ √(2 ln 20), drms σ √2.
    let (n, e) = (normals(1, "north", 40_000), normals(1, "east", 40_000));
    let errors: Vec<[f64; 2]> = n.iter().zip(&e).map(|(n, e)| [3.0 * n, 3.0 * e]).collect();
    let found = position::position_statistics(&errors).unwrap();
    let near = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}")
    };
    near(found.cep50_empirical, 3.0 * (2.0 * 2f64.ln()).sqrt());
    near(found.cep50_gaussian, 3.0 * (2.0 * 2f64.ln()).sqrt());
    near(found.r95, 3.0 * (2.0 * 20f64.ln()).sqrt());
    near(found.drms, 3.0 * 2f64.sqrt());
    let bounds = position::position_bounds(&errors, 0.95).unwrap();
    assert_eq!((bounds.cep50.value, bounds.r95.value), (found.cep50_empirical, found.r95));
    assert!(bounds.cep50.low < bounds.cep50.value && bounds.cep50.value < bounds.cep50.high);
    assert_eq!(position::position_statistics(&[]), None);
}

#[test]
fn bounds_of_a_quantile_cover_it_as_often_as_they_say() {
    // 2000 samples of 100 uniform numbers: the 95 % quantile is 0.95, and a 90 % interval covers it in
    // at least that fraction of samples, within the scatter of a binomial distribution.
    let mut held = 0;
    for sample in 0..2000 {
        let name = format!("sample {sample}");
        let values: Vec<f64> =
            normals(2, &name, 100).into_iter().map(octant_statistics::normal::cdf).collect();
        let interval = quantile::interval(&values, 0.95, 0.9).unwrap();
        held += u32::from(interval.low <= 0.95 && 0.95 <= interval.high);
    }
    assert!(held > 1800 - 3 * 14, "{held} of 2000");
    // Ranks are integers: the coverage is more than nominal, but not complete.
    assert!(held < 1960, "{held} of 2000");
    // Too few values give no upper end.
    assert_eq!(quantile::interval(&[1.0, 2.0], 0.95, 0.9).unwrap().high, f64::INFINITY);
}

#[test]
fn the_rate_of_a_ramp_is_its_slope() {
    let ramp: Vec<RadialSample> = (0..100)
        .map(|i| RadialSample { t_h: 0.3 * f64::from(i), radial_nmi: 0.24 * f64::from(i) })
        .collect();
    assert!((radial_rate_nmi_per_h(&ramp).unwrap() - 0.8).abs() < 1e-14);
    // Expected: √(1/T ∫ (0.8 t)² dt) = 0.8 T / √3.
    let expected = 0.8 * 0.3 * 99.0 / 3f64.sqrt();
    assert!((time_rms_nmi(&ramp).unwrap() - expected).abs() < 1e-12);
    assert_eq!(radial_rate_nmi_per_h(&ramp[..1]), None);
    assert_eq!(time_rms_nmi(&ramp[..1]), None);
    let [half, most] = rate::radial_rates(&[0.0, 1.0, 2.0]).unwrap();
    assert!((half - 1.0).abs() < 1e-15 && (most - 1.9).abs() < 1e-15);
    let bounds = rate::rate_bounds(&[0.0, 1.0, 2.0], 0.5).unwrap();
    assert_eq!((bounds.rate50.low, bounds.rate50.high), (0.0, 2.0));
}

#[test]
fn an_envelope_has_the_percentiles_of_every_point() {
    // Run k is k times a line: at t its p-percentile is p (n − 1) t.
    let series: Vec<Vec<f64>> =
        (0..11).rev().map(|k| (0..5).map(|t| f64::from(k * t)).collect()).collect();
    let found = envelope(&series, 5, &[0.0, 0.5, 0.95, 1.0]).unwrap();
    for (curve, p) in found.curves.iter().zip([0.0, 0.5, 0.95, 1.0]) {
        for (t, value) in curve.iter().enumerate() {
            assert!((value - p * 10.0 * t as f64).abs() < 1e-12);
        }
    }
    assert_eq!(envelope::<Vec<f64>>(&[], 5, &[0.5]), Err(EnvelopeError::Empty));
    let short = envelope(&[vec![0.0; 5], vec![0.0; 4]], 5, &[0.5]).unwrap_err();
    assert_eq!(short.to_string(), "make an envelope: run 1 has 4 points, the grid has 5");
    let nan = envelope(&[vec![0.0, f64::NAN]], 2, &[0.5]);
    assert_eq!(nan, Err(EnvelopeError::NotANumber { run: 0, point: 1 }));
}

#[test]
fn a_series_on_a_grid_is_straight_between_its_points() {
    // A line through any of its points, and a corner at one of the points.
    let points = [[0.0, 0.0], [0.1, 0.2], [1.0, 2.0], [4.0, -1.0]];
    let grid = [0.0, 0.05, 0.1, 0.5, 1.0, 2.0, 3.5, 4.0];
    let found = resampled(&points, &grid).unwrap();
    for (value, expected) in found.iter().zip([0.0, 0.1, 0.2, 1.0, 2.0, 1.0, -0.5, -1.0]) {
        assert!((value - expected).abs() < 1e-15, "{found:?}");
    }
    assert_eq!(resampled(&points[2..3], &[1.0]), Some(vec![2.0]));
    // A jump at one time, and a grid beyond the points.
    assert_eq!(resampled(&[[0.0, 1.0], [0.0, 3.0], [1.0, 3.0]], &[0.5]), Some(vec![3.0]));
    assert_eq!(resampled(&points, &[4.1]), None);
    assert_eq!(resampled(&points, &[-0.1, 1.0]), None);
    assert_eq!(resampled(&[], &[0.0]), None);
}

#[test]
fn what_is_more_than_chance_is_less_the_more_is_looked_at() {
    let found = rank::RankCorrelation { rho: 0.5, p: 0.02 };
    assert!(found.stands_out(0.05, 1) && found.stands_out(0.05, 2));
    assert!(!found.stands_out(0.05, 3));
}

#[test]
fn what_stands_out_is_found_and_nothing_else() {
    let mut values = normals(3, "bulk", 300);
    values[17] = 40.0;
    values[200] = -25.0;
    values[5] = f64::NAN;
    let found: Vec<usize> =
        outliers(&values, OutlierScale::Linear, 5.0).iter().map(|o| o.index).collect();
    assert_eq!(found, [5, 17, 200]);
    // Skewed magnitudes have outliers by themselves, their logarithms don't.
    let skewed: Vec<f64> = normals(3, "skewed", 300).into_iter().map(|v| (1.5 * v).exp()).collect();
    assert!(outliers(&skewed, OutlierScale::Linear, 5.0).len() > 10);
    assert_eq!(outliers(&skewed, OutlierScale::Logarithm, 5.0), []);
    // If most values are equal, every other value is an outlier with an infinite score.
    let found = outliers(&[1.0, 1.0, 1.0, 1.0, 1.1], OutlierScale::Linear, LIMIT);
    assert_eq!((found.len(), found[0].index, found[0].score), (1, 4, f64::INFINITY));
    assert_eq!(outliers(&[1.0, 1.0, 1.0], OutlierScale::Linear, LIMIT), []);
    assert_eq!(outliers(&[1.0, 2.0, 0.0], OutlierScale::Logarithm, LIMIT)[0].index, 2);
}

#[test]
fn an_estimate_settles_as_one_over_the_root() {
    let values = normals(4, "settles", 10_000);
    let found = convergence::convergence(&values, |v| convergence::mean(v, 0.95));
    let runs: Vec<u64> = found.iter().map(|step| step.runs).collect();
    assert_eq!(runs, [2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000]);
    let last = found.last().unwrap().estimate;
    assert!(((last.high - last.low) / (2.0 * 1.96 / 100.0) - 1.0).abs() < 0.03);
    let passed: Vec<bool> = (0..59).map(|_| true).collect();
    let pass = convergence::pass(&passed, 0.9).unwrap();
    assert!(pass.value == 1.0 && pass.high == 1.0 && pass.low > 0.95);
    assert!(convergence::convergence(&[] as &[f64], |v| convergence::mean(v, 0.9)).is_empty());
}

#[test]
fn sensitivities_come_with_the_strongest_first() {
    let factors: Vec<(String, Vec<f64>)> =
        ["weak", "none", "strong"].map(|name| (name.to_owned(), normals(5, name, 200))).into();
    let output: Vec<f64> =
        (0..200).map(|i| (3.0 * factors[2].1[i]).exp() + 2.0 * factors[0].1[i]).collect();
    let mut with_constant = factors.clone();
    with_constant.push(("constant".to_owned(), vec![1.0; 200]));
    let found = rank::sensitivities(&with_constant, &output);
    let names: Vec<&str> = found.iter().map(|s| s.factor.as_str()).collect();
    assert_eq!(names, ["strong", "weak", "none", "constant"]);
    assert!(found[0].correlation.unwrap().p < 1e-20);
    assert_eq!(found[3].correlation, None);
}

#[test]
fn improvement_is_paired() {
    let first = normals(6, "first", 40);
    let half: Vec<f64> = first.iter().map(|v| 0.5 * v).collect();
    // With the same noise in both, the interval has zero width.
    let found = paired::improvement(&first, &half, 0.9).unwrap();
    assert!([found.value, found.low, found.high].iter().all(|v| (v - 0.5).abs() < 1e-12));
    let other = normals(6, "second", 40);
    let found = paired::improvement(&first, &other, 0.9).unwrap();
    assert!(
        found.low < found.value && found.value < found.high && found.low < 0.0 && found.high > 0.0
    );
    assert_eq!(paired::improvement(&first, &other[1..], 0.9), None);
    assert_eq!(paired::improvement(&[0.0, 0.0], &[1.0, 1.0], 0.9), None);
    assert_eq!(paired::improvement(&[0.0, 0.0], &[0.0, 0.0], 0.9), None);
    assert_eq!(paired::improvement(&[1.0, f64::INFINITY], &[1.0, 1.0], 0.9), None);
}

#[test]
fn figures_of_a_sample() {
    assert_eq!(sample::rms(&[3.0, 4.0]), Some(12.5f64.sqrt()));
    assert_eq!(sample::deviation(&[1.0, 3.0]), Some(2f64.sqrt()));
    assert_eq!((sample::mean(&[]), sample::deviation(&[1.0])), (None, None));
    assert_eq!(sample::ranks(&[2.0, 1.0, 2.0, 5.0]), [2.5, 1.0, 2.5, 4.0]);
}

#[test]
fn the_radius_of_a_normal_error_is_that_of_rayleigh_and_of_a_line() {
    let near = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 1e-7, "{found} {expected}");
    };
    for p in [0.05f64, 0.5, 0.95, 0.999] {
        let round = Plane { mean: [0.0; 2], variances: [9.0; 2], covariance: 0.0 };
        near(round.quantile(p), 3.0 * (-2.0 * (1.0 - p).ln()).sqrt());
        // A degenerate distribution on a line of any direction is a half normal distribution.
        let half_normal = 3.0 * normal::quantile(0.5 + 0.5 * p);
        for (variances, covariance) in [([9.0, 0.0], 0.0), ([0.0, 9.0], 0.0), ([4.5, 4.5], 4.5)] {
            let line = Plane { mean: [0.0; 2], variances, covariance };
            assert!((line.quantile(p) / half_normal - 1.0).abs() < 2e-3, "{p} {variances:?}");
        }
    }
    let nothing = Plane { mean: [3.0, 4.0], variances: [0.0; 2], covariance: 0.0 };
    assert_eq!(nothing.quantile(0.5), 5.0);
    assert!(Plane { variances: [f64::NAN; 2], ..nothing }.quantile(0.5).is_nan());
}

#[test]
fn the_radius_of_any_normal_error_is_that_of_a_sample() {
    let plane = Plane { mean: [1.0, -2.0], variances: [4.0, 1.0], covariance: 1.2 };
    // Rows of the Cholesky factor: [2 0; 0.6 0.8].
    let (a, b) = (normals(7, "a", 200_000), normals(7, "b", 200_000));
    let sample: Vec<[f64; 2]> =
        a.iter().zip(&b).map(|(a, b)| [1.0 + 2.0 * a, -2.0 + 0.6 * a + 0.8 * b]).collect();
    let radial = position::radial(&sample);
    for p in [0.1, 0.5, 0.95] {
        let expected = sample::percentile(&radial, p).unwrap();
        let found = plane.quantile(p);
        // Standard errors of these quantiles are below 0.3 %.
        assert!((found / expected - 1.0).abs() < 0.01, "{p}: {found} {expected}");
        assert!((plane.within(found) - p).abs() < 1e-9);
    }
}

#[test]
fn power_where_it_is_known_and_where_there_is_none() {
    // Six equal signs are the first that a level of 5 % detects: 2 · 2^−6; five are 6.25 %.
    assert_eq!(power::signed_rank_shift(5, 0.05, 0.9), None);
    assert!(power::signed_rank_shift(6, 0.05, 0.9).is_some());
    assert_eq!(power::turning(5, 0.05, 0.9), None);
    let turning = power::turning(6, 0.05, 0.9).unwrap();
    assert!((turning - 0.9f64.powf(1.0 / 6.0)).abs() < 1e-9, "{turning}");
    for pairs in [0, 20, 200] {
        for (level, power) in
            [(0.0, 0.9), (1.0, 0.9), (1.5, 0.9), (0.05, 0.0), (0.05, 1.0), (f64::NAN, 0.9)]
        {
            assert_eq!(power::signed_rank_shift(pairs, level, power), None, "{pairs}");
            assert_eq!(power::turning(pairs, level, power), None, "{pairs}");
            assert_eq!(power::mean_shift(pairs, 1.0 - level, power), None, "{pairs}");
            assert_eq!(power::sigma_ratios(pairs, 1.0 - level, power), None, "{pairs}");
        }
    }
}

#[test]
fn a_deviation_has_the_interval_of_chi_squared() {
    // From tables: χ² with 9 degrees of freedom is 2.700 at 2.5 % and 19.023 at 97.5 %.
    let (low, high) = sample::deviation_factors(9, 0.95).unwrap();
    assert!((low - (9.0f64 / 19.023).sqrt()).abs() < 1e-4, "{low}");
    assert!((high - (9.0f64 / 2.700).sqrt()).abs() < 1e-3, "{high}");
    let mut held = 0;
    for sample in 0..2000 {
        let interval =
            sample::deviation_interval(&normals(9, &format!("{sample}"), 12), 0.9).unwrap();
        held += u32::from(interval.low <= 1.0 && 1.0 <= interval.high);
    }
    // Three standard errors of 90 % of 2000.
    assert!((held as f64 - 1800.0).abs() < 3.0 * 13.5, "{held} of 2000");
    assert_eq!(sample::deviation_interval(&[1.0], 0.9), None);
    assert_eq!(sample::deviation_factors(9, 1.0), None);
}
