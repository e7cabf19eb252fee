//! Searches on a short run at a low rate.

use crate::bench::SearchBench;
use crate::candidate::{Candidate, PlacedFault};
use crate::derived::{RunTimes, derived, searchable};
use crate::earlier::{EarlierFound, EarlierSearch, ScreenFound};
use crate::error::SearchError;
use crate::found::{SearchFound, worst};
use crate::minimal::minimal;
use crate::search::{SearchPlan, Strategy, search};
use crate::space::{FormKey, Space};
use crate::space_file::{SpaceError, read, to_toml};
use crate::trial::{Trial, TrialResult};
use octant_base::chained_lines::ChainedLines;
use octant_base::control::Control;
use octant_faults::kinds;
use octant_scenario::Scenario;
use std::path::Path;

/// 24 minutes at 20 Hz.
const SHORT: &str = include_str!("../../../../fixtures/search/short.toml");
const TIMES: RunTimes = RunTimes { sample_s: 0.05, length_s: 1440.0 };

fn scenario(changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|change| (*change).to_owned()).collect();
    Scenario::parse(SHORT, "short.toml", Path::new("."), &changes).unwrap()
}

fn bench(jobs: usize) -> SearchBench {
    SearchBench::new(&scenario(&[]), 1, jobs, &Control::default()).unwrap()
}

fn space(names: &[&str]) -> Space {
    let all: Vec<_> = names.iter().map(|name| kinds::named(name).unwrap()).collect();
    derived(&all, TIMES)
}

fn plan(runs: usize) -> SearchPlan {
    SearchPlan { strategy: Strategy::Guided, runs, seed: 1, pairs: 0.3, enough: None, after: None }
}

fn searched(bench: &SearchBench, runs: usize, journal: Option<&Path>) -> Vec<Trial> {
    let space = space(&["bias-step", "spike", "scale-step"]);
    search(bench, &space, &plan(runs), journal, &Control::default(), &mut |_| {}).unwrap()
}

#[test]
fn threads_and_interruptions_change_nothing() {
    let one = searched(&bench(1), 24, None);
    assert!(one.iter().filter(|trial| trial.is_run()).count() >= 24);
    assert_eq!(searched(&bench(2), 24, None), one);
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("search.jsonl");
    let bench = bench(2);
    assert_eq!(searched(&bench, 24, Some(&journal)), one);
    let whole = std::fs::read(&journal).unwrap();
    // Cut anywhere, as a kill does: in the middle of a line, of a proposal, of the first line.
    for kept in [whole.len() - 7, whole.len() / 2, 1000, 30, 0] {
        std::fs::write(&journal, &whole[..kept]).unwrap();
        assert_eq!(searched(&bench, 24, Some(&journal)), one, "{kept}");
        assert_eq!(std::fs::read(&journal).unwrap(), whole, "{kept}");
    }
    // A longer search begins as the shorter one.
    let longer = searched(&bench, 32, Some(&journal));
    assert_eq!(longer[..one.len()], one);
}

#[test]
fn a_journal_of_another_search_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("search.jsonl");
    let bench = bench(2);
    let tried = |space: &Space, plan: &SearchPlan| {
        search(&bench, space, plan, Some(&journal), &Control::default(), &mut |_| {})
            .map(|trials| trials.len())
            .map_err(|error| error.to_string())
    };
    let bias = space(&["bias-step"]);
    tried(&bias, &plan(16)).unwrap();
    let told = tried(&space(&["spike"]), &plan(16)).unwrap_err();
    assert!(told.contains("line 1: found space_blake3"), "{told}");
    let told = tried(&bias, &SearchPlan { seed: 2, ..plan(16) }).unwrap_err();
    assert!(told.contains("found search_seed 1, expected 2"), "{told}");
    let text = std::fs::read_to_string(&journal).unwrap();
    // Neither a result nor a candidate can be edited, and no line be left out.
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let edits = [
        text.replacen("\"places\":[0.", "\"places\":[0.9", 1),
        text.replacen("\"noticed_by\":null", "\"noticed_by\":\"gap\"", 1),
        [&lines[..2], &lines[3..]].concat().concat(),
    ];
    for edited in edits {
        assert_ne!(edited, text);
        std::fs::write(&journal, edited).unwrap();
        let told = tried(&bias, &plan(16)).unwrap_err();
        assert!(told.contains("was changed or left out"), "{told}");
    }
    std::fs::write(&journal, text.replace("{\"schema\":1", "{\"schema\":2")).unwrap();
    let told = tried(&bias, &plan(16)).unwrap_err();
    assert!(told.contains("newer version"), "{told}");
}

/// A core without the test of jumps answers otherwise where that test had noticed faults, and the search goes on there.
#[test]
fn after_an_earlier_search_the_screen_that_changed_is_found_first() {
    let folder = tempfile::tempdir().unwrap();
    let journal = |name: &str| folder.path().join(name);
    let space = space(&["bias-step", "noise-gain", "stuck-at-current"]);
    let searched = |bench: &SearchBench, plan: &SearchPlan, name: &str| {
        let journal = journal(name);
        search(bench, &space, plan, Some(&journal), &Control::default(), &mut |_| {})
    };
    let full = bench(2);
    let first = SearchPlan { pairs: 0.1, ..plan(96) };
    let trials = searched(&full, &first, "first").unwrap();
    let earlier = EarlierSearch::read(&journal("first"), &space).unwrap();
    assert_eq!(earlier.trials, trials);
    let after = SearchPlan { after: Some(earlier.clone()), seed: 5, pairs: 0.0, ..plan(24) };
    let found = |trials: &[Trial]| {
        let found = EarlierFound::of(&earlier, trials);
        let counts = |screen: &ScreenFound| (screen.report.clone(), screen.again, screen.otherwise);
        found.screens.iter().map(counts).collect::<Vec<_>>()
    };
    // The same core says the same of each, and what it missed it misses again.
    let trials = searched(&full, &after, "same").unwrap();
    let missed = EarlierFound::of(&earlier, &trials);
    assert!(missed.missed > 0 && missed.missed_again > 0, "{missed:?}");
    assert!(missed.still_missed > 0 && !missed.is_too_short(), "{missed:?}");
    let harm = |trial: Option<&Trial>| trial.and_then(Trial::unnoticed_harm);
    assert_eq!(harm(worst(&earlier.trials)), harm(trials.first()));
    let same = found(&trials);
    assert!(same.len() >= 3 && same.iter().all(|(_, _, otherwise)| *otherwise == 0), "{same:?}");
    assert!(same.iter().filter(|(_, again, _)| *again > 0).count() >= 3, "{same:?}");
    let weak = |jobs| {
        let weak = scenario(&["screening.jumps=\"off\""]);
        SearchBench::new(&weak, 1, jobs, &Control::default()).unwrap()
    };
    let trials = searched(&weak(2), &after, "weak").unwrap();
    let screens = found(&trials);
    for (report, again, otherwise) in &screens {
        let is_off = report == "increments jumped";
        assert_eq!(*otherwise, if is_off { *again } else { 0 }, "{screens:?}");
        assert!(!is_off || *again > 4, "{screens:?}");
    }
    // On one thread, and after an interruption, it is the same search.
    let whole = std::fs::read(journal("weak")).unwrap();
    std::fs::write(journal("weak"), &whole[..whole.len() / 2]).unwrap();
    assert_eq!(searched(&weak(1), &after, "weak").unwrap(), trials);
    assert_eq!(std::fs::read(journal("weak")).unwrap(), whole);
    let told = searched(&weak(2), &SearchPlan { after: None, ..after }, "weak").unwrap_err();
    assert!(told.to_string().contains(&format!("after {}", earlier.journal_blake3)), "{told}");
}

/// A core that notices the faults that another one missed has to show it of each of them.
#[test]
fn after_a_repair_all_that_was_missed_is_run_again() {
    let space = space(&["bias-step"]);
    let searched = |bench: &SearchBench, plan: &SearchPlan| {
        search(bench, &space, plan, None, &Control::default(), &mut |_| {}).unwrap()
    };
    let blind = scenario(&["screening.drift=\"off\""]);
    let blind = SearchBench::new(&blind, 1, 2, &Control::default()).unwrap();
    let trials = searched(&blind, &SearchPlan { pairs: 0.0, ..plan(80) });
    let missed = |trial: &&Trial| trial.unnoticed_harm().is_some_and(|harm| harm >= 1.0);
    let all: Vec<&Trial> = trials.iter().filter(missed).collect();
    // The repaired core has the drift test, and notices most of them.
    let repaired = bench(2);
    let noticed = repaired.run(
        &space,
        all.iter().map(|trial| trial.candidate.clone()).collect(),
        &Control::default(),
    );
    let noticed: Vec<Trial> =
        noticed.unwrap().into_iter().filter(|trial| !missed(&trial)).collect();
    assert!(noticed.len() > 6, "{} of {}", noticed.len(), all.len());
    let known = |trial: &&Trial| noticed.iter().any(|other| other.candidate == trial.candidate);
    let trials: Vec<Trial> = trials.iter().filter(known).cloned().collect();
    let earlier = EarlierSearch { trials, journal_blake3: String::new() };
    let after = |runs| {
        let plan = SearchPlan { after: Some(earlier.clone()), pairs: 0.0, ..plan(runs) };
        EarlierFound::of(&earlier, &searched(&repaired, &plan))
    };
    let short = after(4);
    assert!(short.is_too_short() && short.missed_again == 1, "{short:?}");
    // The search goes elsewhere in between.
    let whole = after(2 * noticed.len() + 8);
    assert!(!whole.is_too_short() && whole.missed_again == noticed.len(), "{whole:?}");
}

#[test]
fn what_is_no_earlier_search_of_the_space_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("search.jsonl");
    let told = |space: &Space| EarlierSearch::read(&journal, space).unwrap_err().to_string();
    let bias = space(&["bias-step"]);
    assert!(told(&bias).starts_with("read "), "{}", told(&bias));
    let control = Control::default();
    search(&bench(2), &bias, &plan(16), Some(&journal), &control, &mut |_| {}).unwrap();
    assert!(told(&space(&["spike"])).contains("line 1: found a search of another space"));
    let text = std::fs::read_to_string(&journal).unwrap();
    let first = text.split_inclusive('\n').next().unwrap();
    for (edited, expected) in [
        (String::new(), "found no line"),
        (first.to_owned(), "found no trial"),
        (text.replace("{\"schema\":1", "{\"schema\":2"), "newer version"),
        (text.replacen("\"places\":[0.", "\"places\":[0.9", 1), "was changed or left out"),
    ] {
        std::fs::write(&journal, edited).unwrap();
        assert!(told(&bias).contains(expected), "{}", told(&bias));
    }
    // Faults that the space doesn't have, in a file whose checksums are right.
    let fault = |form, places| vec![PlacedFault { form, places }];
    let far = vec![0.5, 0.5, 0.5, f64::MAX];
    for faults in [vec![], fault(7, vec![0.5; 4]), fault(0, vec![0.5]), fault(0, far)] {
        std::fs::write(&journal, first).unwrap();
        let candidate = Candidate { faults };
        let trial = Trial { candidate, result: TrialResult::Broken(String::new()) };
        let mut lines = ChainedLines::open(&journal, "", |_| Ok(()), |_| Ok(())).unwrap();
        lines.append([serde_json::to_string(&trial).unwrap()]).unwrap();
        assert!(told(&bias).contains("isn't in the space"), "{}", told(&bias));
    }
}

#[test]
fn a_pair_is_made_a_single_fault_that_runs_again() {
    let bench = bench(2);
    let space = space(&["asymmetry", "noise-gain"]);
    // All gyros for the time of a turn; beside them a fault that does nothing to speak of.
    let placed = |kind: &str, set: &[(&str, f64)]| {
        let form = space.forms.iter().position(|form| form.kind.name == kind).unwrap();
        let keys = space.forms[form].keys.iter();
        let of = |key: &FormKey| match set.iter().find(|(name, _)| *name == key.name) {
            Some((_, value)) => match key.values.range() {
                Some(range) if range.is_logarithmic => {
                    range.distance_of(value / range.from).unwrap()
                }
                Some(range) => (value - range.from) / (range.to - range.from),
                None => *value,
            },
            None => 0.01,
        };
        PlacedFault { form, places: keys.map(of).collect() }
    };
    let gyros = [("channels", 0.9), ("error", 93.8), ("onset", 537.66), ("duration", 12.6)];
    let noise = [("onset", 1200.0), ("gain", 300.0), ("duration", 1.0)];
    let faults = vec![placed("asymmetry", &gyros), placed("noise-gain", &noise)];
    let tried = bench.run(&space, vec![Candidate { faults }], &Control::default()).unwrap();
    let found = tried.into_iter().next().unwrap();
    let harm = found.unnoticed_harm().unwrap_or_else(|| panic!("{found:?}"));
    assert!(harm >= 1.0, "{harm}");
    let smaller = minimal(&bench, &space, &found, &Control::default()).unwrap();
    assert_eq!(smaller.trial.candidate.faults.len(), 1);
    let text = smaller.trial.candidate.to_toml(&smaller.space);
    assert!(text.contains("kind = \"asymmetry\"") && !text.contains("noise-gain"), "{text}");
    assert!(smaller.trial.unnoticed_harm().unwrap() >= 0.8 * harm);
    // Written, read and run undivided it has the same effect, to the bit.
    let text = bench.text_of(&smaller.space, &smaller.trial.candidate, &[]);
    assert_eq!(bench.again(&text, &Control::default()).unwrap(), smaller.trial.result);
}

#[test]
fn every_kind_that_acts_on_samples_has_a_form_or_a_reason() {
    let all: Vec<_> = searchable().collect();
    let bench = bench(1);
    let (space, left_out) = bench.possible(&derived(&all, TIMES));
    for kind in &all {
        let has_form = space.forms.iter().any(|form| form.kind.name == kind.name);
        let why: Vec<_> = left_out.iter().filter(|(name, _)| name == kind.name).collect();
        assert!(has_form || !why.is_empty(), "{}", kind.name);
    }
    assert!(all.len() > 50 && left_out.len() < 4, "{left_out:?}");
    let sized = space.forms.iter().filter(|form| form.size().is_some()).count();
    assert!(sized * 10 > space.forms.len() * 8, "{sized} of {}", space.forms.len());
    // Written as a file and read, it's the same space.
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), to_toml(&space)).unwrap();
    let again = read(file.path(), TIMES).unwrap();
    assert_eq!(bench.impossible(&again), None);
    assert_eq!(again.forms.len(), space.forms.len());
    for (a, b) in again.forms.iter().zip(&space.forms) {
        let ends = |form: &crate::space::Form, at: f64| {
            let mut lines: Vec<String> = form.keys.iter().map(|key| key.line(at)).collect();
            lines.sort();
            lines
        };
        assert_eq!((ends(a, 0.0), ends(a, 1.0)), (ends(b, 0.0), ends(b, 1.0)), "{}", a.kind.name);
    }
}

#[test]
fn a_file_that_is_no_space_is_refused_with_its_field() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let told = |text: &str| {
        std::fs::write(file.path(), text).unwrap();
        let error = read(file.path(), TIMES).unwrap_err();
        assert!(matches!(error, SpaceError::Content(_)));
        error.to_string()
    };
    let head =
        "schema = 1\n[[faults]]\nkind = \"bias-step\"\nchannels = \"gyro x\"\nonset = \"5 s\"\n";
    let cases = [
        ("", ":1:1: schema: expected schema = 1"),
        ("schema = 2", ":1:10: schema: found 2, of a newer version"),
        ("schema = 1", "faults: expected one [[faults]] or more"),
        ("schema = 1\nfault = 3", ":2:1: fault: unknown key, did you mean \"faults\"?"),
        (
            "schema = 1\n[[faults]]\nkind = \"bias-stop\"",
            ":3:8: faults[1].kind: found \"bias-stop\", which is no kind, did you mean \"bias-step\"?",
        ),
        (&format!("{head}id = \"a\""), ":6:6: faults[1].id: found an id"),
        (&format!("{head}trigger = {{ at = \"1 s\" }}"), "faults[1].onset: expected either onset"),
        (
            &format!("{head}amplitude = {{ from = \"1 deg/h\" }}"),
            ":6:13: faults[1].amplitude: expected a value",
        ),
        (
            &format!("{head}amplitude = {{ from = \"1 deg/h\", to = \"1 ug\" }}"),
            "expected one dimension",
        ),
        (
            &format!("{head}amplitude = {{ from = \"2 deg/h\", to = \"1 deg/h\" }}"),
            "expected a larger end",
        ),
        (
            &format!(
                "{head}amplitude = {{ from = \"-2 deg/h\", to = \"1 deg/h\", scale = \"log\" }}"
            ),
            "expected ends above zero",
        ),
        (
            &format!("{head}amplitude = {{ from = \"nan deg/h\", to = \"1 deg/h\" }}"),
            "expected a number",
        ),
        (&format!("{head}amplitude = {{ one_of = [] }}"), "expected { one_of = [VALUE, ...] }"),
        (&format!("{head}amplitude = {{ from = 1, to = 2, step = 1 }}"), "unknown key \"step\""),
        ("schema = ", ":1:10: not TOML: "),
    ];
    for (text, expected) in cases {
        let told = told(text);
        assert!(told.contains(expected), "{text}: {told}");
    }
    // The values of keys are checked by the scenario.
    std::fs::write(file.path(), format!("{head}amplitude = {{ from = 1, to = 2 }}")).unwrap();
    let (form, reason) = bench(1).impossible(&read(file.path(), TIMES).unwrap()).unwrap();
    assert!(form == 0 && reason.contains("expected"), "{reason}");
}

#[test]
fn a_scenario_that_gives_no_reference_is_refused() {
    let control = Control::default();
    let tried =
        |scenario: &Scenario| SearchBench::new(scenario, 1, 1, &control).map(|_| ()).unwrap_err();
    let fault = "[[faults]]\nid = \"a\"\nkind = \"spike\"\nchannels = \"gyro x\"\namplitude = \"1 deg/h\"\n\
                 trigger = { at = \"5 s\" }\nduration = \"1 samples\"\n";
    let text = format!("{SHORT}{fault}");
    let faulty = Scenario::parse(&text, "short.toml", Path::new("."), &[]).unwrap();
    assert!(matches!(tried(&faulty), SearchError::HasFaults(1)));
    control.cancel.store(true, std::sync::atomic::Ordering::Relaxed);
    assert!(matches!(tried(&scenario(&[])), SearchError::Cancelled));
}

#[test]
fn counts_of_a_result_add_up() {
    let trials = searched(&bench(2), 24, None);
    let space = space(&["bias-step", "spike", "scale-step"]);
    let found = SearchFound::of(&trials, &space);
    let unnoticed = trials.iter().filter(|trial| trial.unnoticed_harm().is_some()).count();
    assert_eq!(found.runs, found.noticed + found.not_fired + unnoticed + found.broken.len());
    assert_eq!(found.runs + found.refused, trials.len());
    assert_eq!(
        found.kinds.iter().map(|kind| kind.runs).sum::<usize>() + found.broken.len(),
        found.runs
    );
    let most = worst(&trials).unwrap();
    assert_eq!(Some(most.unnoticed_harm().unwrap()), found.worst.as_ref().map(|worst| worst.harm));
    // Each parameter's largest shift is that of one of the trials, and none is larger.
    for (parameter, shift) in &found.largest_unnoticed {
        let largest =
            trials.iter().filter_map(Trial::effect).filter(|effect| effect.is_unnoticed());
        let largest = largest.filter_map(|effect| effect.shifts_sigma.get(parameter));
        assert_eq!(largest.map(|sigma| sigma.abs()).fold(0.0, f64::max), shift.sigma.abs());
    }
    assert!(trials.iter().all(|trial| !matches!(trial.result, TrialResult::Broken(_))));
}
