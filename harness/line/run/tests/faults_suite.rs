//! Every kind of fault in a short scenario: each ends as its suite expects, and each fault fired.

use octant_base::control::Control;
use octant_base::pool::processors;
use octant_run::Run;
use octant_run::many::{ManyError, judge_many};
use octant_scenario::Scenario;
use octant_scenario::suite::{Suite, SuiteCase};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Mutex;

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/faults"))
}

fn suite() -> Suite {
    Suite::load(&folder().join("nightly.toml")).unwrap()
}

#[test]
fn every_case_has_its_kind_and_requires_something() {
    for SuiteCase { scenario: path, .. } in suite().cases {
        let scenario = Scenario::load(&path, &[]).unwrap();
        let name = path.file_stem().unwrap();
        assert!(scenario.faults.iter().any(|f| name == f.spec.kind.name), "{}", path.display());
        assert!(!scenario.requirements.is_empty(), "{}", path.display());
    }
}

/// Lists the problems of a case.
fn problems(case: &SuiteCase, run: Result<Run, ManyError>) -> Vec<String> {
    let summary = run.unwrap().summary;
    let unfired = summary.faults.iter().filter(|f| !f.fired);
    let unexpected = case.hold(summary.verdict, &summary.reasons).err();
    let unfired = unfired.map(|f| format!("{} never fired", f.id));
    unfired.chain(unexpected.map(|found| found.to_string())).collect()
}

#[test]
fn every_case_ends_as_it_has_to() {
    let suite = suite();
    let scenario = |case: &SuiteCase| Scenario::load(&case.scenario, &[]).unwrap();
    let scenarios: Vec<Scenario> = suite.cases.iter().map(scenario).collect();
    let found = Mutex::new(BTreeMap::new());
    judge_many(&scenarios, processors(), &Control::default(), &|index, run| {
        found.lock().unwrap().insert(index, problems(&suite.cases[index], run));
    });
    let found = found.into_inner().unwrap();
    assert_eq!(found.len(), suite.cases.len(), "a case was not told");
    let name = |index: &usize| scenarios[*index].file.clone();
    let wrong = found.iter().filter(|(_, problems)| !problems.is_empty());
    let lines: Vec<String> =
        wrong.map(|(index, what)| format!("{}: {}", name(index), what.join("; "))).collect();
    assert!(lines.is_empty(), "{} of {}:\n{}", lines.len(), found.len(), lines.join("\n"));
}
