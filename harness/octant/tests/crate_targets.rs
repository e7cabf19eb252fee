//! Test targets of libraries. Each costs as much as the library itself: it is compiled again for the unit tests in it, and
//! read again for examples in its documentation. A manifest may say that there
//! are none, and then there has to be none, which would never run.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn manifest(folder: &Path) -> toml::Table {
    std::fs::read_to_string(folder.join("Cargo.toml")).unwrap().parse().unwrap()
}

/// Whether rustdoc finds an example in the doc comments of a source file: a block of code that isn't marked
/// as another language.
fn has_example(text: &str) -> bool {
    const OTHERS: [&str; 4] = ["text", "toml", "xml", "json"];
    let comment = |line: &str| {
        let line = line.trim_start();
        let found = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        found.map(|text| text.trim_start().to_owned())
    };
    let fences = text.lines().filter_map(comment);
    let fences = fences.filter_map(|line| line.strip_prefix("```").map(str::to_owned));
    // Every second fence is the end of a block.
    fences.step_by(2).any(|language| !OTHERS.contains(&language.trim()))
}

/// Whether any source file of a folder has something.
fn any(folder: &Path, has: fn(&str) -> bool) -> bool {
    std::fs::read_dir(folder).unwrap().any(|entry| {
        let path = entry.unwrap().path();
        if path.is_dir() {
            return any(&path, has);
        }
        path.extension().is_some_and(|end| end == "rs")
            && has(&std::fs::read_to_string(&path).unwrap())
    })
}

#[test]
fn an_example_is_found() {
    assert!(has_example("/// One.\n/// ```\n/// assert!(true);\n/// ```\n"));
    assert!(has_example("//! ```text\n//! a\n//! ```\n//!\n//! ```should_panic\n//! ```\n"));
    assert!(!has_example("    /// ```text\n    /// ```\n// ```\nlet fence = \"```\";\n"));
}

#[test]
fn no_test_and_no_example_is_where_the_manifest_says_that_there_is_none() {
    let workspace = manifest(&root());
    for folder in workspace["workspace"]["members"].as_array().unwrap() {
        let folder = root().join(folder.as_str().unwrap());
        let manifest = manifest(&folder);
        let switched_on = |key: &str| {
            let value = manifest.get("lib").and_then(|lib| lib.get(key));
            value.is_none_or(|value| value.as_bool().unwrap())
        };
        let (source, folder) = (folder.join("src"), folder.display());
        for (key, found) in [
            ("doctest", any(&source, has_example)),
            ("test", any(&source, |text| text.contains("#[test]") || text.contains("proptest! {"))),
        ] {
            assert!(
                switched_on(key) || !found,
                "{folder}/Cargo.toml: [lib] says `{key} = false`, and its sources have one"
            );
        }
    }
}
