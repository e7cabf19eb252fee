//! Attacks on campaigns whose cases have twins: plans that can't show what they require, and stored results that were changed.

use super::{Ends, Row, breaks, open};
use crate::campaign_twins::{CAMPAIGN, SCENARIO, written};
use crate::common::program::octant_in;
use crate::common::results;
use octant_campaign::execute::alike::run_alike;
use octant_campaign::execute::case::hash_of_summary;
use octant_campaign::plan::{Case, Plan};
use serde_json::Value;
use std::path::Path;
use std::sync::LazyLock;

/// The campaign with one draw: two cases with one twin.
fn one_draw() -> String {
    CAMPAIGN.replace("replicates = 6\n", "")
}

/// Results of the two cases, as they are.
static RESULTS: LazyLock<Vec<Value>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), SCENARIO, &one_draw());
    let plan = Plan::of(&folder.path().join("campaign.toml")).unwrap();
    let cases: Vec<&Case> = plan.cases.iter().collect();
    let results = run_alike(plan.planned(cases[0]).unwrap(), &cases);
    results.into_iter().map(|result| serde_json::to_value(result.unwrap()).unwrap()).collect()
});

/// Status and words of a command.
fn octant(folder: &Path, words: &[&str]) -> (u8, String) {
    let output = octant_in(folder, words);
    let text =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    (output.status.code().unwrap() as u8, text.concat())
}

/// Plans a campaign.
fn planned(scenario: &str, campaign: &str) -> (u8, String) {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), scenario, campaign);
    octant(folder.path(), &["campaign", "plan", "campaign.toml", "--out", "out"])
}

/// Changes the stored results, makes their hashes anew, and makes tables and report of them.
fn reported(change: impl Fn(usize, &mut Value)) -> (u8, String) {
    let folder = tempfile::tempdir().unwrap();
    reported_in(folder.path(), change)
}

fn reported_in(folder: &Path, change: impl Fn(usize, &mut Value)) -> (u8, String) {
    written(folder, SCENARIO, &one_draw());
    let plan = Plan::of(&folder.join("campaign.toml")).unwrap();
    let out = folder.join("out");
    plan.write(&out, false).unwrap();
    for (index, (case, result)) in plan.cases.iter().zip(RESULTS.iter()).enumerate() {
        let mut result = result.clone();
        change(index, &mut result);
        result["summary_blake3"] = hash_of_summary(&result["summary"]).into();
        results::put(&out, &case.id, &(result.to_string() + "\n"));
    }
    let merged = octant(folder, &["campaign", "run", "out"]);
    let shown = octant(folder, &["campaign", "report", "out"]);
    // A folder without tables has no report.
    assert_eq!(merged.0 > 3, shown.0 > 3, "{merged:?} {shown:?}");
    shown
}

fn check(row: &Row, (status, words): (u8, String)) {
    assert_eq!(status, row.ends.status, "{}: {words}", row.about);
    assert!(words.contains(row.ends.because), "{}: {words}", row.about);
}

const NO_FAULTS: Ends = Ends { status: 2, because: "the scenario has no faults" };
const NO_FAULT: Ends = Ends { status: 2, because: "which not every case can have" };
const NEVER: Ends = open("never fired");
const NO_TWIN: Ends = breaks("its own measure is none");
const OTHER_SHIFT: Ends = breaks("isn't the largest shift of its parameters");
const OTHER_DELAY: Ends = breaks("isn't the longest delay of its faults");
const OTHER_TWIN: Ends = breaks("which has the same but for the faults");

/// Returns the rows of the table.
pub fn rows() -> Vec<Row> {
    let row = |about, ends| Row { group: "campaign", about, over: "campaign", ends };
    vec![
        row("requires an effect of faults, in a scenario without any", NO_FAULTS),
        row(
            "has cases without a fault among those that are compared with a twin: each would pass",
            NO_FAULT,
        ),
        row("has a fault that isn't reached before the end of the run", NEVER),
        row("leaves the twin out of a stored result", NO_TWIN),
        row(
            "edits the largest shift of a stored result, with its check and its hashes",
            OTHER_SHIFT,
        ),
        row("edits the delay of a detection, with its hashes", OTHER_DELAY),
        row("takes away the false alarms of a twin, in one of the cases that share it", OTHER_TWIN),
        row("mixes results whose common twin another version made", OTHER_TWIN),
    ]
}

/// Puts an alarm into the twin of a result.
fn alarm(result: &mut Value) {
    result["verdict"] = "fail".into();
    let summary = &mut result["summary"];
    summary["verdict"] = "fail".into();
    summary["counterfactual"]["false_alarms"] = 1.into();
    let quiet = &mut summary["requirements"][3];
    quiet["verdict"] = "fail".into();
    (quiet["value"], quiet["margin"]) = (1.0.into(), (-1.0).into());
}

#[test]
fn a_requirement_that_fails_is_not_met() {
    let folder = tempfile::tempdir().unwrap();
    let (status, words) = reported_in(folder.path(), |_, result| alarm(result));
    assert_eq!(status, 1, "{words}");
    let dispositions = folder.path().join("out/dispositions.toml");
    let dispositions = std::fs::read_to_string(dispositions).unwrap();
    assert!(dispositions.contains("QUIET is not met: 2 of 2 checks failed"), "{dispositions}");
    assert!(!dispositions.contains("is not shown"), "{dispositions}");
}

#[test]
fn the_campaign_itself_passes() {
    let (status, words) = reported(|_, _| {});
    assert_eq!(status, 0, "{words}");
    for result in RESULTS.iter() {
        assert_eq!(result["verdict"], "pass", "{:?}", result["summary"]["reasons"]);
    }
    let twin =
        |place: usize| RESULTS[place]["summary"]["counterfactual"]["twin_stream_hash"].clone();
    assert_eq!(twin(0), twin(1), "one twin for both");
}

#[test]
fn plans_that_can_show_nothing_are_refused() {
    let (before, rest) = SCENARIO.split_once("[[faults]]").unwrap();
    let after = &rest[rest.find("[[requirements]]").unwrap()..];
    let campaign = CAMPAIGN.split("[[factors]]").next().unwrap();
    check(&rows()[0], planned(&format!("{before}{after}"), campaign));
    let campaign = CAMPAIGN.replace("faults = [", "faults = [[], ");
    check(&rows()[1], planned(SCENARIO, &campaign));
}

#[test]
fn a_fault_that_never_comes_shows_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let late = SCENARIO.replace("{ at = \"60 s\" }", "{ when = \"nis above 1e9\" }");
    written(folder.path(), &late, &one_draw());
    let plan = octant(folder.path(), &["campaign", "plan", "campaign.toml", "--out", "out"]);
    assert_eq!(plan.0, 0, "{plan:?}");
    check(&rows()[2], octant(folder.path(), &["campaign", "run", "out"]));
    let trace = octant(folder.path(), &["campaign", "trace", "out"]);
    assert!(trace.1.contains("1 of 2 checks are inconclusive"), "{}", trace.1);
}

#[test]
fn results_that_were_changed_are_refused() {
    let without = |_: usize, result: &mut Value| result["summary"]["counterfactual"] = Value::Null;
    check(&rows()[3], reported(without));
    let check_of = |summary: &mut Value, value: f64| {
        let shift = &mut summary["requirements"][0];
        (shift["value"], shift["margin"]) = (value.into(), (3.0 - value).into());
    };
    check(
        &rows()[4],
        reported(|_, result| {
            let summary = &mut result["summary"];
            summary["counterfactual"]["worst_shift_sigma"] = 1e-3.into();
            check_of(summary, 1e-3);
        }),
    );
    check(
        &rows()[5],
        reported(|_, result| {
            result["summary"]["counterfactual"]["detection_delay_max_s"] = 0.001.into();
        }),
    );
    // With an alarm in the twin of one case alone the other's is gone.
    check(
        &rows()[6],
        reported(|index, result| {
            if index == 1 {
                alarm(result)
            }
        }),
    );
    check(
        &rows()[7],
        reported(|index, result| {
            if index == 0 {
                let hash = "0123456789abcdef".repeat(4);
                result["summary"]["counterfactual"]["twin_stream_hash"] = hash.into();
            }
        }),
    );
}
