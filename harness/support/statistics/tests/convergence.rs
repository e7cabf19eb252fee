//! Estimates over a growing number of runs.

use octant_statistics::convergence::pass;

#[test]
fn no_runs_have_no_probability_and_all_passed_has_its_closed_form() {
    assert_eq!(pass(&[], 0.95), None);
    // Lower bound for n passes in n runs: α^(1/n), where α is half of 1 − 0.9.
    let all = pass(&[true; 10], 0.9).unwrap();
    assert_eq!((all.value, all.high), (1.0, 1.0));
    assert!((all.low - libm::pow(0.05, 0.1)).abs() < 1e-9, "{all:?}");
}
