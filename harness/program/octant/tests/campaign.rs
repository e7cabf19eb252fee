//! Campaigns: planned, run in processes of their own, in parts, interrupted, merged; and all the
//! cases that must not end in a pass.

use crate::common::program::{OCTANT, program};
use crate::common::results as stored;
use octant_campaign::execute::case;
use octant_campaign::execute::selection::CaseSelection;
use octant_campaign::execute::{ExecuteOptions, ExecutionEvent, ExecutionSummary, Shard, execute};
use octant_campaign::judge::status;
use octant_campaign::merge::results;
use octant_campaign::merge::{self, MergeError};
use octant_campaign::plan::{Case, Plan, PlanWritten};
use octant_campaign::report::CampaignReport;
use octant_campaign::store::{CampaignResults, StoreOutcome, keep};
use octant_campaign::table::{ColumnValue, ExistingTable};
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use tempfile::TempDir;

const SCENARIO: &str = "schema = 1
title = \"short\"
seed = 1
[procedure.calibration]
positions = \"eight\"
duration = \"24 min\"
[procedure.navigation]
duration = \"10 min\"
[[faults]]
id = \"spike-1\"
kind = \"spike\"
trigger = { at = \"500 s\" }
duration = \"10 samples\"
channels = \"gyro x\"
amplitude = \"100 deg/h\"
[[requirements]]
id = \"NAV-1\"
text = \"It stays near.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"10 nmi\"
";

const CAMPAIGN: &str = "schema = 1
title = \"test\"
seed = 1
replicates = 3
[[scenarios]]
id = \"short\"
file = \"short.toml\"
[[factors]]
name = \"latitude\"
key = \"site.latitude\"
values = [\"0 deg\", \"60 deg\"]
[[factors]]
name = \"fault\"
faults = [[], [\"spike-1\"]]
draw = true
[[factors]]
name = \"amplitude\"
key = \"faults.spike-1.amplitude\"
unit = \"deg/h\"
uniform = [10, 1000]
";

struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new(campaign: &str) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::write(bench.at("short.toml"), SCENARIO).unwrap();
        std::fs::write(bench.at("campaign.toml"), campaign).unwrap();
        bench
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn plan(&self) -> Plan {
        Plan::of(&self.at("campaign.toml")).unwrap()
    }

    fn refusal(&self) -> String {
        Plan::of(&self.at("campaign.toml")).unwrap_err().to_string()
    }
}

/// Runs a part of a plan, and writes its tables.
fn run(plan: &Plan, folder: &Path, shard: Shard, jobs: usize) -> ExecutionSummary {
    let outcome = begin(plan, folder, shard, jobs, &AtomicBool::new(false), false).unwrap();
    let cases = (0..plan.cases.len()).filter(|index| shard.has(*index));
    results::tables(plan, folder, cases, |table| merge::part(folder, shard, table)).unwrap();
    outcome
}

fn begin(
    plan: &Plan,
    folder: &Path,
    shard: Shard,
    jobs: usize,
    cancel: &AtomicBool,
    again: bool,
) -> Result<ExecutionSummary, String> {
    let program = Path::new(OCTANT);
    let options = ExecuteOptions {
        folder,
        program,
        jobs,
        shard,
        end: plan.cases.len(),
        again,
        selection: CaseSelection::default(),
        together: true,
        cancel,
    };
    execute(plan, &options, &|_| {}).map_err(|error| error.to_string())
}

fn merged(plan: &Plan, folder: &Path) -> Vec<Vec<u8>> {
    let found = merge::merge(plan, &[folder.to_owned()], folder, plan.cases.len()).unwrap();
    assert_eq!((found.cases, found.missing), (plan.cases.len(), 0));
    ["cases", "checks", "drift"]
        .map(|table| std::fs::read(merge::merged(folder, table)).unwrap())
        .to_vec()
}

#[test]
fn the_same_bytes_on_one_processor_in_parts_and_after_interruptions() {
    let bench = Bench::new(CAMPAIGN);
    let plan = bench.plan();
    assert_eq!(plan.cases.len(), 6);
    let whole = bench.at("whole");
    assert_eq!(run(&plan, &whole, Shard::WHOLE, 1).run, 6);
    let expected = merged(&plan, &whole);

    let parts = bench.at("parts");
    for number in 1..=4 {
        run(&plan, &parts, Shard { number, of: 4 }, 2);
    }
    assert!(merged(&plan, &parts) == expected, "four parts");

    // Stopped after each case, and resumed.
    let torn = bench.at("torn");
    let mut rounds = 0;
    loop {
        let cancel = AtomicBool::new(false);
        let program = Path::new(OCTANT);
        let options = ExecuteOptions {
            folder: &torn,
            program,
            jobs: 2,
            shard: Shard::WHOLE,
            end: plan.cases.len(),
            again: false,
            selection: CaseSelection::default(),
            together: true,
            cancel: &cancel,
        };
        let tell = |event: &ExecutionEvent| {
            cancel.fetch_or(matches!(event, ExecutionEvent::Done(_)), Ordering::Relaxed);
        };
        let outcome = execute(&plan, &options, &tell).unwrap();
        rounds += 1;
        if outcome.left == 0 {
            break;
        }
        assert!(outcome.run <= 2, "{outcome:?}");
    }
    assert!(rounds >= 3, "{rounds}");
    assert_eq!(
        run(&plan, &torn, Shard::WHOLE, 2),
        ExecutionSummary { skipped: 6, ..ExecutionSummary::default() }
    );
    assert!(merged(&plan, &torn) == expected, "interrupted");

    // The tables agree with the cases.
    let table = ExistingTable::open(&merge::merged(&whole, "cases")).unwrap();
    assert_eq!((table.rows, table.plan.as_str()), (6, plan.id.as_str()));
    let column = |name: &str| table.column(name).unwrap().unwrap();
    let kept = CampaignResults::open(&whole).unwrap();
    for (row, case) in plan.cases.iter().enumerate() {
        assert_eq!(column("case").at(row), Some(ColumnValue::Text(case.id.as_str().into())));
        let (result, _) = kept.result(&case.id).unwrap().unwrap();
        let summary = result.summary.unwrap();
        let radial = summary.navigation.as_ref().unwrap().radial_error_nmi.unwrap().max;
        assert_eq!(
            column("navigation.radial_error_nmi.max").at(row),
            Some(ColumnValue::Number(radial))
        );
        assert_eq!(
            column("stream_hash").at(row),
            Some(ColumnValue::Text(summary.stream_hash.into()))
        );
        let spiked = case.faults.as_ref().unwrap().contains(&"spike-1".into());
        let fired = column("faults.spike-1.fired").at(row);
        assert_eq!(fired, spiked.then_some(ColumnValue::Boolean(true)));
    }
    let state = status::of(&plan, &whole, Shard::WHOLE).unwrap();
    assert_eq!((state.verdict(), state.open), (Verdict::Pass, 0), "{}", state.text());
}

#[test]
fn errors_of_cases_stay_until_they_are_run_again() {
    let bench = Bench::new(&format!("{CAMPAIGN}[limits]\ntime = \"20 ms\"\n"));
    let (plan, folder) = (bench.plan(), bench.at("out"));
    assert_eq!(run(&plan, &folder, Shard::WHOLE, 2).run, 6);
    let state = status::of(&plan, &folder, Shard::WHOLE).unwrap();
    assert_eq!(state.verdict(), Verdict::Error);
    assert_eq!(state.bad[0].reason, "it took more than its 0.02 s");
    // An error isn't kept as a result for ever.
    let never = AtomicBool::new(false);
    let again = |again| begin(&plan, &folder, Shard::WHOLE, 2, &never, again).unwrap();
    assert_eq!((again(false).run, again(true).run), (0, 6));
}

/// Makes a campaign of two scenarios, the second of which misbehaves, with limits.
fn one_of_two(other: &str, limits: &str) -> (Bench, Plan, ExecutionSummary) {
    let campaign = CAMPAIGN.split("[[factors]]").next().unwrap();
    let second = "[[scenarios]]\nid = \"other\"\nfile = \"other.toml\"\n";
    let campaign = campaign.replace("replicates = 3", "replicates = 1");
    let bench = Bench::new(&format!("{campaign}{second}[limits]\n{limits}\n"));
    std::fs::write(bench.at("other.toml"), other).unwrap();
    let plan = bench.plan();
    let outcome = run(&plan, &bench.at("out"), Shard::WHOLE, 2);
    (bench, plan, outcome)
}

/// Checks that one of two cases is an error for this reason, and that the other passes.
fn assert_one_error(bench: &Bench, plan: &Plan, reason: &str) {
    let state = status::of(plan, &bench.at("out"), Shard::WHOLE).unwrap();
    assert_eq!(state.verdict(), Verdict::Error, "{}", state.text());
    let counts = [("pass", 1), ("error", 1)];
    assert!(state.verdicts == counts.into_iter().collect(), "{}", state.text());
    assert_eq!(plan.case(&state.bad[0].case).unwrap().scenario.as_str(), "other");
    assert_eq!(state.bad[0].reason, reason);
    merged(plan, &bench.at("out"));
}

/// A year of samples, whose end never comes.
#[test]
fn a_case_that_hangs_is_one_error_and_the_others_pass() {
    let endless = SCENARIO.replace("\"10 min\"", "\"365 day\"");
    assert_ne!(endless, SCENARIO);
    let (bench, plan, outcome) = one_of_two(&endless, "time = \"12 s\"");
    assert_eq!(outcome.run, 2);
    assert_one_error(&bench, &plan, "it took more than its 12 s");
}

/// Millions of lines, which need memory to read.
#[cfg(target_os = "linux")]
#[test]
fn a_case_that_wants_too_much_memory_is_one_error_and_the_others_pass() {
    let large = SCENARIO.to_owned() + &"#\n".repeat(4_000_000);
    let (bench, plan, outcome) = one_of_two(&large, "memory_mib = 256");
    assert_eq!(outcome.run, 2);
    assert_one_error(&bench, &plan, "it wanted more than its 256 MiB of memory");
    // With enough memory it is a normal case.
    let (bench, plan, _) = one_of_two(&large, "memory_mib = 8000");
    let state = status::of(&plan, &bench.at("out"), Shard::WHOLE).unwrap();
    assert_eq!(state.verdict(), Verdict::Pass, "{}", state.text());
}

/// An error that comes again is stored again: the process that had run another case before has the forgotten
/// one in its part.
#[cfg(target_os = "linux")]
#[test]
fn an_error_that_is_forgotten_and_comes_again_is_stored_again() {
    let large = SCENARIO.to_owned() + &"#\n".repeat(4_000_000);
    let (bench, plan, _) = one_of_two(&large, "memory_mib = 256");
    let (folder, never) = (bench.at("out"), AtomicBool::new(false));
    stored::clear(&folder);
    let options = ExecuteOptions {
        folder: &folder,
        program: Path::new(OCTANT),
        jobs: 1,
        shard: Shard::WHOLE,
        end: plan.cases.len(),
        again: false,
        selection: CaseSelection::of(&plan, &["other".to_owned()]).unwrap(),
        together: true,
        cancel: &never,
    };
    assert_eq!(execute(&plan, &options, &|_| {}).unwrap().run, 1);
    assert_eq!(begin(&plan, &folder, Shard::WHOLE, 1, &never, true).unwrap().run, 2);
    run(&plan, &folder, Shard::WHOLE, 1);
    assert_one_error(&bench, &plan, "it wanted more than its 256 MiB of memory");
}

#[test]
fn a_campaign_that_grows_keeps_its_cases_and_results() {
    let bench = Bench::new(CAMPAIGN);
    let (plan, folder) = (bench.plan(), bench.at("out"));
    assert_eq!(plan.write(&folder, false).unwrap(), PlanWritten::New);
    assert_eq!(plan.write(&folder, false).unwrap(), PlanWritten::There);
    let file = folder.join("plan.json");
    assert_eq!(Plan::read(&file).unwrap(), plan);

    let more = CAMPAIGN
        .replace("replicates = 3", "replicates = 5")
        .replace("60 deg\"", "60 deg\", \"80 deg\"");
    std::fs::write(bench.at("campaign.toml"), more).unwrap();
    let grown = bench.plan();
    assert_eq!(grown.cases.len(), 15);
    for case in &plan.cases {
        assert_eq!(grown.case(&case.id), Some(case));
    }
    let error = grown.write(&folder, false).unwrap_err().to_string();
    assert!(error.contains("a plan with 6 of these 15 cases is there"), "{error}");
    assert_eq!(grown.write(&folder, true).unwrap(), PlanWritten::Extended(9));
    let error = plan.write(&folder, true).unwrap_err().to_string();
    assert!(error.contains("9 of 15 cases are not in this one"), "{error}");

    // The cases don't depend on the place of the files.
    let elsewhere = Bench::new(CAMPAIGN);
    assert_eq!(elsewhere.plan().id, plan.id);
}

#[test]
fn what_was_changed_after_it_was_planned_is_refused() {
    let bench = Bench::new(CAMPAIGN);
    let (plan, folder) = (bench.plan(), bench.at("out"));
    plan.write(&folder, false).unwrap();
    let file = folder.join("plan.json");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("\"seed\": 2", "\"seed\": 9")).unwrap();
    let error = Plan::read(&file).unwrap_err().to_string();
    assert!(error.contains("changed after it was made"), "{error}");
    std::fs::write(&file, text.replace("\"schema\": 1", "\"schema\": 2")).unwrap();
    let error = Plan::read(&file).unwrap_err().to_string();
    assert!(error.contains("found version 2") && error.contains("a newer Octant"), "{error}");

    std::fs::write(bench.at("short.toml"), SCENARIO.replace("24 min", "25 min")).unwrap();
    let never = AtomicBool::new(false);
    let error = begin(&plan, &folder, Shard::WHOLE, 1, &never, false).unwrap_err();
    assert!(error.contains("changed after the campaign was planned"), "{error}");
}

#[test]
fn results_of_others_and_two_results_of_a_case_are_no_pass() {
    let bench = Bench::new(&CAMPAIGN.replace("replicates = 3", "replicates = 1"));
    let (plan, folder) = (bench.plan(), bench.at("out"));
    run(&plan, &folder, Shard::WHOLE, 2);
    let id = plan.cases[0].id.as_str();
    let text = stored::text(&folder, id);
    assert_eq!(keep(&folder, id, text.as_bytes()).unwrap(), StoreOutcome::Same);

    // One of the results is stored by this process, the other by the program: nobody could tell from the results.
    let mixed = bench.at("mixed");
    keep(&mixed, id, text.as_bytes()).unwrap();
    let never = AtomicBool::new(false);
    let lock = std::fs::File::create(mixed.join("plan.json")).unwrap();
    for (lock_all, shard) in [(true, "1/1"), (true, "1/2"), (false, "1/1")] {
        if lock_all { lock.lock() } else { lock.lock_shared() }.unwrap();
        let error =
            begin(&plan, &mixed, Shard::parse(shard).unwrap(), 1, &never, false).unwrap_err();
        assert!(error.contains("another octant campaign run works on it"), "{shard}: {error}");
    }
    drop(lock);
    run(&plan, &mixed, Shard::WHOLE, 2);
    let report = |folder: &Path| {
        let report = CampaignReport::of(&plan, folder).unwrap();
        let found = report.statistics.discrepancies.iter();
        let found: Vec<String> = found.map(|found| found.what.clone()).collect();
        (report.made_by, found)
    };
    let (made_by, found) = report(&mixed);
    assert_eq!(made_by.iter().map(|made| made.results).collect::<Vec<_>>(), [1, 1]);
    let programs: Vec<_> =
        made_by.iter().map(|made| made.maker.as_ref().unwrap().program_sha256.clone()).collect();
    assert!(programs.contains(&octant_base::hash::sha256(Path::new(OCTANT)).ok()), "{programs:?}");
    assert!(found.iter().any(|what| what.contains("the results are by 2 programs")), "{found:?}");
    let (made_by, found) = report(&folder);
    assert!(made_by.len() == 1 && !found.iter().any(|what| what.contains("programs")), "{found:?}");

    // The same case again, with another result.
    let mut other: serde_json::Value = serde_json::from_str(&text).unwrap();
    other["summary"]["stream_hash"] = "another".into();
    other["summary_blake3"] = case::hash_of_summary(&other["summary"]).into();
    let other = format!("{other}\n");
    stored::put_beside(&folder, id, &other);
    assert_eq!(stored::text(&folder, id), text, "the first stays");
    let state = status::of(&plan, &folder, Shard::WHOLE).unwrap();
    assert_eq!(state.verdict(), Verdict::Error, "{}", state.text());

    // The same result from another machine.
    let elsewhere = bench.at("elsewhere");
    run(&plan, &elsewhere, Shard::WHOLE, 2);
    let both = [folder.clone(), elsewhere.clone()];
    let merged = merge::merge(&plan, &both, &bench.at("good"), 2).unwrap();
    assert_eq!(merged.cases, 2);
    // Each of the parts has both cases: the second ones are left out.
    let account = &merged.account;
    assert_eq!((account.read(), account.used_count(), account.left_out_count()), (4, 2, 2));
    let merged = merge::merge(&plan, &both, &bench.at("one"), 1).unwrap();
    let told = merged.account.lines();
    assert_eq!(told[0], "results of the parts: 4 results read, 1 used, 3 left out");
    assert!(
        told.contains(&"left out: 2 results after the point at which the campaign stopped".into()),
        "{told:?}"
    );
    stored::put(&elsewhere, id, &other);
    run(&plan, &elsewhere, Shard::WHOLE, 2);
    let error = merge::merge(&plan, &both, &bench.at("bad"), 2).unwrap_err();
    assert!(
        matches!(&error, MergeError::Differs { case, column, .. } if case == id && column == "stream_hash"),
        "{error}"
    );

    // Result of a case that isn't in the plan.
    stored::put(&elsewhere, "0123456789abcdef", &other);
    let never = AtomicBool::new(false);
    let error = begin(&plan, &elsewhere, Shard::WHOLE, 1, &never, false).unwrap_err();
    assert!(
        error.contains("results of 1 cases that the plan doesn't have, such as 0123456789abcdef"),
        "{error}"
    );

    // Part of another plan.
    let grown = Bench::new(CAMPAIGN).plan();
    let error = merge::merge(&grown, &[folder], &bench.at("bad"), 6).unwrap_err().to_string();
    assert!(error.contains("it is of plan"), "{error}");
}

#[test]
fn nothing_checked_and_nothing_run_is_no_pass() {
    let bench = Bench::new(&CAMPAIGN.replace("replicates = 3", "replicates = 1"));
    let (plan, folder) = (bench.plan(), bench.at("out"));
    let state = status::of(&plan, &folder, Shard::WHOLE).unwrap();
    assert_eq!((state.verdict(), state.open), (Verdict::Inconclusive, 2));
    let error =
        merge::merge(&plan, std::slice::from_ref(&folder), &folder, 2).unwrap_err().to_string();
    assert!(error.contains("no parts of shards are there"), "{error}");

    let without = SCENARIO.split("[[requirements]]").next().unwrap();
    std::fs::write(bench.at("short.toml"), without).unwrap();
    let plan = bench.plan();
    run(&plan, &folder, Shard::WHOLE, 2);
    let state = status::of(&plan, &folder, Shard::WHOLE).unwrap();
    assert_eq!(state.verdict(), Verdict::Inconclusive, "{}", state.text());
    assert!(state.text().contains("no requirement checked"));
}

#[test]
fn a_campaign_that_contradicts_itself_is_refused_with_its_place() {
    let cases = [
        ("replicates = 3", "replicates = 0", "campaign.toml:4:14: replicates: found 0"),
        ("\"60 deg\"]", "\"0 deg\"]", "a second time, expected it once"),
        ("uniform = [10, 1000]", "uniform = [10, 10]", "expected the smaller one first"),
        ("name = \"fault\"", "name = \"latitude\"", "a second time, expected unique names"),
        ("site.latitude", "site.lattitude", "did you mean \"latitude\"?"),
        ("[[], [\"spike-1\"]]", "[[], [\"spike-2\"]]", "no fault has the id \"spike-2\""),
        ("uniform = [10, 1000]", "unifrom = [10, 1000]", "did you mean \"uniform\"?"),
        ("file = \"short.toml\"", "file = \"shorter.toml\"", "shorter.toml"),
        (
            "uniform = [10, 1000]",
            "uniform = [10, 1000]\n[stop]\nrequirement = \"NAV-2\"",
            "no scenario checks it",
        ),
    ];
    for (what, instead, words) in cases {
        assert!(CAMPAIGN.contains(what));
        let error = Bench::new(&CAMPAIGN.replacen(what, instead, 1)).refusal();
        assert!(error.contains(words), "{instead}: {error}");
    }
    // Two equal scenarios.
    let twice = CAMPAIGN.replace(
        "[[factors]]\nname = \"latitude\"",
        "[[scenarios]]\nid = \"again\"\nfile = \"short.toml\"\n[[factors]]\nname = \"latitude\"",
    );
    let error = Bench::new(&twice).refusal();
    assert!(error.contains("\"short\" and scenario \"again\" give the same case"), "{error}");
}

#[test]
fn a_requirement_that_no_case_can_meet_is_refused() {
    for (measure, limit, words) in [
        (
            "navigation.marks.24h.radial_nmi",
            "\"1 nmi\"",
            "the scenario navigates for less than 24 h",
        ),
        (
            "baseline.navigation.radial_error_nmi.max",
            "\"1 nmi\"",
            "the scenario has no second method",
        ),
    ] {
        let bench = Bench::new(CAMPAIGN);
        let other = SCENARIO
            .replace("navigation.radial_error_nmi.max", measure)
            .replace("\"10 nmi\"", limit);
        std::fs::write(bench.at("short.toml"), other).unwrap();
        let error = bench.refusal();
        assert!(error.contains(words) && error.contains("no case can have"), "{measure}: {error}");
    }
    // Measures of a twin: each case has a fault.
    let bench = Bench::new(CAMPAIGN);
    let shift = SCENARIO
        .replace("navigation.radial_error_nmi.max", "counterfactual.worst_shift_sigma")
        .replace("\"10 nmi\"", "3");
    std::fs::write(bench.at("short.toml"), &shift).unwrap();
    let error = bench.refusal();
    let words = "which not every case can have: factor \"fault\" injects no fault in some of them";
    assert!(error.contains(words), "{error}");
    let without = shift.split("[[faults]]").next().unwrap();
    let requirements = &shift[shift.find("[[requirements]]").unwrap()..];
    std::fs::write(bench.at("short.toml"), format!("{without}{requirements}")).unwrap();
    let campaign = CAMPAIGN.split("[[factors]]").next().unwrap();
    std::fs::write(bench.at("campaign.toml"), campaign).unwrap();
    let error = bench.refusal();
    assert!(error.contains("the scenario has no faults"), "{error}");
    let seeds = CAMPAIGN
        .replace("key = \"site.latitude\"", "key = \"seed\"")
        .replace("[\"0 deg\", \"60 deg\"]", "[1, 2]");
    let error = Bench::new(&seeds).refusal();
    assert!(error.contains("which the campaign gives to each case"), "{error}");
    let set = CAMPAIGN.replacen(
        "file = \"short.toml\"",
        "file = \"short.toml\"\nset = { seed = \"7\" }",
        1,
    );
    let error = Bench::new(&set).refusal();
    assert!(error.contains("scenario \"short\" sets seed"), "{error}");
    let unsure = format!("{CAMPAIGN}[stop]\nrequirement = \"NAV-1\"\nconfidence = 0.01\n");
    let error = Bench::new(&unsure).refusal();
    assert!(error.contains("between 0.5 and 0.999999"), "{error}");
}

#[test]
fn every_case_is_told_once() {
    let bench = Bench::new(CAMPAIGN);
    let (plan, folder) = (bench.plan(), bench.at("out"));
    let (there, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let cancel = AtomicBool::new(false);
    let program = Path::new(OCTANT);
    let options = ExecuteOptions {
        folder: &folder,
        program,
        jobs: 3,
        shard: Shard::WHOLE,
        end: plan.cases.len(),
        again: false,
        selection: CaseSelection::default(),
        together: true,
        cancel: &cancel,
    };
    let tell = |event: &ExecutionEvent| match event {
        ExecutionEvent::There(count) => _ = there.fetch_add(*count, Ordering::Relaxed),
        ExecutionEvent::Begun(_) => {}
        ExecutionEvent::Done(one) => done.lock().unwrap().push(one.index),
    };
    execute(&plan, &options, &tell).unwrap();
    let mut told = std::mem::take(&mut *done.lock().unwrap());
    told.sort_unstable();
    assert_eq!((there.load(Ordering::Relaxed), told), (0, (0..6).collect()));
    execute(&plan, &options, &tell).unwrap();
    assert_eq!(there.load(Ordering::Relaxed), 6);
}

#[test]
fn it_ends_where_enough_is_known_wherever_it_ran() {
    // Three evaluations share the error of 20 %: two draws that pass, of two, show a quarter with
    // 93.75 %.
    let stop = "[stop]\nrequirement = \"NAV-1\"\npass = 0.25\nconfidence = 0.8\nevery = 2\n";
    let bench = Bench::new(&format!("{CAMPAIGN}{stop}"));
    let octant = |arguments: &[&str]| {
        let mut command = program(&[]);
        let output =
            command.current_dir(bench.folder.path()).arg("campaign").args(arguments).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    octant(&["plan", "campaign.toml", "--out", "a"]);
    let said = octant(&["run", "a"]);
    assert!(
        said.contains("4 cases run") && said.contains("after 4 cases: no more are needed"),
        "{said}"
    );
    assert!(octant(&["merge", "a"]).starts_with("4 of 4 cases from 1 part"));
    // In parts all six cases run, and the same four count.
    octant(&["plan", "campaign.toml", "--out", "b"]);
    for shard in ["1/2", "2/2"] {
        octant(&["run", "b", "--shard", shard]);
    }
    assert!(octant(&["merge", "b"]).starts_with("4 of 4 cases from 2 parts"));
    for table in ["cases", "checks", "drift"] {
        let [a, b] = ["a", "b"]
            .map(|folder| std::fs::read(merge::merged(&bench.at(folder), table)).unwrap());
        assert!(a == b, "{table} differs");
    }
}

#[test]
fn a_rule_counts_nothing_that_is_not_shown() {
    use octant_campaign::judge::independence::Shown;
    use octant_campaign::judge::stop::{StopDecision, decide};
    use octant_statistics::cluster::RowResult;
    let stop = "[stop]\nrequirement = \"NAV-1\"\nevery = 10\n";
    let plan =
        Bench::new(&format!("{CAMPAIGN}{stop}").replace("replicates = 3", "replicates = 200"))
            .plan();
    let rule = plan.stop.as_ref().unwrap();
    let decided_of = |shown: &dyn Fn(usize) -> Option<Shown>| {
        let place = |id: &str| plan.cases.iter().position(|case| case.id == id).unwrap();
        decide(&plan, rule, |case| shown(place(&case.id)))
    };
    let decided = |check: &dyn Fn(usize) -> Option<Verdict>| {
        decided_of(&|index| {
            let result = match check(index)? {
                Verdict::Pass => RowResult::Passed,
                Verdict::Fail => RowResult::Failed,
                Verdict::None | Verdict::Inconclusive | Verdict::Error => RowResult::Unknown,
            };
            Some(Shown { result, stream: Some(index.to_string()) })
        })
    };
    // 40 evaluations at 95 %: 0.00125 each; 0.95^n falls below it at n = 131 draws of two cases.
    assert_eq!(decided(&|_| Some(Verdict::Pass)), StopDecision::Shown { end: 270 });
    // Draws with the same streams are one draw, whatever their seeds.
    let same = |index: usize| {
        Some(Shown { result: RowResult::Passed, stream: Some((index % 2).to_string()) })
    };
    assert_eq!(decided_of(&same), StopDecision::Open { next: 400 });
    assert_eq!(decided(&|_| Some(Verdict::Fail)), StopDecision::Refuted { end: 10 });
    // Checks that came to nothing show nothing.
    assert_eq!(decided(&|_| Some(Verdict::Inconclusive)), StopDecision::Open { next: 400 });
    assert_eq!(decided(&|_| Some(Verdict::Error)), StopDecision::Open { next: 400 });
    assert_eq!(decided(&|_| None), StopDecision::Open { next: 10 });
    assert_eq!(
        decided(&|index| (index != 15).then_some(Verdict::Pass)),
        StopDecision::Open { next: 20 }
    );
    // One failure in twenty draws is exactly the allowed rate, which is never shown.
    let one_in_20 =
        |index: usize| Some(if index.is_multiple_of(40) { Verdict::Fail } else { Verdict::Pass });
    assert_eq!(decided(&one_in_20), StopDecision::Open { next: 400 });
}

/// Requirements of a file, some of them on all cases together.
#[test]
fn requirements_of_a_file_are_checked_in_every_case() {
    let campaign = CAMPAIGN
        .replace("title = \"test\"", "title = \"test\"\nrequirements = \"requirements.toml\"");
    let bench = Bench::new(&campaign);
    let requirements = "schema = 1
title = \"Navigation\"
[[requirements]]
id = \"NAV-2\"
text = \"It stays nearer.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"9 nmi\"
pass = \"40 %\"
confidence = \"90 %\"
[[requirements]]
id = \"NAV-3\"
text = \"It stays nearer than anything can.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"0 nmi\"
pass = \"5 %\"
confidence = \"50 %\"
[[requirements]]
id = \"DOC-1\"
text = \"There is a manual.\"
verification = \"inspection\"
";
    std::fs::write(bench.at("requirements.toml"), requirements).unwrap();
    let (plan, folder) = (bench.plan(), bench.at("out"));
    run(&plan, &folder, Shard::WHOLE, 2);
    let state = status::of(&plan, &folder, Shard::WHOLE).unwrap();
    let of = |id: &str| &state.requirements[id];
    // Three draws of two cases each: if all pass they show 46 %, 0.1^(1/3); if none passes, at most
    // 21 % is possible.
    assert_eq!(of("NAV-1").verdict, Verdict::Pass, "{}", state.text());
    assert_eq!(of("NAV-2").verdict, Verdict::Pass, "{}", state.text());
    assert!(of("NAV-2").reason.contains("at least 46.41 %"), "{}", of("NAV-2").reason);
    assert_eq!(of("NAV-3").verdict, Verdict::Inconclusive, "{}", state.text());
    assert_eq!((state.besides, state.verdict()), (Verdict::Pass, Verdict::Inconclusive));
    assert!(state.text().contains("not verified by runs: DOC-1"), "{}", state.text());
    let checks = ExistingTable::open(&merge::part(&folder, Shard::WHOLE, "checks")).unwrap();
    assert_eq!(checks.rows, 18);

    // The trace, and its form for StrictDoc.
    plan.write(&folder, false).unwrap();
    let trace = |arguments: &[&str]| {
        let mut command = program(&[]);
        command.current_dir(bench.folder.path()).args(["campaign", "trace", "out"]);
        command.args(arguments).output().unwrap()
    };
    let output = trace(&["--strictdoc", "project", "--json"]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    let traced: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(traced["requirements"][0]["counts"]["pass"], 6);
    assert_eq!(traced["requirements"][2]["verdict"], serde_json::Value::Null);
    // Requirements of the scenario itself are traced too.
    assert_eq!(traced["requirements"][3]["id"], "NAV-1");
    assert_eq!(traced["requirements"][3]["verdict"], "pass");
    assert_eq!(traced["without_case"], serde_json::json!([]));
    let case =
        std::fs::read_to_string(bench.at(&format!("project/cases/{}.toml", plan.cases[0].id)));
    assert!(case.unwrap().contains("@relation(NAV-2, NAV-3, NAV-1, scope=file)"));
    assert_eq!(trace(&["--strictdoc", "project"]).status.code(), Some(2), "it is there");

    // A failing requirement of the scenario alone fails the trace, as it fails the campaign.
    let broken = Bench::new(&campaign);
    let short = SCENARIO.replace("limit = \"10 nmi\"", "limit = \"1e-9 nmi\"");
    assert_ne!(short, SCENARIO);
    std::fs::write(broken.at("short.toml"), short).unwrap();
    std::fs::write(broken.at("requirements.toml"), requirements).unwrap();
    let (plan, folder) = (broken.plan(), broken.at("out"));
    run(&plan, &folder, Shard::WHOLE, 2);
    plan.write(&folder, false).unwrap();
    for command in [&["campaign", "trace", "out"][..], &["campaign", "status", "out"]] {
        let output = program(command).current_dir(broken.folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{command:?}: {said}");
        assert!(said.contains("NAV-1: fail"), "{said}");
    }

    // Another limit gives other cases.
    std::fs::write(bench.at("requirements.toml"), requirements.replace("9 nmi", "8 nmi")).unwrap();
    assert!(bench.plan().cases.iter().all(|case| plan.case(&case.id).is_none()));
    let refusals = [
        ("id = \"NAV-2\"", "id = \"NAV-1\"", "is one thing in scenario \"short\" and another"),
        ("9 nmi", "9 deg/h", "comparable with nmi"),
        ("radial_error_nmi.max", "radial_eror_nmi.max", "did you mean \"radial_error_nmi\"?"),
        ("schema = 1", "schema = 2", "a newer Octant"),
    ];
    for (what, instead, words) in refusals {
        std::fs::write(bench.at("requirements.toml"), requirements.replacen(what, instead, 1))
            .unwrap();
        let error = bench.refusal();
        assert!(error.contains(words), "{instead}: {error}");
    }
    std::fs::write(bench.at("requirements.toml"), requirements).unwrap();
    let verifies = campaign.replace("id = \"short\"", "id = \"short\"\nverifies = [\"NAV-4\"]");
    std::fs::write(bench.at("campaign.toml"), verifies).unwrap();
    let error = bench.refusal();
    assert!(error.contains("verifies \"NAV-4\", which the requirements don't have"), "{error}");
    let none = campaign.replace("id = \"short\"", "id = \"short\"\nverifies = []");
    std::fs::write(bench.at("campaign.toml"), none).unwrap();
    let state = status::of(&bench.plan(), &bench.at("none"), Shard::WHOLE).unwrap();
    assert_eq!(state.requirements["NAV-2"].reason, "no case verifies it");
    assert_eq!(state.requirements["NAV-2"].verdict, Verdict::Inconclusive);
}

/// Signals from outside: an interrupted case has no result, and the same command resumes.
#[cfg(target_os = "linux")]
mod interrupted {
    use super::*;
    use crate::common::running::{Running, Target, gone};
    use rustix::process::Signal;

    /// Makes cases long enough to be met by a signal.
    fn slow(hours: u32) -> (Bench, Plan) {
        let bench = Bench::new(CAMPAIGN);
        let slow = SCENARIO
            .replace("24 min", &format!("{hours} h"))
            .replace("10 min", &format!("{hours} h"));
        std::fs::write(bench.at("short.toml"), slow).unwrap();
        let plan = bench.plan();
        plan.write(&bench.at("whole"), false).unwrap();
        plan.write(&bench.at("torn"), false).unwrap();
        (bench, plan)
    }

    fn start(bench: &Bench, jobs: &str) -> Running {
        Running::start(bench.folder.path(), &["campaign", "run", "torn", "--jobs", jobs])
    }

    /// Counts the results; each must belong to a case that came to its end.
    fn whole_results(plan: &Plan, folder: &Path) -> usize {
        let stored = CampaignResults::open(folder).unwrap();
        let there = plan.cases.iter().filter(|case| stored.has(&case.id));
        let error = |case: &Case| stored.of_plan(plan, case).unwrap().unwrap().0.error;
        there.inspect(|case| assert_eq!(error(case), None)).count()
    }

    #[test]
    fn a_signal_leaves_no_result_and_the_same_command_goes_on() {
        let (bench, plan) = slow(2);
        run(&plan, &bench.at("whole"), Shard::WHOLE, 2);
        let expected = merged(&plan, &bench.at("whole"));
        let torn = bench.at("torn");
        for (target, signal, statuses) in [
            // A signal may come before the program handles it, or after its last case.
            (Target::Group, Signal::INT, [Some(3), Some(0)]),
            (Target::Group, Signal::TERM, [Some(3), Some(0)]),
            (Target::Parent, Signal::HUP, [Some(3), Some(0)]),
            (Target::Parent, Signal::KILL, [None, Some(0)]),
            (Target::Group, Signal::KILL, [None, Some(0)]),
        ] {
            // At least one case must be left to interrupt.
            stored::clear(&torn);
            let mut running = start(&bench, "2");
            let children = running.children();
            assert!(!children.is_empty());
            running.signal(target, signal);
            let output = running.end();
            assert!(statuses.contains(&output.status.code()), "{signal:?}: {output:?}");
            gone(&children);
            whole_results(&plan, &torn);
        }
        let output = start(&bench, "2").end();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert!(merged(&plan, &torn) == expected);
    }

    #[test]
    fn a_case_whose_process_is_killed_runs_again() {
        let (bench, plan) = slow(2);
        run(&plan, &bench.at("whole"), Shard::WHOLE, 2);
        let mut running = start(&bench, "2");
        for signal in [Signal::KILL, Signal::INT] {
            assert!(!running.children().is_empty());
            running.signal(Target::Child, signal);
        }
        let output = running.end();
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert_eq!(whole_results(&plan, &bench.at("torn")), 6);
        assert!(merged(&plan, &bench.at("torn")) == merged(&plan, &bench.at("whole")));
    }

    /// The process of a case aborts, as after a failed assertion in an FMU or a library.
    #[test]
    fn a_case_that_crashes_is_one_error_and_the_others_pass() {
        let (bench, plan) = slow(2);
        let mut running = start(&bench, "1");
        assert!(!running.children().is_empty());
        running.signal(Target::Child, Signal::ABORT);
        let output = running.end();
        assert_eq!(output.status.code(), Some(4), "{output:?}");
        let state = status::of(&plan, &bench.at("torn"), Shard::WHOLE).unwrap();
        assert_eq!(state.verdict(), Verdict::Error, "{}", state.text());
        let counts = [("pass", 5), ("error", 1)];
        assert!(state.verdicts == counts.into_iter().collect(), "{}", state.text());
        assert!(state.bad[0].reason.starts_with("it crashed: signal: 6"), "{}", state.text());
    }

    #[test]
    fn a_case_whose_process_is_always_killed_has_no_result_and_the_bench_has_failed() {
        // Long cases: each is met before its end.
        let (bench, plan) = slow(1000);
        let mut running = start(&bench, "1");
        while !running.children().is_empty() {
            running.signal(Target::Child, Signal::KILL);
        }
        let output = running.end();
        assert_eq!(output.status.code(), Some(4), "{output:?}");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains("ended from outside 3 times, the last time by SIGKILL"), "{said}");
        assert_eq!(whole_results(&plan, &bench.at("torn")), 0);
    }
}
