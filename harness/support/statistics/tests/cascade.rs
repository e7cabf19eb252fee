//! The cascade of averages against the definition of the Allan variance.

use octant_statistics::allan::AllanCascade;

/// The definition: averages over `m` samples, `stride` apart, without a cascade.
fn direct(stretches: &[Vec<f64>], m: usize) -> (f64, u64) {
    let stride = (m / 2).max(1);
    let (mut squares, mut terms) = (0.0, 0);
    for samples in stretches {
        let mean = |from: usize| samples[from..from + m].iter().sum::<f64>() / m as f64;
        let mut from = 0;
        while from + 2 * m <= samples.len() {
            let difference = mean(from + m) - mean(from);
            squares += difference * difference;
            terms += 1;
            from += stride;
        }
    }
    (squares / (2.0 * terms as f64), terms)
}

/// Numbers without a pattern, the same on every run.
fn scatter(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64 / 1024.0 - 8000.0
    };
    (0..count).map(|_| next()).collect()
}

#[test]
fn the_cascade_is_the_definition_for_stretches_of_any_length() {
    let lengths = [1, 2, 3, 7, 64, 65, 127, 500, 1000];
    let stretches: Vec<Vec<f64>> =
        lengths.iter().zip(1..).map(|(n, seed)| scatter(seed, *n)).collect();
    let mut cascade = AllanCascade::<2>::unlimited();
    for samples in &stretches {
        samples.iter().for_each(|y| cascade.push(&[*y, -3.0 * y]));
        cascade.end_stretch();
        cascade.end_stretch();
    }
    assert_eq!((cascade.stretches(), cascade.longest()), (lengths.len() as u64, 1000));
    let tallies = cascade.tallies();
    assert_eq!(tallies.len(), 9, "the longest average is over 256 samples");
    for tally in tallies {
        let (variance, terms) = direct(&stretches, tally.samples as usize);
        assert_eq!(tally.counts.terms, terms, "{} samples", tally.samples);
        assert!((tally.variance[0] / variance - 1.0).abs() < 1e-12, "{} samples", tally.samples);
        assert!((tally.variance[1] / variance - 9.0).abs() < 1e-11, "{} samples", tally.samples);
    }
}

#[test]
fn the_present_stretch_counts_before_its_end_as_after_it() {
    let mut cascade = AllanCascade::<1>::new(4);
    scatter(5, 300).iter().for_each(|y| cascade.push(&[*y]));
    let (before, stretches) = (cascade.tallies(), cascade.stretches());
    cascade.end_stretch();
    assert_eq!((before, stretches), (cascade.tallies(), cascade.stretches()));
    assert_eq!(cascade.tallies().len(), 4);
}

/// Sums of 2¹⁹ samples of gravity at 200 Hz are 2⁴⁵ counts. f64 has them exactly, so that a constant
/// cancels to zero.
#[test]
fn a_constant_cancels_exactly() {
    let mut cascade = AllanCascade::<1>::unlimited();
    (0..1_500_000).for_each(|_| cascade.push(&[52_654_321.0]));
    let tallies = cascade.tallies();
    assert_eq!(tallies.last().map(|tally| tally.samples), Some(1 << 19));
    assert!(tallies.iter().all(|tally| tally.variance == [0.0]));
}
