//! Cases judged: an alarm, a failure, a pass.

use octant_selftest::cases;
use octant_selftest::judge::{CaseOutcome, CaseVerdict, Expectation, judge};
use octant_verdict::Verdict;

fn passing() -> CaseOutcome {
    CaseOutcome { status: Some(0), verdict: Some(Verdict::Pass), ..CaseOutcome::default() }
}

#[test]
fn every_case_that_must_not_pass_is_an_alarm_when_it_does() {
    let mut count = 0;
    for case in cases() {
        let (judged, words) = judge(&case.expectation, &passing());
        match case.expectation {
            Expectation::NotPass { .. } => {
                count += 1;
                assert_eq!(judged, CaseVerdict::Alarm, "{}", case.id);
                assert!(words.contains("PASSED"), "{words}");
                // Only one of the two indicates a failure.
                for outcome in [
                    CaseOutcome { verdict: Some(Verdict::Fail), ..passing() },
                    CaseOutcome { status: Some(1), ..passing() },
                ] {
                    assert_eq!(judge(&case.expectation, &outcome).0, CaseVerdict::Alarm);
                }
            }
            Expectation::Pass => assert_eq!(judged, CaseVerdict::Pass, "{}", case.id),
            // A program that reports success without a number shows nothing.
            _ => assert_eq!(judged, CaseVerdict::Fail, "{}", case.id),
        }
    }
    assert!(count >= 15, "{count}");
}

#[test]
fn every_case_fails_when_something_else_comes() {
    for case in cases() {
        let crashed = CaseOutcome::default();
        assert_eq!(judge(&case.expectation, &crashed).0, CaseVerdict::Fail, "{}", case.id);
        let otherwise = CaseOutcome {
            status: Some(1),
            said: "another reason".to_owned(),
            verdict: Some(Verdict::Fail),
            text: "another text".to_owned(),
            made: vec![("once".into(), vec![1]), ("again".into(), vec![2])],
            ..CaseOutcome::default()
        };
        assert_eq!(judge(&case.expectation, &otherwise).0, CaseVerdict::Fail, "{}", case.id);
        if let Expectation::Numbers { known, .. } = &case.expectation {
            let with = |shift: f64| CaseOutcome {
                numbers: known
                    .iter()
                    .map(|k| (k.name.clone(), k.value + shift * k.tolerance))
                    .collect(),
                ..CaseOutcome::default()
            };
            assert_eq!(judge(&case.expectation, &with(0.9)).0, CaseVerdict::Pass, "{}", case.id);
            assert_eq!(judge(&case.expectation, &with(1.1)).0, CaseVerdict::Fail, "{}", case.id);
            assert_eq!(judge(&case.expectation, &with(f64::NAN)).0, CaseVerdict::Fail);
            // Each number is required.
            for missing in known {
                let mut outcome = with(0.0);
                outcome.numbers.remove(&missing.name);
                assert_eq!(judge(&case.expectation, &outcome).0, CaseVerdict::Fail);
            }
        }
    }
}

#[test]
fn nothing_to_compare_is_not_the_same() {
    let made = |made: &[&[u8]]| CaseOutcome {
        made: made.iter().map(|bytes| ("so".to_owned(), bytes.to_vec())).collect(),
        ..passing()
    };
    for (outcome, judged) in [
        (made(&[]), CaseVerdict::Fail),
        (made(&[b"a"]), CaseVerdict::Fail),
        (made(&[b"", b""]), CaseVerdict::Fail),
        (made(&[b"a", b"a", b"b"]), CaseVerdict::Fail),
        (made(&[b"a", b"a", b"a"]), CaseVerdict::Pass),
    ] {
        assert_eq!(judge(&Expectation::Same, &outcome).0, judged, "{outcome:?}");
    }
    let none = Expectation::Numbers { known: Vec::new(), source: "" };
    assert_eq!(judge(&none, &passing()).0, CaseVerdict::Fail);
}
