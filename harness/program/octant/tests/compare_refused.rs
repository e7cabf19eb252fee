//! Comparisons in which calibrations are refused: a refusal is a result of its method, reported as
//! a rate, and the rest is compared.

use crate::common::program::program;
use octant_base::control::Control;
use octant_report::compare as page;
use octant_run::paired::{MethodSide, paired};
use octant_scenario::{Method, Scenario};
use octant_score::compare::{Maxima, PairedRun, Refusals, compare};
use std::path::Path;

/// Limits of the mean NIS about its expectation: some seeds are refused.
const SCENARIO: &str = "schema = 1
title = \"refused\"
seed = 1
[imu]
rate = \"20 Hz\"
[procedure.calibration]
positions = \"eight\"
duration = \"1 h\"
refuse_above_mean_nis = 3.02
[procedure.navigation]
duration = \"24 h\"
[baseline]
positions = \"six\"
";

const SEEDS: u64 = 8;

#[test]
fn refused_seeds_are_a_rate_and_the_rest_is_compared() {
    let scenario = Scenario::parse(SCENARIO, "refused.toml", Path::new(""), &[]).unwrap();
    let side = |method| MethodSide { scenario: scenario.clone(), method };
    let seeds: Vec<u64> = (1..=SEEDS).collect();
    let controls: Vec<Control> = (0..2 * SEEDS).map(|_| Control::default()).collect();
    let found = paired(&side(Method::Baseline), &side(Method::Primary), &seeds, &controls).unwrap();
    let refused = |of: fn(&PairedRun) -> bool| found.runs.iter().filter(|run| of(run)).count();
    let first = refused(|run| run.first_refused.is_some());
    let second = refused(|run| run.second_refused.is_some());
    let either = refused(|run| run.first_refused.is_some() || run.second_refused.is_some());
    // These seeds must give some refused and some accepted calibrations.
    assert!(either > 0 && SEEDS as usize - either >= 2, "{first} {second} {either}");
    let rates = found.refusals.as_ref().unwrap();
    assert_eq!((rates.first, rates.second), (first as u64, second as u64));
    assert_eq!(rates.seeds, SEEDS);
    assert!(!found.cells.is_empty());
    assert!(found.cells.iter().all(|cell| cell.runs as usize == SEEDS as usize - either));
    let words = found.words.join("; ");
    for part in [
        format!("refused {first} of {SEEDS} seeds"),
        format!("refused {second} of {SEEDS} seeds"),
        format!(
            "errors are compared of the {} seeds that neither refused",
            SEEDS as usize - either
        ),
        "is not defined".to_owned(),
    ] {
        assert!(words.contains(&part), "{part}: {words}");
    }
    let html = page::render(&found, &[], &octant_base::display::DisplayUnits::default());
    assert!(html.contains("Refused calibrations") && html.contains(">refused<"));
}

#[test]
fn where_everything_is_refused_that_is_what_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let text = SCENARIO.replace("3.02", "2.0");
    std::fs::write(folder.path().join("refused.toml"), text).unwrap();
    let output = program(&["compare", "refused.toml", "--seeds", "2"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("nothing to compare"), "{said}");
    assert!(said.contains("refused 2 of 2 seeds (100 %, 95 % interval [16 %, 100 %])"), "{said}");
}

#[test]
fn rates_are_paired_by_seed() {
    let run = |seed: u64, first: bool, second: bool| {
        let refused = |is: bool| is.then(|| "the mean NIS is 5".to_owned());
        let maxima = |is: bool| match is {
            true => Maxima::default(),
            false => Maxima { longitude_24h: Some(1.0 + seed as f64), ..Maxima::default() },
        };
        PairedRun {
            seed,
            first: maxima(first),
            second: maxima(second),
            first_refused: refused(first),
            second_refused: refused(second),
        }
    };
    // The second method refuses eight of twenty that the first accepts, and both refuse one.
    let runs: Vec<PairedRun> = (0..20).map(|k| run(k, k == 9, k < 8 || k == 9)).collect();
    let found = Refusals::of(&runs).unwrap();
    assert_eq!((found.first, found.second, found.both), (1, 9, 1));
    assert!((found.p - 2.0 * 0.5f64.powi(8)).abs() < 1e-12, "{}", found.p);
    assert!(found.second_rate.low > 0.23 && found.second_rate.high < 0.69, "{found:?}");
    let comparison = compare("s", "six", "eight", &runs, &[], None);
    assert_eq!(comparison.cells[0].runs, 11);
    let none: Vec<PairedRun> = (0..20).map(|k| run(k, false, false)).collect();
    assert_eq!(Refusals::of(&none), None);
}
