//! A case that doesn't end, and one that panics.

use octant_selftest::judge::{CaseOutcome, CaseVerdict, Expectation, Known};
use octant_selftest::record::CaseRecord;
use octant_selftest::{COMPUTED_LIMIT, Case, cases, run};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

fn case(
    id: &'static str,
    limit: Duration,
    run: fn(&octant_selftest::bench::CaseBench<'_>) -> Outcome,
) -> Case {
    let known = vec![Known { name: "one".to_owned(), value: 1.0, tolerance: 1e-9 }];
    let expectation = Expectation::Numbers { known, source: "its definition" };
    Case { id, about: "A number.", expectation, limit, run }
}

type Outcome = Result<CaseOutcome, octant_selftest::error::CaseSetupError>;

fn one() -> Outcome {
    let numbers = [("one".to_owned(), 1.0)].into_iter().collect();
    Ok(CaseOutcome { status: Some(0), numbers, ..CaseOutcome::default() })
}

#[test]
fn a_case_that_computes_for_ever_fails_after_its_limit_and_the_others_go_on() {
    let all = [
        case("endless", Duration::from_millis(200), |_| {
            // As a search for a root does whose tolerance has become negative.
            let mut step = 1.0f64;
            while std::hint::black_box(step) >= 0.0 {
                step = 0.5 * step + f64::MIN_POSITIVE;
            }
            one()
        }),
        case("sound", COMPUTED_LIMIT, |_| one()),
    ];
    let started = Instant::now();
    let cancel = AtomicBool::new(false);
    let found = run(Path::new("octant"), &all, 1, &cancel, &|_: &CaseRecord| {}).unwrap();
    assert!(started.elapsed() < Duration::from_secs(60), "{:?}", started.elapsed());
    assert_eq!(found[0].verdict, CaseVerdict::Fail);
    assert!(found[0].found.contains("longer than its limit of 0.2 s"), "{}", found[0].found);
    assert_eq!(found[1].verdict, CaseVerdict::Pass, "{}", found[1].found);
}

#[test]
fn every_case_has_a_limit() {
    for case in cases() {
        assert!(
            case.limit > Duration::ZERO && case.limit <= Duration::from_secs(3600),
            "{}",
            case.id
        );
        assert_eq!(case.id.starts_with("answers-"), case.limit == COMPUTED_LIMIT, "{}", case.id);
    }
}
