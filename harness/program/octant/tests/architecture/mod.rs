//! Layout of the workspace: wings stand in their order, and neither their graph nor that of the crates nor that of the
//! files inside a crate has a circle; the architecture page says so; files stay within their size.

mod crates;
mod files;
mod imports;
mod pages;
mod wings;

use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/architecture.md");
/// Most lines of a file of product code.
pub(crate) const FILE_LINES_MAX: usize = 500;

/// Who takes something from whom.
type Graph = BTreeMap<String, BTreeSet<String>>;

/// A crate of the workspace.
pub(crate) struct Member {
    /// Folder, from the root of the repository.
    pub(crate) folder: String,
    /// Folders' last names of the workspace's crates that it is built with.
    needs: BTreeSet<String>,
    /// The same of its tests and benches alone.
    tests_need: BTreeSet<String>,
}

impl Member {
    /// The folder that its folder is in, without `harness`.
    fn wing(&self) -> &str {
        let (folders, _) = self.folder.rsplit_once('/').unwrap();
        folders.strip_prefix("harness/").unwrap_or(folders)
    }
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
            let of_build = dependencies(manifest, "build-dependencies");
            let needs = ours(&dependencies(manifest, "dependencies") | &of_build);
            let tests_need = ours(dependencies(manifest, "dev-dependencies"));
            (short(folder), Member { folder: (*folder).to_owned(), needs, tests_need })
        })
        .collect();
    let names: BTreeSet<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names.len(), found.len(), "two crates have folders of one name");
    found
}

/// Files of product code below a folder, without those of tests.
pub(crate) fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            sources(&path, found);
        } else if name.ends_with(".rs")
            && !matches!(name.as_str(), "tests.rs" | "testing.rs" | "main.rs")
        {
            found.push(path);
        }
    }
}

/// Where a file's own tests begin.
static TESTS: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(r"#\[cfg\(test\)\]\s*(?:pub(?:\(crate\))? )?mod \w+ \{").unwrap());

/// Text of a file up to its own tests.
pub(crate) fn product(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let end = TESTS.find(&text).map_or(text.len(), |found| found.start());
    text[..end].to_owned()
}

/// Circles of a graph: parts in which each member reaches each, itself too.
fn circles(graph: &Graph) -> Vec<Vec<String>> {
    let reach = |from: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(name) = open.pop() {
            open.extend(
                graph.get(name).into_iter().flatten().filter(|next| seen.insert((*next).clone())),
            );
        }
        seen
    };
    let reached: Graph = graph.keys().map(|name| (name.clone(), reach(name))).collect();
    let mut parts = BTreeSet::new();
    for (name, others) in &reached {
        let part: Vec<String> = others
            .iter()
            .filter(|other| reached.get(*other).is_some_and(|back| back.contains(name)))
            .cloned()
            .collect();
        if !part.is_empty() {
            parts.insert(part);
        }
    }
    parts.into_iter().collect()
}

/// A graph in a line each: `"a: b c"`.
fn graph(lines: &[&str]) -> Graph {
    let line = |line: &&str| {
        let (from, to) = line.split_once(':').unwrap();
        (from.to_owned(), to.split_whitespace().map(str::to_owned).collect())
    };
    lines.iter().map(line).collect()
}
