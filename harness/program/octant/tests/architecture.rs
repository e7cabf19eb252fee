//! Layout of the workspace: the graph of crates is that of the architecture page and has no circle, nor has
//! the graph of files inside a crate; crates and files stay within their sizes.

use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/architecture.md");
/// Most lines of product code in a crate.
pub(crate) const CRATE_LINES_MAX: usize = 14_000;
/// Most lines of a file of product code.
pub(crate) const FILE_LINES_MAX: usize = 500;

/// A crate of the workspace.
pub(crate) struct Member {
    /// Folder, from the root of the repository.
    pub(crate) folder: String,
    /// Folders' last names of the workspace's crates that it is built with.
    needs: BTreeSet<String>,
    /// The same of its tests and benches alone.
    tests_need: BTreeSet<String>,
}

pub(crate) fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../.."))
}

pub(crate) fn manifest(folder: &Path) -> toml::Table {
    std::fs::read_to_string(folder.join("Cargo.toml")).unwrap().parse().unwrap()
}

/// Names of the dependencies in a section of a manifest, on every platform.
fn dependencies(manifest: &toml::Table, section: &str) -> BTreeSet<String> {
    let in_table = |table: &toml::Table| -> Vec<String> {
        let found = table.get(section).and_then(toml::Value::as_table);
        found.into_iter().flat_map(|found| found.keys().cloned()).collect()
    };
    let targets = manifest.get("target").and_then(toml::Value::as_table);
    let targets =
        targets.into_iter().flat_map(toml::Table::values).filter_map(toml::Value::as_table);
    targets.chain([manifest]).flat_map(in_table).collect()
}

/// Crates of the workspace by the last name of their folder, in the order of the root manifest.
pub(crate) fn members() -> Vec<(String, Member)> {
    let workspace = manifest(&root());
    let folders = workspace["workspace"]["members"].as_array().unwrap();
    let folders: Vec<&str> = folders.iter().map(|folder| folder.as_str().unwrap()).collect();
    let manifests: Vec<toml::Table> =
        folders.iter().map(|folder| manifest(&root().join(folder))).collect();
    let short = |folder: &str| folder.rsplit('/').next().unwrap().to_owned();
    let packages: BTreeMap<&str, String> = folders
        .iter()
        .zip(&manifests)
        .map(|(folder, manifest)| (manifest["package"]["name"].as_str().unwrap(), short(folder)))
        .collect();
    let ours = |names: BTreeSet<String>| -> BTreeSet<String> {
        names.iter().filter_map(|name| packages.get(name.as_str()).cloned()).collect()
    };
    let found: Vec<(String, Member)> = folders
        .iter()
        .zip(&manifests)
        .map(|(folder, manifest)| {
            let needs = ours(dependencies(manifest, "dependencies"));
            let tests_need = ours(dependencies(manifest, "dev-dependencies"));
            (short(folder), Member { folder: (*folder).to_owned(), needs, tests_need })
        })
        .collect();
    let names: BTreeSet<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names.len(), found.len(), "two crates have folders of one name");
    found
}

/// One circle of a graph, as the names along it; empty where there is none.
fn circle(graph: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    fn visit(
        at: &str,
        graph: &BTreeMap<String, BTreeSet<String>>,
        way: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(from) = way.iter().position(|name| name == at) {
            return Some(way[from..].to_vec());
        }
        if !done.insert(at.to_owned()) {
            return None;
        }
        way.push(at.to_owned());
        for next in graph.get(at).into_iter().flatten() {
            if let Some(found) = visit(next, graph, way, done) {
                return Some(found);
            }
        }
        way.pop();
        None
    }
    let mut done = BTreeSet::new();
    graph
        .keys()
        .find_map(|start| visit(start, graph, &mut Vec::new(), &mut done))
        .unwrap_or_default()
}

#[test]
fn the_graph_of_crates_has_no_circle() {
    let members = members();
    let built = members.iter().map(|(name, member)| (name.clone(), member.needs.clone())).collect();
    assert_eq!(circle(&built), Vec::<String>::new());
    // Nor through what tests need.
    let tested = members
        .iter()
        .map(|(name, member)| (name.clone(), &member.needs | &member.tests_need))
        .collect();
    assert_eq!(circle(&tested), Vec::<String>::new());
    let twisted = [("a", "b"), ("b", "c"), ("c", "b")];
    let twisted = twisted.map(|(from, to)| (from.to_owned(), BTreeSet::from([to.to_owned()])));
    assert_eq!(circle(&BTreeMap::from(twisted)), ["b", "c"]);
}

#[test]
fn the_architecture_page_has_the_graph_of_the_manifests() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let members = members();
    let mut after = page.clone();
    for (name, member) in &members {
        let start = format!("| `{}` | ", member.folder);
        let Some(line) = page.lines().find(|line| line.starts_with(&start)) else {
            panic!("docs/architecture.md has no row that begins with {start:?}")
        };
        let content = line[start.len()..].split(" | ").next().unwrap();
        let needs: Vec<String> = member.needs.iter().map(|name| format!("`{name}`")).collect();
        let needs = if needs.is_empty() { "no Octant crate".to_owned() } else { needs.join(", ") };
        assert!(!content.is_empty(), "{name} has no content in the table");
        after = after.replace(line, &format!("{start}{content} | {needs} |"));
    }
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(PAGE, &after).unwrap();
        return;
    }
    for (before, now) in page.lines().zip(after.lines()) {
        assert_eq!(before, now, "written anew by OCTANT_WRITE_FIXTURES=1");
    }
    let rows = page
        .lines()
        .filter(|line| Regex::new(r"^\| `(models|fmu|harness)/\w+` ").unwrap().is_match(line));
    assert_eq!(rows.count(), members.len(), "the table has a crate that isn't there");
}

#[test]
fn the_core_never_sees_the_truth_and_the_plant_never_an_estimate() {
    let members: BTreeMap<String, Member> = members().into_iter().collect();
    let reach = |from: &str| {
        let mut found = BTreeSet::new();
        let mut open = vec![from.to_owned()];
        while let Some(name) = open.pop() {
            for next in &members[&name].needs {
                if found.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        found
    };
    for (from, never) in [
        ("calibration", &["plant", "faults", "random"][..]),
        ("plant", &["calibration"][..]),
        ("scenario", &["source", "endpoint", "host", "unit", "run", "score"][..]),
        ("score", &["source", "endpoint", "run", "scenario"][..]),
        ("report", &["run", "campaign", "source", "endpoint"][..]),
    ] {
        for name in never {
            assert!(members.contains_key(*name), "{name} is no crate");
            assert!(!reach(from).contains(*name), "{from} reaches {name}");
        }
    }
}

/// Files of product code below a folder, without those of tests.
pub(crate) fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            files(&path, found);
        } else if name.ends_with(".rs")
            && !matches!(name.as_str(), "tests.rs" | "testing.rs" | "main.rs")
        {
            found.push(path);
        }
    }
}

/// Text of a file up to its own tests.
pub(crate) fn product(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let tests = Regex::new(r"#\[cfg\(test\)\]\s*(?:pub(?:\(crate\))? )?mod \w+ \{").unwrap();
    let end = tests.find(&text).map_or(text.len(), |found| found.start());
    text[..end].to_owned()
}

#[test]
fn crates_and_files_stay_within_their_sizes() {
    let mut long = Vec::new();
    for (name, member) in members() {
        let mut all = Vec::new();
        files(&root().join(&member.folder).join("src"), &mut all);
        let lines: Vec<usize> = all.iter().map(|file| product(file).lines().count()).collect();
        let sum: usize = lines.iter().sum();
        assert!(sum > 0 && sum <= CRATE_LINES_MAX, "{name} has {sum} lines");
        for (file, lines) in all.iter().zip(lines) {
            if lines > FILE_LINES_MAX {
                long.push(format!("{}: {lines} lines", file.display()));
            }
        }
    }
    assert!(long.is_empty(), "at most {FILE_LINES_MAX} lines in a file: {long:#?}");
}

/// A definition for one kind of system has its counterpart for the others in the same file. The C types of FMI have
/// the names of their standards, `fmi2::Status` and `fmi3::Status`, and are no part of this.
#[test]
fn names_of_public_types_stand_once_in_the_workspace() {
    let definition =
        Regex::new(r"(?m)^\s*pub (?:unsafe )?(?:struct|enum|trait|type|union) (\w+)").unwrap();
    let mut places: BTreeMap<String, BTreeSet<PathBuf>> = BTreeMap::new();
    for (_, member) in members() {
        if member.folder == "fmu/abi" {
            continue;
        }
        let mut all = Vec::new();
        files(&root().join(&member.folder).join("src"), &mut all);
        for file in all {
            for found in definition.captures_iter(&product(&file)) {
                places.entry(found[1].to_owned()).or_default().insert(file.clone());
            }
        }
    }
    assert!(places.len() > 1000, "{} definitions are found", places.len());
    places.retain(|_, files| files.len() > 1);
    assert!(places.is_empty(), "one name for each thing: {places:#?}");
}

/// Module path of a file below `src`; that of the crate's root is empty.
fn module(source: &Path, file: &Path) -> Vec<String> {
    let below = file.strip_prefix(source).unwrap().with_extension("");
    let mut names: Vec<String> =
        below.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|name| name == "mod" || name == "lib") {
        names.pop();
    }
    names
}

/// Modules of a crate that each of its modules takes something from, as far as their paths tell it: paths
/// from `crate`, `super` and `self`, and those that begin with a child. A `pub use` of a child names it only.
fn imports(source: &Path) -> BTreeMap<Vec<String>, BTreeSet<Vec<String>>> {
    let mut all = Vec::new();
    files(source, &mut all);
    let modules: BTreeMap<Vec<String>, PathBuf> =
        all.into_iter().map(|file| (module(source, &file), file)).collect();
    let comment = Regex::new(r"//.*").unwrap();
    let named = Regex::new(r"pub(?:\([^)]*\))? use [^;]*;").unwrap();
    let path =
        Regex::new(r"\b((?:crate|super|self)(?:::super)*)::((?:\w+::)*)(\w+|\{[^;]*?\})").unwrap();
    let first = Regex::new(r"(?:^|,)\s*(\w+)").unwrap();
    let start = Regex::new(r"(?:^|[^\w:])(\w+)::[\w{]").unwrap();
    let mut graph = BTreeMap::new();
    for (module, file) in &modules {
        let text = comment.replace_all(&product(file), "").into_owned();
        let mut takes = BTreeSet::new();
        for found in path.captures_iter(&text) {
            let mut at = module.clone();
            for step in found[1].split("::") {
                match step {
                    "crate" => at.clear(),
                    "super" => drop(at.pop()),
                    _ => {}
                }
            }
            at.extend(found[2].split("::").filter(|name| !name.is_empty()).map(str::to_owned));
            let names: Vec<String> = match found[3].strip_prefix('{') {
                Some(list) => {
                    let list = list.trim_end_matches('}');
                    first.captures_iter(list).map(|name| name[1].to_owned()).collect()
                }
                None => vec![found[3].to_owned()],
            };
            for name in names {
                let mut target = at.clone();
                target.push(name);
                while !target.is_empty() && !modules.contains_key(&target) {
                    target.pop();
                }
                takes.insert(target);
            }
        }
        let text = named.replace_all(&text, "");
        for found in start.captures_iter(&text) {
            let mut child = module.clone();
            child.push(found[1].to_owned());
            if modules.contains_key(&child) {
                takes.insert(child);
            }
        }
        takes.remove(module);
        graph.insert(module.clone(), takes);
    }
    graph
}

#[test]
fn files_that_import_each_other_are_found() {
    let siblings = [("a.rs", "use crate::b::B;"), ("b.rs", "use super::a::{A, C};")];
    let parent = [("a/mod.rs", "mod b;\nuse b::{B, C};"), ("a/b.rs", "fn f(_: super::A) {}")];
    let three =
        [("a.rs", "use crate::b;"), ("b.rs", "use crate::{c::C, d};"), ("c.rs", "crate::a::f()")];
    let named =
        [("a/mod.rs", "mod b;\npub use b::B;"), ("a/b.rs", "// crate::b::X\nuse super::A;")];
    let tests =
        [("a.rs", "use crate::b;"), ("b.rs", "#[cfg(test)]\nmod tests {\n use crate::a;\n}")];
    for (files, is_circle) in
        [(&siblings[..], true), (&parent, true), (&three, true), (&named, false), (&tests, false)]
    {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let graph = imports(folder.path())
            .iter()
            .map(|(module, takes)| {
                (module.join("::"), takes.iter().map(|m| m.join("::")).collect())
            })
            .collect();
        assert_eq!(!circle(&graph).is_empty(), is_circle, "{files:?}");
    }
}

#[test]
fn no_two_files_of_a_crate_import_each_other() {
    let mut circles = Vec::new();
    for (name, member) in members() {
        let text = |module: &Vec<String>| match module.is_empty() {
            true => "lib".to_owned(),
            false => module.join("::"),
        };
        let graph = imports(&root().join(&member.folder).join("src"))
            .iter()
            .map(|(module, takes)| (text(module), takes.iter().map(text).collect()))
            .collect();
        let found = circle(&graph);
        if !found.is_empty() {
            circles.push(format!("{name}: {}", found.join(" -> ")));
        }
    }
    assert!(circles.is_empty(), "{circles:#?}");
}

/// The way of a sample is a table of files and functions: each function is in its file, and each file is in the
/// table that stands in the page.
#[test]
fn the_functions_on_a_samples_way_are_in_their_files() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (_, way) = page.split_once("## A faulted sample, station by station").unwrap();
    let (way, _) = way.split_once("`Steps::step`").unwrap();
    let row = Regex::new(r"(?m)^\| `([\w/.]+\.rs)` \| `(\w+)` \| .+ \|$").unwrap();
    let rows = row.captures_iter(way).map(|found| {
        let (file, function) = (&found[1], &found[2]);
        let definition = Regex::new(&format!(r"\bfn {function}\b")).unwrap();
        let text = product(&root().join(file));
        assert!(definition.is_match(&text), "docs/architecture.md: {file} has no `fn {function}`");
    });
    let lines = way.lines().filter(|line| line.starts_with("| `")).count();
    assert_eq!(rows.count(), lines, "a row that isn't | `FILE.rs` | `FUNCTION` | STEP |");
    assert!(lines > 10, "{lines}");
}

#[test]
fn the_files_that_the_pages_name_are_there() {
    let path = Regex::new(r"`((?:models|fmu|harness|docs|fixtures|tests|fuzz)/[\w./-]+)`").unwrap();
    // A name in capitals stands for one that the reader chooses.
    let is_placeholder = |name: &str| Regex::new(r"(?:^|[/_])[A-Z]{3,}").unwrap().is_match(name);
    for (page, least) in
        [("docs/extending.md", 30), ("docs/architecture.md", 40), ("CONTRIBUTING.md", 5)]
    {
        let text = std::fs::read_to_string(root().join(page)).unwrap();
        let mut seen = 0;
        for found in path.captures_iter(&text) {
            let name = &found[1];
            // Every crate has these.
            if matches!(name, "tests/main.rs" | "tests/common") {
                continue;
            }
            if !is_placeholder(&name.replace("README", "readme")) {
                assert!(root().join(name).exists(), "{page}: {name} isn't there");
                seen += 1;
            }
        }
        assert!(seen >= least, "{page} names {seen} files, expected {least} or more");
    }
}
