//! The normal equations against closed forms.

use octant_followed::regression::{Block, Normal};

#[test]
fn a_slope_is_found_beside_nuisance() {
    let mut normal = Normal::<4>::default();
    for k in 0..100_u32 {
        let t = f64::from(k);
        let (regressor, error) = ((0.7 * t).sin(), 1e-3 * (1.9 * t).cos());
        normal.push(&[1.0, t, regressor, 5.0 - 0.3 * t + 0.25 * regressor + error]);
    }
    let slope = normal.slope(2, 2, 3).unwrap();
    assert!((slope.value - 0.25).abs() < 5.0 * slope.sigma, "{slope:?}");
    // The rms of the error is 1e-3/√2, that of a sine 1/√2.
    assert!((slope.residual_rms - 0.707e-3).abs() < 2e-5, "{slope:?}");
    assert!((slope.sigma - 1e-4).abs() < 5e-6, "{slope:?}");
}

#[test]
fn what_the_nuisance_explains_says_nothing() {
    let mut normal = Normal::<3>::default();
    for k in 0..100_u32 {
        normal.push(&[f64::from(k), 2.0 * f64::from(k), 1.0]);
    }
    assert_eq!(normal.slope(1, 1, 2), None);
}

#[test]
fn few_rows_say_nothing() {
    let mut normal = Normal::<3>::default();
    normal.push(&[1.0, 2.0, 3.0]);
    normal.push(&[1.0, 1.0, 1.0]);
    assert_eq!(normal.slope(1, 1, 2), None);
}

#[test]
fn a_line_in_each_block_is_no_part_of_it() {
    let (mut normal, mut blocks) = (Normal::<2>::default(), Block::of(5));
    for k in 0..100_u32 {
        let (regressor, block) = (f64::from(k * k % 7), f64::from(k / 5));
        // Another line in every block.
        let line = block * block - 0.5 * block * f64::from(k);
        blocks.push(&[regressor, 2.0 * regressor + line], &mut normal);
    }
    let slope = normal.slope(0, 0, 1).unwrap();
    assert!((slope.value - 2.0).abs() < 1e-9 && slope.sigma < 1e-9, "{slope:?}");
}

#[test]
fn a_block_of_three_rows_says_nothing() {
    let (mut normal, mut blocks) = (Normal::<2>::default(), Block::of(12));
    for k in 0..3_u32 {
        blocks.push(&[f64::from(k * k), 1.0], &mut normal);
    }
    blocks.end(&mut normal);
    assert_eq!(normal.slope(0, 0, 1), None);
}
