//! Every kind of fault in a short scenario: each ends as its suite expects, and each fault fired.

use octant_base::control::Control;
use octant_faults::catalogue::Acts;
use octant_faults::{Kind, kinds};
use octant_run::{MethodRun, Recording, assemble, run_method};
use octant_scenario::suite::{Case, Suite};
use octant_scenario::{Method, Scenario};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/faults"))
}

fn suite() -> Suite {
    Suite::load(&folder().join("nightly.toml")).unwrap()
}

/// Lists all kinds except those of the wire, which need a device, and of the host, which need a
/// recording or the clock.
fn in_samples() -> impl Iterator<Item = &'static Kind> {
    kinds::all().filter(|kind| !matches!(kind.acts, Acts::Wire | Acts::Host))
}

#[test]
fn every_kind_has_a_case_and_every_file_is_listed() {
    let listed: Vec<PathBuf> = suite().cases.into_iter().map(|case| case.scenario).collect();
    let there: BTreeSet<PathBuf> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| !path.ends_with("nightly.toml"))
        .collect();
    assert_eq!(listed.iter().cloned().collect::<BTreeSet<_>>(), there);
    let expected: Vec<PathBuf> =
        in_samples().map(|kind| folder().join(format!("{}.toml", kind.name))).collect();
    assert_eq!(listed, expected, "in the order of the catalogue");
    for (path, kind) in expected.iter().zip(in_samples()) {
        let scenario = Scenario::load(path, &[]).unwrap();
        let of_kind = |f: &octant_scenario::Fault| f.spec.kind.name == kind.name;
        assert!(scenario.faults.iter().any(of_kind), "{}", path.display());
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
        let run = || Arc::new(run(&clean, Recording::Hash));
        Arc::clone(slot.get_or_init(run))
    }
}

fn run(scenario: &Scenario, recording: Recording<'_>) -> MethodRun {
    run_method(scenario, Method::Primary, scenario.seed, recording, &Control::default()).unwrap()
}

/// Lists the problems of a case.
fn problems(case: &Case, twins: &Twins) -> Vec<String> {
    let scenario = Scenario::load(&case.scenario, &[]).unwrap();
    let mut faulted = run(&scenario, Recording::None);
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
