//! Measures of requirements, in a summary that a run gave.

use octant_base::control::Control;
use octant_run::{StreamKeeping, assemble, run_method};
use octant_scenario::{Method, Scenario};
use octant_verdict::measures;

/// Lists every number of a real summary by its path.
fn numbers(path: &str, value: &serde_json::Value, all: &mut Vec<String>) {
    match value {
        serde_json::Value::Number(_) => all.push(path.to_owned()),
        serde_json::Value::Object(map) => {
            for (key, value) in map {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                numbers(&path, value, all);
            }
        }
        _ => {}
    }
}

#[test]
fn every_number_of_a_run_can_be_required() {
    let text = "schema = 1\n[procedure.calibration]\nduration = \"1 h\"\n\
                [procedure.navigation]\nduration = \"2 h\"\n[baseline]\ng_states = false\n";
    let scenario = Scenario::parse(text, "f", std::path::Path::new(""), &[]).unwrap();
    let run = |method| {
        run_method(&scenario, method, 1, StreamKeeping::None, &Control::default()).unwrap()
    };
    let (primary, baseline) = (run(Method::Primary), run(Method::Baseline));
    let run = assemble(&scenario, 1, primary, Some(baseline)).unwrap();
    let mut all = Vec::new();
    numbers("", &serde_json::to_value(&run.summary).unwrap(), &mut all);
    let refused: Vec<&String> = all.iter().filter(|path| measures::check(path).is_err()).collect();
    assert_eq!(
        refused,
        ["numerics", "schema", "seed"],
        "the form and what was put in are no results"
    );
    assert!(all.len() > 300, "{}", all.len());
}
