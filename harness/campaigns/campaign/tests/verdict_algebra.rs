//! No mix of incomplete evidence ends in a pass: for a run, a campaign, and its trace.
//!
//! `verdict.rs` tests the algebra of two verdicts and of a run's own parts one by one, and the
//! crate of requirements that of counts; here the parts come in any mix, on the types that programs
//! use.

use octant_base::control::Control;
use octant_campaign::execute::Shard;
use octant_campaign::execute::case::{self, CaseResult};
use octant_campaign::judge::status;
use octant_campaign::judge::trace;
use octant_campaign::plan::requirements::Planned;
use octant_campaign::plan::{self, Case, CaseLimits, Plan, PlannedScenario, StopRule};
use octant_campaign::store::{self, StoreOutcome};
use octant_realtime::schedule::{Granted, RequestOutcome};
use octant_run::TimeKeeping;
use octant_run::{StreamKeeping, assemble, run_method};
use octant_scenario::{Method, Scenario};
use octant_score::judge::{Finding, FindingSubject, derive, except_requirements, judge};
use octant_score::summary::{
    BaselineMethod, CalibrationScore, ErrorScore, FaultResult, HealthCounts, HeightChannel,
    LatenessQuantiles, NavigationScore, PacingRecord, RadialScore, Summary,
};
use octant_statistics::proportion::Demand;
use octant_verdict::requirement::{
    self as required, Check, EnsembleRequirement, Limit, Requirements, Verification,
};
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{Comparison, Verdict};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn any_verdict() -> impl Strategy<Value = Verdict> {
    prop::sample::select(Verdict::ALL.to_vec())
}

/// Folds verdicts in any order, with repetitions.
fn worst_of(verdicts: impl IntoIterator<Item = Verdict>) -> Verdict {
    verdicts.into_iter().fold(Verdict::None, Verdict::worst)
}

proptest! {
    #[test]
    fn the_worst_is_the_least_upper_bound_of_any_mix(
        (all, mixed) in prop::collection::vec(any_verdict(), 0..12)
            .prop_flat_map(|all| (Just(all.clone()), Just(all).prop_shuffle())),
        again in any::<prop::sample::Index>(),
        other in any_verdict(),
    ) {
        let worst = worst_of(all.iter().copied());
        // Order and repetition change nothing.
        prop_assert_eq!(worst, worst_of(mixed.iter().copied()));
        if !all.is_empty() {
            let twice = all.iter().copied().chain([all[again.index(all.len())]]);
            prop_assert_eq!(worst, worst_of(twice));
        }
        // No verdict is worse than it, and no upper bound is better.
        prop_assert!(all.iter().all(|v| *v <= worst));
        if all.iter().all(|v| *v <= other) {
            prop_assert!(worst <= other);
        }
        // A worse part never improves the whole.
        for at in 0..all.len() {
            let mut worse = all.clone();
            worse[at] = worse[at].worst(other);
            prop_assert!(worst_of(worse) >= worst);
        }
    }
}

/// Result of a requirement in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Found {
    Kept,
    Broken,
    NoMeasure,
    NotANumber,
}

/// Parts of a run with a summary.
#[derive(Clone, Debug)]
struct Parts {
    checks: Vec<Found>,
    findings: Vec<Verdict>,
    fired: Vec<bool>,
    refused: bool,
    /// Second method: whether its faults fired, and whether it was refused.
    baseline: Option<(Vec<bool>, bool)>,
}

fn parts() -> impl Strategy<Value = Parts> {
    // Mostly good, so that a good whole occurs.
    let found = prop_oneof![
        8 => Just(Found::Kept),
        2 => Just(Found::Broken),
        1 => Just(Found::NoMeasure),
        1 => Just(Found::NotANumber),
    ];
    let finding = prop::sample::select(Verdict::ALL[2..].to_vec());
    let findings = prop_oneof![4 => Just(Vec::new()), 1 => prop::collection::vec(finding, 1..3)];
    let fired = || prop::collection::vec(prop::bool::weighted(0.85), 0..3);
    let refused = || prop::bool::weighted(0.1);
    let checks = prop::collection::vec(found, 0..3);
    (checks, findings, fired(), refused(), prop::option::of((fired(), refused()))).prop_map(
        |(checks, findings, fired, refused, baseline)| Parts {
            checks,
            findings,
            fired,
            refused,
            baseline,
        },
    )
}

impl Parts {
    fn is_whole(&self) -> bool {
        let fired = |faults: &[bool]| faults.iter().all(|fired| *fired);
        self.findings.is_empty()
            && fired(&self.fired)
            && !self.refused
            && self.baseline.as_ref().is_none_or(|(faults, _)| fired(faults))
    }

    fn summary(&self) -> Summary {
        let fault = |fired: &bool| FaultResult {
            id: "f".to_owned(),
            kind: "spike".to_owned(),
            armed: true,
            fired: *fired,
            first_sample: None,
            last_sample: None,
            samples_altered: 0,
            firings: 0,
            clean_crc32: None,
            faulted_crc32: None,
            largest_change: None,
        };
        let calibration = |refused: bool| CalibrationScore {
            reference: None,
            solution: None,
            positions: "eight".to_owned(),
            estimator: "kalman".to_owned(),
            duration_h: 4.0,
            parameters: BTreeMap::new(),
            further: BTreeMap::new(),
            nis_mean: None,
            nis_expected: None,
            rest: None,
            nees: BTreeMap::new(),
            worst_normalized_error: None,
            least_gain: None,
            refused: refused.then(|| "so it was".to_owned()),
            refusal_explained: Vec::new(),
            health: HealthCounts::default(),
            sigma_hours: Vec::new(),
        };
        let slope_per_day = Some(f64::NAN);
        let score = ErrorScore {
            max: 0.75,
            rms: 0.4,
            r#final: -0.6,
            slope_per_day,
            schuler_amplitude: None,
        };
        let mut summary = Summary {
            schema: octant_score::summary::SCHEMA,
            octant: "0.1.0".to_owned(),
            numerics: None,
            scenario: "s".to_owned(),
            seed: 1,
            verdict: Verdict::Pass,
            reasons: Vec::new(),
            requirements: Vec::new(),
            findings: Vec::new(),
            decision: None,
            planned: None,
            done: None,
            faults: self.fired.iter().map(fault).collect(),
            inputs: Vec::new(),
            altered_streams: None,
            method: "eight".to_owned(),
            followed: None,
            false_alarms: None,
            heading: None,
            calibration: Some(calibration(self.refused)),
            navigation: Some(NavigationScore {
                duration_h: 1.0,
                height: HeightChannel::Held,
                latitude_error_arcmin: Some(score),
                longitude_error_arcmin: Some(score),
                radial_error_nmi: Some(RadialScore {
                    max: 1.0,
                    rms: 0.5,
                    r#final: 0.9,
                    rate_per_h: 0.8,
                }),
                heading_output: None,
                heading_error_arcmin: None,
                pitch_error_arcmin: None,
                roll_error_arcmin: None,
                velocity_north_error_mps: None,
                velocity_east_error_mps: None,
                slope_window: None,
                marks: BTreeMap::new(),
                gaps: None,
                series_hours: Vec::new(),
            }),
            alignment: None,
            counterfactual: None,
            baseline: self.baseline.as_ref().map(|(fired, refused)| BaselineMethod {
                planned: None,
                done: None,
                followed: None,
                label: "six".to_owned(),
                calibration: Some(calibration(*refused)),
                navigation: None,
                alignment: None,
                counterfactual: None,
                stream_hash: "00".to_owned(),
                faults: fired.iter().map(fault).collect(),
            }),
            reference: None,
            allan_deviation: None,
            pacing: None,
            stream_hash: "00".to_owned(),
        };
        let requirements: Vec<LimitCheck> = self.checks.iter().map(Found::requirement).collect();
        let finding = |verdict: &Verdict| Finding {
            verdict: *verdict,
            about: FindingSubject::Run,
            reason: "x".to_owned(),
        };
        let findings: Vec<Finding> = self.findings.iter().map(finding).collect();
        judge(&mut summary, &requirements, &findings).unwrap();
        summary
    }
}

impl Found {
    /// All of them check the same requirement.
    fn requirement(&self) -> LimitCheck {
        let (measure, limit) = match self {
            Self::Kept => ("navigation.longitude_error_arcmin.max", 1.0),
            Self::Broken => ("navigation.longitude_error_arcmin.max", 0.5),
            Self::NoMeasure => ("navigation.nothing", 1.0),
            Self::NotANumber => ("navigation.longitude_error_arcmin.slope_per_day", 1.0),
        };
        let measure = measure.to_owned();
        LimitCheck {
            id: "NAV-1".to_owned(),
            measure,
            comparison: Comparison::AtMost,
            limit,
            secant_latitude: false,
        }
    }

    fn verdict(self) -> Verdict {
        match self {
            Self::Kept => Verdict::Pass,
            Self::Broken => Verdict::Fail,
            Self::NoMeasure | Self::NotANumber => Verdict::Inconclusive,
        }
    }
}

proptest! {
    #[test]
    fn a_run_is_as_good_as_the_worst_of_its_parts(parts in parts()) {
        let summary = parts.summary();
        let checks = parts.checks.iter().map(|found| found.verdict());
        let silent = if parts.is_whole() { Verdict::None } else { Verdict::Inconclusive };
        let refused = if parts.refused { Verdict::Fail } else { Verdict::None };
        let expected = worst_of(checks.chain(parts.findings.iter().copied()).chain([silent, refused]));
        prop_assert_eq!(summary.verdict, expected);
        // Every verdict except a pass has a reason.
        prop_assert!(summary.verdict == Verdict::Pass || !summary.reasons.is_empty());
        // A failed requirement doesn't hide other problems.
        let good = parts.is_whole() && !parts.checks.is_empty();
        prop_assert_eq!(except_requirements(&summary) == Verdict::Pass, good);
        // Storing and reading again doesn't either.
        let read = Summary::from_json(&summary.to_json().unwrap()).unwrap();
        prop_assert_eq!(except_requirements(&read), except_requirements(&summary));
        // The verdict and the reasons can be derived again, also from the file.
        for summary in [&summary, &read] {
            let derived = derive(summary);
            prop_assert_eq!((derived.verdict, derived.reasons), (summary.verdict, summary.reasons.clone()));
        }
    }
}

/// Outcome of a case of a campaign.
#[derive(Clone, Debug)]
enum Came {
    Missing,
    Broken,
    Ran(Parts),
    /// Ran twice, with two results.
    Differs(Parts),
    /// The file holds the result of another case.
    Foreign(Parts),
}

fn outcome() -> impl Strategy<Value = Came> {
    prop_oneof![
        1 => Just(Came::Missing),
        1 => Just(Came::Broken),
        30 => parts().prop_map(Came::Ran),
        1 => parts().prop_map(Came::Differs),
        1 => parts().prop_map(Came::Foreign),
    ]
}

fn good() -> impl Strategy<Value = Came> {
    let fired = || prop::collection::vec(Just(true), 0..3);
    let check = prop::sample::select(vec![Found::Kept, Found::Broken]);
    (check, fired()).prop_map(|(check, fired)| {
        let (findings, refused, baseline) = (Vec::new(), false, None);
        Came::Ran(Parts { checks: vec![check], findings, fired, refused, baseline })
    })
}

fn result(id: &str, scenario: &PlannedScenario, case: &Case, parts: &Parts) -> CaseResult {
    // Every case has a stream of its own, so it is a draw of its own.
    let (seed, stream_hash) = (case.seed, id.to_owned());
    let summary = Summary { seed, stream_hash, ..parts.summary() };
    CaseResult::of(id, Some(case::hash_of(scenario, case)), summary).unwrap()
}

/// Makes a campaign in a folder, and its requirements.
fn campaign(
    folder: &Path,
    outcomes: &[Came],
    ensemble: Option<EnsembleRequirement>,
) -> (Plan, Requirements) {
    let planned = PlannedScenario {
        id: "s".to_owned(),
        file: PathBuf::from("s.toml"),
        blake3: String::new(),
        requirements: vec!["NAV-1".to_owned()],
        checks: Vec::new(),
        files: Default::default(),
    };
    let case = |i: usize| Case {
        id: "0123456789abcdef".parse().unwrap(),
        scenario: "s".into(),
        seed: i as u64,
        replicate: i as u32,
        set: Default::default(),
        faults: None,
        factors: Default::default(),
    };
    let id = |i: usize| case::hash_of(&planned, &case(i))[..16].to_owned();
    let cases = (0..outcomes.len()).map(|i| Case { id: id(i).parse().unwrap(), ..case(i) });
    let plan = Plan {
        bundled: None,
        copies: None,
        schema: plan::SCHEMA,
        id: String::new(),
        title: "t".to_owned(),
        campaign: PathBuf::from("c.toml"),
        limits: CaseLimits { time_s: 1.0, memory_mib: 1 },
        stop: None,
        looks: Default::default(),
        seed_from_plan: false,
        factors: Vec::new(),
        requirements: vec![Planned { check: Found::Kept.requirement(), ensemble }],
        not_by_test: Vec::new(),
        accounts: Vec::new(),
        scenarios: vec![planned.clone()],
        cases: cases.collect(),
    };
    let keep = |i: usize, result: &CaseResult| {
        store::keep(folder, &id(i), result.to_json().unwrap().as_bytes()).unwrap()
    };
    for (i, outcome) in outcomes.iter().enumerate() {
        match outcome {
            Came::Missing => {}
            Came::Broken => _ = keep(i, &CaseResult::broken(&id(i), "gone".to_owned())),
            Came::Ran(parts) => _ = keep(i, &result(&id(i), &planned, &case(i), parts)),
            Came::Differs(parts) => {
                let mut other = result(&id(i), &planned, &case(i), parts);
                keep(i, &other);
                other.verdict = Verdict::Error;
                other.error = Some("another".to_owned());
                assert!(matches!(keep(i, &other), StoreOutcome::Differs(_)));
            }
            Came::Foreign(parts) => {
                _ = keep(i, &result("ffffffffffffffff", &planned, &case(i), parts))
            }
        }
    }
    let check = Check {
        measure: Found::Kept.requirement().measure,
        comparison: Comparison::AtMost,
        limit: Limit::Number(1.0),
        secant_latitude: false,
        ensemble,
    };
    let requirement = required::Requirement::new("NAV-1", "Near.", Verification::Test(check));
    let requirements = Requirements {
        title: "T".to_owned(),
        requirements: vec![requirement],
        ..Requirements::default()
    };
    (plan, requirements)
}

fn ensemble() -> impl Strategy<Value = Option<EnsembleRequirement>> {
    // A weak requirement on the ensemble, which a few cases can show.
    let weak = (0.01f64..0.4, 0.01f64..0.6)
        .prop_map(|(pass, confidence)| EnsembleRequirement { pass, confidence });
    prop::option::of(weak)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn a_campaign_passes_on_whole_evidence_alone(
        outcomes in prop_oneof![
            prop::collection::vec(outcome(), 0..6),
            prop::collection::vec(good(), 1..6),
            // One bad case among good ones.
            (prop::collection::vec(good(), 1..5), outcome()).prop_map(|(mut all, one)| {
                all.push(one);
                all
            }),
        ],
        ensemble in ensemble(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let (plan, requirements) = campaign(folder.path(), &outcomes, ensemble);
        // A result that belongs to another case is an error, and nothing is judged.
        let status = status::of(&plan, folder.path(), Shard::WHOLE);
        let trace = trace::trace(&plan, &requirements, folder.path(), plan.cases.len());
        let foreign = outcomes.iter().any(|outcome| matches!(outcome, Came::Foreign(_)));
        prop_assert_eq!((status.is_err(), trace.is_err()), (foreign, foreign));
        let (Ok(status), Ok(trace)) = (status, trace) else { return Ok(()) };

        // If a requirement is checked more than once in a run, all checks must hold; with a
        // requirement on the ensemble, a failed or inconclusive check or a refused calibration is
        // allowed: they count as not passed.
        let shown = |parts: &Parts| {
            let parts = &Parts { refused: parts.refused && ensemble.is_none(), ..parts.clone() };
            let worst = parts.checks.iter().map(|found| found.verdict()).max();
            parts.is_whole()
                && worst.is_some_and(|worst| {
                    worst == Verdict::Pass || (worst <= Verdict::Fail && ensemble.is_some())
                })
        };
        let whole = !outcomes.is_empty()
            && outcomes.iter().all(|outcome| matches!(outcome, Came::Ran(parts) if shown(parts)));
        if status.verdict() == Verdict::Pass {
            prop_assert!(whole, "{outcomes:?}");
            prop_assert_eq!(trace.verdict(), Verdict::Pass);
        }
        // The trace judges requirements alone: with a requirement on the ensemble, an inconclusive
        // run counts as not passed. A missing case or a failed bench never passes.
        if trace.verdict() == Verdict::Pass {
            let ran = outcomes.iter().all(|outcome| matches!(outcome, Came::Ran(_)));
            prop_assert!(whole || (ran && ensemble.is_some()), "{outcomes:?}");
        }
        // Complete evidence does pass.
        if whole && ensemble.is_none() {
            prop_assert_eq!(status.verdict(), Verdict::Pass);
        }
        // Requirement that no case checks, beside the others.
        let mut more = plan;
        more.requirements.push(Planned {
            check: LimitCheck { id: "NAV-2".to_owned(), ..Found::Kept.requirement() },
            ensemble,
        });
        let with = status::of(&more, folder.path(), Shard::WHOLE).unwrap().verdict();
        prop_assert!(with >= Verdict::Inconclusive);
        prop_assert!(with >= status.verdict());
    }
}

#[test]
fn checks_that_come_to_nothing_show_nothing_broken_and_end_nothing() {
    let without = Parts {
        checks: vec![Found::NoMeasure],
        findings: Vec::new(),
        fired: Vec::new(),
        refused: false,
        baseline: None,
    };
    let required = EnsembleRequirement { pass: 0.95, confidence: 0.9 };
    let folder = tempfile::tempdir().unwrap();
    let (mut plan, _) =
        campaign(folder.path(), &vec![Came::Ran(without.clone()); 40], Some(required));
    let demand = Demand { pass: required.pass, confidence: required.confidence };
    plan.stop = Some(StopRule { requirement: "NAV-1".to_owned(), demand, every: 5 });
    let status = status::of(&plan, folder.path(), Shard::WHOLE).unwrap();
    let found = &status.requirements["NAV-1"];
    assert_eq!(found.verdict, Verdict::Inconclusive, "{}", found.reason);
    assert_eq!((found.draws.not_passed, found.draws.unknown), (40, 40));
    assert!(
        found.reason.contains("40 independent draws came to nothing; case "),
        "{}",
        found.reason
    );
    assert_eq!((status.stopped.clone(), status.cases), (None, 40));
    // They count against a claim that it is kept: 60 draws that passed would be enough.
    let kept = Parts { checks: vec![Found::Kept], ..without.clone() };
    let folder = tempfile::tempdir().unwrap();
    let mut outcomes = vec![Came::Ran(kept); 60];
    outcomes.extend(vec![Came::Ran(without.clone()); 10]);
    let (plan, _) = campaign(folder.path(), &outcomes, Some(required));
    let status = status::of(&plan, folder.path(), Shard::WHOLE).unwrap();
    assert_eq!(status.requirements["NAV-1"].verdict, Verdict::Inconclusive);
    // Failures among them still show that it is broken, and end the campaign.
    let broken = Parts { checks: vec![Found::Broken], ..without };
    let folder = tempfile::tempdir().unwrap();
    let (mut plan, _) = campaign(folder.path(), &vec![Came::Ran(broken); 40], Some(required));
    plan.stop = Some(StopRule { requirement: "NAV-1".to_owned(), demand, every: 5 });
    let status = status::of(&plan, folder.path(), Shard::WHOLE).unwrap();
    assert_eq!(status.requirements["NAV-1"].verdict, Verdict::Fail);
    assert!(status.stopped.is_some() && status.cases == 5, "{:?}", status.stopped);
}

#[test]
fn a_failure_that_an_ensemble_allows_hides_no_silent_fault() {
    // Each of these runs violates the requirement, as some may; any other problem of one of them
    // must be reported.
    let bad = |findings: Vec<Verdict>, baseline| Parts {
        checks: vec![Found::Broken],
        findings,
        fired: vec![true],
        refused: false,
        baseline,
    };
    let good = Parts { checks: vec![Found::Kept], ..bad(Vec::new(), None) };
    let allowed = Some(EnsembleRequirement { pass: 0.2, confidence: 0.5 });
    let verdict = |one: Parts| {
        let folder = tempfile::tempdir().unwrap();
        let mut outcomes = vec![Came::Ran(good.clone()); 9];
        outcomes.push(Came::Ran(one));
        let (plan, _) = campaign(folder.path(), &outcomes, allowed);
        status::of(&plan, folder.path(), Shard::WHOLE).unwrap().verdict()
    };
    assert_eq!(verdict(bad(Vec::new(), None)), Verdict::Pass);
    assert_eq!(verdict(bad(vec![Verdict::Inconclusive], None)), Verdict::Inconclusive);
    assert_eq!(verdict(bad(vec![Verdict::Error], None)), Verdict::Error);
    assert_eq!(verdict(bad(Vec::new(), Some((vec![false], false)))), Verdict::Inconclusive);
    assert_eq!(
        verdict(Parts { fired: vec![false], ..bad(Vec::new(), None) }),
        Verdict::Inconclusive
    );
    // Checked twice, and only the second check fails.
    let twice = Parts { checks: vec![Found::Kept, Found::Broken], ..good.clone() };
    let folder = tempfile::tempdir().unwrap();
    let (plan, _) = campaign(folder.path(), &[Came::Ran(twice)], None);
    let status = status::of(&plan, folder.path(), Shard::WHOLE).unwrap();
    assert_eq!(status.verdict(), Verdict::Fail);
}

fn lateness(p99: f64) -> LatenessQuantiles {
    LatenessQuantiles { p50: 0.0, p99, p999: p99, max: p99 }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn a_run_by_the_clock_that_lost_anything_shows_nothing(
        overruns in prop_oneof![Just(0u64), 1..100u64],
        p99_us in prop_oneof![Just(1.0), 400.0..900.0f64],
        late_answers in prop_oneof![Just(0u64), 1..9u64],
        missed_answers in prop_oneof![Just(0u64), 1..9u64],
        not_sent in prop_oneof![Just(0u64), 1..9u64],
        dropped_records in prop_oneof![Just(0u64), 1..9u64],
        in_baseline in any::<bool>(),
    ) {
        let text = "schema = 1\n[procedure.navigation]\nduration = \"4 s\"\n\
                    [realtime]\nlateness_p99 = \"500 us\"\n\
                    [[requirements]]\nid = \"A\"\ntext = \"x\"\n\
                    measure = \"navigation.radial_error_nmi.max\"\nlimit = \"10 nmi\"\n";
        let scenario = Scenario::parse(text, "f", Path::new(""), &[]).unwrap();
        let run = || {
            run_method(&scenario, Method::Primary, 1, StreamKeeping::None, &Control::default()).unwrap()
        };
        let (mut primary, mut baseline) = (run(), run());
        let pacing = PacingRecord {
            frames: 800,
            period_us: 5000.0,
            lateness_us: lateness(p99_us),
            lateness_histogram_ns: Vec::new(),
            lateness_over_run: None,
            overrun_us: 5000.0,
            overruns,
            overruns_in_a_row: overruns,
            first_overrun: (overruns > 0).then_some(1),
            slack_p1_us: 100.0,
            answer_us: lateness(1.0),
            late_answers,
            missed_answers,
            not_sent,
            device_clock: None,
            dropped_records,
        };
        let side = if in_baseline { &mut baseline } else { &mut primary };
        let granted = Granted {
            scheduling: RequestOutcome::NotAsked,
            memory: RequestOutcome::NotAsked,
            cpu: RequestOutcome::NotAsked,
        };
        side.bench.kept = Some(TimeKeeping { pacing, granted });
        let lost = overruns + late_answers + missed_answers + not_sent + dropped_records > 0
            || p99_us > 500.0;
        let summary = assemble(&scenario, 1, primary, Some(baseline)).unwrap().summary;
        let expected = if lost { Verdict::Inconclusive } else { Verdict::Pass };
        prop_assert_eq!(summary.verdict, expected, "{:?}", summary.reasons);
        prop_assert_eq!(except_requirements(&summary), expected);
    }
}

#[test]
fn a_baseline_that_was_interrupted_shows_nothing() {
    let text = "schema = 1\n[procedure.navigation]\nduration = \"4 s\"\n\
                [[requirements]]\nid = \"A\"\ntext = \"x\"\n\
                measure = \"navigation.radial_error_nmi.max\"\nlimit = \"10 nmi\"\n";
    let scenario = Scenario::parse(text, "f", Path::new(""), &[]).unwrap();
    let run = || {
        run_method(&scenario, Method::Primary, 1, StreamKeeping::None, &Control::default()).unwrap()
    };
    let mut baseline = run();
    baseline.ended = octant_run::Ended::Cancelled;
    let summary = assemble(&scenario, 1, run(), Some(baseline)).unwrap().summary;
    assert_eq!(summary.verdict, Verdict::Inconclusive, "{:?}", summary.reasons);
}
