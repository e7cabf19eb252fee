//! The trace of a campaign shows every requirement that its cases check, and its exit status is
//! that of every other command that reports the verdict.

use crate::campaign_report::bench::{Bench, CAMPAIGN, SCENARIO, TEMPLATE, check};
use crate::common::results;
use octant_campaign::plan::{Case, Plan};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

type Change = fn(usize, &Case, &mut Value);

/// Makes two by two cases.
fn small(change: Change) -> (Bench, Plan, PathBuf) {
    Bench::filled(&CAMPAIGN.replace("replicates = 40", "replicates = 2"), change)
}

/// Runs a command on the campaign; returns its exit status and its output.
fn says(bench: &Bench, arguments: &[&str]) -> (i32, String) {
    let output = bench.octant(arguments);
    let said =
        String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
    (output.status.code().unwrap(), said)
}

/// Checks that all commands that report the verdict have the same exit status; returns the trace as
/// JSON.
#[track_caller]
fn agree(bench: &Bench, expected: i32, name: &str) -> Value {
    let before = parts(&bench.at("out"));
    for command in [
        &["campaign", "status", "out"][..],
        &["campaign", "trace", "out"],
        &["campaign", "report", "out"],
        // All results are there: the command reports their verdict, and runs nothing.
        &["campaign", "run", "out"],
    ] {
        if command[1] == "run" && expected == 3 && before.len() < 4 {
            continue;
        }
        let (status, said) = says(bench, command);
        assert_eq!(status, expected, "{command:?}: {said}");
        assert!(said.contains(&format!(": {name}\n")), "{command:?}: {said}");
    }
    assert_eq!(parts(&bench.at("out")), before, "no case has run");
    let (_, said) = says(bench, &["campaign", "trace", "out", "--json"]);
    let traced: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(traced["verdict"], name);
    traced
}

fn parts(out: &Path) -> BTreeSet<(Vec<u8>, PathBuf)> {
    let all = std::fs::read_dir(out.join("results")).unwrap();
    all.map(|file| file.unwrap().path()).map(|path| (std::fs::read(&path).unwrap(), path)).collect()
}

/// Returns the row of a requirement in a trace.
fn row_of<'a>(traced: &'a Value, id: &str) -> &'a Value {
    let rows = traced["requirements"].as_array().unwrap();
    rows.iter().find(|row| row["id"] == id).unwrap_or_else(|| panic!("{id} isn't there"))
}

/// Returns the verdict of a requirement in a trace.
fn verdict_of<'a>(traced: &'a Value, id: &str) -> &'a Value {
    &row_of(traced, id)["verdict"]
}

/// Lowers the ensemble's requirement so that two draws can show it.
fn lower(bench: &Bench, pass: &str) {
    let path = bench.at("requirements.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let modest = text.replace("\"80 %\"", &format!("{pass:?}")).replace("\"90 %\"", "\"80 %\"");
    assert_ne!(text, modest);
    std::fs::write(path, modest).unwrap();
}

fn modest_and_filled(change: Change) -> (Bench, Plan, PathBuf) {
    demanding("20 %", change)
}

fn demanding(pass: &str, change: Change) -> (Bench, Plan, PathBuf) {
    let bench = Bench::new(&CAMPAIGN.replace("replicates = 40", "replicates = 2"));
    lower(&bench, pass);
    bench.fill(change)
}

#[test]
fn a_pass_is_a_pass_everywhere() {
    let (bench, ..) = modest_and_filled(|_, _, _| {});
    let traced = agree(&bench, 0, "pass");
    assert_eq!(verdict_of(&traced, "CAL-1"), "pass");
    assert_eq!(verdict_of(&traced, "NAV-1"), "pass");
    assert_eq!(verdict_of(&traced, "DOC-1"), &Value::Null);
}

/// A part of the document that the requirements came from could not be read: nobody tests what it said.
#[test]
fn requirements_that_may_be_missing_are_inconclusive_everywhere() {
    let bench = Bench::new(&CAMPAIGN.replace("replicates = 40", "replicates = 2"));
    lower(&bench, "20 %");
    let path = bench.at("requirements.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let account = "[[accounts]]\ninput = \"ins.reqif\"\nunit = [\"object\", \"objects\"]\nread = 4\nused = 3\n\
                   left_out = [{ kind = \"without a text\", count = 1, first = \"o4 in line 9\", doubt = true }]\n";
    std::fs::write(&path, format!("{text}\n{account}")).unwrap();
    let (bench, plan, _) = bench.fill(|_, _, _| {});
    let traced = agree(&bench, 3, "inconclusive");
    assert_eq!(verdict_of(&traced, "CAL-1"), "pass");
    assert_eq!(verdict_of(&traced, "NAV-1"), "pass");
    let doubt = "ins.reqif: left out: 1 without a text, the first o4 in line 9";
    assert_eq!(traced["doubts"], json!([doubt]));
    assert_eq!(plan.accounts.len(), 1);
    for command in ["status", "trace"] {
        let (_, said) = says(&bench, &["campaign", command, "out"]);
        assert!(said.contains(&format!("requirements may be missing: {doubt}")), "{said}");
    }
    // The account is a part of the plan: without it the file is another one.
    std::fs::write(&path, text).unwrap();
    let (status, said) = says(&bench, &["campaign", "trace", "out"]);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("changed after the campaign was planned"), "{said}");
}

/// A document of another tool stands in place of a `requirements.toml`, and its hash is a part of the plan.
#[test]
fn a_campaign_takes_a_document_of_another_tool() {
    let text = CAMPAIGN
        .replace("replicates = 40", "replicates = 2")
        .replace("requirements.toml", "requirements.sdoc");
    let bench = Bench::new(&text);
    lower(&bench, "20 %");
    let (status, said) =
        says(&bench, &["requirements", "convert", "requirements.toml", "requirements.sdoc"]);
    assert_eq!(status, 0, "{said}");
    let (bench, plan, _) = bench.fill(|_, _, _| {});
    let traced = agree(&bench, 0, "pass");
    for id in ["CAL-1", "NAV-1"] {
        assert_eq!(verdict_of(&traced, id), "pass");
    }
    let path = bench.at("requirements.sdoc");
    let document = std::fs::read_to_string(&path).unwrap();
    let hash = blake3::hash(document.as_bytes()).to_hex();
    let lines = plan.accounts[0].lines();
    assert!(lines[0].starts_with("requirements.sdoc: "), "{lines:?}");
    assert!(lines.contains(&format!("note: BLAKE3 of the document {hash}")), "{lines:?}");
    // A comment more is another document.
    std::fs::write(&path, format!("{document}\n[TEXT]\nSTATEMENT: x\n")).unwrap();
    let (status, said) = says(&bench, &["campaign", "trace", "out"]);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("changed after the campaign was planned"), "{said}");
    // A measure that no run has is refused by its requirement.
    let wrong = document.replacen("MEASURE: ", "MEASURE: no.", 1);
    std::fs::write(&path, wrong).unwrap();
    let (status, said) = says(&bench, &["campaign", "plan", "campaign.toml", "--out", "other"]);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains(".measure: "), "{said}");
}

#[test]
fn a_failing_requirement_of_a_scenario_is_in_the_trace_and_fails_everywhere() {
    let (bench, ..) = modest_and_filled(|index, _, result| {
        if index == 0 {
            check(result, "CAL-1", 99.0, 50.0);
        }
    });
    let traced = agree(&bench, 1, "fail");
    assert_eq!(verdict_of(&traced, "CAL-1"), "fail");
    assert_eq!(verdict_of(&traced, "NAV-1"), "pass");
}

#[test]
fn an_ensemble_that_shows_too_little_is_inconclusive_everywhere() {
    let (bench, ..) = small(|_, _, _| {});
    let traced = agree(&bench, 3, "inconclusive");
    assert_eq!(verdict_of(&traced, "NAV-1"), "inconclusive");
    assert_eq!(verdict_of(&traced, "CAL-1"), "pass");
}

#[test]
fn a_case_without_a_result_is_inconclusive_everywhere() {
    let (bench, plan, out) = modest_and_filled(|_, _, _| {});
    results::remove(&out, &plan.cases[1].id);
    let traced = agree(&bench, 3, "inconclusive");
    assert_eq!(traced["open"], 1);
    assert_eq!(verdict_of(&traced, "CAL-1"), "inconclusive");
}

#[test]
fn a_case_that_ended_as_an_error_is_one_everywhere() {
    let (bench, ..) = modest_and_filled(|index, _, result| {
        if index == 2 {
            *result = json!({"schema": 1, "case": result["case"], "case_blake3": result["case_blake3"],
                             "verdict": "error", "error": "it crashed", "summary": null});
        }
    });
    let traced = agree(&bench, 4, "error");
    assert_eq!(verdict_of(&traced, "CAL-1"), "error");
}

/// A problem outside of all requirements: a fault that never fired, in a case that meets all of
/// them.
#[test]
fn what_is_wrong_beside_all_requirements_is_told_everywhere() {
    let (bench, ..) = modest_and_filled(|index, _, result| {
        if index == 1 {
            let mut receipt = TEMPLATE["summary"]["faults"][0].clone();
            receipt["fired"] = false.into();
            result["summary"]["faults"] = json!([receipt]);
            result["summary"]["verdict"] = "inconclusive".into();
            result["verdict"] = "inconclusive".into();
        }
    });
    let traced = agree(&bench, 3, "inconclusive");
    assert_eq!(traced["besides"], "inconclusive");
    let (_, said) = says(&bench, &["campaign", "trace", "out"]);
    assert!(said.contains("apart from requirements: inconclusive"), "{said}");
}

/// A failure in a case that shows nothing isn't one of the failures that an ensemble may have.
#[test]
fn a_failure_without_evidence_is_none_that_draws_may_have() {
    let failed: Change = |index, _, result| {
        if index == 1 {
            check(result, "NAV-1", 11.0, 10.0);
        }
    };
    let (bench, ..) = demanding("10 %", failed);
    let traced = agree(&bench, 0, "pass");
    assert_eq!(verdict_of(&traced, "NAV-1"), "pass");
    assert_eq!(row_of(&traced, "NAV-1")["counts"]["fail"], 1);

    let (bench, ..) = demanding("10 %", |index, _, result| {
        if index == 1 {
            check(result, "NAV-1", 11.0, 10.0);
            let mut receipt = TEMPLATE["summary"]["faults"][0].clone();
            receipt["fired"] = false.into();
            result["summary"]["faults"] = json!([receipt]);
        }
    });
    let traced = agree(&bench, 3, "inconclusive");
    let counts = &row_of(&traced, "NAV-1")["counts"];
    assert_eq!((&counts["fail"], &counts["inconclusive"]), (&json!(0), &json!(1)), "{counts}");
}

/// Two machines had different results of one case: none of them counts.
#[test]
fn a_case_with_two_results_is_an_error_of_all_that_it_checks() {
    let (bench, plan, out) = modest_and_filled(|_, _, _| {});
    let id = plan.cases[1].id.as_str();
    results::put_beside(&out, id, &(results::text(&out, id) + "\n"));
    let (_, said) = says(&bench, &["campaign", "trace", "out", "--json"]);
    let traced: Value = serde_json::from_str(&said).unwrap();
    for id in ["CAL-1", "NAV-1"] {
        assert_eq!(row_of(&traced, id)["counts"]["error"], 1, "{traced}");
    }
}

/// A campaign that names no file of requirements checks those of its scenarios.
#[test]
fn requirements_of_scenarios_alone_are_traced() {
    let campaign = CAMPAIGN
        .replace("replicates = 40", "replicates = 2")
        .replace("requirements = \"requirements.toml\"\n", "");
    let alone: Change = |index, _, result| {
        let checks = result["summary"]["requirements"].as_array_mut().unwrap();
        checks.retain(|check| check["id"] == "CAL-1");
        if index == 0 {
            check(result, "CAL-1", 99.0, 50.0);
        }
    };
    let (bench, ..) = Bench::new(&campaign).fill(alone);
    let traced = agree(&bench, 1, "fail");
    assert_eq!(traced["requirements"].as_array().unwrap().len(), 1);
    assert_eq!(verdict_of(&traced, "CAL-1"), "fail");

    // If the scenarios have no requirements, nothing is shown.
    let bench = Bench::new(&campaign);
    let nothing = SCENARIO.split("[[requirements]]").next().unwrap();
    std::fs::write(bench.at("short.toml"), nothing).unwrap();
    let (bench, ..) = bench.fill(|_, _, result| {
        result["summary"]["requirements"] = json!([]);
        result["summary"]["verdict"] = "none".into();
        // In a campaign, a case that checks nothing shows nothing.
        result["verdict"] = "inconclusive".into();
    });
    let traced = agree(&bench, 3, "inconclusive");
    assert_eq!(traced["requirements"], json!([]));
    assert_eq!(traced["besides"], "inconclusive");
}
