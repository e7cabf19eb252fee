//! `octant requirements measures`: what it lists is what readers of requirements take.

use crate::common::program::{ended, ends, octant_in};
use octant_scenario::Scenario;
use octant_verdict::Comparison;
use octant_verdict::signed::one_sided;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn each_listed_measure_is_taken_with_a_limit_in_its_unit() {
    let (said, _) = ends(&["requirements", "measures", "--json"], 0);
    let listed: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(
        (&listed["schema"], &listed["octant"]),
        (&1.into(), &env!("CARGO_PKG_VERSION").into())
    );
    let needs: BTreeSet<&str> =
        listed["needs"].as_object().unwrap().keys().map(String::as_str).collect();
    let (mut all, mut used) = (Vec::new(), BTreeSet::new());
    let measures = listed["measures"].as_array().unwrap();
    for (number, entry) in measures.iter().enumerate() {
        let text = |name: &str| entry[name].as_str().unwrap();
        let limit = match text("unit") {
            "1" => "1".to_owned(),
            unit => format!("\"1 {unit}\""),
        };
        // A limit on one side alone of a measure with a sign is refused: bars take its magnitude.
        let bars = if entry["signed"] == true { "|" } else { "" };
        let measure = format!("{bars}{}{bars}", text("measure"));
        all.push(format!(
            "[[requirements]]\nid = \"R{number}\"\ntext = \"t\"\nmeasure = \"{measure}\"\nlimit = {limit}\n"
        ));
        used.extend(entry["needs"].as_array().unwrap().iter().map(|need| need.as_str().unwrap()));
        assert!(!text("meaning").is_empty());
    }
    assert_eq!(used, needs, "each condition is told, and each is one of some measure");
    let folder = tempfile::tempdir().unwrap();
    let file = format!("schema = 1\ntitle = \"all\"\n{}", all.concat());
    std::fs::write(folder.path().join("all.toml"), file).unwrap();
    let (said, _) = ended(octant_in(folder.path(), &["requirements", "check", "all.toml"]), 0);
    let count = measures.len();
    assert!(count > 600 && said.contains(&format!("{count} requirements")), "{said}");
    // A scenario takes the same, a thousand at most.
    let mut parsed = 0;
    for part in all.chunks(900) {
        let head = "schema = 1\n[procedure.navigation]\nduration = \"1 h\"\n";
        let text = head.to_owned() + &part.concat();
        let scenario = Scenario::parse(&text, "all.toml", Path::new(""), &[]).unwrap();
        parsed += scenario.requirements.len();
    }
    assert_eq!(parsed, count);
}

#[test]
fn a_signed_measure_is_refused_with_a_limit_on_one_side() {
    let (said, _) = ends(&["requirements", "measures", "--json"], 0);
    let listed: Value = serde_json::from_str(&said).unwrap();
    let mut refused = 0;
    for entry in listed["measures"].as_array().unwrap() {
        let measure = entry["measure"].as_str().unwrap();
        let told = one_sided((measure, Comparison::AtMost), []);
        assert_eq!(told.is_some(), entry["signed"] == true, "{measure}");
        refused += usize::from(told.is_some());
    }
    assert!(refused > 200, "{refused}");
}

#[test]
fn the_text_names_units_and_conditions() {
    let (said, _) = ends(&["requirements", "measures"], 0);
    let line = |name: &str| {
        let mut lines = said.lines().filter(|line| line.split(' ').next() == Some(name));
        lines.next().unwrap_or_else(|| panic!("no {name} in {said}")).to_owned()
    };
    let longitude = line("navigation.longitude_error_arcmin.max");
    assert!(
        longitude.contains(" arcmin ") && longitude.contains("[navigation, truth]"),
        "{longitude}"
    );
    assert!(line("navigation.marks.24h.radial_nmi").contains("24h]"));
    assert!(said.lines().all(|line| line.trim_end() == line), "no line ends in spaces");
}

#[test]
fn the_text_has_each_table_of_parameters_once() {
    let (text, _) = ends(&["requirements", "measures"], 0);
    let line = |name: &str| {
        let mut found = text.lines().filter(|line| line.split_whitespace().next() == Some(name));
        let line = found.next().unwrap_or_else(|| panic!("no {name} in {text}")).to_owned();
        assert_eq!(found.next(), None, "{name}");
        line
    };
    assert!(line("calibration.parameters.NAME.error").contains("of NAME"));
    assert!(line("calibration.parameters.NAME.error").ends_with(", ± [calibration, truth]"));
    assert!(line("calibration.nees.GROUP").ends_with("[calibration, truth, sigma]"));
    assert!(line("navigation.radial_error_nmi.rate_per_h").contains(" nmi/h "));
    assert!(!text.lines().any(|line| line.starts_with("baseline.")));
    assert!(text.contains(
        "The second method has the measures of alignment, calibration, counterfactual, done"
    ));
}
