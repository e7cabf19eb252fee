//! The core's configuration survives as parameters of the Calibrator FMU: bit for bit, and within
//! the ranges of its table.

use octant_calibration::CoreConfig;
use octant_earth::{Vector3, rotation};
use octant_fmu::calibrator::table::MODEL;
use octant_fmu::calibrator::{config, put, start_values};
use octant_fmu::table::{DeclaredVariable, ElementType};
use octant_fmu::values::CellValues;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario};
use std::path::PathBuf;

fn files() -> Vec<PathBuf> {
    let scenarios = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios");
    let mut files = Vec::new();
    for folder in [scenarios.to_owned(), format!("{scenarios}/faults")] {
        files.extend(std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()));
    }
    // A suite names scenarios, and isn't one.
    files.retain(|path| path.is_file() && !path.ends_with("nightly.toml"));
    files.sort();
    assert!(files.len() >= 60);
    files
}

/// Collects the configurations of both methods, with an attitude and velocity of many digits.
fn configurations() -> Vec<(String, CoreConfig)> {
    let mut all = Vec::new();
    for file in files() {
        let scenario = Scenario::load(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
        let draws = DrawnValues::of(&scenario, &Seeded(scenario.seed));
        let turn = rotation::exp(&Vector3::new(0.1, -0.2, 0.3));
        let velocity = Vector3::new(1.0 / 3.0, -2.0 / 7.0, 1e-9);
        for method in [Method::Primary, Method::Baseline] {
            let q_nb = turn * scenario.mean_attitude();
            if let Some(config) = scenario.core(method, &draws, &q_nb, &velocity) {
                all.push((format!("{} {method:?}", file.display()), config));
            }
        }
    }
    all
}

fn set(values: &mut CellValues, slot: usize, variable: &DeclaredVariable, value: f64) {
    match variable.kind {
        ElementType::Real => values.set_real(slot, value),
        ElementType::Count => values.set_count(slot, value as u64),
        ElementType::Integer | ElementType::Enumeration(_) => {
            values.set_integer(slot, value as i32)
        }
        ElementType::Boolean => values.set_boolean(slot, value != 0.0),
        ElementType::Binary(_) | ElementType::Clock(_) => panic!("no parameter is one"),
    }
}

#[test]
fn every_scenario_survives_as_parameters() {
    for (name, original) in configurations() {
        // Debug prints every field, and floats so that they read back to the same bits.
        let expected = format!("{original:?}");
        let mut values = CellValues::new(&MODEL);
        put(&original, &mut values);
        assert_eq!(format!("{:?}", config(&values).unwrap()), expected, "{name}");

        // As numbers set by an importer, by name.
        let mut values = CellValues::new(&MODEL);
        for (variable_name, elements) in start_values(&original) {
            let (slot, variable) = MODEL.find(variable_name).unwrap();
            assert_eq!(elements.len(), variable.slots());
            for (i, element) in elements.into_iter().enumerate() {
                assert!(element.is_finite(), "{name}: {variable_name}");
                assert!(variable.min.is_none_or(|min| element >= min), "{name}: {variable_name}");
                assert!(variable.max.is_none_or(|max| element <= max), "{name}: {variable_name}");
                set(&mut values, slot + i, variable, element);
            }
        }
        assert_eq!(format!("{:?}", config(&values).unwrap()), expected, "{name}");
    }
}
