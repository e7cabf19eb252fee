//! Tails with closed forms.

use octant_smoother::quadratic::probability_above;

/// Pairs of equal weights make exponential variables: the sum of two with the means a and b is above q with the probability
/// (a e^(−q/a) − b e^(−q/b))/(a − b).
#[test]
fn two_pairs_of_weights_have_the_tail_of_two_exponentials() {
    let (a, b) = (2.0 * 0.7, 2.0 * 0.3);
    for q in [1.0, 4.0, 8.0, 16.0, 30.0] {
        let exact = (a * f64::exp(-q / a) - b * f64::exp(-q / b)) / (a - b);
        let found = probability_above(&[0.7, 0.3, 0.3, 0.7, 0.0], q);
        // The formula's error grows from nothing to six percent, that of a normal tail for an exponential one.
        assert!((found / exact - 1.0).abs() < 0.06, "{q}: {found}, expected {exact}");
    }
}

/// χ² with 2 m degrees of freedom is above q with the probability e^(−q/2) Σ (q/2)ᵏ/k!, k < m.
#[test]
fn equal_weights_have_the_tail_of_chi_squared() {
    for m in [1_usize, 5, 24] {
        for share in [0.5, 1.0, 1.7, 3.0] {
            let q = 2.0 * m as f64 * share;
            let (mut term, mut sum) = (1.0, 0.0);
            for k in 0..m {
                sum += term;
                term *= 0.5 * q / (k + 1) as f64;
            }
            let exact = f64::exp(-0.5 * q) * sum;
            // Any unit of the weights gives the same.
            let found = probability_above(&vec![1e-9; 2 * m], 1e-9 * q);
            assert!((found / exact - 1.0).abs() < 0.05, "{m}, {q}: {found}, expected {exact}");
        }
    }
}

#[test]
fn what_has_no_weight_is_nothing_unusual() {
    assert_eq!(probability_above(&[], 1.0), 1.0);
    assert_eq!(probability_above(&[0.0, -1e-20], 1.0), 1.0);
    assert_eq!(probability_above(&[1.0], f64::NAN), 1.0);
    assert_eq!(probability_above(&[1.0], -1.0), 1.0);
}
