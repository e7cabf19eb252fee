//! `octant campaign run --only` and `--failed`: parts of a campaign, which never count twice.

use crate::common::program::{ended, octant_in};
use std::path::Path;
use tempfile::TempDir;

/// Makes a campaign of two scenarios in the folders `a` and `b`: one that passes, and one that fails.
fn planned() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scenario = |limit: &str| {
        format!(
            "schema = 1\n[procedure.calibration]\npositions = \"eight\"\nduration = \"24 min\"\n\
             [procedure.navigation]\nduration = \"10 min\"\n[[requirements]]\nid = \"NAV\"\n\
             text = \"It stays near.\"\nmeasure = \"navigation.radial_error_nmi.max\"\n\
             limit = \"{limit}\"\n"
        )
    };
    let campaign = "schema = 1\ntitle = \"two\"\n[[scenarios]]\nid = \"good\"\nfile = \"good.toml\"\n\
                    [[scenarios]]\nid = \"bad\"\nfile = \"bad.toml\"\n[[factors]]\nname = \"latitude\"\n\
                    key = \"site.latitude\"\nvalues = [\"0 deg\", \"60 deg\"]\n";
    for (name, text) in [
        ("good.toml", scenario("10 nmi").as_str()),
        ("bad.toml", scenario("0 nmi").as_str()),
        ("campaign.toml", campaign),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    for out in ["a", "b"] {
        campaign_of(folder.path(), &["plan", "campaign.toml", "--out", out], 0);
    }
    folder
}

/// Runs `octant campaign`, which has to end with this status; returns what it prints.
#[track_caller]
fn campaign_of(folder: &Path, arguments: &[&str], status: i32) -> String {
    let arguments = [&["campaign"][..], arguments].concat();
    ended(octant_in(folder, &arguments), status).0
}

fn tables(folder: &Path) -> Vec<Vec<u8>> {
    let file = |name: &str| std::fs::read(folder.join(format!("{name}.parquet"))).unwrap();
    ["cases", "checks", "drift"].map(file).to_vec()
}

#[test]
fn a_selection_is_inconclusive_about_the_rest_and_the_rest_completes_it() {
    let folder = planned();
    let run = |arguments: &[&str], status| campaign_of(folder.path(), arguments, status);
    run(&["run", "b"], 1);
    run(&["merge", "b"], 0);
    let good = ["run", "a", "--only", "good", "--only", "latitude=6*"];
    let said = run(&good, 3);
    assert!(said.starts_with("1 case run, 0 with a result already\n"), "{said}");
    assert!(said.contains("next: octant campaign run a "), "{said}");
    let said = run(&["merge", "a"], 3);
    assert!(said.starts_with("1 of 4 cases from 1 part, 3 without a result yet"), "{said}");
    assert!(run(&good, 3).starts_with("0 cases run, 1 with a result already\n"));
    let said = run(&["run", "a"], 1);
    assert!(said.starts_with("3 cases run, 1 with a result already\n"), "{said}");
    run(&["merge", "a"], 0);
    assert!(tables(&folder.path().join("a")) == tables(&folder.path().join("b")));
    let none = octant_in(folder.path(), &["campaign", "run", "a", "--only", "goo"]);
    let (_, said) = ended(none, 2);
    assert!(said.contains("found no case that matches \"goo\""), "{said}");
    assert!(said.contains("good, latitude=0 deg"), "{said}");
}

#[test]
fn failed_and_missing_cases_run_again_and_count_once() {
    let folder = planned();
    let run = |arguments: &[&str], status| campaign_of(folder.path(), arguments, status);
    run(&["run", "a"], 1);
    run(&["merge", "a"], 0);
    let expected = tables(&folder.path().join("a"));
    let said = run(&["run", "a", "--failed"], 1);
    assert!(said.starts_with("2 cases run, 2 with a result already\n"), "{said}");
    assert!(said.contains("next: octant campaign case a "), "{said}");
    // One of those that passed is lost.
    let status = octant_in(folder.path(), &["campaign", "status", "a", "--json"]);
    assert_eq!(status.status.code(), Some(1));
    let plan: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("a/plan.json")).unwrap()).unwrap();
    let cases = plan["cases"].as_array().unwrap();
    let good = cases.iter().find(|case| case["scenario"] == "good").unwrap();
    let id = good["id"].as_str().unwrap();
    crate::common::results::remove(&folder.path().join("a"), id);
    let said = run(&["run", "a", "--failed"], 1);
    assert!(said.starts_with("3 cases run, 1 with a result already\n"), "{said}");
    run(&["merge", "a"], 0);
    assert!(tables(&folder.path().join("a")) == expected);
}

/// The lines that say what comes next can be pasted into a shell.
#[test]
fn folders_with_spaces_are_quoted_in_the_commands_that_come_next() {
    let folder = planned();
    let run = |arguments: &[&str], status| campaign_of(folder.path(), arguments, status);
    std::fs::rename(folder.path().join("a"), folder.path().join("it's a")).unwrap();
    let said = run(&["run", "it's a", "--only", "bad"], 1);
    assert!(said.contains(r"next: octant campaign case 'it'\''s a' "), "{said}");
    assert!(said.contains(r"next: octant campaign run 'it'\''s a'   (2 cases "), "{said}");
    let said = run(&["run", "it's a"], 1);
    for command in ["merge", "report"] {
        let line = format!(r"next: octant campaign {command} 'it'\''s a'");
        assert!(said.lines().any(|said| said == line), "{said}");
    }
    let file = folder.path().join("a b.toml");
    std::fs::copy(folder.path().join("campaign.toml"), &file).unwrap();
    let (_, said) = ended(octant_in(folder.path(), &["campaign", "run", "a b.toml"]), 2);
    assert!(said.contains("octant campaign plan 'a b.toml' makes one"), "{said}");
}
