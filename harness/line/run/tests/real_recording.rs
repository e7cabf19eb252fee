//! A real recording through the usual stages: scenario, text source, core, passes, raw counts. The
//! reference values come from an independent program (see the recording's README).

use octant_calibration::least_squares::raw::{self, Nominal};
use octant_earth::Vector3;
use octant_run::passes::in_passes;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario};
use octant_source as source;
use std::path::{Path, PathBuf};

/// Returns the folder of real recordings: by default one beside the repository.
fn recordings() -> PathBuf {
    std::env::var_os("OCTANT_RECORDINGS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/recordings"),
        PathBuf::from,
    )
}

#[test]
fn the_values_of_an_independent_program_come_out_of_the_scenario() {
    let recordings = recordings();
    if !recordings.join("xsens-multiposition/gyroscope.txt").is_file() {
        println!("skipped: no recording in {} (set OCTANT_RECORDINGS)", recordings.display());
        return;
    }
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/xsens.toml");
    // A test doesn't require the variable to be set.
    let text = std::fs::read_to_string(file)
        .unwrap()
        .replace("${OCTANT_RECORDINGS}", recordings.to_str().unwrap());
    let scenario = Scenario::parse(&text, file, Path::new(""), &[]).unwrap();
    let draws = DrawnValues::of(&scenario, &Seeded(scenario.seed));
    let config = scenario
        .core(Method::Primary, &draws, &scenario.mean_attitude(), &Vector3::zeros())
        .unwrap();
    let plant = scenario.plant(scenario.seed, &draws);
    let passes = in_passes(&config, || Ok(source::open(&scenario, &plant)?.unwrap())).unwrap();
    println!("{} passes, settled: {}", passes.passes, passes.settled);
    assert_eq!(passes.core.refusal(), None);
    assert!(passes.core.table().is_some(), "concluded at the end of the file");
    assert!(passes.settled && passes.passes > 1, "{} passes", passes.passes);
    let tally = passes.core.diagnostics().monitor;
    println!("{tally:?}");
    assert_eq!((tally.gaps, tally.out_of_order), (0, 0));

    let mapping = scenario.source.text().unwrap();
    let nominal = |axes: &[octant_scenario::recorded::AxisColumn; 3]| Nominal {
        bias_counts: axes.each_ref().map(|axis| axis.offset),
        scale: axes.each_ref().map(|axis| axis.scale),
    };
    let parameters = passes.core.parameters();
    let accelerometer = raw::accelerometer(parameters, &nominal(&mapping.accelerometer)).unwrap();
    let gyroscope = raw::gyroscope(parameters, &nominal(&mapping.gyro)).unwrap();

    let near = |what: &str, found: f64, expected: f64, tolerance: f64| {
        println!("{what}: {found:.7} (reference {expected:.7}, {:+.2e})", found - expected);
        assert!((found - expected).abs() <= tolerance, "{what}: {found}, expected {expected}");
    };
    let (k, t) = (accelerometer.scale, accelerometer.cross);
    for (axis, expected) in [33123.8, 33275.1, 32364.5].into_iter().enumerate() {
        near("accelerometer bias", accelerometer.bias_counts[axis], expected, 0.5);
    }
    for (axis, expected) in [0.0024129, 0.0024264, 0.0024125].into_iter().enumerate() {
        near("accelerometer scale", k[axis], expected, 1e-7);
    }
    near("T yx", t[1][0], -0.00359, 5e-4);
    near("T zx", t[2][0], -0.00918, 5e-4);
    near("T zy", t[2][1], -0.02134, 5e-4);

    let (k, t) = (gyroscope.scale, gyroscope.cross);
    for (axis, expected) in [32777.14, 32459.81, 32511.84].into_iter().enumerate() {
        near("gyro bias", gyroscope.bias_counts[axis], expected, 0.5);
    }
    for (axis, expected) in [2.0935e-4, 2.0982e-4, 2.0962e-4].into_iter().enumerate() {
        near("gyro scale", k[axis], expected, 0.01 * expected);
    }
    let cross = [
        ("xy", t[0][1], 0.0093),
        ("xz", t[0][2], 0.0102),
        ("yx", t[1][0], 0.0052),
        ("yz", t[1][2], -0.0322),
        ("zx", t[2][0], 0.0159),
        ("zy", t[2][1], -0.0240),
    ];
    for (what, found, expected) in cross {
        near(what, found, expected, 3e-3);
    }
}
