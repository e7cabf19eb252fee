//! Files that follow from the catalogues: each is what the program makes of them. `tests/generate`
//! writes them with `OCTANT_WRITE_FIXTURES=1`.

use crate::common::program::ends;
use octant_faults::catalogue::{Acts, Family};
use octant_faults::{FaultKind, kinds};
use std::path::{Path, PathBuf};

fn path(file: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../..")).join(file)
}

fn read(file: &str) -> String {
    std::fs::read_to_string(path(file)).unwrap_or_default()
}

/// Compares a file with its content as made now, or writes it.
#[track_caller]
fn is_made(file: &str, made: &str) {
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(path(file), made).unwrap();
    }
    assert!(read(file) == made, "{file} is out of date: tests/generate writes it");
}

/// The same for the part of a document between two marks.
#[track_caller]
fn part_is_made(file: &str, mark: &str, made: &str) {
    let (begin, end) = (format!("<!-- begin {mark} -->\n"), format!("<!-- end {mark} -->"));
    let page = read(file);
    let (before, rest) = page.split_once(&begin).unwrap_or_else(|| panic!("{file}: no {begin}"));
    let (_, after) = rest.split_once(&end).unwrap_or_else(|| panic!("{file}: no {end}"));
    is_made(file, &format!("{before}{begin}{made}{end}{after}"));
}

/// Files of a folder with this ending, by their names without it.
fn named(folder: &str, ending: &str) -> Vec<String> {
    let entries = std::fs::read_dir(path(folder)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> =
        names.filter_map(|name| name.strip_suffix(ending).map(str::to_owned)).collect();
    names.sort();
    names
}

/// Names of kinds in the order of a folder.
fn names<'a>(kinds: impl Iterator<Item = &'a FaultKind>) -> Vec<&'a str> {
    let mut names: Vec<&str> = kinds.map(|kind| kind.name).collect();
    names.sort_unstable();
    names
}

/// Kinds that alter samples. Those of the wire need a device and those of the host the clock: they
/// have no sample that could be drawn, and no short scenario.
fn in_samples() -> impl Iterator<Item = &'static FaultKind> {
    kinds::all().filter(|kind| !matches!(kind.acts, Acts::Wire | Acts::Host | Acts::Power))
}

#[test]
fn pages_of_faults() {
    let folder = tempfile::tempdir().unwrap();
    let svg = folder.path().join("p.svg");
    let describe = |name: &str, options: &[&str]| {
        ends(&[&["faults", "describe", name, "--markdown"], options].concat(), 0).0
    };
    for kind in kinds::all() {
        is_made(&format!("docs/faults/{}.md", kind.name), &describe(kind.name, &[]));
    }
    for FaultKind { name, .. } in in_samples() {
        describe(name, &["--picture", svg.to_str().unwrap()]);
        let picture = std::fs::read_to_string(&svg).unwrap();
        is_made(&format!("docs/faults/{name}.svg"), &picture);
        let drawn = roxmltree::Document::parse(&picture).unwrap();
        let lines = drawn.descendants().filter(|n| {
            matches!(n.tag_name().name(), "path" | "circle")
                && n.attribute("class") == Some("faulted")
        });
        assert!(lines.count() > 1, "{name}: nothing but the legend is drawn");
    }
    assert_eq!(named("docs/faults", ".md"), names(kinds::all()));
    let mut pictures = named("docs/faults", ".svg");
    pictures.retain(|name| !name.starts_with("sweep-"));
    assert_eq!(pictures, names(in_samples()));
}

#[test]
fn tables_of_faults() {
    let mut tables = String::new();
    for family in Family::ALL {
        let (first, rest) = family.name().split_at(1);
        tables += &format!(
            "\n### {}{rest}\n\n| kind | what happens |\n|---|---|\n",
            first.to_uppercase()
        );
        for FaultKind { name, summary, .. } in kinds::all().filter(|kind| kind.family == family) {
            tables += &format!("| [{name}](faults/{name}.md) | {summary} |\n");
        }
    }
    part_is_made("docs/faults.md", "kinds", &format!("{tables}\n"));
}

#[test]
fn suite_of_faults() {
    const FOLDER: &str = "fixtures/scenarios/faults";
    let mut suite = String::from(
        "# Every kind of fault, one short scenario each, and how it has to end. `tests/generate` makes it from what the\n\
         # scenarios say that they expect.\n\
         #\n\
         # `expect` is the verdict. Where it isn't a pass, `because` are words that every reason of it has to\n\
         # contain: nothing else may be wrong. A fault that is harmful and goes unnoticed stands here as what it is: a fail, because of\n\
         # \"counterfactual.undetected\". Where the right end is that the core refuses its calibration, the\n\
         # verdict is a fail, because it is \"refused\".\n\
         schema = 1\n",
    );
    for FaultKind { name, .. } in in_samples() {
        let scenario = read(&format!("{FOLDER}/{name}.toml"));
        let expected = scenario.lines().find_map(|line| line.strip_prefix("# Expected ("));
        let expected = expected.and_then(|line| line.split_once("): "));
        let Some((expected, _)) = expected else {
            panic!(
                "{FOLDER}/{name}.toml has no comment \"# Expected (VERDICT): \" or (VERDICT, REASON)"
            )
        };
        let (verdict, because) = expected.split_once(", ").unwrap_or((expected, ""));
        suite += &format!("\n[[cases]]\nscenario = \"{name}.toml\"\nexpect = \"{verdict}\"\n");
        if !because.is_empty() {
            suite += &format!("because = \"{because}\"\n");
        }
    }
    is_made(&format!("{FOLDER}/nightly.toml"), &suite);
    let mut there = named(FOLDER, ".toml");
    there.retain(|name| name != "nightly");
    assert_eq!(there, names(in_samples()));
}
