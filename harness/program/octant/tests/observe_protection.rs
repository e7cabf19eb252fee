//! `octant observe --protection`: what the drift test leaves unnoticed.

use crate::common::program::program;
use serde_json::Value;

const SHORT: &str = r#"schema = 1
title = "short"

[imu]
rate = "20 Hz"

[procedure.calibration]
duration = "30 min"
"#;

fn observe(settings: &[&str]) -> (Option<i32>, Value, String) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), SHORT).unwrap();
    let mut arguments = vec!["observe", "s.toml", "--protection", "--json"];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    let output = program(&arguments).current_dir(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), serde_json::from_slice(&output.stdout).unwrap_or_default(), said)
}

#[test]
fn every_parameter_has_its_jump_or_none_and_the_limit_scales_it() {
    let (code, found, said) = observe(&[]);
    assert_eq!(code, Some(0), "{said}");
    let (_, wider, _) = observe(&["screening.drift=10"]);
    let rows = |found: &Value| found["parameters"].as_array().unwrap().clone();
    assert_eq!((rows(&found).len(), &found["limit_sigmas"]), (30, &Value::from(5.0)));
    let mut jumps = 0;
    for (row, wider) in rows(&found).iter().zip(rows(&wider)) {
        let sizes = &row["jump"]["sizes"];
        if row["jump"].is_null() {
            continue;
        }
        jumps += 1;
        let number = |value: &Value| value.as_f64().unwrap();
        // Half of the jumps pass at the mean of z that is the limit: twice the limit, twice the shift.
        let half = number(&sizes[0]["shift"]);
        assert!((number(&wider["jump"]["sizes"][0]["shift"]) / half - 2.0).abs() < 1e-9, "{row}");
        let rare = number(&sizes[1]["shift"]) / half;
        assert!((rare - (5.0 + 3.090_232) / 5.0).abs() < 1e-6, "{row}");
        let sigmas = number(&sizes[0]["shift_sigmas"]) * number(&row["sigma"]);
        assert!((sigmas / half - 1.0).abs() < 1e-12, "{row}");
        assert!(number(&row["jump"]["from_s"]) < number(&row["jump"]["to_s"]), "{row}");
    }
    assert!(jumps > 15, "{jumps}");
}

#[test]
fn without_a_drift_test_it_says_so() {
    for settings in [
        &["screening.drift=off"][..],
        &["procedure.calibration.estimator=least-squares"],
        &["procedure.calibration.g_states=false"],
    ] {
        let (code, _, said) = observe(settings);
        assert_eq!(code, Some(2), "{settings:?}: {said}");
        assert!(said.contains("found no test for drifts, expected"), "{settings:?}: {said}");
    }
}
