//! Verdicts, the form of the summary, JUnit.

use crate::common::{judged, requirement, silent, summary};
use octant_account::{Account, AccountEntry, Weight};
use octant_score::judge::{Finding, FindingSubject, NO_REQUIREMENT, derive, judge, judge_by};
use octant_score::junit::junit;
use octant_score::rederive::{contradictions, rejudge};
use octant_score::summary::{Summary, SummaryError};
use octant_score::verdict::{MeasureError, evaluate, measure};
use octant_score::work::Work;
use octant_verdict::{Comparison, Verdict};
use proptest::prelude::*;

#[test]
fn exit_codes_are_those_of_the_contract() {
    let codes: Vec<u8> = Verdict::ALL.iter().map(|v| v.exit_code()).collect();
    assert_eq!(codes, [0, 0, 3, 1, 4], "none, pass, inconclusive, fail, error");
}

fn any_verdict() -> impl Strategy<Value = Verdict> {
    prop::sample::select(Verdict::ALL.to_vec())
}

proptest! {
    #[test]
    fn the_worst_wins_in_any_order_and_grouping(
        a in any_verdict(), b in any_verdict(), c in any_verdict(),
    ) {
        prop_assert_eq!(a.worst(b), b.worst(a));
        prop_assert_eq!(a.worst(b).worst(c), a.worst(b.worst(c)));
        prop_assert_eq!(a.worst(a), a);
        prop_assert_eq!(a.worst(Verdict::None), a);
        prop_assert_eq!(a.worst(Verdict::Error), Verdict::Error);
    }

    #[test]
    fn findings_can_only_make_a_run_worse(
        verdicts in prop::collection::vec(any_verdict(), 0..6), limit in 0.0..2.0f64,
    ) {
        let findings: Vec<Finding> = verdicts
            .iter()
            .map(|&verdict| Finding {
                verdict,
                about: FindingSubject::Run,
                reason: "so it was".to_owned(),
            })
            .collect();
        let required =
            [requirement("navigation.longitude_error_arcmin.max", Comparison::AtMost, limit)];
        let alone = judged(&required, &[]).verdict;
        let with = judged(&required, &findings).verdict;
        let worst = verdicts.iter().copied().max().unwrap_or(Verdict::Pass);
        prop_assert_eq!(with, alone.worst(worst));
    }

    #[test]
    fn a_margin_is_positive_where_a_limit_is_kept(limit in -2.0..2.0f64, comparison in
        prop::sample::select(vec![Comparison::AtMost, Comparison::Below, Comparison::AtLeast,
            Comparison::Above]),
    ) {
        let summary =
            judged(&[requirement("navigation.longitude_error_arcmin.final", comparison, limit)], &[]);
        let result = &summary.requirements[0];
        prop_assert_eq!(result.value, Some(-0.6));
        prop_assert_eq!(result.margin.unwrap() > 0.0, result.verdict == Verdict::Pass);
        prop_assert_eq!(summary.verdict, result.verdict);
    }
}

#[test]
fn on_the_limit_at_most_holds_and_below_does_not() {
    let at = |comparison| {
        judged(&[requirement("navigation.radial_error_nmi.rate_per_h", comparison, 0.8)], &[])
            .verdict
    };
    assert_eq!(at(Comparison::AtMost), Verdict::Pass);
    assert_eq!(at(Comparison::AtLeast), Verdict::Pass);
    assert_eq!(at(Comparison::Below), Verdict::Fail);
    assert_eq!(at(Comparison::Above), Verdict::Fail);
}

#[test]
fn a_measure_that_is_not_there_is_inconclusive_and_says_what_is() {
    let result = |path: &str| {
        judged(&[requirement(path, Comparison::AtMost, 1.0)], &[]).requirements[0].clone()
    };
    for (path, reason) in [
        (
            "navigation.latitude_error_arcmin.maximum",
            "navigation.latitude_error_arcmin has no `maximum`; it has final, max, rms, schuler_amplitude, slope_per_day",
        ),
        (
            "navigation.latitude_error_arcmin.slope_per_day",
            "navigation.latitude_error_arcmin.slope_per_day is null: the run doesn't have it",
        ),
        ("baseline.navigation.radial_error_nmi.max", "baseline is null: the run doesn't have it"),
        ("navigation.height", "navigation.height is not a number"),
        ("seed.more", "seed is a value and has no `more`"),
    ] {
        let found = result(path);
        assert_eq!(found.verdict, Verdict::Inconclusive);
        assert_eq!(found.reason.as_deref(), Some(reason));
        assert_eq!((found.value, found.margin), (None, None));
    }
    let limitless = requirement("navigation.radial_error_nmi.max", Comparison::AtMost, f64::NAN);
    assert_eq!(judged(&[limitless], &[]).verdict, Verdict::Inconclusive);
}

#[test]
fn bars_take_the_magnitude() {
    let value = serde_json::to_value(summary()).unwrap();
    assert_eq!(measure("navigation.latitude_error_arcmin.final", &value), Ok(-0.6));
    assert_eq!(measure("|navigation.latitude_error_arcmin.final|", &value), Ok(0.6));
}

#[test]
fn a_run_of_which_nothing_is_asked_is_none_and_no_pass() {
    let summary = judged(&[], &[]);
    assert_eq!(summary.verdict, Verdict::None);
    assert_eq!(summary.reasons, [NO_REQUIREMENT]);
    let xml = junit(&summary, None).unwrap();
    let document = roxmltree::Document::parse(&xml).unwrap();
    let skipped = document.descendants().find(|node| node.has_tag_name("skipped")).unwrap();
    assert_eq!(skipped.attribute("message"), Some(NO_REQUIREMENT));
}

/// Makes a summary with planned and completed work.
fn worked(navigation_s: f64) -> Summary {
    let planned = Work { navigation_s: Some(3600.0), ..Work::default() };
    let done = Work { navigation_s: Some(navigation_s), ..planned };
    Summary { planned: Some(planned), done: Some(done), ..summary() }
}

const LONGITUDE: &str = "navigation.longitude_error_arcmin.max";

#[test]
fn what_falls_short_of_its_plan_passes_nothing_and_says_both() {
    let at_most = |measure: &str, limit| requirement(measure, Comparison::AtMost, limit);
    let mut short = worked(1.0);
    judge(&mut short, &[at_most(LONGITUDE, 1.0)], &[]).unwrap();
    assert_eq!(short.verdict, Verdict::Inconclusive);
    let text = "navigation: planned 1 h, done 1 s";
    assert_eq!(
        short.reasons,
        [text.to_owned(), format!("NAV-1: met as far as it was done ({text})")]
    );
    assert_eq!(short.requirements[0].verdict, Verdict::Inconclusive);
    // A violated requirement stays violated.
    judge(&mut short, &[at_most(LONGITUDE, 0.5)], &[]).unwrap();
    assert_eq!(short.verdict, Verdict::Fail);
    // Requirements on a completed part aren't affected.
    judge(&mut short, &[at_most("calibration.nis_mean", 4.0)], &[]).unwrap();
    assert_eq!(short.requirements[0].verdict, Verdict::Pass);
    assert_eq!(short.verdict, Verdict::Inconclusive);
    let mut whole = worked(3600.0);
    judge(&mut whole, &[at_most(LONGITUDE, 1.0)], &[]).unwrap();
    assert_eq!(whole.verdict, Verdict::Pass);
}

#[test]
fn after_the_bench_failed_nothing_is_judged_but_what_was_broken_before() {
    let late = || [Finding::of_bench(Verdict::Inconclusive, "a sample left late".to_owned())];
    let gone = || [Finding::of_bench(Verdict::Error, "the disk is full".to_owned())];
    let final_error = "|navigation.longitude_error_arcmin.final|";
    let at = |measure: &str, limit, findings: &[Finding]| {
        let mut judged = worked(1800.0);
        judge(&mut judged, &[requirement(measure, Comparison::AtMost, limit)], findings).unwrap();
        assert!(judged.reasons.contains(&findings[0].reason), "both facts are told");
        (judged.verdict, judged.requirements[0].verdict)
    };
    let (open, fail, error) = (Verdict::Inconclusive, Verdict::Fail, Verdict::Error);
    // A violated maximum stays violated, whatever followed; a met one isn't a pass.
    assert_eq!(at(LONGITUDE, 0.5, &late()), (fail, fail));
    assert_eq!(at(LONGITUDE, 0.5, &gone()), (fail, fail));
    assert_eq!(at(LONGITUDE, 1.0, &late()), (open, open));
    assert_eq!(at(LONGITUDE, 1.0, &gone()), (error, open));
    // A measure that could still have improved isn't held against the unit.
    assert_eq!(at(final_error, 0.5, &late()), (open, open));
    // A later refusal isn't either.
    let mut refused = worked(0.0);
    refused.calibration.as_mut().unwrap().refused = Some("no".to_owned());
    judge(&mut refused, &[], &late()).unwrap();
    assert_eq!(refused.verdict, open);
}

/// An account makes a run inconclusive by a finding: who takes the finding away contradicts the account.
#[test]
fn a_doubt_in_an_account_is_a_finding() {
    let at_most = |measure: &str, limit| requirement(measure, Comparison::AtMost, limit);
    let doubtful = AccountEntry::new(3, "rows without a time").weight(Weight::Doubt);
    let account = Account::new("unit.csv", ["row", "rows"]).used(9).left_out(doubtful);
    let [doubt] = account.doubts().try_into().unwrap();
    let mut told = Summary { inputs: vec![account], ..worked(3600.0) };
    let finding = Finding::of_bench(Verdict::Inconclusive, doubt.clone());
    judge(&mut told, &[at_most(LONGITUDE, 1.0)], &[finding]).unwrap();
    assert_eq!((told.verdict, contradictions(&told)), (Verdict::Inconclusive, vec![]));
    let mut silent = told.clone();
    judge(&mut silent, &[at_most(LONGITUDE, 1.0)], &[]).unwrap();
    silent.findings.clear();
    assert_eq!(silent.verdict, Verdict::Pass);
    assert_eq!(contradictions(&silent), [format!("its findings don't tell that {doubt}")]);
    let again = rejudge(&silent, &[]).unwrap().summary;
    assert_eq!(again.verdict, Verdict::Inconclusive);
    assert!(again.reasons.contains(&doubt), "{:?}", again.reasons);
}

#[test]
fn within_the_uncertainty_of_the_reference_nothing_is_shown() {
    // The longitude's maximum is 0.75.
    let at = |limit, uncertainty: Result<f64, String>| {
        let mut judged = summary();
        let asked = requirement(LONGITUDE, Comparison::AtMost, limit);
        judge_by(&mut judged, &[asked], &[], |_| uncertainty.clone()).unwrap();
        // Every reader derives the same.
        let read = Summary::from_json(&judged.to_json().unwrap()).unwrap();
        assert_eq!(derive(&read).verdict, judged.verdict);
        (judged.verdict, judged.reasons.join("; "))
    };
    let (pass, open, fail) = (Verdict::Pass, Verdict::Inconclusive, Verdict::Fail);
    assert_eq!(at(1.0, Ok(0.0)).0, pass);
    assert_eq!(at(1.0, Ok(0.2)).0, pass);
    assert_eq!(at(0.8, Ok(0.1)).0, open);
    assert_eq!(at(0.7, Ok(0.1)).0, open);
    assert_eq!(at(0.5, Ok(0.1)).0, fail);
    let (_, told) = at(0.8, Ok(0.1));
    assert!(told.contains("is 0.75, which its reference, uncertain by 0.1, can't tell"), "{told}");
    assert_eq!(at(1.0, Err("nobody says".to_owned())), (open, "NAV-1: nobody says".to_owned()));
}

#[test]
fn an_answer_that_may_not_be_fails_whatever_was_met_before() {
    let wrong = Finding::of_unit(Verdict::Fail, "the answer to sample 3: nis is -1".to_owned());
    let mut judged = summary();
    let met = requirement(LONGITUDE, Comparison::AtMost, 1.0);
    judge(&mut judged, std::slice::from_ref(&met), std::slice::from_ref(&wrong)).unwrap();
    assert_eq!(judged.verdict, Verdict::Fail);
    assert_eq!(judged.requirements[0].verdict, Verdict::Inconclusive);
    judge(&mut judged, &[], &[wrong]).unwrap();
    assert_eq!(judged.verdict, Verdict::Fail);
}

#[test]
fn a_verdict_that_was_altered_is_derived_anew() {
    let asked = requirement(LONGITUDE, Comparison::AtMost, 0.5);
    let mut altered = summary();
    judge(&mut altered, &[asked], &[]).unwrap();
    let honest = derive(&altered);
    assert_eq!((honest.verdict, &honest.reasons), (Verdict::Fail, &altered.reasons));
    altered.verdict = Verdict::Pass;
    altered.reasons.clear();
    altered.requirements[0].verdict = Verdict::Pass;
    altered.requirements[0].margin = Some(0.1);
    assert_eq!(derive(&altered), honest);
}

#[test]
fn a_summary_of_before_findings_is_read_and_is_never_better_than_it_said() {
    let mut old = summary();
    judge(&mut old, &[requirement(LONGITUDE, Comparison::AtMost, 1.0)], &[]).unwrap();
    old.schema = 1;
    old.verdict = Verdict::Inconclusive;
    let read = Summary::from_json(&old.to_json().unwrap()).unwrap();
    assert_eq!(derive(&read).verdict, Verdict::Inconclusive);
}

#[test]
fn a_refused_calibration_fails_and_a_silent_fault_is_inconclusive() {
    let mut refused = summary();
    refused.calibration.as_mut().unwrap().refused = Some("mean NIS 40 is above 9".to_owned());
    judge(&mut refused, &[], &[]).unwrap();
    assert_eq!(refused.verdict, Verdict::Fail);
    assert_eq!(refused.reasons[0], "calibration of eight refused: mean NIS 40 is above 9");

    let mut silent = summary();
    silent.faults.push(self::silent());
    judge(&mut silent, &[], &[]).unwrap();
    assert_eq!(silent.verdict, Verdict::Inconclusive);
}

#[test]
fn a_summary_survives_its_file_and_a_newer_schema_is_refused() {
    let mut summary = judged(&[requirement("seed", Comparison::AtLeast, 1.0)], &[]);
    summary.scenario = "a \"[1, 2]\" \\ [3, 4]".to_owned();
    let text = summary.to_json().unwrap();
    assert_eq!(Summary::from_json(&text).unwrap(), summary);
    assert_eq!(text, summary.to_json().unwrap());
    assert!(text.contains("[0.0,0.0,0.0],\n"), "a point of the series has one line");
    let order = ["schema", "octant", "scenario", "seed", "verdict", "requirements", "stream_hash"];
    let places: Vec<_> = order.map(|key| text.find(&format!("\n  \"{key}\"")).unwrap()).into();
    assert!(places.is_sorted(), "the order of the fields is that of the type");
    let other = text.replacen("\"schema\": 3", "\"schema\": 4", 1);
    assert_eq!(Summary::from_json(&other), Err(SummaryError::Schema { found: 4 }));
    assert!(matches!(Summary::from_json("{}"), Err(SummaryError::Form(_))));
}

#[test]
fn junit_names_what_each_case_verifies_and_passes_nothing_inconclusive() {
    let xml = junit(
        &judged(
            &[
                requirement("navigation.longitude_error_arcmin.max", Comparison::AtMost, 0.5),
                requirement("navigation.nothing", Comparison::AtMost, 0.5),
                requirement("navigation.radial_error_nmi.max", Comparison::AtMost, 5.0),
            ],
            &[],
        ),
        None,
    )
    .unwrap();
    let document = roxmltree::Document::parse(&xml).unwrap();
    let cases: Vec<_> = document.descendants().filter(|n| n.has_tag_name("testcase")).collect();
    let kinds: Vec<Option<&str>> = cases
        .iter()
        .map(|case| {
            case.children()
                .find(|c| c.has_tag_name("failure") || c.has_tag_name("error"))
                .and_then(|c| c.attribute("type"))
        })
        .collect();
    assert_eq!(kinds, [Some("fail"), Some("inconclusive"), None, Some("fail")]);
    let outputs = document.descendants().filter(|n| n.has_tag_name("system-out"));
    let verifies: Vec<_> = outputs
        .filter_map(|n| n.text().unwrap().lines().next())
        .filter(|line| line.starts_with("[[PROPERTY|verifies="))
        .collect();
    assert_eq!(verifies, ["[[PROPERTY|verifies=NAV-1]]"; 3]);
}

#[test]
fn figures_are_short_unless_they_look_alike() {
    let found = |value: f64, limit| {
        let requirement = requirement("v", Comparison::AtMost, limit);
        evaluate(&requirement, &serde_json::json!({ "v": value })).figures()
    };
    let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
    assert_eq!(found(0.180_326_271_973_461_98, 0.01), pair("0.180326", "0.01"));
    assert_eq!(found(3.000_000_001, 3.0), pair("3.000000001", "3"));
}

/// Paths that lead nowhere in a summary.
#[test]
fn names_that_are_left_out_are_counted() {
    let told = |more: usize| {
        let (place, key, there) = ("a".to_owned(), "b".to_owned(), vec!["c".to_owned()]);
        MeasureError::Missing { place, key, there, more }.to_string()
    };
    assert_eq!(told(0), "a has no `b`; it has c");
    assert_eq!(told(3), "a has no `b`; it has c and 3 more");
}
