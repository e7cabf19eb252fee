//! Folders of older programs, and of programs with other numerics: read, reported, judged again,
//! and never taken for more than they are.

use crate::campaign_report::bench::{Bench, CAMPAIGN};
use crate::chain::{TOO_NEAR, run};
use crate::common::program::{octant_in, program};
use crate::common::results;
use octant_campaign::execute::case;
use octant_score::numerics::NUMERICS;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Copies a folder that the first program wrote: summaries of schema 1, no numerics version.
fn older(name: &str) -> (TempDir, PathBuf) {
    let place = tempfile::tempdir().unwrap();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/formats").join(name);
    let to = place.path().join(name);
    copy(&from, &to);
    (place, to)
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let into = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &into);
        } else {
            std::fs::copy(entry.path(), into).unwrap();
        }
    }
}

/// Judges a folder again; returns the status, the object on stdout, and stderr.
fn rejudged(folder: &Path, more: &[&str]) -> (i32, Value, String) {
    let mut words = vec!["rejudge", folder.to_str().unwrap(), "--json"];
    words.extend_from_slice(more);
    let output = program(&words).output().unwrap();
    let found = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    (output.status.code().unwrap(), found, String::from_utf8(output.stderr).unwrap())
}

/// Reads every file of a folder.
fn bytes(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        if entry.path().is_dir() {
            all.extend(bytes(&entry.path()));
        } else {
            all.push((entry.path(), std::fs::read(entry.path()).unwrap()));
        }
    }
    all.sort();
    all
}

#[test]
fn an_older_run_is_judged_anew_beside_what_it_said() {
    let (place, folder) = older("run");
    let before = bytes(&folder);
    let (status, found, err) = rejudged(&folder, &[]);
    // The stored verdict is pass. Completion of the plan wasn't stored, so it isn't a pass any
    // more.
    let judged = &found["judged"][0];
    assert_eq!(
        (status, &judged["then"], &judged["now"]),
        (3, &json!("pass"), &json!("inconclusive")),
        "{err}"
    );
    assert_eq!(judged["requirements"][0]["now"], "pass");
    assert_eq!(judged["made_by"], json!(["0.1.0"]));
    let text = found.to_string();
    for told in ["what the run was to do and what it did", "verdicts can be compared, bits can't"] {
        assert!(text.contains(told), "{told}: {text}");
    }
    // The signed folder is unchanged; the result is beside it.
    assert_eq!(bytes(&folder), before);
    let beside = std::fs::read(place.path().join("run.rejudged.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Value>(&beside).unwrap(), found);
    let whole = program(&["verify", folder.to_str().unwrap()]).output().unwrap();
    let said = String::from_utf8(whole.stdout).unwrap();
    assert!(whole.status.success() && said.contains("no numerics version"), "{said}");
    // As text, and from inside the folder.
    let output = octant_in(&folder, &["rejudge", "."]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("then: pass") && said.contains("now: inconclusive"), "{said}");
    assert_eq!(bytes(&folder), before);

    // A changed file is refused by its name, and nothing is written into the folder.
    let (status, _, err) = rejudged(&folder, &["--out", folder.join("x.json").to_str().unwrap()]);
    assert!(status == 2 && err.contains("in the judged folder"), "{err}");
    let path = folder.join("summary.json");
    let summary = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, summary.replace("\"limit\": 10.0", "\"limit\": 99.0")).unwrap();
    let (status, _, err) = rejudged(&folder, &[]);
    assert!(status == 2 && err.contains("summary.json was changed"), "{err}");
    let (status, _, err) = rejudged(place.path(), &[]);
    assert!(
        status == 2 && err.contains("expected the folder of a run, a campaign or a night"),
        "{err}"
    );
}

#[test]
fn an_older_campaign_is_judged_anew_case_by_case() {
    let (_place, folder) = older("campaign");
    let before = bytes(&folder);
    let (status, found, err) = rejudged(&folder, &[]);
    let judged = &found["judged"][0];
    assert_eq!((status, judged["cases"].as_array().map(Vec::len)), (3, Some(4)), "{found}{err}");
    assert_eq!(judged["cases"][0]["then"], "pass");
    // An unknown outcome is neither passed nor failed, also in a probability.
    let reasons = judged["reasons_now"].to_string();
    assert!(reasons.contains("4 of 4 cases hold too little for a pass"), "{reasons}");
    for check in judged["requirements"].as_array().unwrap() {
        assert_eq!(check["now"], "inconclusive", "{check}");
    }
    assert_eq!(bytes(&folder), before);
    let output = program(&["campaign", "status", folder.to_str().unwrap()]).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("4 of 4 cases: made with no numerics version"), "{said}");

    // A value over its limit with a stored pass: every other reader refuses the file, here it is
    // judged, and fails.
    let case = judged["cases"][0]["case"].as_str().unwrap();
    let path = octant_campaign::store::file(&folder, case);
    let mut result: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    result["summary"]["navigation"]["radial_error_nmi"]["max"] = 4711.0.into();
    std::fs::write(&path, result.to_string()).unwrap();
    let (status, found, _) = rejudged(&folder, &[]);
    assert_eq!((status, &found["judged"][0]["now"]), (1, &json!("fail")), "{found}");
    let turned = found["judged"][0]["cases"].as_array().unwrap();
    assert!(turned.iter().any(|one| one["case"] == case && one["now"] == "fail"), "{turned:?}");
    // A file that isn't a result is named.
    std::fs::write(&path, "{}").unwrap();
    let (status, _, err) = rejudged(&folder, &[]);
    assert!(status == 2 && err.contains(case), "{err}");
}

#[test]
fn what_this_program_made_comes_to_the_same_again() {
    for (requirement, status, verdict) in [(TOO_NEAR, 1, "fail"), ("", 0, "none")] {
        let folder = run(requirement);
        let (found_status, found, _) = rejudged(&folder.path().join("run"), &[]);
        let judged = &found["judged"][0];
        assert_eq!(
            (found_status, &judged["then"], &judged["now"]),
            (status, &json!(verdict), &json!(verdict))
        );
        assert_eq!((&judged["not_stored"], &judged["numerics"]), (&json!([]), &json!([])));
        assert_eq!(judged["reasons_then"], judged["reasons_now"]);
    }
}

#[test]
fn the_numerics_version_is_wherever_a_number_is() {
    let folder = run("");
    let read =
        |path: PathBuf| -> Value { serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap() };
    for name in ["summary.json", "manifest.json"] {
        assert_eq!(read(folder.path().join("run").join(name))["numerics"], NUMERICS, "{name}");
    }
    // No version number turns altered bits into expected ones: neither in one of the two files, nor
    // in both.
    let run_folder = folder.path().join("run");
    let verify = |more: &[&str]| {
        let output =
            program(&[&["verify", run_folder.to_str().unwrap()], more].concat()).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
    };
    let anew = |numerics: u32, in_manifest: u32| {
        let path = run_folder.join("summary.json");
        let mut summary = read(path.clone());
        summary["numerics"] = numerics.into();
        summary["calibration"]["nis_mean"] = 3.0.into();
        let bytes = summary.to_string();
        std::fs::write(path, &bytes).unwrap();
        let path = run_folder.join("manifest.json");
        let mut manifest = read(path.clone());
        manifest["numerics"] = in_manifest.into();
        for file in manifest["files"].as_array_mut().unwrap() {
            if file["path"] == "summary.json" {
                use sha2::{Digest, Sha256};
                let sha256: String =
                    Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
                file["blake3"] = blake3::hash(bytes.as_bytes()).to_hex().as_str().into();
                file["sha256"] = sha256.into();
                file["bytes"] = bytes.len().into();
            }
        }
        std::fs::write(path, manifest.to_string()).unwrap();
    };
    anew(NUMERICS + 1, NUMERICS);
    let (status, said) = verify(&[]);
    assert!(status == 1 && said.contains("manifest.json has numerics version"), "{said}");
    anew(NUMERICS + 1, NUMERICS + 1);
    let (status, said) = verify(&["--reexecute"]);
    assert!(status == 1 && said.contains("nis_mean"), "{said}");

    let small = CAMPAIGN.replace("replicates = 40", "replicates = 2");
    let bench = Bench::new(&small);
    let plan = bench.plan();
    let out = bench.at("out");
    plan.write(&out, false).unwrap();
    bench.octant(&["campaign", "run", "out"]);
    bench.octant(&["campaign", "merge", "out"]);
    let id = plan.cases[0].id.as_str();
    let mut result = results::value(&out, id);
    assert_eq!(result["summary"]["numerics"], NUMERICS);
    let table =
        octant_campaign::table::ExistingTable::open(&octant_campaign::merge::merged(&out, "cases"))
            .unwrap();
    let column = table.column("numerics").unwrap().unwrap();
    let expected = octant_campaign::table::ColumnValue::Integer(NUMERICS.into());
    assert_eq!(column.at(0), Some(expected));

    // A part of another version isn't merged with one of this version, which is reported before any
    // number.
    let other = bench.at("other");
    copy(&out, &other);
    result["summary"]["numerics"] = (NUMERICS + 1).into();
    result["summary_blake3"] = case::hash_of_summary(&result["summary"]).into();
    results::put(&other, id, &result.to_string());
    std::fs::remove_dir_all(other.join("parts")).unwrap();
    bench.octant(&["campaign", "run", "other"]);
    let output = bench.octant(&["campaign", "merge", "out", "other"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    let told = format!("case {} is of another numerics version", plan.cases[0].id);
    assert!(said.contains(&told) && said.contains("other/parts"), "{said}");

    // A result of another version with other numbers is no alteration; one of this version is.
    bench.octant(&["campaign", "report", "out"]);
    for (version, status, told) in
        [(NUMERICS, 1, "latitude_error_arcmin.rms"), (NUMERICS + 1, 3, "bits can't")]
    {
        result["summary"]["numerics"] = version.into();
        result["summary"]["navigation"]["latitude_error_arcmin"]["rms"] = 0.001.into();
        result["summary_blake3"] = case::hash_of_summary(&result["summary"]).into();
        results::put(&out, id, &result.to_string());
        for name in ["cases", "checks", "drift"] {
            std::fs::remove_file(octant_campaign::merge::merged(&out, name)).unwrap_or(());
        }
        bench.octant(&["campaign", "report", "out"]);
        let output = bench.octant(&["verify", "out", "--reexecute", "all"]);
        let said = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(status), "{version}: {said}");
        assert!(said.contains(told), "{version}: {said}");
    }
}
