//! What isn't a pass in a run is found, and its ids last.

use crate::common::{judged, requirement, silent, summary};
use octant_evidence::discrepancy::of_run;
use octant_score::judge::{Finding, judge};
use octant_score::summary::FaultResult;
use octant_verdict::{Comparison, Verdict};
use std::collections::BTreeSet;

/// Everything that isn't a pass is found, exactly once; and the same run has the same ids.
#[test]
fn discrepancies_of_a_run_are_its_reasons() {
    let mut told = summary();
    told.calibration.as_mut().unwrap().refused = Some("mean NIS 40 is above 9".to_owned());
    told.faults.push(FaultResult { id: "spike-1".to_owned(), ..silent() });
    let asked = [
        requirement("navigation.longitude_error_arcmin.max", Comparison::AtMost, 0.5),
        requirement("navigation.nothing", Comparison::AtMost, 0.5),
        requirement("navigation.radial_error_nmi.max", Comparison::AtMost, 5.0),
    ];
    let late = Finding::of_run("7 overruns".to_owned());
    judge(&mut told, &asked, &[late]).unwrap();
    let found = of_run(&told);
    let mut whats: Vec<&str> = found.iter().map(|found| found.what.as_str()).collect();
    let mut reasons: Vec<&str> = told.reasons.iter().map(String::as_str).collect();
    whats.sort_unstable();
    reasons.sort_unstable();
    assert_eq!((whats.len(), &whats), (5, &reasons));
    let kinds: Vec<_> = found.iter().map(|found| (found.kind, found.verdict)).collect();
    let (fail, open) = (Verdict::Fail, Verdict::Inconclusive);
    let expected = [
        ("requirement", fail),
        ("requirement", open),
        ("refused", fail),
        ("fault", open),
        ("run", open),
    ];
    assert_eq!(kinds, expected);
    let ids: BTreeSet<&str> = found.iter().map(|found| found.id.as_str()).collect();
    assert_eq!(ids.len(), 5);
    assert_eq!(of_run(&told), found);
    told.seed += 1;
    assert!(of_run(&told).iter().all(|found| !ids.contains(found.id.as_str())));

    // A failed bench is the only discrepancy; a run that passes has none.
    let gone = Finding::of_bench(Verdict::Error, "the device went away".to_owned());
    let found = of_run(&judged(&[], &[gone]));
    assert_eq!((found.len(), found[0].verdict, found[0].kind), (1, Verdict::Error, "run"));
    assert_eq!(of_run(&judged(&[], &[])), []);
}
