//! Qualification kit: every operational requirement names existing tests, every case of the
//! self-test verifies one, and the trace is up to date.

use octant_campaign::plan::requirements::load;
use octant_verdict::requirement::{Requirement, Requirements, Verification};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../.."))
}

fn kit() -> Requirements {
    load(&root().join("docs/qualification/requirements.toml")).unwrap()
}

fn tests(requirement: &Requirement) -> Vec<(String, String)> {
    let Verification::Tests(all) = &requirement.verification else {
        panic!(
            "{} is verified by {}, and not by tests",
            requirement.id,
            requirement.verification.name()
        )
    };
    all.iter()
        .map(|test| {
            let (file, name) = test.split_once("::").unwrap_or_else(|| panic!("{test}: no ::"));
            (file.to_owned(), name.to_owned())
        })
        .collect()
}

/// Returns whether a test exists: a case of the self-test, a test function, or a check of a rig.
pub(crate) fn is_there(file: &str, name: &str) -> bool {
    if file == "selftest" {
        return octant_selftest::cases().iter().any(|case| case.id == name);
    }
    let Ok(text) = std::fs::read_to_string(root().join(file)) else { return false };
    // A rig as a whole.
    if name == "all" && step(file) == file.strip_prefix("tests/rigs/") {
        return step(file).is_some();
    }
    if Path::new(file).extension().is_some_and(|ending| ending == "rs") {
        // A test, or a property inside of `proptest!`, but not an excluded one.
        let Some(at) = text.find(&format!("fn {name}(")) else { return false };
        let before = &text[..at];
        let attributes = &before[before.rfind(['}', ';']).map_or(0, |end| end + 1)..];
        return attributes.contains("#[test]");
    }
    if Path::new(file).extension().is_some_and(|ending| ending == "py") {
        let part = |kind: &str| text.contains(&format!("\n{kind} {name}("));
        return part("def") || part("class") || text.contains(&format!("\"{name}\""));
    }
    text.contains(&format!("\"{name}\""))
}

/// Returns the step of `tests/run` to which a rig's file belongs.
fn step(file: &str) -> Option<&str> {
    let name = file.strip_prefix("tests/rigs/")?;
    Some(name.strip_suffix(".py").unwrap_or(name))
}

#[test]
fn every_requirement_names_tests_that_there_are() {
    let kit = kit();
    let run = std::fs::read_to_string(root().join("tests/run")).unwrap();
    assert!(kit.requirements.len() >= 40);
    let mut missing = Vec::new();
    for requirement in &kit.requirements {
        let tests = tests(requirement);
        assert!(!tests.is_empty(), "{} has no test", requirement.id);
        for (file, name) in tests {
            // A rig that `tests/run` doesn't list is never run.
            let is_run =
                step(&file).is_none_or(|name| run.contains(&format!("tests/rigs/{name}\n")));
            if !is_there(&file, &name) || !is_run {
                missing.push(format!("{}: {file}::{name}", requirement.id));
            }
        }
    }
    assert!(missing.is_empty(), "not there:\n{}", missing.join("\n"));
    // Missing tests are found.
    assert!(!is_there("selftest", "nothing"));
    assert!(!is_there("harness/program/octant/tests/campaign.rs", "nothing"));
    assert!(
        !is_there("harness/program/octant/tests/campaign.rs", "begin"),
        "a function that is no test"
    );
    assert!(!is_there("harness/program/octant/tests/gone.rs", "nothing"));
    assert!(!is_there("tests/rigs/survival.py", "Gone"));
    assert!(!is_there("harness/program/octant/tests/campaign.rs", "all"));
    assert!(!is_there("tests/rigs/gone", "all"));
}

/// Mutants that no test detects are listed with a reason, by names that don't change with edits of
/// the file.
#[test]
fn missed_mutants_are_of_files_that_there_are_and_have_reasons() {
    #[derive(serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Missed {
        mutant: String,
        reason: String,
    }
    #[derive(serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        missed: Vec<Missed>,
    }
    let text = std::fs::read_to_string(root().join("docs/qualification/mutants.toml")).unwrap();
    let all = toml::from_str::<File>(&text).unwrap().missed;
    for Missed { mutant, reason } in &all {
        let (file, change) =
            mutant.split_once(": ").unwrap_or_else(|| panic!("{mutant}: no change"));
        assert!(
            root().join(file).is_file(),
            "{mutant}: there is no such file, or a line stands in it"
        );
        assert!(change.starts_with("replace ") || change.starts_with("delete "), "{mutant}");
        assert!(!reason.trim().is_empty(), "{mutant}: no reason");
        assert_eq!(all.iter().filter(|other| other.mutant == *mutant).count(), 1, "{mutant}");
    }
}

#[test]
fn every_case_of_the_self_test_verifies_a_requirement() {
    let named: Vec<String> = kit()
        .requirements
        .iter()
        .flat_map(tests)
        .filter(|(file, _)| file == "selftest")
        .map(|(_, name)| name)
        .collect();
    for case in octant_selftest::cases() {
        assert!(named.contains(&case.id.to_owned()), "{} verifies nothing", case.id);
    }
}

fn link(file: &str, name: &str) -> String {
    if file == "selftest" {
        return format!("[self-test](../selftest.md) `{name}`");
    }
    format!("[{file}](../../{file}) `{name}`")
}

/// Renders `trace.md`.
fn trace(kit: &Requirements) -> String {
    let mut text = "# Trace\n\nMade from `requirements.toml` by `OCTANT_WRITE_FIXTURES=1 cargo test -p octant \
        qualification`; the same test fails where it isn't up to date, or where a test that it names isn't \
        there.\n\n## From requirements to tests\n"
        .to_owned();
    let mut section = "";
    let mut back: BTreeMap<(String, String), Vec<&str>> = BTreeMap::new();
    for requirement in &kit.requirements {
        let title = requirement.section.first().map_or("", String::as_str);
        if title != section {
            section = title;
            _ = write!(
                text,
                "\n### {section}\n\n| id | requirement | verified by |\n|---|---|---|\n"
            );
        }
        let tests = tests(requirement);
        let links: Vec<String> = tests.iter().map(|(file, name)| link(file, name)).collect();
        _ = writeln!(
            text,
            "| {} | {} | {} |",
            requirement.id,
            requirement.text,
            links.join("<br>")
        );
        for test in tests {
            back.entry(test).or_default().push(&requirement.id);
        }
    }
    text += "\n## From tests to requirements\n\n| test | verifies |\n|---|---|\n";
    for ((file, name), ids) in back {
        _ = writeln!(text, "| {} | {} |", link(&file, &name), ids.join(", "));
    }
    text
}

#[test]
fn the_trace_is_up_to_date() {
    let path = root().join("docs/qualification/trace.md");
    let made = trace(&kit());
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let there = std::fs::read_to_string(&path).unwrap();
    assert_eq!(there, made, "run this test with OCTANT_WRITE_FIXTURES=1 to write the trace");
}
