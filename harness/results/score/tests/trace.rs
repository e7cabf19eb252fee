//! Traces of runs, compared.

use octant_sample::Output;
use octant_score::trace::{POINTS_MAX, RunTrace};

#[test]
fn runs_part_where_an_output_differs() {
    let run = |changed: u64| {
        let mut trace = RunTrace::new();
        for k in 0..10_050u64 {
            let mut output = Output::default();
            output.navigation.latitude_rad = k as f64;
            if k == changed {
                output.navigation.velocity_mps[2] = 1e-300;
            }
            trace.output(&output);
        }
        trace
    };
    let clean = run(u64::MAX);
    assert_eq!(run(u64::MAX).parts_from(&clean), None);
    assert_eq!(run(4321).parts_from(&clean), Some(4200));
    assert_eq!(run(0).parts_from(&clean), Some(0));
    assert_eq!(run(10_049).parts_from(&clean), Some(10_000));
    let mut shorter = RunTrace::new();
    shorter.output(&Output::default());
    assert_eq!(shorter.parts_from(&clean), Some(0));
}

#[test]
fn a_long_drift_keeps_a_common_grid_with_a_shorter_one() {
    let run = |seconds: u64, slope: f64| {
        let mut trace = RunTrace::new();
        for t in 0..=seconds {
            trace.drift(t as f64, slope * t as f64, -slope * t as f64);
            trace.drift(t as f64 + 0.5, f64::NAN, f64::NAN);
        }
        trace
    };
    let difference = run(300_000, 3.0).minus(&run(100_000, 1.0));
    assert!(difference.len() > 500 && difference.len() < POINTS_MAX);
    for (hours, latitude, longitude) in &difference {
        assert!((latitude - 2.0 * hours * 3600.0).abs() < 1e-6);
        assert_eq!(*longitude, -latitude);
    }
    assert!(difference.last().unwrap().0 > 27.7);
}
