//! Looks at the results of a campaign: what is shown before one, what counts after it, and the journal of both.

use crate::campaign_report::bench::{Bench, SCENARIO, check, put, synthetic};
use octant_campaign::journal::{Journal, JournalEvent};
use octant_campaign::plan::Plan;
use serde_json::{Value, json};

const ASKED: &str = "schema = 1
title = \"Requirements\"
[[requirements]]
id = \"NAV-1\"
text = \"The position stays near.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"10 nmi\"
pass = \"90 %\"
confidence = \"90 %\"
";

/// A campaign of a number of draws, with further keys of its file.
pub(crate) struct Looked {
    pub(crate) bench: Bench,
    pub(crate) plan: Plan,
}

impl Looked {
    pub(crate) fn of(replicates: u32, keys: &str) -> Self {
        Self::asked(replicates, keys, ASKED)
    }

    fn asked(replicates: u32, keys: &str, requirements: &str) -> Self {
        let bench = Bench::new(&campaign(replicates, keys));
        let scenario = SCENARIO.split("[[faults]]").next().unwrap();
        std::fs::write(bench.at("short.toml"), scenario).unwrap();
        std::fs::write(bench.at("requirements.toml"), requirements).unwrap();
        let plan = bench.plan();
        let looked = Self { bench, plan };
        looked.octant(&["campaign", "plan", "campaign.toml", "--out", "out"], 0);
        looked
    }

    /// Gives results to the cases at these places; those that `fails` names fail.
    pub(crate) fn fill(&self, places: std::ops::Range<usize>, fails: &[usize]) {
        for index in places {
            let case = &self.plan.cases[index];
            let mut result = synthetic(&self.plan, index, case);
            result["summary"]["faults"] = json!([]);
            let checks = result["summary"]["requirements"].as_array_mut().unwrap();
            let asked: Vec<&str> =
                self.plan.requirements.iter().map(|planned| planned.check.id.as_str()).collect();
            checks.retain(|check| asked.contains(&check["id"].as_str().unwrap()));
            check(&mut result, "NAV-1", if fails.contains(&index) { 11.0 } else { 1.0 }, 10.0);
            put(&self.bench.at("out"), case, &result);
        }
    }

    /// Runs a command that has to end with a status, and returns what it says.
    #[track_caller]
    pub(crate) fn octant(&self, arguments: &[&str], status: i32) -> String {
        let output = self.bench.octant(arguments);
        let said =
            String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {said}");
        said
    }

    #[track_caller]
    pub(crate) fn status(&self, status: i32) -> String {
        self.octant(&["campaign", "status", "out"], status)
    }

    /// Makes the plan larger.
    pub(crate) fn extend(&mut self, replicates: u32, keys: &str) -> String {
        std::fs::write(self.bench.at("campaign.toml"), campaign(replicates, keys)).unwrap();
        self.plan = self.bench.plan();
        self.octant(&["campaign", "plan", "campaign.toml", "--out", "out", "--extend"], 0)
    }

    pub(crate) fn journal(&self) -> Vec<JournalEvent> {
        let journal = Journal::read(&self.bench.at("out")).unwrap();
        journal.entries.into_iter().map(|entry| entry.event).collect()
    }

    pub(crate) fn looks(&self) -> usize {
        let is_look = |event: &&JournalEvent| matches!(event, JournalEvent::Look { .. });
        self.journal().iter().filter(is_look).count()
    }
}

fn campaign(replicates: u32, keys: &str) -> String {
    format!(
        "schema = 1\ntitle = \"looks\"\nreplicates = {replicates}\n{keys}requirements = \"requirements.toml\"\n\
         [[scenarios]]\nid = \"short\"\nfile = \"short.toml\"\n"
    )
}

/// Progress is shown before the look and no outcome; then the draws of the plan count, and what is added doesn't.
#[test]
fn a_plan_that_is_looked_at_once() {
    let mut looked = Looked::of(22, "");
    looked.fill(0..12, &[3]);
    let said = looked.status(3);
    assert!(said.contains("12 of 22 cases have run: not looked at yet"), "{said}");
    assert!(
        said.contains("looked at once, after 22 draws; the next look is due when 22 cases"),
        "{said}"
    );
    for outcome in ["fail", "passed", "11 nmi", &looked.plan.cases[3].id.to_string()] {
        assert!(!said.contains(outcome), "{outcome}: {said}");
    }
    let shown: Value =
        serde_json::from_str(&looked.octant(&["campaign", "status", "out", "--json"], 3)).unwrap();
    assert_eq!(shown["requirements"]["NAV-1"]["draws"]["not_passed"], 0);
    assert_eq!((&shown["verdicts"], &shown["looks"]["is_due"]), (&json!({}), &json!(false)));
    assert_eq!(looked.looks(), 0);
    looked.fill(12..22, &[]);
    let said = looked.status(3);
    assert!(said.contains("21 of 22 independent draws passed"), "{said}");
    // One failure in 38 draws shows 90 % at 90 %.
    assert!(
        said.contains("draws that are added to this plan don't count; a new plan with 38 draws"),
        "{said}"
    );
    assert!(!said.contains("more independent draws would show it"), "{said}");
    looked.status(3);
    assert_eq!(looked.looks(), 1, "the same results again are no further look");
    let said = looked.extend(60, "");
    assert!(
        said.contains("the first look was at 22 cases: the 38 further ones are nominal"),
        "{said}"
    );
    looked.fill(22..60, &[]);
    let said = looked.status(3);
    assert!(said.contains("21 of 22 independent draws passed"), "{said}");
    assert!(
        said.contains("nominal, with what was drawn after the first look: 59 of 60 passed"),
        "{said}"
    );
    let events = looked.journal();
    let is_told = |is: fn(&JournalEvent) -> bool| events.iter().any(is);
    assert!(is_told(|event| matches!(event, JournalEvent::Extended { cases_before: 22, .. })));
    assert_eq!(looked.looks(), 2);
    looked.octant(&["campaign", "report", "out"], 3);
    let statistics = looked.bench.statistics();
    let found = &statistics["requirements"][0];
    assert_eq!(
        (&found["draws"]["passed"], &found["verdict"]),
        (&json!(21), &json!("inconclusive"))
    );
    let page = looked.bench.read("report.html");
    assert!(
        page.contains("extended from 22 cases")
            && page.contains("looked at by octant campaign status")
    );
    assert!(looked.octant(&["verify", "out"], 0).contains("integrity: whole"));
}

/// A plan that grows before anything was seen has the claim of all of its draws.
#[test]
fn an_extension_before_the_look_counts() {
    let mut looked = Looked::of(10, "");
    looked.fill(0..10, &[]);
    looked.extend(22, "");
    looked.fill(10..22, &[]);
    let said = looked.status(0);
    assert!(said.contains("NAV-1: pass: 22 of 22 independent draws passed"), "{said}");
}

#[test]
fn a_plan_with_several_looks() {
    let looked = Looked::of(66, "looks = 3\n");
    let said = looked.octant(&["campaign", "plan", "campaign.toml", "--out", "out"], 0);
    // Each look may spend a third more of 10 %: 0.9^44 is 0.97 %, and 0.9^22 is 9.8 %.
    assert!(said.contains("looked at 3 times, the last time after 66 draws"), "{said}");
    assert!(
        said.contains(
            "after 22 can't be shown yet, after 44 at most 1 may fail, after 66 at most 2 may fail"
        ),
        "{said}"
    );
    assert!(said.contains("(22 if it is looked at once)"), "{said}");
    looked.fill(0..21, &[]);
    assert!(looked.status(3).contains("21 of 66 cases have run: not looked at yet"));
    // More than a look has come to is not shown: the two failures are beyond it.
    looked.fill(21..30, &[25, 26]);
    let said = looked.status(3);
    assert!(said.contains("look 1 of 3: 0 of 22 draws didn't pass, too few draws to show it; the next look is after 44 draws"), "{said}");
    looked.fill(30..44, &[]);
    let said = looked.status(3);
    assert!(
        said.contains(
            "look 2 of 3: 2 of 44 draws didn't pass, 1 may; the next look is after 66 draws"
        ),
        "{said}"
    );
    looked.fill(44..66, &[]);
    let said = looked.status(0);
    assert!(said.contains("look 3 of 3: 2 of 66 draws didn't pass, 2 may"), "{said}");
    assert!(said.contains("over all looks"), "{said}");
}

#[test]
fn a_plan_that_is_looked_at_openly() {
    let mut looked = Looked::of(30, "looks = \"open\"\n");
    let said = looked.octant(&["campaign", "plan", "campaign.toml", "--out", "out"], 0);
    assert!(said.contains("looked at openly, at any time"), "{said}");
    assert!(said.contains("needs 34 draws if all pass (22 if it is looked at once)"), "{said}");
    looked.fill(0..10, &[]);
    let said = looked.status(3);
    assert!(said.contains("10 of 10 independent draws passed"), "{said}");
    assert!(
        said.contains("24 more independent draws would show it, if all of them pass"),
        "{said}"
    );
    looked.fill(10..30, &[]);
    looked.status(3);
    looked.extend(40, "looks = \"open\"\n");
    looked.fill(30..40, &[]);
    let said = looked.status(0);
    assert!(
        said.contains("40 of 40 independent draws passed")
            && said.contains("whenever it is looked at"),
        "{said}"
    );
}

/// A stopping rule looks several times: the verdict at the end has the part of the error that each of its looks has.
#[test]
fn a_stopping_rule_counts_its_looks() {
    let stop = "stop = { requirement = \"NAV-1\", pass = 0.9, confidence = 0.9, every = 10 }\n";
    let looked = Looked::of(40, stop);
    // Two failures in 52 draws show 90 % at 90 %, one in 38: but 40 draws are the fourth look.
    looked.fill(0..40, &[1]);
    let said = looked.status(3);
    assert!(said.contains("NAV-1: inconclusive: 39 of 40 independent draws passed"), "{said}");
    assert!(said.contains("at each of the looks of [stop], together"), "{said}");
    let once = Looked::of(40, "");
    once.fill(0..40, &[1]);
    assert!(once.status(0).contains("NAV-1: pass: 39 of 40 independent draws passed"));
    let refused = Bench::new(&campaign(40, &format!("looks = 3\n{stop}")));
    let output = refused.octant(&["campaign", "plan", "campaign.toml"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("found [stop] too, whose looks are counted already"), "{said}");
}

/// The seed comes from what the plan says; one that is given is told.
#[test]
fn seeds_that_are_given_are_told() {
    let own = Looked::of(3, "");
    let seed = own.plan.seed().unwrap();
    assert!(own.plan.seed_from_plan && seed > 1);
    let said = own.octant(&["campaign", "plan", "campaign.toml", "--out", "out"], 0);
    assert!(said.contains(&format!("seed {seed}, from the plan's hash")), "{said}");
    assert_eq!(Looked::of(5, "").plan.seed(), Some(seed), "a campaign can grow");
    assert_ne!(Looked::of(3, "looks = \"open\"\n").plan.seed(), Some(seed));
    let given = Looked::of(3, "seed = 4\n");
    let said = given.octant(&["campaign", "plan", "campaign.toml", "--out", "out"], 0);
    assert!(said.contains("seed 4, given in the campaign's file"), "{said}");
    given.fill(0..3, &[]);
    given.octant(&["campaign", "report", "out"], 3);
    assert_eq!(given.bench.statistics()["seed"], "seed 4, given in the campaign's file");
    assert!(given.bench.read("report.html").contains("Seed 4, given in the campaign"));
}

/// All requirements together: draws that pass every check, and the errors of the claims in sum.
#[test]
fn requirements_are_stated_together_too() {
    let two = format!(
        "{ASKED}[[requirements]]\nid = \"CAL-1\"\ntext = \"No parameter is far off.\"\n\
         measure = \"calibration.worst_normalized_error\"\nlimit = 50\npass = \"80 %\"\nconfidence = \"95 %\"\n"
    );
    let looked = Looked::asked(22, "", &two);
    looked.fill(0..22, &[3]);
    let case = &looked.plan.cases[5];
    let place = looked.bench.at("out");
    let text = crate::common::results::text(&place, &case.id);
    let mut result: Value = serde_json::from_str(&text).unwrap();
    check(&mut result, "CAL-1", 60.0, 50.0);
    crate::common::results::remove(&place, &case.id);
    put(&place, case, &result);
    let said = looked.status(3);
    assert!(
        said.contains("NAV-1: inconclusive: 21 of 22") && said.contains("CAL-1: pass: 21 of 22"),
        "{said}"
    );
    // The p at which at most two failures in 22 have a probability of 5 %: 0.740533.
    assert!(
        said.contains("all together: 20 of 22 independent draws passed every check of 2 requirements: with 95.00 % confidence a draw passes all of them with a probability of at least 74.05 %"),
        "{said}"
    );
    assert!(said.contains("hold together with a confidence of at least 85.00 %"), "{said}");
    looked.octant(&["campaign", "report", "out"], 3);
    let joint = &looked.bench.statistics()["joint"];
    assert_eq!((&joint["requirements"], &joint["claims"]), (&json!(2), &json!(2)));
    assert!((joint["together"].as_f64().unwrap() - 0.85).abs() < 1e-12);
    assert!(looked.bench.read("report.html").contains("All requirements together: 20 of 22"));
}
