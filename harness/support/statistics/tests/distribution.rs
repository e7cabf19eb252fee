//! Standardised values of distributions.

use octant_statistics::draw::{Distribution, Factor};

#[test]
fn standard_values_are_those_of_the_definition() {
    let uniform = Factor::new("u", Distribution::Uniform { low: 2.0, high: 10.0 });
    assert_eq!([2.0, 4.0, 10.0].map(|x| uniform.standard(x)), [0.0, 0.25, 1.0]);
    let normal = Factor::new("n", Distribution::Normal { mean: 3.0, sigma: 2.0 });
    assert_eq!([3.0, 7.0].map(|x| normal.standard(x)), [0.0, 2.0]);
    let median = Distribution::LogNormal { median: 5.0, sigma_ln: 0.5 };
    let log_normal = Factor::new("l", median);
    assert_eq!(log_normal.standard(5.0), 0.0);
    assert!((log_normal.standard(5.0 * core::f64::consts::E) - 2.0).abs() < 1e-12);
    assert_eq!(log_normal.standard(0.0), f64::NEG_INFINITY);
}
