//! Figures of the studies, from the last time that each was run, for the page of attacks.

use serde::Deserialize;
use std::fmt::Write as _;
use std::path::Path;

/// Studies that must be included.
const REQUIRED: [&str; 4] = ["program-constants", "code-mutants", "coverage", "signals"];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    studies: Vec<Study>,
}

/// Study that takes too long to be run with every change.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Study {
    id: String,
    title: String,
    command: String,
    asks: String,
    demand: String,
    page: String,
    date: Option<String>,
    commit: Option<String>,
    took: Option<String>,
    found: Option<String>,
    met: Option<bool>,
}

fn root() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..")
}

fn read() -> Vec<Study> {
    let path = root().join("docs/qualification/studies.toml");
    toml::from_str::<File>(&std::fs::read_to_string(path).unwrap()).unwrap().studies
}

/// Renders the section of the page.
pub fn section() -> String {
    let mut text = "## Figures of the studies\n\nFrom `studies.toml`, where each is entered that was run; the \
                    commands are those of [testing](../testing.md#studies).\n\n\
                    | study | asks | has to be found | found | date, commit, time |\n|---|---|---|---|---|\n"
        .to_owned();
    for study in read() {
        let Study { title, command, asks, demand, page, date, commit, took, found, met, .. } =
            study;
        let (found, when) = match (found, date, commit, took, met) {
            (Some(found), Some(date), Some(commit), Some(took), Some(met)) => {
                let met = if met { "met" } else { "**not met**" };
                (format!("{met}: {found}"), format!("{date}, {commit}, {took}"))
            }
            _ => ("**not yet run**".to_owned(), String::new()),
        };
        let _ = writeln!(
            text,
            "| [{title}]({page}), `{command}` | {asks} | {demand} | {found} | {when} |"
        );
    }
    text
}

#[test]
fn every_study_is_there_and_whole() {
    let studies = read();
    for id in REQUIRED {
        assert_eq!(studies.iter().filter(|study| study.id == id).count(), 1, "{id}");
    }
    let testing = std::fs::read_to_string(root().join("docs/testing.md")).unwrap();
    for study in &studies {
        let id = &study.id;
        for text in [&study.title, &study.command, &study.asks, &study.demand] {
            assert!(!text.trim().is_empty() && !text.contains(['|', '\n']), "{id}");
        }
        let told = [&study.date, &study.commit, &study.took, &study.found].map(Option::is_some);
        let is_run = study.met.is_some();
        assert!(told.iter().all(|told| *told == is_run), "{id}: half of a result");
        let named = format!("`{}`", study.command);
        assert!(testing.contains(&named), "{id}: docs/testing.md doesn't name {named}");
        if let (Some(date), Some(commit)) = (&study.date, &study.commit) {
            let number = |part: &str, digits: usize| {
                part.len() == digits && part.chars().all(|c| c.is_ascii_digit())
            };
            let parts: Vec<&str> = date.split('-').collect();
            let is_date =
                matches!(parts[..], [y, m, d] if number(y, 4) && number(m, 2) && number(d, 2));
            assert!(is_date, "{id}: {date}");
            let is_commit = commit.len() >= 7 && commit.chars().all(|c| c.is_ascii_hexdigit());
            assert!(is_commit, "{id}: {commit}");
            // The command of each study must exist here.
            let first = study.command.split(' ').next().unwrap();
            assert!(first == "cargo" || root().join(first).exists(), "{id}: there is no {first}");
        }
    }
}
