//! Verdict and exit status of a self-test.

use octant_selftest::judge::CaseVerdict;
use octant_selftest::record::{CaseRecord, Record, verdict};
use std::time::SystemTime;

fn case(verdict: CaseVerdict) -> CaseRecord {
    CaseRecord {
        id: "one",
        kind: "must not pass",
        about: "",
        expected: String::new(),
        source: None,
        found: String::new(),
        verdict,
    }
}

#[test]
fn an_alarm_is_the_worst_and_nothing_tried_is_no_pass() {
    use CaseVerdict::{Alarm, Error, Fail, Pass};
    for (planned, cases, expected) in [
        (0, &[][..], "inconclusive"),
        (1, &[], "inconclusive"),
        (2, &[Pass], "inconclusive"),
        (2, &[Pass, Pass], "pass"),
        (3, &[Pass, Fail], "fail"),
        (3, &[Fail, Error, Pass], "error"),
        (3, &[Alarm, Error, Fail], "alarm"),
    ] {
        let cases: Vec<CaseRecord> = cases.iter().copied().map(case).collect();
        assert_eq!(verdict(planned, &cases), expected);
    }
    let program = std::env::current_exe().unwrap();
    let now = SystemTime::now();
    let record = Record::new(&program, now, 1, vec![case(Alarm)]).unwrap();
    assert_eq!((record.verdict, record.exit_code()), ("alarm", 5));
    assert!(record.text().contains("ALARM: what must not pass has passed"));
    assert_eq!(Record::new(&program, now, 2, vec![case(Pass)]).unwrap().exit_code(), 3);
}
