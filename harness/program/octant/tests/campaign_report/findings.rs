//! Problems of cases, missing evidence, and files that aren't of the plan.

use super::bench::{Bench, CAMPAIGN, SCENARIO, files, put, synthetic, troubled};
use crate::common::results;
use octant_campaign::plan::Plan;
use octant_campaign::report::CampaignReport;
use octant_evidence::discrepancy::Discrepancy;
use octant_verdict::Verdict;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn names_are_escaped() {
    let (bench, plan, out) = Bench::filled(CAMPAIGN, |_, _, _| {});
    assert_eq!(bench.report().0, 0);
    let page = bench.read("report.html");
    for text in ["T<script>", "short <i>", "amp <b>", "is <far> off", "<b>near</b>"] {
        assert!(!page.contains(text), "{text} is on the page as it is");
        assert!(
            page.contains(&text.replace('<', "&lt;").replace('>', "&gt;")),
            "{text} is missing"
        );
    }
    assert!(page.contains("DOC-1"), "what no run verifies is told");
    // One script on which no content depends, the numbers of the charts as data, and nothing from other hosts.
    let data = page.matches("type=\"application/json\">").count();
    assert_eq!((page.matches("<script>").count(), page.matches("<script").count()), (1, 1 + data));
    for outside in ["http://", "https://", "src=", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    // Every anchor that is linked exists.
    for link in page.split("href=\"#").skip(1) {
        let anchor = link.split('"').next().unwrap();
        assert!(page.contains(&format!("id=\"{anchor}\"")), "{anchor}");
    }
    // Each case has the command that shows its result.
    let shown: BTreeSet<&str> = page.split("title=\"octant campaign result out ").skip(1).collect();
    let shown: BTreeSet<&str> =
        shown.into_iter().map(|after| after.split('"').next().unwrap()).collect();
    assert_eq!(shown, plan.cases.iter().map(|case| case.id.as_str()).collect());
    let output = bench.octant(&["campaign", "result", "out", &plan.cases[7].id]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(said, results::text(&out, &plan.cases[7].id));
    let output = bench.octant(&["campaign", "result", "out", &plan.cases[7].id[..5]]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && said.contains(plan.cases[7].id.as_str()), "{said}");
    let xml = bench.read("junit.xml");
    assert!(xml.contains("T&lt;script"), "the title is escaped");
    assert_eq!(xml.matches("[[PROPERTY|verifies=").count(), 2 * 80 + 2);
    assert!(!xml.contains("<failure") && !xml.contains("<error"));
}

#[test]
fn what_is_wrong_with_cases_is_told_with_the_line_that_runs_them_again() {
    let (bench, plan, out) = Bench::filled(CAMPAIGN, troubled);
    // Second result of a case.
    results::put_beside(&out, &plan.cases[10].id, "{}\n");
    assert_eq!(bench.report().0, 4);
    let (page, statistics) = (bench.read("report.html"), bench.statistics());
    for index in [3, 5, 7, 10] {
        let line = format!("octant campaign case out {}", plan.cases[index].id);
        assert!(page.contains(&line), "case {index}");
    }
    assert!(page.contains("it took &lt;more&gt; than its 2 s"));
    let found: Vec<Discrepancy> = CampaignReport::of(&plan, &out).unwrap().statistics.discrepancies;
    let kinds: Vec<(&str, Verdict, usize)> =
        found.iter().map(|d| (d.kind, d.verdict, d.cases.len())).collect();
    assert_eq!(
        kinds,
        [
            ("requirement", Verdict::Error, 0),
            ("requirement", Verdict::Error, 0),
            ("two results", Verdict::Error, 1),
            ("check", Verdict::Fail, 1),
            ("error", Verdict::Error, 1),
            ("fault", Verdict::Inconclusive, 1),
        ]
    );
    assert!(page.contains("6 in all, <strong>6 without a disposition</strong>"));
    for found in &found {
        assert!(page.contains(&format!("id=\"{}\"", found.id)), "{}", found.what);
        assert_eq!(found.id.len(), 12);
    }
    let outlier = &statistics["outliers"][0];
    assert_eq!(outlier["case"], plan.cases[7].id.as_str());
    assert_eq!(outlier["measure"], "navigation.radial_error_nmi.rate_per_h");
    let xml = bench.read("junit.xml");
    assert!(xml.contains("<failure") && xml.contains("type=\"inconclusive\""));
}

#[test]
fn nothing_looks_like_a_pass_that_is_none() {
    let shows = |bench: &Bench, words: &str| {
        let (page, xml) = (bench.read("report.html"), bench.read("junit.xml"));
        assert!(page.contains(
            "<title>T&lt;script&gt;alert(1)&lt;/script&gt; &amp; co: inconclusive</title>"
        ));
        assert!(page.contains(words), "{words}");
        assert_eq!(bench.statistics()["verdict"], "inconclusive");
        // No requirement and no campaign is a success.
        let verified = xml.split("all cases together").nth(1);
        assert!(
            verified.is_none_or(|text| text
                .split("</testcase>")
                .next()
                .unwrap()
                .contains("<error"))
        );
        assert!(
            xml.contains("<error type=\"inconclusive\"") || xml.contains("type=\"inconclusive\"")
        );
    };
    // No case has run.
    let bench = Bench::new(CAMPAIGN);
    bench.plan().write(&bench.at("out"), false).unwrap();
    let (status, said) = bench.report();
    assert!(status == 3 && said.contains("inconclusive"), "{said}");
    shows(&bench, "80 cases have no result");

    // One case is missing among many that pass.
    let (bench, plan, out) = Bench::filled(CAMPAIGN, |_, _, _| {});
    results::remove(&out, &plan.cases[79].id);
    assert_eq!(bench.report().0, 3);
    shows(&bench, "1 case has no result");

    // Requirement that no case checks.
    let campaign =
        CAMPAIGN.replace("file = \"short.toml\"", "file = \"short.toml\"\nverifies = []");
    let (bench, ..) = Bench::filled(&campaign, |_, _, result| {
        let checks = result["summary"]["requirements"].as_array_mut().unwrap();
        checks.retain(|check| check["id"] != "NAV-1");
    });
    assert_eq!(bench.report().0, 3);
    let nav = &bench.statistics()["requirements"][1];
    assert_eq!(
        (nav["verdict"].as_str(), &nav["lower_bound"]),
        (Some("inconclusive"), &Value::Null)
    );
    let page = bench.read("report.html");
    assert!(page.contains("no case verifies it"));
    let missing = page.split("Requirements without a case").nth(1).unwrap();
    assert!(missing.split("</p>").next().unwrap().contains("NAV-1"));

    // A campaign without requirements, and one without cases.
    let bench = Bench::new(&CAMPAIGN.replace("requirements = \"requirements.toml\"\n", ""));
    let without = SCENARIO.split("[[requirements]]").next().unwrap();
    std::fs::write(bench.at("short.toml"), without).unwrap();
    let plan = bench.plan();
    plan.write(&bench.at("out"), false).unwrap();
    for (index, case) in plan.cases.iter().enumerate() {
        let mut result = synthetic(&plan, index, case);
        result["summary"]["requirements"] = json!([]);
        result["summary"]["verdict"] = "none".into();
        result["verdict"] = "inconclusive".into();
        put(&bench.at("out"), case, &result);
    }
    assert_eq!(bench.report().0, 3);
    shows(&bench, "no requirement is checked: nothing is shown");
    let empty = Plan { cases: Vec::new(), ..Bench::new(CAMPAIGN).plan() };
    let folder = tempfile::tempdir().unwrap();
    let report = CampaignReport::of(&empty, folder.path()).unwrap();
    assert_eq!(report.statistics.verdict, Verdict::Inconclusive);
    assert!(octant_campaign_pages::campaign::render(&report, true).contains("there is no case"));
    assert!(report.open() > 0);
}

#[test]
fn what_is_not_of_the_plan_is_refused_and_nothing_is_written() {
    let (bench, plan, out) = Bench::filled(CAMPAIGN, |_, _, _| {});
    results::put(&out, "0123456789abcdef", "{}");
    let before = files(&out);
    let (status, said) = bench.report();
    assert!(
        status == 2 && said.contains("results of 1 cases that the plan doesn't have"),
        "{said}"
    );
    assert!(files(&out) == before);
    results::remove(&out, "0123456789abcdef");
    results::put(&out, &plan.cases[0].id, "{\"schema\": 1");
    let (status, said) = bench.report();
    assert!(status == 4 && said.contains("expected the result of a case"), "{said}");
    assert!(!out.join("report.html").exists() && !out.join("manifest.json").exists());
    let (status, said) = {
        let output = bench.octant_with(
            &["campaign", "report", "out"],
            &[("OCTANT_SIGNING_KEY", Path::new("no/such/key"))],
        );
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert!(status == Some(2) && said.contains("no/such/key"), "{said}");
    // Table from earlier, when there were fewer cases.
    put(&out, &plan.cases[0], &synthetic(&plan, 0, &plan.cases[0]));
    octant_campaign::merge::results::tables(&plan, &out, 0..79, |table| {
        octant_campaign::merge::merged(&out, table)
    })
    .unwrap();
    assert_eq!(bench.report().0, 0);
    let page = bench.read("report.html");
    assert!(page.contains("cases.parquet has 79 cases and the folder 80 results"));
}
