//! Noise of the sensors at rest, in units of data sheets.

use octant_earth::units::DEG;
use octant_score::allan::{AllanDeviation, AxisAllan, InstrumentNoise, RestOctave, RestRecord};
use octant_statistics::allan::DifferenceCounts;

/// Octaves of white noise and bias instability without scatter.
fn record(base_moves: bool) -> RestRecord {
    let (n, b) = (0.0007 * DEG / 60.0, 0.005 * DEG / 3600.0);
    let (m, c) = (50e-6 * 9.80665, 10e-6 * 9.80665);
    let mut counts = DifferenceCounts::new(2);
    counts.add_stretch(100_000_000);
    let octave = |k: i32| {
        let tau_s = 0.005 * f64::from(1 << k);
        let variance = |n: f64, b: f64| n * n / tau_s + 0.441_271 * b * b;
        let (gyro, accelerometer) = (variance(n, b), variance(m, c));
        let variance = [[gyro; 3], [accelerometer; 3]].concat();
        let variance = std::array::from_fn(|i| variance[i]);
        RestOctave { tau_s, variance, counts }
    };
    RestRecord {
        sample_period_s: 0.005,
        base_moves,
        stretches: 3,
        at_rest_s: 1e6,
        longest_s: 5e5,
        octaves: (0..20).map(octave).collect(),
    }
}

#[test]
fn terms_are_in_the_units_of_data_sheets() {
    let gyro = [0.0, 0.0007 * DEG / 60.0, 0.005 * DEG / 3600.0, 0.0, 0.0];
    let instrument = InstrumentNoise { gyro, accelerometer: [0.0; 5] };
    let found = AllanDeviation::of(&record(false), Some(&instrument)).unwrap();
    let term = |axis: &AxisAllan, name: &str| axis.terms[name].clone();
    let near = |found: Option<f64>, expected: f64| {
        assert!((found.unwrap() / expected - 1.0).abs() < 1e-4, "{found:?}, {expected}");
    };
    let (walk, floor) =
        (term(&found.gyro.y, "random_walk"), term(&found.gyro.y, "bias_instability"));
    near(walk.estimate, 0.0007);
    near(walk.r#true, 0.0007);
    near(floor.estimate, 0.005);
    near(floor.r#true, 0.005);
    assert_eq!((walk.unit.as_str(), floor.unit.as_str()), ("deg/sqrt(h)", "deg/h"));
    near(term(&found.accelerometer.z, "random_walk").estimate, 50.0);
    near(term(&found.accelerometer.z, "bias_instability").estimate, 10.0);
    // 0.0007 deg/√h is 0.042 deg/h at a second.
    let at_first = found.gyro.x.series[0];
    near(Some(at_first[1]), 0.042 / 0.005f64.sqrt());
    let curve = found.gyro.x.of_terms(0.005, |term| term.estimate, true);
    near(curve, at_first[1]);
    let unresolved = term(&found.gyro.x, "rate_ramp");
    assert_eq!((unresolved.estimate, unresolved.low, unresolved.r#true), (None, 0.0, Some(0.0)));
}

#[test]
fn a_base_that_moves_has_a_deviation_and_no_terms() {
    let found = AllanDeviation::of(&record(true), None).unwrap();
    assert_eq!(found.gyro.x.series.len(), 20);
    assert!(found.gyro.x.terms.is_empty() && found.gyro.x.misfit.is_none());
    assert_eq!(found.gyro.x.of_terms(1.0, |term| term.estimate, true), None);
    let nothing = RestRecord { octaves: Vec::new(), ..record(false) };
    assert_eq!(AllanDeviation::of(&nothing, None), None);
}
