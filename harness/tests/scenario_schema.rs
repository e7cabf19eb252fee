//! The JSON Schema accepts what the program accepts and refuses unknown keys.
#![allow(clippy::unwrap_used)]

use serde_json::{Value, json};

fn fixtures() -> Vec<(String, Value)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/scenarios");
    let read = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        (path.display().to_string(), toml::from_str(&text).unwrap())
    };
    std::fs::read_dir(folder).unwrap().map(read).collect()
}

#[test]
fn every_shipped_scenario_validates_and_none_does_with_an_unknown_key() {
    let validator = jsonschema::draft202012::new(&octant::scenario::schema()).unwrap();
    for (file, mut scenario) in fixtures() {
        if let Err(error) = validator.validate(&scenario) {
            panic!("{file}: {}: {error}", error.instance_path());
        }
        let calibration = scenario["procedure"]["calibration"].as_object_mut().unwrap();
        calibration.insert("dwel".into(), json!("1 h"));
        assert!(!validator.is_valid(&scenario), "{file} with an unknown key");
        let calibration = scenario["procedure"]["calibration"].as_object_mut().unwrap();
        calibration.remove("dwel");
        scenario["faults"] = json!([]);
        assert!(!validator.is_valid(&scenario), "{file} with faults");
    }
}

#[test]
fn the_schema_refuses_what_the_program_refuses_at_sight() {
    let validator = jsonschema::draft202012::new(&octant::scenario::schema()).unwrap();
    let base = json!({ "schema": 1, "procedure": { "calibration": {} } });
    assert!(validator.is_valid(&base));
    for (pointer, value) in [
        ("/schema", json!(2)),
        ("/procedure/calibration", json!({ "duration": 12 })),
        ("/procedure/calibration", json!({ "duration": "12" })),
        ("/procedure/calibration", json!({ "positions": "seven" })),
        ("/procedure/calibration", json!({ "stops": [] })),
        ("/procedure", json!({ "calibration": {}, "imu": {} })),
    ] {
        let mut scenario = base.clone();
        *scenario.pointer_mut(pointer).unwrap() = value;
        assert!(!validator.is_valid(&scenario), "{scenario}");
    }
}
