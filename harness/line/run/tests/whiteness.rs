//! White innovations and others.

use octant_run::observers::whiteness::Whiteness;
use octant_sample::{Innovation, InnovationOf};

fn of(values: impl Iterator<Item = f64>) -> Whiteness {
    let mut whiteness = Whiteness::default();
    for value in values {
        let (value, sigma) = ([value, -value, 0.5 * value], [1.0; 3]);
        whiteness.push(&Innovation { of: InnovationOf::Position, value, sigma });
    }
    whiteness
}

#[test]
fn a_sine_has_the_largest_cosine_of_its_steps() {
    for period in [3.0, 4.0, 5.5, 6.0, 10.0, 15.0] {
        let step = std::f64::consts::TAU / period;
        let (found, lag) =
            of((0..30_000).map(|k| (step * f64::from(k)).sin())).correlation().unwrap();
        let largest = (1..=4).map(|lag| (step * f64::from(lag)).cos().abs()).fold(0.0, f64::max);
        assert!((found - (step * lag as f64).cos()).abs() < 1e-3, "{period} s: {found}");
        assert!((found.abs() - largest).abs() < 1e-3, "{period} s: {found}, {largest}");
        assert!(found.abs() > 0.5, "{period} s: {found}");
    }
}

#[test]
fn white_noise_is_not_correlated_and_says_nothing() {
    let triad = octant_random::stream::Triad::new(1, "whiteness");
    let whiteness = of((0..3000).map(|k| triad.at(k)[0]));
    assert!(whiteness.correlation().unwrap().0.abs() < 0.08);
    assert_eq!(whiteness.doubt(9.0), None);
}

#[test]
fn few_pairs_outliers_and_velocities_say_nothing() {
    assert_eq!(of((0..100).map(|_| 1.0)).correlation(), None);
    assert_eq!(of((0..1000).map(|_| 10.0)).correlation(), None);
    assert_eq!(of((0..1000).map(|_| f64::NAN)).correlation(), None);
    let mut velocities = Whiteness::default();
    for _ in 0..1000 {
        velocities.push(&Innovation { value: [1.0; 3], sigma: [1.0; 3], ..Innovation::default() });
    }
    assert_eq!(velocities.correlation(), None);
}
