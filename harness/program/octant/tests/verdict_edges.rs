//! Results that the whole depends on at one edge alone: the plan of a run, results without a value,
//! results within the uncertainty of a reference.

use crate::common::program::program;
use octant_score::judge::judge_by;
use octant_score::rederive;
use octant_score::summary::Summary;
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{Comparison, Verdict};
use std::path::Path;

const SCENARIO: &str = "schema = 1
[imu]
rate = \"50 Hz\"
[procedure.calibration]
positions = \"eight\"
duration = \"0.5 h\"
[procedure.navigation]
duration = \"10 min\"
[[requirements]]
id = \"A\"
text = \"x\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"100 nmi\"
";

/// Runs the scenario; returns its summary.
fn run(folder: &Path) -> Summary {
    std::fs::write(folder.join("short.toml"), SCENARIO).unwrap();
    let output =
        program(&["run", "short.toml", "--out", "run"]).current_dir(folder).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = std::fs::read_to_string(folder.join("run/summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_run_is_held_to_the_work_of_its_scenario() {
    let folder = tempfile::tempdir().unwrap();
    let summary = run(folder.path());
    // Eight positions are reached in 19 stops (docs/method.md, from the paper's sequence).
    for work in [summary.planned.unwrap(), summary.done.unwrap()] {
        assert_eq!(work.stops, Some(19), "{work:?}");
        assert_eq!(work.calibration_s, Some(1800.0), "{work:?}");
        assert_eq!(work.references, Some(1800), "once a second: {work:?}");
        assert_eq!(work.navigation_s, Some(600.0), "{work:?}");
    }
}

#[test]
fn what_a_result_rests_on_is_kept_where_it_is_derived_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut summary = run(folder.path());
    let check = LimitCheck {
        id: "A".to_owned(),
        measure: "navigation.duration_h".to_owned(),
        comparison: Comparison::AtMost,
        limit: 0.17,
        secant_latitude: false,
    };
    // Ten minutes are 0.1667 h.
    for (uncertainty, expected) in [
        (Ok(0.001), Verdict::Pass),
        (Ok(0.01), Verdict::Inconclusive),
        (Err("not known"), Verdict::Inconclusive),
    ] {
        judge_by(&mut summary, std::slice::from_ref(&check), &[], |_| uncertainty).unwrap();
        let result = &summary.requirements[0];
        assert_eq!((result.verdict, summary.verdict), (expected, expected), "{result:?}");
        if let Err(reason) = uncertainty {
            assert_eq!(
                (result.value, result.margin, result.reason.as_deref()),
                (None, None, Some(reason))
            );
        } else {
            assert!(result.value.is_some() && result.margin.is_some(), "{result:?}");
        }
        assert_eq!(rederive::results(&summary).unwrap(), summary.requirements);
        assert_eq!(rederive::contradictions(&summary), Vec::<String>::new());
    }
}
