//! Holm's procedure compared with the closed test, of which it is a shortcut.

use octant_statistics::multiple::holm;
use proptest::prelude::*;

/// The closed test (Marcus, Peritz and Gabriel, Biometrika 63, 1976) with Bonferroni's test of each
/// intersection: a hypothesis is rejected if every set that contains it is.
fn closed(probabilities: &[f64]) -> Vec<f64> {
    let n = probabilities.len();
    let of = |hypothesis: usize| {
        (1u32..1 << n)
            .filter(|set| set >> hypothesis & 1 == 1)
            .map(|set| {
                let members = || (0..n).filter(move |member| set >> member & 1 == 1);
                let least = members().map(|m| probabilities[m]).fold(f64::INFINITY, f64::min);
                (members().count() as f64 * least).min(1.0)
            })
            .fold(0.0, f64::max)
    };
    (0..n).map(of).collect()
}

proptest! {
    #[test]
    fn it_is_the_closed_test_of_bonferroni(
        probabilities in proptest::collection::vec(prop_oneof![0.0..0.1, 0.0..=1.0], 0..8)
    ) {
        let (found, expected) = (holm(&probabilities), closed(&probabilities));
        for (found, expected) in found.iter().zip(&expected) {
            prop_assert!((found - expected).abs() <= 1e-15, "{found} {expected}");
        }
        prop_assert_eq!(found.len(), expected.len());
    }
}

#[test]
fn a_worked_example() {
    // Expected: 4 · 0.005, 3 · 0.01, 2 · 0.03, and 0.04 raised to the one before.
    let found = holm(&[0.01, 0.04, 0.03, 0.005]);
    for (found, expected) in found.iter().zip([0.03, 0.06, 0.06, 0.02]) {
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    }
    assert_eq!(holm(&[]), [0.0; 0]);
    assert_eq!(holm(&[f64::NAN, 0.01]), [1.0, 0.02]);
    // Among twenty comparisons, a probability of one in twenty is not significant.
    let mut many = vec![0.5; 19];
    many.push(0.04);
    assert_eq!(holm(&many)[19], 0.8);
}
