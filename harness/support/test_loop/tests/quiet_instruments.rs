//! Sensors with little noise: the filter's σ are as large as its errors, and clean calibrations aren't refused.

use octant_sample::Mode;
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use octant_test_loop::draws;
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};
use octant_test_loop::squares::{AttitudeSquares, assert_consistent, chi_squared_limit};
use std::path::Path;

/// An ensemble of a scenario: mean normalized squares of the groups of parameters and of all of them, mean NIS, and the
/// number of refused calibrations.
struct Ensemble {
    groups: [f64; 7],
    all: f64,
    nis: f64,
    refused: usize,
    /// Heading and tilt of those that were accepted.
    attitude: Vec<AttitudeSquares>,
}

impl Ensemble {
    /// Four hours in eight positions with the errors of Table 1, and this noise (°/√h, µg/√Hz) at this rate (Hz).
    fn of(rate_hz: u32, angle_random_walk: f64, velocity_random_walk: f64, seeds: u64) -> Self {
        let text = format!(
            "schema = 1\nimu.rate = \"{rate_hz} Hz\"\nimu.angle_random_walk = \"{angle_random_walk:e} deg/sqrt(h)\"\n\
             imu.velocity_random_walk = \"{velocity_random_walk:e} ug/sqrt(Hz)\"\nprocedure.calibration = {{}}\n"
        );
        let scenario = Scenario::parse(&text, "quiet.toml", Path::new(""), &[]).unwrap();
        let seeds: Vec<u64> = (1..=seeds).collect();
        let runs = on_two_threads(&seeds, |seed| {
            let (plant, core, _) = configurations(&scenario, Method::Primary, *seed).unwrap();
            let truth = plant.imu.parameters.to_array();
            let mut run = ClosedLoop::new(&plant, &core);
            let refused = run.calibrate() == Mode::Refused;
            let (estimate, sigma) = (run.core.parameters().to_array(), *run.core.sigma());
            let squares: [f64; PARAMETER_COUNT] =
                core::array::from_fn(|i| ((estimate[i] - truth[i]) / sigma[i]).powi(2));
            let attitude = (!refused).then(|| AttitudeSquares::of(&run));
            (refused, attitude, run.core.diagnostics().quality.nis_mean, squares)
        });
        let n = runs.len() as f64;
        let mean = |range: core::ops::Range<usize>| {
            let count = range.len() as f64;
            runs.iter().map(|(.., squares)| squares[range.clone()].iter().sum::<f64>()).sum::<f64>()
                / (n * count)
        };
        let found = Self {
            groups: ParameterGroup::ALL.map(|group| mean(group.range())),
            all: mean(0..PARAMETER_COUNT),
            nis: runs.iter().map(|(_, _, nis, _)| nis).sum::<f64>() / n,
            refused: runs.iter().filter(|(refused, ..)| *refused).count(),
            attitude: runs.iter().filter_map(|(_, attitude, ..)| *attitude).collect(),
        };
        let groups: Vec<String> =
            found.groups.iter().map(|square| format!("{square:.2}")).collect();
        println!(
            "| {rate_hz} | {angle_random_walk:e} | {velocity_random_walk} | {:.2} | {} | {:.3} | {} of {n} |",
            found.all,
            groups.join(" | "),
            found.nis,
            found.refused
        );
        found
    }
}

fn heading() {
    let groups = ParameterGroup::ALL.map(ParameterGroup::name).join(" | ");
    println!("| Hz | deg/√h | µg/√Hz | all | {groups} | NIS | refused |");
}

#[test]
fn normalized_errors_of_quiet_sensors_have_the_size_of_one() {
    heading();
    for (angle_random_walk, velocity_random_walk) in [(0.0, 1.0), (1e-5, 1.0), (7e-4, 1.0)] {
        let seeds = draws(24, 12);
        let found = Ensemble::of(20, angle_random_walk, velocity_random_walk, seeds);
        // The mean over thirty parameters, which depend on each other, scatters by 0.3/√seeds from one sample of seeds to
        // the next. Three scale factors share what is wrong with gravity, and count as one.
        let root = (seeds as f64).sqrt();
        assert!((found.all - 1.0).abs() < 4.0 * 0.3 / root, "all parameters: {}", found.all);
        let scale = found.groups[ParameterGroup::AccelScale as usize];
        let [least, most] = [-3.29, 3.29].map(|z| chi_squared_limit(seeds as f64, z));
        assert!((least..=most).contains(&scale), "accelerometer scale factors: {scale}");
        assert!((found.nis - 3.0).abs() < 0.05, "NIS {}", found.nis);
        assert!(found.refused <= 1, "{} of {seeds} refused", found.refused);
        let what = format!("{angle_random_walk} °/√h, {velocity_random_walk} µg/√Hz");
        assert_consistent(&what, found.attitude.into_iter());
    }
}

/// Prints the table of docs/method.md.
#[test]
#[ignore = "minutes: a study"]
fn study_of_quiet_instruments() {
    heading();
    for rate_hz in [200, 20, 8] {
        let seeds = if rate_hz == 200 { 24 } else { 96 };
        for noise in [
            (7e-4, 50.0),
            (7e-4, 5.0),
            (7e-4, 1.0),
            (1e-4, 1.0),
            (1e-5, 50.0),
            (1e-5, 1.0),
            (1e-6, 1.0),
            (0.0, 1.0),
            (1e-5, 0.0),
            (0.0, 0.5),
            (0.0, 0.0),
        ] {
            Ensemble::of(rate_hz, noise.0, noise.1, seeds);
        }
    }
}
