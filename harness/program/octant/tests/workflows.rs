//! Workflows of hosted CI, the project's own and the shipped example: what they run is named by hashes, which don't
//! move.

use crate::architecture::root;
use regex::Regex;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Files that name actions.
fn workflows() -> Vec<PathBuf> {
    let own = std::fs::read_dir(root().join(".github/workflows")).unwrap();
    let mut found: Vec<PathBuf> = own.map(|entry| entry.unwrap().path()).collect();
    found.push(root().join("docs/nightly/github.yml"));
    found.sort();
    found
}

/// Returns the name, hash and version of the action that a line names, or what is wrong with the line.
fn pinned(line: &str) -> Result<(String, String), String> {
    let form = Regex::new(r"^uses: ([\w.-]+/[\w./-]+)@([0-9a-f]{40}) # (v\d+\.\d+\.\d+)$").unwrap();
    let line = line.trim().trim_start_matches("- ");
    let Some(found) = form.captures(line) else {
        return Err(format!("found {line:?}, expected uses: OWNER/NAME@COMMIT # vX.Y.Z"));
    };
    Ok((found[1].to_owned(), format!("{} {}", &found[2], &found[3])))
}

#[test]
fn every_action_is_named_by_its_commit() {
    let mut commits: BTreeMap<String, String> = BTreeMap::new();
    for file in workflows() {
        let text = std::fs::read_to_string(&file).unwrap();
        let names = |line: &&str| line.trim().trim_start_matches("- ").starts_with("uses:");
        for line in text.lines().filter(names) {
            let (name, commit) =
                pinned(line).unwrap_or_else(|wrong| panic!("{}: {wrong}", file.display()));
            let before = commits.entry(name.clone()).or_insert_with(|| commit.clone());
            assert_eq!(*before, commit, "{}: two versions of {name}", file.display());
        }
    }
    assert!(commits.len() >= 4, "{commits:?}");
    for wrong in [
        "      - uses: actions/checkout@v4",
        "uses: actions/checkout@11d5960a326750d5838078e36cf38b85af67726 # v4.4.0",
        "uses: actions/checkout@11d5960a326750d5838078e36cf38b85af677262",
    ] {
        assert!(pinned(wrong).is_err(), "{wrong}");
    }
}

/// Scripts that a step runs are in the tree.
#[test]
fn scripts_of_the_workflows_are_there() {
    let script = Regex::new(r"(?m)^\s+(?:- )?run: ((?:\.ci|tests)/[\w./-]+)").unwrap();
    let mut count = 0;
    for file in workflows() {
        let text = std::fs::read_to_string(&file).unwrap();
        for found in script.captures_iter(&text) {
            assert!(root().join(&found[1]).is_file(), "{}: no {}", file.display(), &found[1]);
            count += 1;
        }
    }
    assert!(count >= 4, "{count}");
}
