//! Files of a crate: their size, the names of types in them, and that none takes something from one that takes something
//! from it.

use super::imports::imports;
use super::{FILE_LINES_MAX, circles, members, product, root, sources};
use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

#[test]
fn files_stay_within_their_size() {
    let mut long = Vec::new();
    for (name, member) in members() {
        let mut all = Vec::new();
        sources(&root().join(&member.folder).join("src"), &mut all);
        assert!(!all.is_empty(), "{name} has no file");
        for file in all {
            let lines = product(&file).lines().count();
            if lines > FILE_LINES_MAX {
                long.push(format!("{}: {lines} lines", file.display()));
            }
        }
    }
    assert!(long.is_empty(), "at most {FILE_LINES_MAX} lines in a file: {long:#?}");
}

/// Across crates the path tells types apart. A definition for one kind of system has its counterpart for the others in
/// the same file. The C types of FMI have the names of their standards, `fmi2::Status` and `fmi3::Status`, and are no
/// part of this.
#[test]
fn names_of_public_types_stand_once_in_their_crate() {
    let definition =
        Regex::new(r"(?m)^\s*pub (?:unsafe )?(?:struct|enum|trait|type|union) (\w+)").unwrap();
    let (mut seen, mut twice) = (0, Vec::new());
    for (name, member) in members() {
        if member.folder == "fmu/abi" {
            continue;
        }
        let mut all = Vec::new();
        sources(&root().join(&member.folder).join("src"), &mut all);
        let mut places: BTreeMap<String, BTreeSet<PathBuf>> = BTreeMap::new();
        for file in all {
            for found in definition.captures_iter(&product(&file)) {
                places.entry(found[1].to_owned()).or_default().insert(file.clone());
            }
        }
        seen += places.len();
        places.retain(|_, files| files.len() > 1);
        twice.extend(places.into_iter().map(|place| (name.clone(), place)));
    }
    assert!(seen > 1000, "{seen} definitions are found");
    assert!(twice.is_empty(), "one name for each thing of a crate: {twice:#?}");
}

/// Whether a crate with these files has a circle.
fn has_circle(files: &[(&str, &str)]) -> bool {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    !circles(&imports(folder.path())).is_empty()
}

#[test]
fn files_that_import_each_other_are_found() {
    let siblings = [("a.rs", "use crate::b::B;"), ("b.rs", "use super::a::{A, C};")];
    let parent = [("a/mod.rs", "mod b;\nuse b::{B, C};"), ("a/b.rs", "fn f(_: super::A) {}")];
    let three =
        [("a.rs", "use crate::b;"), ("b.rs", "use crate::{c::C, d};"), ("c.rs", "crate::a::f()")];
    let nested =
        [("a.rs", "use crate::{c::{C, D}, b::{self, B}};"), ("b.rs", "fn f() { crate::a::A }")];
    let all = [("a/mod.rs", "mod b;\nfn f() { b::f() }"), ("a/b.rs", "use super::*;")];
    let alias = [("a.rs", "use crate::b as other;"), ("b.rs", "fn f() { super::a::f() }")];
    for files in [&siblings[..], &parent, &three, &nested, &all, &alias] {
        assert!(has_circle(files), "{files:?}");
    }
    let tests =
        [("a.rs", "use crate::b;"), ("b.rs", "#[cfg(test)]\nmod tests {\n use crate::a;\n}")];
    let comment = [("a/mod.rs", "mod b;\nuse b::B;"), ("a/b.rs", "// crate::a::X\nfn f() {}")];
    let below = [("a/mod.rs", "mod b; mod c;"), ("a/b.rs", "use super::c::C;"), ("a/c.rs", "")];
    for files in [&tests[..], &comment, &below] {
        assert!(!has_circle(files), "{files:?}");
    }
}

/// A `pub use` of a child names it for others and takes nothing; whoever takes the name takes it from where it is defined.
#[test]
fn circles_through_a_public_use_are_found() {
    // The parent uses what it names.
    let used = [
        ("a/mod.rs", "mod b;\npub use b::B;\npub const C: B = B::NEW;"),
        ("a/b.rs", "use super::C;\npub struct B;"),
    ];
    // Two children meet by their parent's names.
    let children = [
        ("a/mod.rs", "mod b; mod c;\npub use b::B;\npub(crate) use c::{C, D as E};"),
        ("a/b.rs", "use super::C;\npub struct B;"),
        ("a/c.rs", "use super::B;\npub struct C;\npub struct D;"),
    ];
    let renamed = [children[0], ("a/b.rs", "fn f(_: super::E) {}\npub struct B;"), children[2]];
    // By the name of a name, and by all names.
    let twice = [
        ("lib.rs", "mod a; mod d;\npub use a::B;"),
        children[0],
        ("a/b.rs", "use crate::d::f;\npub struct B;"),
        ("d.rs", "use crate::B;\npub fn f() {}"),
    ];
    let all = [
        ("a/mod.rs", "mod b; mod c;\npub use b::*;\npub use c::*;"),
        ("a/b.rs", "use super::C;\npub struct B;"),
        ("a/c.rs", "use super::*;\npub struct C;\nfn f(_: B) {}"),
    ];
    let module = [
        ("a/mod.rs", "mod b; mod c;\npub use b::B;"),
        ("a/b.rs", "use super::c;\npub struct B;"),
        ("a/c.rs", "use crate::a;\nfn f(_: a::B) {}"),
    ];
    for files in [&used[..], &children, &renamed, &twice, &all, &module] {
        assert!(has_circle(files), "{files:?}");
    }
    let named = [("a/mod.rs", "mod b;\npub use b::B;\npub struct A;"), ("a/b.rs", "use super::A;")];
    let one_way = [children[0], children[1], ("a/c.rs", "pub struct C;")];
    let method = [
        ("a/mod.rs", "mod b;\npub use b::run;\npub struct A;\nfn f(a: A) { a.run() }"),
        ("a/b.rs", "use super::A;\npub fn run(run: A) {}"),
    ];
    for files in [&named[..], &one_way, &method] {
        assert!(!has_circle(files), "{files:?}");
    }
}

#[test]
fn no_two_files_of_a_crate_import_each_other() {
    let mut found = Vec::new();
    for (name, member) in members() {
        let graph = imports(&root().join(&member.folder).join("src"));
        for files in circles(&graph) {
            for file in &files {
                let taken: Vec<&str> = files
                    .iter()
                    .filter(|other| graph[file].contains(*other))
                    .map(String::as_str)
                    .collect();
                found.push(format!("{name}: {file} takes from {}", taken.join(", ")));
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}
