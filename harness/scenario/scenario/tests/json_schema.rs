//! The JSON Schema accepts what the program accepts, and refuses unknown keys.

use serde_json::{Value, json};

/// Returns the shipped scenarios, and those of the kinds of faults.
fn fixtures() -> Vec<(String, Value)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios");
    let scenario = |path: &std::path::Path| path.is_file() && !path.ends_with("nightly.toml");
    [folder.to_owned(), format!("{folder}/faults")]
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| scenario(path))
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            (path.display().to_string(), toml::from_str(&text).unwrap())
        })
        .collect()
}

#[test]
fn every_shipped_scenario_validates_and_none_does_with_an_unknown_key() {
    let validator = octant_json_schema::draft202012::new(&octant_scenario::schema()).unwrap();
    for (file, mut scenario) in fixtures() {
        if let Err(error) = validator.validate(&scenario) {
            panic!("{file}: {}: {error}", error.instance_path());
        }
        let calibration = scenario["procedure"]["calibration"].as_object_mut().unwrap();
        calibration.insert("dwel".into(), json!("1 h"));
        assert!(!validator.is_valid(&scenario), "{file} with an unknown key");
        let calibration = scenario["procedure"]["calibration"].as_object_mut().unwrap();
        calibration.remove("dwel");
        for (fault, valid) in [
            (
                json!({ "id": "a", "kind": "spike", "channels": "gyro x", "amplitude": "1 deg/h",
                     "trigger": { "at": "5 s" }, "duration": "3 samples" }),
                true,
            ),
            (
                json!({ "id": "a", "kind": "spike", "channels": ["gyro x", "gyro y"],
                     "amplitude": "1 deg/h", "repeat": "every time",
                     "trigger": { "position": 4, "after": "2 s" }, "duration": "1 s" }),
                true,
            ),
            // An unknown kind, no trigger, two triggers, a key of another trigger, no such channel.
            (
                json!({ "id": "a", "kind": "spik", "channels": "gyro x", "amplitude": "1 deg/h",
                     "trigger": { "at": "5 s" } }),
                false,
            ),
            (
                json!({ "id": "a", "kind": "spike", "channels": "gyro x", "amplitude": "1 deg/h" }),
                false,
            ),
            (
                json!({ "id": "a", "kind": "spike", "channels": "gyro x", "amplitude": "1 deg/h",
                     "trigger": { "at": "5 s", "sample": 3 } }),
                false,
            ),
            (
                json!({ "id": "a", "kind": "spike", "channels": "gyro x", "amplitude": "1 deg/h",
                     "trigger": { "at": "5 s", "after": "1 s" } }),
                false,
            ),
            (
                json!({ "id": "a", "kind": "spike", "channels": "gyro", "amplitude": "1 deg/h",
                     "trigger": { "at": "5 s" }, "chanels": "gyro x" }),
                false,
            ),
        ] {
            scenario["faults"] = json!([fault]);
            assert_eq!(validator.is_valid(&scenario), valid, "{file} with {fault}");
        }
    }
}

#[test]
fn the_schema_refuses_what_the_program_refuses_at_sight() {
    let validator = octant_json_schema::draft202012::new(&octant_scenario::schema()).unwrap();
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
