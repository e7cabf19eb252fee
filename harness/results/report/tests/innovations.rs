//! Statistics of innovations.

use octant_report::innovations::{autocorrelation, statistics};

#[test]
fn statistics_of_a_series() {
    // Mean 1; squares of the differences 0 + 1 + 4 + 9; 1 alone lies within 1.96 of zero.
    let points = [1.0, 2.0, 3.0, -2.0].map(|value| [0.0, value]);
    assert_eq!(statistics(&points), [1.0, libm::sqrt(14.0 / 3.0), 0.25]);
}

#[test]
fn autocorrelation_of_a_first_order_process_is_a_power_of_its_factor() {
    // x[k+1] = 0.8 x[k] + w has correlation 0.8^lag; 1.96/√n of 40 000 values is 0.01, and the
    // estimate of a correlated series is about (1 + 0.64)/(1 − 0.64) times as uncertain squared.
    let mut state = 1u64;
    let mut white = || {
        let mut sum = -6.0;
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (state >> 11) as f64 / 9_007_199_254_740_992.0;
        }
        sum
    };
    let mut x = 0.0;
    let series: Vec<f64> = (0..40_000)
        .map(|_| {
            x = 0.8 * x + white();
            x
        })
        .collect();
    let found = autocorrelation(&series, 5).unwrap_or_default();
    for (k, r) in found.iter().enumerate() {
        let expected = libm::pow(0.8, (k + 1) as f64);
        assert!((r - expected).abs() < 0.04, "lag {}: found {r}, expected {expected}", k + 1);
    }
    assert_eq!(found.len(), 5);
    assert_eq!(autocorrelation(&[3.0; 100], 5), None);
}
