//! Cases that begin alike are run together, and have the results that they have alone.

use crate::common::program::program;
use octant_base::control::Control;
use octant_campaign::execute::alike::{MOST, groups, run_alike};
use octant_campaign::execute::case;
use octant_campaign::plan::{Case, Plan};
use octant_campaign::store::CampaignResults;
use octant_fmu_bind::OpenedFmus;
use octant_run::{Prepared, assemble};
use std::collections::BTreeSet;
use std::path::Path;

const SCENARIO: &str = "schema = 1
title = \"alike\"
seed = 1
[procedure.calibration]
positions = \"eight\"
duration = \"24 min\"
[procedure.navigation]
duration = \"10 min\"
[baseline]
positions = \"six\"
[[faults]]
id = \"spike-1\"
kind = \"spike\"
trigger = { at = \"1300 s\" }
duration = \"10 samples\"
channels = \"gyro x\"
amplitude = \"100 deg/h\"
[[faults]]
id = \"slip-1\"
kind = \"encoder-slip\"
trigger = { at = \"700 s\" }
gimbal = \"azimuth\"
angle = \"0.2 deg\"
[[faults]]
id = \"dropout-1\"
kind = \"dropout-held\"
trigger = { at = \"1500 s\" }
duration = \"0.1 s\"
[[requirements]]
id = \"NAV-1\"
text = \"It stays near.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"10 nmi\"
";

const CAMPAIGN: &str = "schema = 1
title = \"alike\"
replicates = 1
[[scenarios]]
id = \"alike\"
file = \"alike.toml\"
[[factors]]
name = \"latitude\"
key = \"site.latitude\"
values = [\"0 deg\", \"60 deg\"]
[[factors]]
name = \"navigation\"
key = \"procedure.navigation.duration\"
values = [\"10 min\", \"15 min\"]
[[factors]]
name = \"fault\"
faults = [[], [\"spike-1\"], [\"slip-1\"], [\"spike-1\", \"dropout-1\"]]
[[factors]]
name = \"amplitude\"
key = \"faults.spike-1.amplitude\"
values = [\"50 deg/h\", \"500 deg/h\"]
";

/// Asks for a twin of each method.
const OF_TWINS: &str = "[[requirements]]
id = \"SHIFT-1\"
text = \"No parameter moves.\"
measure = \"counterfactual.worst_shift_sigma\"
limit = 1000
[[requirements]]
id = \"SHIFT-2\"
text = \"Nor in the second method.\"
measure = \"baseline.counterfactual.worst_shift_sigma\"
limit = 1000
";

fn plan(folder: &Path) -> Plan {
    plan_of(folder, SCENARIO, CAMPAIGN)
}

/// A plan whose cases have twins, with several navigations and several faulted cases a draw.
fn plan_with_twins(folder: &Path) -> Plan {
    let campaign = CAMPAIGN.replace("faults = [[], ", "faults = [");
    plan_of(folder, &format!("{SCENARIO}{OF_TWINS}"), &campaign)
}

fn plan_of(folder: &Path, scenario: &str, campaign: &str) -> Plan {
    std::fs::write(folder.join("alike.toml"), scenario).unwrap();
    std::fs::write(folder.join("campaign.toml"), campaign).unwrap();
    Plan::of(&folder.join("campaign.toml")).unwrap()
}

#[test]
fn groups_have_one_scenario_and_seed_and_differ_by_faults_and_navigation() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(folder.path());
    let cases: Vec<&Case> = plan.cases.iter().collect();
    let found = groups(&cases, 1);
    let places: BTreeSet<usize> = found.iter().flatten().copied().collect();
    assert_eq!(places.len(), found.iter().map(Vec::len).sum::<usize>(), "each case once");
    assert_eq!(places.len(), cases.len());
    assert!(found.iter().any(|group| group.len() > 4) && found.iter().all(|g| g.len() <= MOST));
    for group in &found {
        let first = cases[group[0]];
        for other in group.iter().map(|place| cases[*place]) {
            assert_eq!((&first.scenario, first.seed), (&other.scenario, other.seed));
            let latitude = |case: &Case| case.set.iter().find(|s| s.starts_with("site.")).cloned();
            assert_eq!(latitude(first), latitude(other));
        }
    }
    // No processor waits for one group.
    assert!(groups(&cases, 8).iter().all(|group| group.len() <= cases.len() / 16));
    assert!(groups(&[], 2).is_empty());
}

#[test]
fn a_case_has_the_result_that_it_has_alone() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(folder.path());
    let cases: Vec<&Case> = plan.cases.iter().collect();
    for group in groups(&cases, 2) {
        let together: Vec<&Case> = group.iter().map(|place| cases[*place]).collect();
        let planned = plan.planned(together[0]).unwrap();
        let results = run_alike(planned, &together);
        assert_eq!(results.len(), together.len());
        for (case, result) in together.iter().zip(results) {
            let alone = case::run(planned, case, &Control::default()).unwrap();
            let alone = alone.to_json().unwrap();
            assert!(
                alone.contains("\"stream_hash\"") && !alone.contains("\"fired\":false"),
                "{alone}"
            );
            assert_eq!(result.unwrap().to_json().unwrap(), alone);
        }
    }
}

/// The effects of faults are those of a single run with its twin, however many cases share the twin.
#[test]
fn a_case_has_the_twin_that_it_has_alone() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan_with_twins(folder.path());
    let cases: Vec<&Case> = plan.cases.iter().collect();
    let together = groups(&cases, 1).swap_remove(0);
    let together: Vec<&Case> = together.iter().map(|place| cases[*place]).collect();
    let planned = plan.planned(together[0]).unwrap();
    let mut twins = BTreeSet::new();
    for (case, result) in together.iter().zip(run_alike(planned, &together)) {
        let result = result.unwrap();
        let alone = case::run(planned, case, &Control::default()).unwrap();
        assert_eq!(result.to_json().unwrap(), alone.to_json().unwrap());
        let summary = result.summary.unwrap();
        let scenario = planned.scenario(case).unwrap();
        let prepared = Prepared::of(&scenario, case.seed, true, &OpenedFmus::default()).unwrap();
        let single = tempfile::tempdir().unwrap();
        let mut methods = prepared.run(single.path()).unwrap().into_iter();
        let (primary, baseline) = (methods.next().unwrap(), methods.next());
        let run = assemble(&scenario, case.seed, primary, baseline).unwrap().summary;
        assert!(run.counterfactual.is_some());
        assert_eq!(summary.counterfactual, run.counterfactual);
        assert_eq!(summary.baseline.unwrap().counterfactual, run.baseline.unwrap().counterfactual);
        assert_eq!(summary.requirements, run.requirements);
        twins.insert(summary.counterfactual.unwrap().twin_stream_hash);
    }
    assert!(together.len() > 4 && twins.len() == 2, "a twin for each navigation: {twins:?}");
}

#[test]
fn the_command_gives_the_same_bytes_both_ways() {
    let folder = tempfile::tempdir().unwrap();
    both_ways(folder.path(), &plan(folder.path()), ("--jobs", "--undivided"));
}

#[test]
fn the_command_gives_the_same_twins_both_ways() {
    let folder = tempfile::tempdir().unwrap();
    both_ways(folder.path(), &plan_with_twins(folder.path()), ("--jobs", "--undivided"));
}

fn both_ways(here: &Path, plan: &Plan, (jobs, alone): (&str, &str)) {
    let [divided, undivided] =
        [("divided", &[][..]), ("undivided", &[alone][..])].map(|(name, options)| {
            plan.write(&here.join(name), false).unwrap();
            let mut command = program(&["campaign", "run", name, jobs, "2"]);
            let output = command.current_dir(here).args(options).output().unwrap();
            assert_eq!(output.status.code(), Some(0), "{output:?}");
            let stored = CampaignResults::open(&here.join(name)).unwrap();
            let json = |case| stored.of_plan(plan, case).unwrap().unwrap().0.to_json().unwrap();
            plan.cases.iter().map(json).collect::<Vec<_>>()
        });
    assert_eq!(divided, undivided);
}

/// A process that dies while it runs cases together has not shown which of them is to blame.
#[cfg(target_os = "linux")]
#[test]
fn a_crash_while_cases_run_together_is_no_error_of_one_of_them() {
    use crate::common::running::{Running, Target};
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let plan = plan(here);
    plan.write(&here.join("run"), false).unwrap();
    let mut running = Running::start(here, &["campaign", "run", "run", "--jobs", "1"]);
    assert!(!running.children().is_empty());
    running.signal(Target::Child, rustix::process::Signal::ABORT);
    let output = running.end();
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let stored = CampaignResults::open(&here.join("run")).unwrap();
    let failed = plan
        .cases
        .iter()
        .filter(|case| stored.of_plan(&plan, case).unwrap().unwrap().0.error.is_some());
    assert_eq!(failed.count(), 0);
}
