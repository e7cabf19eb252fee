//! Every reader of a run's folder: each folder that a test writes has to be readable by all of them.

use octant_diff::side::Side;
use octant_evidence::manifest::Manifest;
use octant_evidence::{ended, statements};
use std::path::{Path, PathBuf};
use std::process::Output;

/// Reads the folder of a run as verify, rejudge, watch and diff do.
#[track_caller]
pub fn read(folder: &Path) {
    let shown = folder.display();
    let manifest = Manifest::read(folder).unwrap_or_else(|error| panic!("{shown}: {error}"));
    let differences = manifest.verify(folder).unwrap();
    assert!(differences.is_empty(), "{shown}: {differences:?}");
    let inside = statements::of_run(folder, &manifest);
    assert!(inside.contradictions.is_empty(), "{shown}: {:?}", inside.contradictions);
    // A system of FMUs has a summary of its own, which has no requirements to judge anew.
    let text = std::fs::read_to_string(folder.join(statements::SUMMARY)).unwrap();
    if serde_json::from_str::<serde_json::Value>(&text).unwrap().get("system").is_some() {
        return;
    }
    let summary = ended::summary(folder).unwrap().expect("it has ended");
    let judged = octant_rejudge::folder(folder).unwrap_or_else(|error| panic!("{shown}: {error}"));
    assert_eq!(judged.verdict, summary.verdict, "{shown}: {:?}", summary.reasons);
    if !folder.join("recording.mcap").is_file() {
        return;
    }
    let side = Side::read(folder).unwrap_or_else(|error| panic!("{shown}: {error}"));
    let difference = octant_diff::runs(&side, &side).unwrap();
    assert!(difference.equal, "{shown} differs from itself");
}

/// Reads what `octant run` has written, if a command was that and its run has ended.
#[track_caller]
pub fn read_written(arguments: &[&str], at: &Path, output: &Output) {
    if arguments.first() != Some(&"run") || !matches!(output.status.code(), Some(0 | 1 | 3)) {
        return;
    }
    let out = arguments.iter().position(|word| *word == "--out").and_then(|k| arguments.get(k + 1));
    let Some(folder): Option<PathBuf> = out.map(|out| at.join(out)) else { return };
    if folder.join("manifest.json").is_file() {
        read(&folder);
    }
}
