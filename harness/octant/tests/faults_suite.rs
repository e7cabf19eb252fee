//! Every kind of fault in a short scenario: each ends as its suite expects, and each fault fired.

use octant_base::control::Control;
use octant_run::{MethodRun, StreamKeeping, assemble, run_method};
use octant_scenario::suite::{Suite, SuiteCase};
use octant_scenario::{Method, Scenario};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/faults"))
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

/// Twins without faults, run once for all scenarios that differ in nothing else.
#[derive(Default)]
struct Twins(Mutex<BTreeMap<String, Arc<OnceLock<Arc<MethodRun>>>>>);

impl Twins {
    fn of(&self, scenario: &Scenario) -> Arc<MethodRun> {
        let mut clean = scenario.without_faults();
        clean.requirements.clear();
        // Plant, core and seed determine a run.
        let (plant, core, _) =
            octant_source::configure::configurations(&clean, Method::Primary, clean.seed).unwrap();
        let key = format!("{plant:?} {core:?} {:?}", clean.samples());
        let slot = Arc::clone(self.0.lock().unwrap().entry(key).or_default());
        let run = || Arc::new(run(&clean, StreamKeeping::Hash));
        Arc::clone(slot.get_or_init(run))
    }
}

fn run(scenario: &Scenario, recording: StreamKeeping<'_>) -> MethodRun {
    run_method(scenario, Method::Primary, scenario.seed, recording, &Control::default()).unwrap()
}

/// Lists the problems of a case.
fn problems(case: &SuiteCase, twins: &Twins) -> Vec<String> {
    let scenario = Scenario::load(&case.scenario, &[]).unwrap();
    let mut faulted = run(&scenario, StreamKeeping::None);
    faulted.twin = Some(twins.of(&scenario));
    let summary = assemble(&scenario, scenario.seed, faulted, None).unwrap().summary;
    let mut problems: Vec<String> = summary
        .faults
        .iter()
        .filter(|f| !f.fired)
        .map(|f| format!("{} never fired", f.id))
        .collect();
    problems
        .extend(case.hold(summary.verdict, &summary.reasons).err().map(|found| found.to_string()));
    problems
}

#[test]
fn every_case_ends_as_it_has_to() {
    let (suite, twins) = (suite(), Twins::default());
    let (next, found) = (AtomicUsize::new(0), Mutex::new(BTreeMap::new()));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(2, usize::from) {
            scope.spawn(|| {
                while let Some(case) = suite.cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let name = case.scenario.file_stem().unwrap().to_string_lossy().into_owned();
                    let problems = problems(case, &twins);
                    if !problems.is_empty() {
                        found.lock().unwrap().insert(name, problems.join("; "));
                    }
                }
            });
        }
    });
    let found = found.into_inner().unwrap();
    let lines: Vec<String> = found.iter().map(|(name, what)| format!("{name}: {what}")).collect();
    assert!(lines.is_empty(), "{} of {}:\n{}", lines.len(), suite.cases.len(), lines.join("\n"));
}
