//! Pages: the architecture page has the graphs of wings and crates of the manifests, and the files that pages name are there.

use super::wings::{WINGS, built, graph_of_wings, wings};
use super::{PAGE, members, product, root};
use regex::Regex;

/// A table's rows below a heading of the page, each with its first two cells as they are and the third as it is given:
/// what a row uses. The first cells are in the order that is given.
fn rows(page: &str, heading: &str, expected: &[(String, String)]) -> Vec<(String, String)> {
    let (_, section) = page
        .split_once(&format!("\n{heading}\n"))
        .unwrap_or_else(|| panic!("docs/architecture.md has no heading {heading:?}"));
    let section = section.split("\n#").next().unwrap();
    let lines: Vec<&str> = section.lines().filter(|line| line.starts_with("| `")).collect();
    let first = |line: &&str| line.split('`').nth(1).unwrap().to_owned();
    let found: Vec<String> = lines.iter().map(first).collect();
    let names: Vec<&String> = expected.iter().map(|(name, _)| name).collect();
    assert_eq!(
        found.iter().collect::<Vec<_>>(),
        names,
        "docs/architecture.md: rows of {heading:?}"
    );
    let row = |(line, (name, uses)): (&&str, &(String, String))| {
        let content = line.split(" | ").nth(1).unwrap();
        assert!(!content.is_empty(), "{name} has no content in its table");
        ((*line).to_owned(), format!("| `{name}` | {content} | {uses} |"))
    };
    lines.iter().zip(expected).map(row).collect()
}

/// Names in code type with commas between; `none` where there are none.
fn listed<'a>(names: impl Iterator<Item = &'a String>, none: &str) -> String {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    if names.is_empty() { none.to_owned() } else { names.join(", ") }
}

#[test]
fn the_architecture_page_has_the_graphs_of_the_manifests() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let members = members();
    let folder = |wing: &str| match wing {
        "models" | "fmu" => wing.to_owned(),
        _ => format!("harness/{wing}"),
    };
    let graph = graph_of_wings(&wings(), &built());
    let order = WINGS.map(str::to_owned);
    let of_wings: Vec<(String, String)> = WINGS
        .iter()
        .map(|wing| {
            let uses = order.iter().filter(|other| graph[*wing].contains(*other));
            (folder(wing), listed(uses, "no other wing"))
        })
        .collect();
    let mut all = rows(&page, "## Wings", &of_wings);
    for wing in WINGS {
        let of_wing: Vec<(String, String)> = members
            .iter()
            .filter(|(_, member)| member.wing() == wing)
            .map(|(_, member)| {
                (member.folder.clone(), listed(member.needs.iter(), "no Octant crate"))
            })
            .collect();
        all.extend(rows(&page, &format!("### `{}`", folder(wing)), &of_wing));
    }
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        let after = all.iter().fold(page, |page, (before, now)| page.replace(before, now));
        std::fs::write(PAGE, after).unwrap();
        return;
    }
    for (before, now) in all {
        assert_eq!(before, now, "written anew by OCTANT_WRITE_FIXTURES=1");
    }
}

/// The way of a sample is a table of files and functions: each function is in its file, and each file is in the
/// table that stands in the page.
#[test]
fn the_functions_on_a_samples_way_are_in_their_files() {
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (_, way) = page.split_once("## A faulted sample, station by station").unwrap();
    let (way, _) = way.split_once("\n#").unwrap();
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
