//! Errors beside the parameters: ignored, considered or estimated by the filter.

use super::*;
use octant_calibration::further::FURTHER_NAMES;
use octant_observe::perfect;

/// A move's second of acceleration is fifty samples, over which the size effect is resolved.
const FURTHER_RATE: &str = "50 Hz";
/// Half a second after a measurement, as of [`CALIBRATION`].
const ONE_HOUR: &str = "duration = \"3600.54 s\"\n";
/// Errors that are the same in every run.
const GIVEN_FURTHER: &str = "
[imu.extensions]
gyro_asymmetry = [\"20 ppm\", \"-15 ppm\", \"10 ppm\"]
accel_asymmetry = [\"-12 ppm\", \"8 ppm\", \"15 ppm\"]
accel_quadratic = [\"8 ug/g^2\", \"-12 ug/g^2\", \"6 ug/g^2\"]
[imu.extensions.lever_arm]
x = [\"3 cm\", \"-4 cm\", \"2 cm\"]
y = [\"-2 cm\", \"3 cm\", \"4 cm\"]
z = [\"1 cm\", \"5 cm\", \"-3 cm\"]
[site]
deflection_north = \"8 arcsec\"
deflection_east = \"-12 arcsec\"
gravity_anomaly = \"30 ug\"
";
/// The same errors, drawn, and Gauss-Markov biases.
const DRAWN_FURTHER: &str = "
[imu.extensions.drawn]
lever_arm = { normal = \"3 cm\" }
gyro_asymmetry = { normal = \"30 ppm\" }
accel_asymmetry = { uniform = \"30 ppm\" }
accel_quadratic = { normal = \"20 ug/g^2\" }
[site.drawn]
deflection = { normal = \"10 arcsec\" }
gravity_anomaly = { normal = \"50 ug\" }
[imu.extensions.gyro_gauss_markov]
sigma = \"0.002 deg/h\"
correlation_time = \"20 min\"
[imu.extensions.accel_gauss_markov]
sigma = \"5 ug\"
correlation_time = \"20 min\"
";
/// A filter that estimates what it can tell apart, with σ that aren't those of the draws, and considers the rest.
const FILTER: &str = "
[procedure.calibration.further]
accel_lever = { estimated = \"5 cm\" }
gyro_asymmetry = { estimated = \"30 ppm\" }
accel_asymmetry = { considered = \"20 ppm\" }
accel_quadratic = { estimated = \"15 ug/g^2\" }
gyro_gauss_markov = { estimated = \"0.002 deg/h\" }
gyro_correlation_time = \"20 min\"
accel_gauss_markov = { considered = \"5 ug\" }
accel_correlation_time = \"20 min\"
deflection = { considered = \"10 arcsec\" }
gravity_anomaly = { considered = \"50 ug\" }
";

fn with(errors: &str, filter: &str, navigation_h: u32) -> Scenario {
    let text = format!(
        "{UNSCREENED}{errors}[procedure.calibration]\n{ONE_HOUR}refuse_above_mean_nis = 1e9\n{filter}\
         [procedure.navigation]\nduration = \"{navigation_h} h\"\n"
    );
    scenario_at(FURTHER_RATE, &text)
}

#[test]
fn further_errors_that_the_filter_lacks_come_out_as_the_mean() {
    let scenario = with(&format!("{GIVEN}{GIVEN_FURTHER}"), "", 12);
    let predicted = ensemble(&scenario, Method::Primary).unwrap();
    assert_eq!(predicted.states.len(), STATE_COUNT);
    assert_same(&predicted, &run(&scenario, 1, silent), 0.05);
}

#[test]
fn further_errors_that_the_filter_has_come_out_as_the_mean() {
    let scenario = with(&format!("{GIVEN}{GIVEN_FURTHER}"), FILTER, 12);
    let predicted = ensemble(&scenario, Method::Primary).unwrap();
    // All but the six Gauss-Markov biases, which have no truth to compare with.
    assert_eq!(predicted.states.len(), STATE_COUNT + 21);
    assert_same(&predicted, &run(&scenario, 1, silent), 0.05);
}

/// Deflection, asymmetry and second order tilt a coarse alignment too.
#[test]
fn further_errors_tilt_a_coarse_alignment() {
    let given = GIVEN.split("[procedure.alignment]").next().unwrap();
    let errors = format!(
        "{given}{GIVEN_FURTHER}[procedure.alignment]\nmethod = \"coarse\"\nduration = \"150 s\"\n"
    );
    let scenario = with(&errors, FILTER, 2);
    assert_same(&ensemble(&scenario, Method::Primary).unwrap(), &run(&scenario, 1, silent), 0.05);
}

/// σ that the prediction's filter believes against those of the core itself, on a perfect instrument: two computations of
/// one covariance, by planned motion and by samples.
#[test]
fn the_predicted_filter_is_the_core() {
    let walking = FILTER
        .replace("deflection =", "gyro_rate_random_walk = \"0.01 deg/h/sqrt(h)\"\ndeflection =");
    let scenario = with("", &walking, 1);
    let predicted = ensemble(&scenario, Method::Primary).unwrap();
    let core = perfect::run(&scenario, Method::Primary).unwrap();
    let mut compared = 0;
    for state in &predicted.states {
        let by_name = |names: &[&str]| names.iter().position(|name| *name == state.name);
        let found = if let Some(k) = by_name(&FURTHER_NAMES) {
            core.further.unwrap().sigma[k] / FurtherGroup::of(k).unwrap().si_per_unit()
        } else if let Some(i) = by_name(&octant_sample::parameters::NAMES) {
            core.parameters[i] / state_unit(PARAMETERS + i).1
        } else {
            continue;
        };
        let ratio = state.believed.unwrap() / found;
        println!("{:24} {found:11.4e} {ratio:.4} {}", state.name, state.unit);
        assert!((ratio - 1.0).abs() < 0.01, "{}: {ratio}", state.name);
        compared += 1;
    }
    assert_eq!(compared, 51);
}

#[test]
#[ignore = "minutes: run by tests/run"]
fn drawn_further_errors_are_predicted() {
    for filter in ["", FILTER] {
        println!("{}", if filter.is_empty() { "ignored" } else { "estimated and considered" });
        assert_ensemble(&with(DRAWN_FURTHER, filter, 12), draws(200, 60), 1..=12);
    }
}
