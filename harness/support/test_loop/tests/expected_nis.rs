//! The mean NIS that a filter with considered states expects of a run, over an ensemble.

use octant_calibration::config::{Estimator, Further, FurtherUse, Screening};
use octant_calibration::positions::EIGHT;
use octant_earth::units::MICRO_G;
use octant_random::stream::Triad;
use octant_sample::Mode;
use octant_sample::further::FurtherGroup;
use octant_test_loop::draws;
use octant_test_loop::instrument::InstrumentCase;
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};

/// σ of the anomaly that the filter considers, m/s².
const SIGMA_MPS2: f64 = 50.0 * MICRO_G;
/// Samples a second, and seconds of a calibration.
const HZ: u64 = 10;
const SECONDS: u64 = 3600;

/// What a run has and what was expected of it.
struct Found {
    nis: f64,
    /// Expected of runs with this anomaly.
    of_anomaly: f64,
    within: (f64, f64),
    accepted: bool,
}

/// A calibration of a base with an anomaly (in units of σ) that the filter considers.
fn run(seed: u64, anomaly: f64) -> Found {
    let hours = SECONDS as f64 / 3600.0;
    let case = InstrumentCase { calibration_h: hours, ..InstrumentCase::table_1(seed, EIGHT) };
    let (mut plant, mut core) = (case.plant(), case.core());
    (plant.sample_period_ns, core.sample_period_ns) = (1_000_000_000 / HZ, 1_000_000_000 / HZ);
    plant.calibration_samples = SECONDS * HZ;
    plant.site.gravity.anomaly_mps2 = anomaly * SIGMA_MPS2;
    core.screening = Screening::none();
    if let Some(calibration) = &mut core.calibration
        && let Estimator::Kalman(kalman) = &mut calibration.estimator
    {
        let considered = FurtherUse::Considered { sigma: SIGMA_MPS2 };
        kalman.further = Further::default().with(FurtherGroup::GravityAnomaly, considered);
    }
    let mut run = ClosedLoop::new(&plant, &core);
    run.run_to(SECONDS * HZ - 2);
    let filter = run.core.filter().unwrap();
    let mut values = [0.0; 40];
    values[FurtherGroup::GravityAnomaly.range()].fill(anomaly);
    let expected = filter.expected_nis().unwrap();
    assert_eq!(run.core.expected_nis(), Some(&expected));
    let of_anomaly = filter.expected_nis_of(&values).unwrap();
    let nis = run.core.diagnostics().quality.nis_mean;
    let accepted = run.calibrate() == Mode::Done;
    Found { nis, of_anomaly, within: (expected.low, expected.high), accepted }
}

#[test]
fn the_mean_nis_with_a_considered_anomaly_is_what_is_expected_of_the_run() {
    let count = draws(120, 100);
    let noise = Triad::new(1, "expected-nis.anomaly");
    let cases: Vec<(u64, f64)> = (1..=count).map(|seed| (seed, noise.at(seed)[0])).collect();
    let all = on_two_threads(&cases, |(seed, anomaly)| run(*seed, *anomaly));
    let n = all.len() as f64;
    let mean = |of: &dyn Fn(&Found) -> f64| all.iter().map(of).sum::<f64>() / n;
    let nis = mean(&|found| found.nis);
    let scatter = mean(&|found| (found.nis - nis).powi(2)).sqrt();
    let off = mean(&|found| found.nis - found.of_anomaly);
    let left = mean(&|found| (found.nis - found.of_anomaly - off).powi(2)).sqrt();
    let (low, high) = all[0].within;
    let inside = mean(&|found| f64::from((low..=high).contains(&found.nis)));
    let white = (6.0 / SECONDS as f64).sqrt();
    println!(
        "{count} runs: NIS {nis:.3}, from run to run ± {scatter:.3} (white: {white:.3}); less what is expected with the anomaly \
         {off:+.4} ± {left:.3}; {:.0} % within {low:.2} to {high:.2}",
        100.0 * inside
    );
    for (anomaly, found) in (0..4).map(|k| (f64::from(k), run(1, f64::from(k)))) {
        println!(
            "anomaly of {anomaly} σ: NIS {:.3}, expected {:.3}, of all runs {:.2} to {:.2}",
            found.nis, found.of_anomaly, found.within.0, found.within.1
        );
        assert!((found.nis - found.of_anomaly).abs() < 5.0 * white, "{anomaly}");
    }
    // Over all runs 3 is right, for one of them it isn't.
    assert!((nis - 3.0).abs() < 4.0 * scatter / n.sqrt(), "{nis}");
    assert!(scatter > 2.0 * white, "{scatter}");
    // With the anomaly known the rest is noise of mean zero. It isn't white: the gain is less than the best for a base
    // without an anomaly.
    assert!(off.abs() < 4.0 * left / n.sqrt(), "{off}");
    assert!(left < 0.5 * scatter, "{left}");
    assert!(inside > 0.88, "{inside}");
}

#[test]
fn a_mean_nis_is_refused_above_three_times_what_is_expected() {
    // 9 is three times 3. With the anomaly considered 3.74 is at the end of what is expected, and 11.2 the limit.
    for (anomaly, accepted) in [(6.3, true), (8.0, false)] {
        let found = run(1, anomaly);
        println!("anomaly of {anomaly} σ: NIS {:.2}, accepted: {}", found.nis, found.accepted);
        assert!(found.nis > 9.0, "{}", found.nis);
        assert_eq!(found.nis <= 3.0 * found.within.1, found.accepted);
        assert_eq!(found.accepted, accepted);
    }
}
