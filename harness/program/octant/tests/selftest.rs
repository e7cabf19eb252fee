//! The whole self-test, through the program that users have; and its results.

use crate::common::program::{OCTANT, octant_in};
use serde_json::Value;

#[test]
fn every_case_comes_as_it_has_to() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // A campaign for which it is made; nothing else of a repository is here.
    std::fs::create_dir(here.join("cert")).unwrap();
    std::fs::write(here.join("cert/plan.json"), "{}").unwrap();
    let files = ["--out", "found.json", "--for", "cert"];
    let words = [&["selftest", "--json", "--jobs", "2"][..], &files].concat();
    let output = octant_in(here, &words);
    let printed = String::from_utf8(output.stdout).unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    let found: Value = serde_json::from_str(&printed).unwrap();
    let cases = found["cases"].as_array().unwrap();
    let bad: Vec<String> = cases
        .iter()
        .filter(|case| case["verdict"] != "pass")
        .map(|case| format!("{}: {} (expected {})", case["id"], case["found"], case["expected"]))
        .collect();
    assert!(bad.is_empty(), "{}\n{said}", bad.join("\n"));
    assert_eq!(
        (output.status.code(), &found["verdict"]),
        (Some(0), &Value::from("pass")),
        "{said}"
    );
    let count = |kind: &str| cases.iter().filter(|case| case["kind"] == kind).count();
    assert_eq!(cases.len(), octant_selftest::cases().len());
    assert!(count("golden") >= 8 && count("must pass") >= 5 && count("must not pass") >= 20);
    assert_eq!(count("same bytes"), 3);
    for case in cases {
        let of_number = case["kind"] == "golden";
        assert_eq!(case["source"].is_string(), of_number, "{case}");
    }
    // Bound to this program file.
    let program = std::fs::read(OCTANT).unwrap();
    assert_eq!(found["program_sha256"], Value::from(sha256(&program)));
    assert_eq!(found["schema"], 1);
    for name in ["at", "started", "octant"] {
        assert!(found[name].is_string(), "{name}");
    }
    for path in ["found.json", "cert/selftest.json"] {
        assert_eq!(std::fs::read_to_string(here.join(path)).unwrap(), printed, "{path}");
    }
}

fn sha256(bytes: &[u8]) -> String {
    use sha2::{Digest, Sha256};
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn a_folder_that_is_no_campaign_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let output = octant_in(folder.path(), &["selftest", "--for", "."]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("--for: found no plan.json in ., expected the folder of a campaign"),
        "{said}"
    );
}

/// Cases that can't write their files end as errors.
#[cfg(unix)]
#[test]
fn a_part_is_run_to_its_first_failure_alone() {
    let run = |more: &[&str]| -> Value {
        let limited = "ulimit -f 2; exec \"$0\" \"$@\"";
        let mut command = octant_test_processes::command("sh");
        command.args(["-c", limited, OCTANT, "selftest", "--answers", "--jobs", "1", "--json"]);
        let output = command.args(more).output().unwrap();
        assert_eq!(output.status.code(), Some(4), "{output:?}");
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let of = |found: &Value| {
        let cases = found["cases"].as_array().unwrap();
        let failed = cases.iter().filter(|case| case["verdict"] != "pass").count();
        (cases.len(), failed)
    };
    let (all, failed) = of(&run(&[]));
    assert!(all < octant_selftest::cases().len() && failed > 1, "{all} {failed}");
    let (some, failed) = of(&run(&["--fail-fast"]));
    assert!(some < all && failed == 1, "{some} of {all}, {failed}");
}

/// A program whose verdicts can't be trusted is detected: everything passes with it.
#[cfg(unix)]
#[test]
fn a_program_that_passes_everything_is_an_alarm() {
    use octant_selftest::judge::{CaseVerdict, Expectation};
    use octant_selftest::record::Record;
    use octant_selftest::{cases, run};
    use std::os::unix::fs::PermissionsExt;
    use std::sync::atomic::AtomicBool;
    let folder = tempfile::tempdir().unwrap();
    // The program does its work, reports nothing, and its exit status is 0.
    let liar = folder.path().join("liar");
    let script = format!("#!/bin/sh\n'{}' \"$@\"\nexit 0\n", OCTANT);
    std::fs::write(&liar, script).unwrap();
    std::fs::set_permissions(&liar, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut some = cases();
    some.retain(|case| {
        matches!(case.expectation, Expectation::NotPass { .. }) && case.id != "records-dropped"
    });
    let started = std::time::SystemTime::now();
    let found = run(&liar, &some, 2, &AtomicBool::new(false), &|_| {}).unwrap();
    assert_eq!(found.len(), some.len());
    for case in &found {
        assert_eq!(case.verdict, CaseVerdict::Alarm, "{}: {}", case.id, case.found);
    }
    let record = Record::new(&liar, started, some.len(), found).unwrap();
    assert_eq!((record.verdict, record.exit_code()), ("alarm", 5));
}
