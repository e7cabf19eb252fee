//! Trace in both directions, and that nothing passes that wasn't shown.

use octant_statistics::cluster::DrawCounts;
use octant_verdict::Comparison;
use octant_verdict::Verdict;
use octant_verdict::requirement::{
    Check, EnsembleRequirement, Limit, Requirement, Requirements, Verification,
};
use octant_verdict::trace::{
    CampaignTrace, GrowingTrace, TracedCase, TracedResult, VerdictCounts, judge,
};
use proptest::prelude::*;

fn tested(id: &str, ensemble: Option<EnsembleRequirement>) -> Requirement {
    let check = Check {
        measure: "navigation.radial_error_nmi.max".to_owned(),
        comparison: Comparison::AtMost,
        limit: Limit::Quantity("1 nmi".to_owned()),
        secant_latitude: false,
        ensemble,
    };
    Requirement::new(id, "It stays close.", Verification::Test(check))
}

fn document(requirements: Vec<Requirement>) -> Requirements {
    Requirements { title: "T".to_owned(), requirements, ..Requirements::default() }
}

fn case(id: &str, checks: &[(&str, Verdict)]) -> TracedCase {
    let checks: Vec<(String, Verdict)> =
        checks.iter().map(|(id, verdict)| ((*id).to_owned(), *verdict)).collect();
    TracedCase {
        id: id.to_owned(),
        draw: id.bytes().fold(0, |draw, byte| 256 * draw + usize::from(byte)),
        verifies: checks.iter().map(|(id, _)| id.clone()).collect(),
        result: Some(TracedResult {
            verdict: checks.iter().map(|(_, v)| *v).max().unwrap_or(Verdict::Pass),
            checks,
            recording: Some(format!("runs/{id}/recording.mcap")),
            folder: Some(format!("runs/{id}")),
        }),
    }
}

#[test]
fn the_trace_goes_both_ways() {
    let requirements = document(vec![
        tested("A", None),
        tested("B", None),
        tested("C", None),
        Requirement::new("D", "x", Verification::Analysis),
        Requirement::new("E", "x", Verification::Open),
    ]);
    let mut planned = case("c4", &[("B", Verdict::Pass)]);
    planned.result = None;
    let cases = [
        case("c1", &[("A", Verdict::Pass), ("B", Verdict::Pass)]),
        case("c2", &[("A", Verdict::Fail), ("X", Verdict::Pass)]),
        case("c3", &[]),
        planned,
    ];
    let trace = CampaignTrace::new(&requirements, &cases);
    assert_eq!(trace.without_case, ["C", "E"]);
    assert_eq!(trace.without_requirement, ["c3"]);
    assert_eq!(
        (trace.unknown[0].case.as_str(), trace.unknown[0].requirement.as_str()),
        ("c2", "X")
    );
    let row = |id: &str| trace.requirements.iter().find(|row| row.id == id).unwrap();
    assert_eq!(row("A").verdict, Some(Verdict::Fail));
    assert_eq!(row("A").cases[1].recording.as_deref(), Some("runs/c2/recording.mcap"));
    assert_eq!(row("B").verdict, Some(Verdict::Inconclusive));
    assert_eq!(row("B").reason, "0 of 2 checks are inconclusive, 1 missing");
    assert_eq!(
        (row("C").verdict, row("C").reason.as_str()),
        (Some(Verdict::Inconclusive), "no case verifies it")
    );
    assert_eq!(row("D").verdict, None);
    assert_eq!(trace.of_case("c1"), [("A", Some(Verdict::Pass)), ("B", Some(Verdict::Pass))]);
    assert_eq!(trace.of_case("c4"), [("B", None)]);
    assert_eq!(trace.verdict(), Verdict::Fail);
}

#[test]
fn nothing_shows_nothing() {
    assert_eq!(CampaignTrace::new(&document(vec![]), &[]).verdict(), Verdict::Inconclusive);
    let analysed = document(vec![Requirement::new("D", "x", Verification::Analysis)]);
    assert_eq!(CampaignTrace::new(&analysed, &[]).verdict(), Verdict::Inconclusive);
    // A run tells nothing about tests outside of it, either.
    let tests = Verification::Tests(vec!["a.rs::b".to_owned(), "c".to_owned()]);
    let trace = CampaignTrace::new(&document(vec![Requirement::new("T", "x", tests)]), &[]);
    assert_eq!((trace.verdict(), trace.requirements[0].verdict), (Verdict::Inconclusive, None));
    assert!(trace.requirements[0].reason.ends_with("no run can tell: a.rs::b; c"));
    assert_eq!(trace.requirements[0].verification, "test");
    // An unknown requirement was meant to be verified by something.
    let one = document(vec![tested("A", None)]);
    let cases = [case("c1", &[("A", Verdict::Pass), ("B", Verdict::Pass)])];
    assert_eq!(CampaignTrace::new(&one, &cases).verdict(), Verdict::Inconclusive);
    assert_eq!(
        CampaignTrace::new(&one, &[case("c1", &[("A", Verdict::Pass)])]).verdict(),
        Verdict::Pass
    );
    assert_eq!(one.get("A").map(|found| found.id.as_str()), Some("A"));
    assert_eq!(one.get("B"), None);
    // The case should verify the requirement, but didn't check it.
    let mut unchecked = case("c1", &[]);
    unchecked.verifies.push("A".to_owned());
    assert_eq!(CampaignTrace::new(&one, &[unchecked]).verdict(), Verdict::Inconclusive);
    // If a requirement is checked twice in a case, the worst check counts.
    let twice = case("c1", &[("A", Verdict::Fail), ("A", Verdict::Pass)]);
    assert_eq!(CampaignTrace::new(&one, &[twice]).verdict(), Verdict::Fail);
}

#[test]
fn an_ensemble_passes_by_its_bound() {
    let demand = Some(EnsembleRequirement { pass: 0.95, confidence: 0.95 });
    let judged = |pass, fail, inconclusive, missing| {
        let counts = VerdictCounts { pass, fail, inconclusive, missing, error: 0 };
        let rows = pass + fail + inconclusive + missing;
        let not_passed = fail + inconclusive;
        judge(
            demand,
            counts,
            DrawCounts { passed: pass, not_passed, unknown: inconclusive, open: missing, rows },
        )
    };
    let verdict = |pass, fail| judged(pass, fail, 0, 0).0;
    assert_eq!(verdict(59, 0), Verdict::Pass);
    assert_eq!(verdict(58, 0), Verdict::Inconclusive);
    // One failure takes 93 runs: 0.95^93 + 93 · 0.05 · 0.95^92 is the first sum below 5 %.
    assert_eq!(verdict(91, 1), Verdict::Inconclusive);
    assert_eq!(verdict(92, 1), Verdict::Pass);
    assert_eq!(verdict(50, 10), Verdict::Fail);
    assert_eq!(verdict(0, 1), Verdict::Inconclusive);
    // Inconclusive runs count against a pass: they neither block it for ever nor support it. They never prove a
    // failure.
    assert_eq!(judged(91, 0, 1, 0).0, Verdict::Inconclusive);
    assert_eq!(judged(92, 0, 1, 0).0, Verdict::Pass);
    assert_eq!(judged(50, 0, 10, 0).0, Verdict::Inconclusive);
    assert_eq!(judged(0, 0, 100, 0).0, Verdict::Inconclusive);
    assert!(judged(0, 0, 100, 0).1.ends_with("; 100 independent draws came to nothing"));
    assert_eq!(judged(50, 10, 1, 0).0, Verdict::Fail);
    assert_eq!(judged(1000, 0, 0, 1).0, Verdict::Inconclusive);
    // 9 of 64 checks are there: two draws have all of theirs.
    let counts = VerdictCounts { pass: 9, missing: 55, ..VerdictCounts::default() };
    let draws = DrawCounts { passed: 2, not_passed: 0, unknown: 0, open: 14, rows: 64 };
    let told = judge(demand, counts, draws).1;
    assert!(told.starts_with("2 of 2 independent draws passed in all of their checks: "), "{told}");
    // One of three draws failed in one of its four checks: the other two have eight.
    let counts = VerdictCounts { pass: 11, fail: 1, ..VerdictCounts::default() };
    let draws = DrawCounts { passed: 2, not_passed: 1, unknown: 0, open: 0, rows: 12 };
    let told = judge(demand, counts, draws).1;
    assert!(told.starts_with("2 of 3 independent draws passed in all of their checks: "), "{told}");
    let counts = VerdictCounts { pass: 1000, error: 1, ..VerdictCounts::default() };
    let draws = DrawCounts { passed: 1000, not_passed: 1, unknown: 0, open: 0, rows: 1001 };
    assert_eq!(judge(demand, counts, draws).0, Verdict::Error);
    assert_eq!(
        judged(59, 0, 0, 0).1,
        "59 of 59 independent draws passed: with 95.00 % confidence a draw passes with a probability \
         of at least 95.04 %, required 95.00 %"
    );
}

#[test]
fn a_trace_of_the_first_cases_counts_all() {
    let requirements = document(vec![tested("A", None), tested("B", None)]);
    let cases: Vec<TracedCase> = (0..9)
        .map(|i| {
            let verdict = if i == 7 { Verdict::Fail } else { Verdict::Pass };
            case(&format!("c{i}"), &[("A", verdict)])
        })
        .collect();
    let whole = CampaignTrace::new(&requirements, &cases);
    let mut growing = GrowingTrace::new(&requirements, 2);
    cases.iter().for_each(|case| growing.add(case));
    let mut first = growing.trace();
    assert_eq!(whole.requirements[0].cases.len(), 9);
    assert_eq!(whole.requirements[0].counts.all(), 9);
    assert_eq!(whole.requirements[0].verdict, Some(Verdict::Fail));
    // All is the same, but for the links.
    assert_eq!(first.requirements[0].cases, whole.requirements[0].cases[..2]);
    first.requirements[0].cases = whole.requirements[0].cases.clone();
    assert_eq!(first, whole);
    assert_eq!(first.without_case, ["B"]);
}

#[test]
fn rows_are_not_draws() {
    let demand = Some(EnsembleRequirement { pass: 0.95, confidence: 0.95 });
    let one = document(vec![tested("A", demand)]);
    let judged = |cases: u64, of: &dyn Fn(u64) -> usize| {
        let cases: Vec<TracedCase> = (0..cases)
            .map(|i| TracedCase { draw: of(i), ..case(&format!("c{i}"), &[("A", Verdict::Pass)]) })
            .collect();
        let row = CampaignTrace::new(&one, &cases).requirements.remove(0);
        (row.verdict.unwrap(), row.reason)
    };
    // One replicate with 59 labels, and five instruments at twelve longitudes.
    assert_eq!(judged(59, &|_| 0).0, Verdict::Inconclusive);
    let (verdict, reason) = judged(60, &|i| i as usize % 5);
    assert_eq!(verdict, Verdict::Inconclusive);
    assert!(
        reason
            .starts_with("5 of 5 independent draws passed in all of their 60 checks: with 95.00 %"),
        "{reason}"
    );
    // A valid counterpart: 59 instruments at twelve longitudes.
    assert_eq!(judged(59 * 12, &|i| i as usize / 12).0, Verdict::Pass);
}

fn verdict() -> impl Strategy<Value = Verdict> {
    prop::sample::select(Verdict::ALL.to_vec())
}

proptest! {
    #[test]
    fn only_passes_make_a_pass(
        all in prop::collection::vec(prop::option::of(verdict()), 0..80),
        ensemble in prop::option::of((0.01f64..0.999, 0.01f64..0.999)),
    ) {
        let ensemble = ensemble.map(|(pass, confidence)| EnsembleRequirement { pass, confidence });
        let requirements = document(vec![tested("A", ensemble)]);
        let cases: Vec<TracedCase> = all.iter().enumerate().map(|(i, verdict)| match verdict {
            Some(verdict) => case(&format!("c{i}"), &[("A", *verdict)]),
            None => TracedCase { id: format!("c{i}"), verifies: vec!["A".to_owned()], draw: usize::MAX - i, result: None },
        }).collect();
        let trace = CampaignTrace::new(&requirements, &cases);
        let counted = trace.requirements[0].counts;
        let sum = counted.pass + counted.inconclusive + counted.fail + counted.error + counted.missing;
        prop_assert_eq!(sum, all.len() as u64);
        if trace.verdict() == Verdict::Pass {
            prop_assert!(!all.is_empty());
            let worst = all.iter().map(|v| v.unwrap_or(Verdict::Error)).max();
            // With a required probability some may be inconclusive or fail, but no error or missing
            // check is allowed.
            prop_assert!(worst == Some(Verdict::Pass) || (ensemble.is_some() && worst <= Some(Verdict::Fail)));
        }
        if all.contains(&Some(Verdict::Error)) {
            prop_assert_eq!(trace.verdict(), Verdict::Error);
        }
        // A further failure never improves the verdict.
        let mut more = cases;
        more.push(case("more", &[("A", Verdict::Fail)]));
        prop_assert!(CampaignTrace::new(&requirements, &more).verdict() >= trace.verdict().max(Verdict::Pass)
            || ensemble.is_some());
    }
}
