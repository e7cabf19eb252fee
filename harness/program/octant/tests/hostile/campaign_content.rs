//! Attacks on the plan, the results and the evidence of a campaign.

use super::campaigns::{edit, forge, out, says, verify};
use crate::campaign_looks::Looked;
use crate::campaign_report::bench::{check, put, synthetic};
use crate::common::results;
use serde_json::Value;

pub(super) fn chooses_a_seed_in_the_plan() -> (i32, String) {
    let looked = Looked::of(3, "");
    let seed = looked.plan.seed().unwrap();
    edit(&out(&looked, "plan.json"), |text| {
        text.replace(&format!("\"seed\": {seed}"), "\"seed\": 5")
    });
    says(&looked, &["campaign", "status", "out"])
}

/// Seeds of the cases are chosen, and the plan has the id of its new content.
pub(super) fn chooses_a_seed_and_an_id() -> (i32, String) {
    let looked = Looked::of(2, "");
    let given = Looked::of(2, "seed = 5\n");
    edit(&out(&given, "plan.json"), |text| {
        text.replace("\"factors\"", "\"seed_from_plan\": true,\n  \"factors\"")
    });
    // The id that its content gives, as the refusal names it only in part: the seed is refused before.
    drop(looked);
    says(&given, &["campaign", "status", "out"])
}

pub(super) fn takes_a_case_out_of_the_plan() -> (i32, String) {
    let looked = Looked::of(22, "");
    looked.fill(0..22, &[21]);
    edit(&out(&looked, "plan.json"), |text| {
        let last = text.rfind("    {\n      \"id\"").unwrap();
        text[..last].trim_end().trim_end_matches(',').to_owned() + "\n  ]\n}\n"
    });
    says(&looked, &["campaign", "status", "out"])
}

/// A plan without the failing draw is made of the file, in the folder with its result.
pub(super) fn plans_fewer_draws_afterwards() -> (i32, String) {
    let looked = Looked::of(23, "seed = 1\n");
    looked.fill(0..23, &[22]);
    edit(&looked.bench.at("campaign.toml"), |text| {
        text.replace("replicates = 23", "replicates = 22")
    });
    says(&looked, &["campaign", "plan", "campaign.toml", "--out", "out", "--extend"])
}

pub(super) fn leaves_a_failing_case_without_a_result() -> (i32, String) {
    let looked = Looked::of(22, "");
    looked.fill(0..21, &[]);
    says(&looked, &["campaign", "report", "out"]).1.contains("inconclusive").then_some(()).unwrap();
    verify(&looked);
    let said = looked.bench.read("report.html");
    (3, said)
}

/// Another result of the failing case is stored beside the first.
pub(super) fn repeats_a_case_until_it_passes() -> (i32, String) {
    let looked = Looked::of(22, "");
    looked.fill(0..22, &[]);
    let (folder, id) = (looked.bench.at("out"), looked.plan.cases[3].id.to_string());
    let passes = results::text(&folder, &id);
    results::remove(&folder, &id);
    looked.fill(3..4, &[3]);
    results::put_beside(&folder, &id, &passes);
    says(&looked, &["campaign", "status", "out"])
}

/// The result of a draw that passes is stored for one that fails.
pub(super) fn copies_a_result_of_another_draw() -> (i32, String) {
    let looked = Looked::of(22, "");
    looked.fill(0..21, &[]);
    let (from, to) = (&looked.plan.cases[0], &looked.plan.cases[21]);
    let mut result = synthetic(&looked.plan, 0, from);
    result["summary"]["faults"] = serde_json::json!([]);
    let checks = result["summary"]["requirements"].as_array_mut().unwrap();
    checks.retain(|check| check["id"] == "NAV-1");
    check(&mut result, "NAV-1", 1.0, 10.0);
    result["case"] = to.id.as_str().into();
    put(&looked.bench.at("out"), to, &result);
    says(&looked, &["campaign", "report", "out"])
}

pub(super) fn edits_statistics() -> (i32, String) {
    let looked = failed();
    edit(&out(&looked, "statistics.json"), |text| {
        text.replacen("\"verdict\": \"inconclusive\"", "\"verdict\": \"pass\"", 1)
    });
    forge(&looked);
    verify(&looked)
}

/// A reported campaign that isn't shown.
pub(super) fn failed() -> Looked {
    let looked = Looked::of(22, "");
    looked.fill(0..22, &[3]);
    looked.octant(&["campaign", "report", "out"], 3);
    looked
}

pub(super) fn edits_the_page() -> (i32, String) {
    let looked = failed();
    edit(&out(&looked, "report.html"), |text| text.replace("21 of 22", "22 of 22"));
    verify(&looked)
}

pub(super) fn edits_junit() -> (i32, String) {
    let looked = failed();
    edit(&out(&looked, "junit.xml"), |text| text.replace("errors=\"2\"", "errors=\"0\""));
    verify(&looked)
}

pub(super) fn edits_the_verdict_of_the_manifest() -> (i32, String) {
    let looked = failed();
    edit(&out(&looked, "manifest.json"), |text| {
        let mut manifest: Value = serde_json::from_str(&text).unwrap();
        manifest["campaign"]["verdict"] = "pass".into();
        format!("{manifest:#}\n")
    });
    verify(&looked)
}

pub(super) fn edits_the_limit_of_a_requirement() -> (i32, String) {
    let looked = Looked::of(22, "");
    looked.fill(0..22, &[3]);
    edit(&looked.bench.at("requirements.toml"), |text| text.replace("10 nmi", "20 nmi"));
    says(&looked, &["campaign", "trace", "out"])
}

/// A part with results of another plan.
pub(super) fn adds_a_part_of_another_plan() -> (i32, String) {
    let looked = Looked::of(22, "");
    looked.fill(0..21, &[]);
    let other = Looked::of(22, "seed = 77\n");
    other.fill(0..22, &[]);
    let from = other.bench.at("out/results");
    for entry in std::fs::read_dir(from).unwrap().flatten() {
        let name = format!("other-{}", entry.file_name().to_string_lossy());
        std::fs::copy(entry.path(), looked.bench.at("out/results").join(name)).unwrap();
    }
    says(&looked, &["campaign", "report", "out"])
}
