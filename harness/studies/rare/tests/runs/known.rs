//! Probabilities and levels of real runs against closed forms and plain Monte Carlo.

use octant_base::control::Control;
use octant_rare::estimators::estimate::RarePlan;
use octant_rare::estimators::point::{RareBench, RarePoint, RareStage};
use octant_rare::runs::error::RareError;
use octant_rare::runs::failure::{RareFailure, failure, requirement};
use octant_rare::runs::many::{RareRuns, SeverityOf};
use octant_rare::runs::outcome::RareSubject;
use octant_rare::runs::protection::{ProtectionLevels, protection};
use octant_scenario::Scenario;
use octant_statistics::normal;
use octant_verdict::Verdict;
use std::path::Path;

/// Two minutes at 10 Hz. The g-dependent biases are not estimated: their errors are minus the drawn values.
pub(crate) const SHORT: &str = r#"
schema = 1
title = "known answer"
seed = 1

[imu]
rate = "10 Hz"
g_dependent = { normal = "0.0005 deg/h/g" }

[procedure.calibration]
duration = "2 min"
g_states = false
stops = [
    { azimuth = "0 deg", roll = "0 deg" },
    { azimuth = "0 deg", roll = "90 deg" },
    { azimuth = "0 deg", roll = "180 deg" },
    { azimuth = "90 deg", roll = "180 deg" },
]
"#;

/// A requirement on the error of g_zz, which has σ = 0.0005 deg/h/g.
pub(crate) fn g_zz(sigmas: f64) -> String {
    format!(
        "\n[[requirements]]\nid = \"G\"\ntext = \"The bias is small.\"\n\
         measure = \"|calibration.parameters.g_zz.error|\"\nlimit = \"{} deg/h/g\"\n",
        0.0005 * sigmas
    )
}

pub(crate) fn scenario(text: &str) -> Scenario {
    Scenario::parse(text, "test.toml", Path::new("."), &[]).unwrap()
}

pub(crate) fn failing(
    scenario: &Scenario,
    plan: &RarePlan,
    asked: (Option<f64>, bool),
) -> Result<(RareFailure, Option<String>), RareError> {
    let of = requirement(scenario, None)?;
    let subject = RareSubject::Requirement(of.check.id.clone());
    let control = Control::default();
    let tell = || ();
    let severity = SeverityOf::Margin(asked.1);
    let mut runs = RareRuns::new(scenario, subject, severity, 2, &control, &tell)?;
    failure(&mut runs, scenario, of, plan, asked)
}

fn levels(text: &str, names: &[&str], risk: f64, plan: &RarePlan) -> ProtectionLevels {
    let scenario = scenario(text);
    let control = Control::default();
    let tell = || ();
    let severity = SeverityOf::Error(String::new());
    let mut runs =
        RareRuns::new(&scenario, RareSubject::Calibration, severity, 2, &control, &tell).unwrap();
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    protection(&mut runs, &scenario, &names, risk, plan).unwrap()
}

/// P(|g_zz| > L) = 2 Φ(−L/σ), among 30 drawn errors.
fn agrees(sigmas: f64, plan: &RarePlan) {
    let text = SHORT.to_owned() + &g_zz(sigmas);
    let truth = 2.0 * normal::cdf(-sigmas);
    let (found, file) = failing(&scenario(&text), plan, (Some(10.0 * truth), false)).unwrap();
    assert!(found.shown, "{:?}", found.doubts);
    let [low, high] = found.interval.unwrap();
    assert!(low <= truth && truth <= high, "{truth}: {low} to {high}");
    assert_eq!((found.verdict, found.components), (Verdict::Pass, 30));
    let worst = found.most_probable.unwrap();
    assert_eq!(worst.values[0].name, "g_zz");
    assert!(worst.values[0].sigmas.abs() > sigmas && worst.margin.unwrap() < 0.0);
    assert!((worst.values[0].value.abs() / 0.0005 - worst.values[0].sigmas.abs()).abs() < 1e-9);
    assert!(file.unwrap().contains("constant"));
}

#[test]
fn a_linear_error_has_the_probability_of_its_closed_form() {
    agrees(
        3.5,
        &RarePlan { error: 0.1, pilot: 400, samples: 100, runs: 4000, ..RarePlan::default() },
    );
}

#[test]
#[ignore = "takes minutes: docs/testing.md has the command"]
fn a_linear_error_of_one_in_a_million_has_its_closed_form() {
    agrees(4.9, &RarePlan::default());
}

/// A requirement whose measure depends on many errors and the noise: 500 plain runs and the estimate agree.
#[test]
fn plain_monte_carlo_agrees_where_failures_are_frequent() {
    let text = SHORT.to_owned()
        + "\n[procedure.navigation]\nduration = \"10 min\"\n\n[[requirements]]\nid = \"N\"\n\
           text = \"It drifts little.\"\nmeasure = \"navigation.radial_error_nmi.max\"\nlimit = \"0.2 nmi\"\n";
    let scenario = scenario(&text);
    let plan = RarePlan { runs: 3000, samples: 100, pilot: 400, error: 0.1, ..RarePlan::default() };
    let (found, _) = failing(&scenario, &plan, (None, false)).unwrap();
    assert!(found.shown, "{:?}", found.doubts);
    let [low, high] = found.interval.unwrap();
    let control = Control::default();
    let tell = || ();
    let subject = RareSubject::Requirement("N".to_owned());
    let mut runs =
        RareRuns::new(&scenario, subject, SeverityOf::Margin(false), 2, &control, &tell).unwrap();
    let points: Vec<RarePoint> = (0..500)
        .map(|step| RarePoint::drawn(30, &mut octant_random::draws::Draws::of(99, "plain", step)))
        .collect();
    let severities = runs.severities(&points, RareStage::Plain).unwrap();
    let failures = severities.iter().filter(|severity| **severity > 0.0).count() as f64;
    let share = failures / 500.0;
    let p = found.probability.unwrap();
    assert!((0.01..0.3).contains(&share), "{share}: not a test at all");
    // Both have their own scatter: four standard errors of their difference.
    let scatter = libm::hypot(libm::sqrt(share * (1.0 - share) / 500.0), (high - low) / 3.92);
    assert!((p - share).abs() < 4.0 * scatter, "{p} {share}");
}

/// The filter's prior is the distribution that the errors are drawn from, and two minutes hardly add to it: errors are
/// normal with the published σ.
#[test]
fn levels_of_an_honest_filter_are_its_sigma_times_the_quantile() {
    let plan = RarePlan { runs: 2000, samples: 50, pilot: 300, error: 0.1, ..RarePlan::default() };
    let found = levels(SHORT, &["gyro_bias_x"], 1e-3, &plan);
    let level = &found.parameters[0];
    assert!(level.shown, "{:?}", level.doubts);
    let [low, high] = level.interval.map(Option::unwrap);
    let expected = level.normal_level.unwrap();
    assert!(low <= expected && expected <= high, "{expected}: {low} to {high}");
    let quantile = -normal::quantile(0.5e-3) * level.sigma.unwrap();
    assert!((expected - quantile).abs() < 1e-12 * quantile);
}

/// A filter whose prior is half of what the errors are drawn from publishes a σ that is too small, and the level says so.
#[test]
fn levels_of_a_filter_that_trusts_itself_too_much_are_above_its_sigma() {
    let wide = SHORT.replace("[imu]", "[imu]\ngyro_bias = { normal = \"0.01 deg/h\" }");
    let plan = RarePlan { runs: 2000, samples: 50, pilot: 300, error: 0.1, ..RarePlan::default() };
    let text = wide + "\n[procedure.calibration.prior]\ngyro_bias = \"0.005 deg/h\"\n";
    let found = levels(&text, &["gyro_bias_x"], 1e-3, &plan);
    let level = &found.parameters[0];
    assert!(level.interval[0].unwrap() > 1.2 * level.normal_level.unwrap(), "{level:?}");
}

#[test]
fn a_measure_that_no_run_has_is_never_a_pass() {
    let text = SHORT.to_owned()
        + &g_zz(3.0)
            .replace("|calibration.parameters.g_zz.error|", "navigation.radial_error_nmi.max")
            .replace("0.0015 deg/h/g", "3 nmi");
    let plan = RarePlan { runs: 200, samples: 50, pilot: 50, ..RarePlan::default() };
    let (found, _) = failing(&scenario(&text), &plan, (Some(0.5), false)).unwrap();
    assert_eq!(found.verdict, Verdict::Inconclusive);
    assert!(!found.shown && found.probability.is_none());
    let (found, _) = failing(&scenario(&text), &plan, (Some(0.5), true)).unwrap();
    assert_eq!(found.verdict, Verdict::Fail);
}

/// A fault that acts in no run, for whatever reason, is no hypothesis that anything was shown under.
#[test]
fn a_fault_that_never_fires_is_never_a_pass() {
    let fault = |trigger: &str| {
        format!(
            "\n[[faults]]\nid = \"late\"\nkind = \"bias-step\"\nchannels = \"gyro x\"\n\
             amplitude = \"1 deg/h\"\ntrigger = {{ {trigger} }}\n"
        )
    };
    let plan = RarePlan { runs: 200, samples: 50, pilot: 50, ..RarePlan::default() };
    let never = fault("when = \"nis above 1e6\"");
    let text = SHORT.to_owned() + &g_zz(4.0) + &never;
    let (found, _) = failing(&scenario(&text), &plan, (Some(0.5), true)).unwrap();
    assert_eq!(found.verdict, Verdict::Inconclusive);
    assert!(found.reasons.keys().any(|r| r.contains("fault late never fired")), "{found:?}");
    let found = levels(&text, &["gyro_bias_x"], 0.1, &plan);
    assert_eq!(found.verdict, Verdict::Inconclusive);
    assert!(!found.parameters[0].shown && !found.reasons.is_empty(), "{found:?}");
    // One that acts in every run is told by the runs that noticed it, or shown.
    let text = SHORT.to_owned() + &g_zz(4.0) + &fault("at = \"100 s\"");
    let (found, _) = failing(&scenario(&text), &plan, (Some(0.5), true)).unwrap();
    assert!(found.stages.values().all(|stage| stage.broken == 0), "{found:?}");
}

#[test]
fn bad_input_is_refused_with_what_is_known() {
    let plan = RarePlan::default();
    let error = failing(&scenario(SHORT), &plan, (None, false)).unwrap_err();
    assert!(matches!(error, RareError::NothingRequired), "{error}");
    let two = SHORT.to_owned() + &g_zz(3.0) + &g_zz(4.0).replace("\"G\"", "\"H\"");
    let error = failing(&scenario(&two), &plan, (None, false)).unwrap_err();
    assert!(error.to_string().contains("G, H"), "{error}");
    let scenario = scenario(&two);
    let error = requirement(&scenario, Some("J")).unwrap_err();
    assert!(error.to_string().contains("\"J\""), "{error}");
}
