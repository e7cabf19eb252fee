//! Test targets of libraries. Each costs as much as the library itself: it is compiled again for the unit tests in it, and
//! read again for examples in its documentation. A manifest may say that there
//! are none, and then there has to be none, which would never run.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../.."))
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

/// Number of programs that cargo makes of a crate's tests: the library's own, those of its other programs, those
/// with a section of their own, and the files of `tests` where nothing else is said.
fn programs(folder: &Path, manifest: &toml::Table) -> usize {
    let is_on = |table: &toml::Table, key: &str| {
        table.get(key).is_none_or(|value| value.as_bool().unwrap())
    };
    let section = |name: &str| manifest.get(name).and_then(toml::Value::as_table);
    let sections = |name: &str| {
        let all = manifest.get(name).and_then(toml::Value::as_array);
        all.into_iter().flatten().map(|one| one.as_table().unwrap())
    };
    let library = folder.join("src/lib.rs").exists()
        && section("lib").is_none_or(|library| is_on(library, "test"));
    let main = folder.join("src/main.rs").exists() && sections("bin").count() == 0;
    let others = sections("bin").filter(|program| is_on(program, "test")).count();
    let found = if section("package").is_none_or(|package| is_on(package, "autotests")) {
        let files = std::fs::read_dir(folder.join("tests")).into_iter().flatten();
        files
            .map(|entry| entry.unwrap().path())
            .filter(|path| {
                path.extension().is_some_and(|end| end == "rs") || path.join("main.rs").exists()
            })
            .count()
    } else {
        sections("test").count()
    };
    usize::from(library) + usize::from(main) + others + found
}

#[test]
fn programs_of_tests_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let count = |text: &str| programs(folder.path(), &text.parse().unwrap());
    assert_eq!(count("[package]"), 0);
    for file in ["src/lib.rs", "src/main.rs", "tests/a.rs", "tests/b/main.rs", "tests/c/mod.rs"] {
        let path = folder.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "").unwrap();
    }
    assert_eq!(count("[package]"), 4);
    assert_eq!(count("[package]\n[lib]\ntest = false\n[[bin]]\nname = \"a\""), 3);
    let one =
        "[package]\nautotests = false\n[lib]\ntest = false\n[[bin]]\ntest = false\n[[test]]\n";
    assert_eq!(count(one), 1);
}

/// A second program costs the time to link it, and unit tests beside a program in `tests` the compilation of the
/// crate too.
#[test]
fn each_crate_has_one_program_of_tests_at_most() {
    let workspace = manifest(&root());
    let mut all = 0;
    for folder in workspace["workspace"]["members"].as_array().unwrap() {
        let folder = root().join(folder.as_str().unwrap());
        let count = programs(&folder, &manifest(&folder));
        assert!(count <= 1, "{} has {count} programs of tests", folder.display());
        all += count;
    }
    let page = std::fs::read_to_string(root().join("CONTRIBUTING.md")).unwrap();
    let said = format!("A crate has one test program at most; there are {all} in all.");
    assert!(page.contains(&said), "CONTRIBUTING.md: {said:?} is expected");
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
