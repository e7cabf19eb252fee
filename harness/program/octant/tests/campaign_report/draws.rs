//! The unit of inference is the independent draw: designs that claim more draws than they have, and
//! honest ones beside them.

use super::bench::{Bench, SCENARIO, check};
use octant_campaign::judge::status;
use octant_campaign::judge::stop::StopDecision;
use octant_campaign::merge;
use octant_campaign::merge::results;
use octant_campaign::plan::{Case, Plan};
use octant_verdict::Verdict;
use serde_json::{Value, json};
use std::path::PathBuf;

const ASKED: &str = "schema = 1
title = \"Requirements\"
[[requirements]]
id = \"NAV-1\"
text = \"The position stays near.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"10 nmi\"
pass = \"95 %\"
confidence = \"95 %\"
";

/// Renders a campaign of a number of replicates with one factor.
fn campaign(replicates: u32, factor: &str) -> String {
    format!(
        "schema = 1\ntitle = \"draws\"\nseed = 1\nreplicates = {replicates}\n\
         requirements = \"requirements.toml\"\n[[scenarios]]\nid = \"short\"\nfile = \"short.toml\"\n{factor}"
    )
}

fn factor(key: &str, values: impl Iterator<Item = String>) -> String {
    let values: Vec<String> = values.map(|value| format!("{value:?}")).collect();
    format!("[[factors]]\nname = \"of\"\nkey = {key:?}\nvalues = [{}]\n", values.join(", "))
}

/// Makes a folder with the campaign's requirements, without faults and requirements of the
/// scenario's own.
fn bench(campaign: &str) -> Bench {
    let bench = Bench::new(campaign);
    let scenario = SCENARIO.split("[[faults]]").next().unwrap();
    std::fs::write(bench.at("short.toml"), scenario).unwrap();
    std::fs::write(bench.at("requirements.toml"), ASKED).unwrap();
    bench
}

fn filled(campaign: &str, change: impl Fn(usize, &Case, &mut Value)) -> (Bench, Plan, PathBuf) {
    bench(campaign).fill(|index, case, result| {
        result["summary"]["faults"] = json!([]);
        let checks = result["summary"]["requirements"].as_array_mut().unwrap();
        checks.retain(|check| check["id"] == "NAV-1");
        check(result, "NAV-1", 1.0, 10.0);
        change(index, case, result);
    })
}

/// Marks the calibration of a case as refused.
fn refuse(result: &mut Value) {
    let summary = &mut result["summary"];
    summary["calibration"]["refused"] = "the mean NIS is 5".into();
    summary["navigation"] = Value::Null;
    let method = summary["method"].as_str().unwrap().to_owned();
    for check in summary["requirements"].as_array_mut().unwrap() {
        check["verdict"] = "inconclusive".into();
        check["value"] = Value::Null;
        check["margin"] = Value::Null;
        check["reason"] = "there is no such measure".into();
    }
    summary["verdict"] = "fail".into();
    summary["reasons"] = json!([
        format!("calibration of {method} refused: the mean NIS is 5"),
        "NAV-1: there is no such measure"
    ]);
    result["verdict"] = "fail".into();
}

fn nav(bench: &Bench) -> Value {
    bench.statistics()["requirements"][0].clone()
}

#[test]
fn one_replicate_with_59_labels_is_one_draw_and_a_finding() {
    let labels = factor("title", (1..=59).map(|label| format!("label {label}")));
    let (bench, plan, _) = filled(&campaign(1, &labels), |_, _, result| {
        result["summary"]["stream_hash"] = "a".repeat(64).into();
    });
    assert_eq!(plan.cases.len(), 59);
    let (status, said) = bench.report();
    assert_eq!(status, 3, "{said}");
    let nav = nav(&bench);
    assert_eq!(nav["verdict"], "inconclusive");
    assert_eq!(nav["draws"], json!({"passed": 1, "not_passed": 0, "open": 0, "rows": 59}));
    let claim = nav["claim"].as_str().unwrap();
    assert!(
        claim.starts_with("1 of 1 independent draw passed in all of their 59 checks"),
        "{claim}"
    );
    let design: Vec<String> = (bench.statistics()["discrepancies"].as_array().unwrap().iter())
        .filter(|found| found["kind"] == "design")
        .map(|found| found["what"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(design.len(), 2, "{design:?}");
    assert!(design[0].starts_with("factor of changes nothing"), "{design:?}");
    assert!(design[1].starts_with("59 cases came to 1 stream:"), "{design:?}");
    // The figures of the drift count the draw once.
    assert!(bench.statistics()["combinations"].as_array().unwrap().iter().all(|c| c["draws"] == 1));
    let said = bench.octant(&["campaign", "status", "out"]).stdout;
    let said = String::from_utf8(said).unwrap();
    assert!(said.contains("  1 independent draw\n") && said.contains("changes nothing"), "{said}");
    assert!(said.contains("a new plan with 59 draws shows it with as many failures"), "{said}");
}

#[test]
fn instruments_with_the_same_stream_are_one_draw() {
    // Different seeds without effect: an instrument without errors and without noise.
    let (bench, _, _) = filled(&campaign(59, ""), |_, _, result| {
        result["summary"]["stream_hash"] = "b".repeat(64).into();
    });
    assert_eq!(bench.report().0, 3);
    assert_eq!(nav(&bench)["draws"]["passed"], 1);
    let combination = &bench.statistics()["combinations"][0];
    assert_eq!((combination["cases"].as_u64(), combination["draws"].as_u64()), (Some(59), Some(1)));
}

#[test]
fn five_instruments_at_twelve_longitudes_are_five_draws() {
    let longitudes = || factor("site.longitude", (0..12).map(|k| format!("{} deg", 30 * k - 160)));
    let (bench, plan, folder) = filled(&campaign(5, &longitudes()), |_, _, _| {});
    assert_eq!(plan.cases.len(), 60);
    assert_eq!(bench.report().0, 3);
    let found = nav(&bench);
    assert_eq!(found["draws"], json!({"passed": 5, "not_passed": 0, "open": 0, "rows": 60}));
    assert_eq!(
        (&found["verdict"], &found["needed_if_all_pass"]),
        (&json!("inconclusive"), &json!({"runs": 54}))
    );
    // The trace, computed separately, agrees.
    let trace = bench.octant(&["campaign", "trace", "out", "--json"]).stdout;
    let trace: Value = serde_json::from_slice(&trace).unwrap();
    assert_eq!(trace["requirements"][0]["draws"], found["draws"]);
    assert_eq!(trace["requirements"][0]["reason"], found["reason"]);
    drop((bench, folder));
    // The honest counterpart has 59 instruments.
    let (bench, _, _) = filled(&campaign(59, &longitudes()), |_, _, _| {});
    let (status, said) = bench.report();
    assert_eq!(status, 0, "{said}");
    assert_eq!(nav(&bench)["draws"]["passed"], 59);
    assert!(
        bench
            .read("report.html")
            .contains("59 of 59 independent draws passed in all of their 708 checks")
    );
}

#[test]
fn a_refused_calibration_counts_as_not_passed_everywhere() {
    // 93 draws with one failure show 95 % at 95 %: a refusal is one, and 92 aren't enough.
    for (replicates, verdict, needed) in [(92, "inconclusive", 1), (93, "pass", 0)] {
        let (bench, plan, folder) = filled(&campaign(replicates, ""), |index, _, result| {
            if index == 17 {
                refuse(result);
            }
        });
        let (status, said) = bench.report();
        assert_eq!(status, if verdict == "pass" { 0 } else { 3 }, "{said}");
        let found = nav(&bench);
        assert_eq!(
            (found["verdict"].as_str(), &found["needed_if_all_pass"]["runs"]),
            (Some(verdict), &json!(needed))
        );
        assert_eq!(found["draws"]["not_passed"], 1);
        assert_eq!(found["counts"]["inconclusive"], 1);
        assert!(bench.read("report.html").contains("refused"));
        let trace = bench.octant(&["campaign", "trace", "out", "--json"]).stdout;
        let trace: Value = serde_json::from_slice(&trace).unwrap();
        assert_eq!(trace["requirements"][0]["verdict"], verdict);
        // Beyond every number: the percentiles are those of all cases.
        let combination = &bench.statistics()["combinations"][0];
        assert_eq!(
            (&combination["navigated"], &combination["beyond"]),
            (&json!(replicates - 1), &json!(1))
        );
        assert!(combination["at_end"]["r95"]["value"].is_number());
        assert!(combination["at_end"]["drms"].is_null());
        let envelope = &combination["envelope"]["longitude_arcmin"];
        assert!(envelope[2][5].is_null() && envelope[4][5].is_number(), "{}", envelope[2][5]);
        drop((plan, folder));
    }
}

#[test]
fn a_percentile_that_falls_on_refused_cases_is_not_defined() {
    let (bench, _, _) = filled(&campaign(40, ""), |index, _, result| {
        if index < 4 {
            refuse(result);
        }
    });
    // 36 of 40 pass where 95 % are required.
    assert_eq!(bench.report().0, 3);
    let at_end = &bench.statistics()["combinations"][0]["at_end"];
    assert!(at_end["cep50"]["value"].is_number() && at_end["r95"]["value"].is_null(), "{at_end}");
    assert!(bench.read("report.html").contains("not defined"));
}

#[test]
fn a_stopping_rule_and_its_tables_count_alike() {
    let longitudes = factor("site.longitude", (0..3).map(|k| format!("{} deg", 30 * k)));
    let stop = "[stop]\nrequirement = \"NAV-1\"\npass = 0.8\nconfidence = 0.9\nevery = 30\n";
    for refused in [0, 1, 4] {
        let text = campaign(30, &(longitudes.clone() + stop));
        // The stop table comes before the tables of scenarios and factors.
        let (bench, plan, folder) = filled(&text, |index, _, result| {
            if index % 9 == 4 && index < 9 * refused {
                refuse(result);
            }
        });
        let rule = plan.stop.as_ref().unwrap();
        let by_results = status::decide(&plan, &folder, rule).unwrap();
        let part =
            |table: &str| merge::part(&folder, octant_campaign::execute::Shard::WHOLE, table);
        results::tables(&plan, &folder, 0..plan.cases.len(), part).unwrap();
        let end = merge::end(&plan, std::slice::from_ref(&folder)).unwrap();
        assert_eq!(end, by_results.end(plan.cases.len()));
        // 3 evaluations share 10 %: 0.8^n falls below a thirtieth at 16 draws, of three cases each.
        match refused {
            0 => assert_eq!(by_results, StopDecision::Shown { end: 60 }),
            1 => assert_eq!(by_results, StopDecision::Shown { end: 90 }),
            _ => assert_eq!(by_results, StopDecision::Open { next: 90 }),
        }
        let status = status::of(&plan, &folder, octant_campaign::execute::Shard::WHOLE).unwrap();
        assert_eq!(status.stopped.is_some(), refused < 2);
        assert_eq!(status.verdicts.get(Verdict::Fail.name()).copied().unwrap_or(0), refused);
        drop(bench);
    }
}

#[test]
fn equal_values_in_another_spelling_are_refused() {
    for (key, values) in [
        ("site.latitude", ["0 deg", "0 rad"]),
        ("site.latitude", ["1 deg", "60 arcmin"]),
        ("procedure.calibration.duration", ["1 h", "60 min"]),
        ("title", ["a", "a"]),
    ] {
        let of = factor(key, values.iter().map(|value| (*value).to_owned()));
        let error =
            Plan::of(&bench(&campaign(2, &of)).at("campaign.toml")).unwrap_err().to_string();
        assert!(error.contains("are the same") || error.contains("a second time"), "{error}");
    }
    let number = "[[factors]]\nname = \"of\"\nkey = \"seed\"\nvalues = [1, 1.0]\n";
    assert!(Plan::of(&bench(&campaign(2, number)).at("campaign.toml")).is_err());
    let of = factor("site.latitude", ["1 deg", "61 arcmin"].iter().map(|v| (*v).to_owned()));
    assert!(Plan::of(&bench(&campaign(2, &of)).at("campaign.toml")).is_ok());
}
