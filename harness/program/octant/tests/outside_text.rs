//! Text from outside with characters that act: none reaches a terminal, a page or a file of XML as it is.

use crate::common::program::{octant_in, program};
use octant_base::printable::is_bad;
use std::path::Path;

/// Clears a terminal, rings its bell, turns text around.
const HOSTILE: &str = "h\u{1b}[2J\u{7}\u{9b}31m\u{202e}e\u{fffe}";

/// Finds no character in a text that acts.
#[track_caller]
pub fn nothing_acts(about: &str, text: &str) {
    let found = text.char_indices().find(|(_, c)| is_bad(*c));
    if let Some((at, c)) = found {
        let around: String = text[..at].chars().rev().take(60).collect();
        let around: String = around.chars().rev().collect();
        panic!("{about}: {c:?} after {around:?}");
    }
}

/// Finds no character that acts in what a run shows.
#[track_caller]
pub fn nothing_acts_in(run: &Path) {
    for name in ["report.html", "junit.xml", "summary.json", "manifest.json"] {
        nothing_acts(name, &std::fs::read_to_string(run.join(name)).unwrap());
    }
}

const SCENARIO: &str = "schema = 1\ntitle = \"short\"\n[procedure.alignment]\nmethod = \"given\"\n\
    [procedure.navigation]\nduration = \"5 s\"\n[record]\nsamples = \"full\"\n";

#[test]
fn names_of_files_and_of_the_operator_act_nowhere() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("s.toml"), SCENARIO).unwrap();
    let file = format!("{HOSTILE}.mcap");
    let first = program(&["run", "s.toml", "--out", HOSTILE])
        .current_dir(at)
        .env("OCTANT_OPERATOR", HOSTILE)
        .output()
        .unwrap();
    assert_eq!(first.status.code(), Some(0), "{first:?}");
    let run = at.join(HOSTILE);
    nothing_acts_in(&run);
    let page = std::fs::read_to_string(run.join("report.html")).unwrap();
    assert!(page.contains("h\\u001b[2J\\u0007\\u009b31m\\u202ee\\ufffe"), "the operator is shown");
    // The name comes back whole.
    let manifest = octant_evidence::Manifest::read(&run).unwrap();
    assert_eq!(manifest.operator.as_deref(), Some(HOSTILE));
    std::fs::copy(run.join("recording.mcap"), at.join(&file)).unwrap();
    let source = format!("replay:{file}");
    let mut all = vec![first];
    for arguments in [
        &["run", "s.toml", "--out", HOSTILE][..],
        &["run", "s.toml", "--out", "other", "--source", &source],
        &["run", "s.toml", "--out", "again"],
        &["run", HOSTILE],
        &["run", "s.toml", "--out", "other", "--endpoint", HOSTILE],
        &["run", "s.toml", "--set", HOSTILE],
        &["verify", HOSTILE],
        &["report", HOSTILE, "--out", "again.html"],
        &["rejudge", HOSTILE],
        &["diff", HOSTILE, "again"],
        &["watch", HOSTILE, "--plain"],
        &["score", &file],
        &["export", HOSTILE, "--to", "csv"],
        &["verify", &file],
        &["campaign", "status", HOSTILE],
        &[HOSTILE],
        &["run", "--loud", HOSTILE],
        &["fmu", HOSTILE],
    ] {
        all.push(octant_in(at, arguments));
    }
    for output in &all {
        for bytes in [&output.stdout, &output.stderr] {
            nothing_acts(&format!("{output:?}"), &String::from_utf8_lossy(bytes));
        }
    }
    nothing_acts_in(&at.join("again"));
    nothing_acts("report", &std::fs::read_to_string(at.join("again.html")).unwrap());
}
