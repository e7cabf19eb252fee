//! Figures and lists on pages that follow from the tree: each is counted here, and stands on its page as it is
//! counted.

use crate::architecture::{FILE_LINES_MAX, Member, manifest, members, product, root, sources};
use regex::Regex;
use std::collections::BTreeSet;

fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap()
}

/// The text of a page with its line breaks as blanks, so that a sentence is found however it is broken.
fn flowing(page: &str) -> String {
    read(page).split_whitespace().collect::<Vec<_>>().join(" ")
}

#[track_caller]
fn says(page: &str, said: &str) {
    assert!(flowing(page).contains(said), "{page}: {said:?} is expected");
}

fn package(member: &Member) -> String {
    let manifest = manifest(&root().join(&member.folder));
    manifest["package"]["name"].as_str().unwrap().to_owned()
}

/// Names in code type, in their order, with commas between.
fn listed(names: &BTreeSet<String>) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// The page says how long a file may be, and that a crate may be as long as its idea.
#[test]
fn contributing_says_how_long_a_file_may_be() {
    says("CONTRIBUTING.md", &format!("A file has at most {FILE_LINES_MAX} lines of source."));
}

#[test]
fn contributing_names_the_crates_whose_tests_are_a_module_of_the_library() {
    let inside: BTreeSet<String> = members()
        .iter()
        .filter(|(_, member)| {
            let library = root().join(&member.folder).join("src/lib.rs");
            std::fs::read_to_string(library).is_ok_and(|text| text.contains("../tests/main.rs"))
        })
        .map(|(_, member)| package(member))
        .collect();
    assert!(!inside.is_empty());
    says("CONTRIBUTING.md", &format!("all the same ({})", listed(&inside)));
}

/// Modules and functions of a crate's tests that a feature switches on.
#[test]
fn contributing_has_the_features_that_switch_tests_on() {
    let switch = Regex::new(r#"(?m)^#\[cfg\(feature = "([\w-]+)"\)\]"#).unwrap();
    let mut commands = BTreeSet::new();
    for (_, member) in members() {
        let package = package(&member);
        // Its features are those of the other crates; `full` is all of them.
        if package == "octant" {
            continue;
        }
        let main = root().join(&member.folder).join("tests/main.rs");
        let Ok(text) = std::fs::read_to_string(main) else { continue };
        let features: BTreeSet<&str> =
            switch.captures_iter(&text).map(|found| found.get(1).unwrap().as_str()).collect();
        if !features.is_empty() {
            let features = features.into_iter().collect::<Vec<_>>().join(",");
            commands.insert(format!("cargo test -p {package} --features {features}"));
        }
    }
    assert!(commands.len() > 2, "{commands:?}");
    says("CONTRIBUTING.md", &format!("Some tests are behind a feature: {}.", listed(&commands)));
}

/// Kinds of faults in the scenarios of the self-test.
#[test]
fn known_limitations_names_the_faults_of_the_self_test() {
    let kind = Regex::new(r#"(?m)^kind = "([\w-]+)""#).unwrap();
    let mut kinds = BTreeSet::new();
    for entry in std::fs::read_dir(root().join("fixtures/selftest")).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        kinds.extend(kind.captures_iter(&text).map(|found| found[1].to_owned()));
    }
    let said = format!("Of the kinds of faults its runs have these: {}.", listed(&kinds));
    says("docs/qualification/known-limitations.md", &said);
}

/// Each folder in code type in the rule's sentence, and no other, has product code that allows `unsafe`.
#[test]
fn contributing_says_where_unsafe_is() {
    let allowed = Regex::new(r"(?:allow|expect)\(\s*unsafe_code").unwrap();
    let found: BTreeSet<String> = members()
        .into_iter()
        .filter(|(_, member)| {
            let mut all = Vec::new();
            sources(&root().join(&member.folder).join("src"), &mut all);
            all.iter().any(|file| allowed.is_match(&product(file)))
        })
        .map(|(_, member)| member.folder)
        .collect();
    let page = flowing("CONTRIBUTING.md");
    let (_, rule) = page.split_once("**No `unsafe` but at the edge to foreign code**").unwrap();
    let (rule, _) = rule.split_once("Each block says").unwrap();
    let folder = Regex::new(r"`((?:models|fmu|harness/\w+)/\w+)`").unwrap();
    let said: BTreeSet<String> =
        folder.captures_iter(rule).map(|found| found[1].to_owned()).collect();
    assert_eq!(said, found, "CONTRIBUTING.md: folders of crates with `unsafe`");
}

/// A dependency's comment stands before it. A sentence of its own line before another one is left over from a
/// dependency that is gone.
#[test]
fn no_comment_of_a_dependency_is_left_over() {
    let text = read("Cargo.toml");
    let (_, table) = text.split_once("[workspace.dependencies]\n").unwrap();
    let (table, _) = table.split_once("\n[").unwrap();
    let lines: Vec<&str> = table.lines().collect();
    for pair in lines.windows(2) {
        let ends = pair[0].starts_with('#') && pair[0].ends_with('.');
        let next = pair[1].strip_prefix("# ").and_then(|text| text.chars().next());
        let is_left = ends && (pair[1].is_empty() || next.is_some_and(char::is_uppercase));
        assert!(!is_left, "Cargo.toml: {:?} is about no dependency", pair[0]);
    }
    assert!(lines.iter().filter(|line| line.starts_with('#')).count() > 10);
}

/// A default with a figure in a help text is made from the constant that is used (`help = format!(…)`), or clap adds
/// it (`default_value_t`).
#[test]
fn no_help_text_has_a_default_of_its_own() {
    let figure = Regex::new(r"[Bb]y default (?:\w+ )?[0-9]").unwrap();
    let (mut all, mut lines) = (Vec::new(), 0);
    sources(&root().join("harness/program/octant/src"), &mut all);
    for file in all {
        for (number, line) in product(&file).lines().enumerate() {
            let is_help = line.trim_start().starts_with("///");
            lines += usize::from(is_help);
            assert!(
                !is_help || !figure.is_match(line),
                "{}:{}: {line}",
                file.display(),
                number + 1
            );
        }
    }
    assert!(lines > 1000, "{lines}");
}

/// Tables of keys on pages: a default is the one of the schema, which is the one that is used.
#[test]
fn defaults_in_tables_of_keys_are_those_of_the_schema() {
    let schema = octant_scenario::schema();
    let row = Regex::new(r"^\| `(\w+)`(?:, `\w+`)* \| (.*?) \| ").unwrap();
    let mut seen = 0;
    for (page, table) in [
        ("docs/instruments.md", "/properties/source/properties/live"),
        ("docs/power.md", "/properties/power"),
        ("docs/real-time.md", "/properties/realtime"),
        ("docs/turntable.md", "/properties/turntable/properties/drive"),
    ] {
        let text = read(page);
        let tables = text.split("| key | default | meaning |\n").skip(1);
        for line in tables.flat_map(|table| table.lines().take_while(|line| line.starts_with('|')))
        {
            let Some(found) = row.captures(line) else { continue };
            let (key, shown) = (&found[1], found[2].replace(['`', '"'], ""));
            let property = schema.pointer(&format!("{table}/properties/{key}"));
            let property = property.unwrap_or_else(|| panic!("{page}: no key {key} in {table}"));
            let is_figure = shown.contains(|c: char| c.is_ascii_digit());
            match property.get("default") {
                Some(default) => {
                    let default =
                        default.as_str().map_or_else(|| default.to_string(), str::to_owned);
                    assert_eq!(shown, default, "{page}: default of {key}");
                    seen += 1;
                }
                // In the words of the schema.
                None if is_figure => {
                    let words = property["description"].as_str().unwrap();
                    assert!(words.contains(&shown), "{page}: default {shown:?} of {key}: {words}");
                    seen += 1;
                }
                None => {}
            }
        }
    }
    assert!(seen > 25, "{seen}");
}

/// A figure that a machine gave is no figure of the program: its section says when it was measured. Output of
/// commands is not looked at.
#[test]
fn measured_times_and_sizes_have_a_date() {
    let measured = Regex::new(
        r"\d MB\b|\btook [\d.]+ (?:s|ms|min|minutes)\b|\btakes? [\d.]+ (?:s|ms|minutes) (?:by|and|of processor)|\d µs (?:more|a |per )",
    )
    .unwrap();
    let year = Regex::new(r"\b20\d\d\b").unwrap();
    let mut undated = Vec::new();
    let mut seen = 0;
    for entry in std::fs::read_dir(root().join("docs")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if !name.ends_with(".md") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        // Every second part is a block of code.
        let prose: String = text.split("```").step_by(2).collect();
        for section in prose.split("\n#") {
            if measured.is_match(section) {
                seen += 1;
                if !year.is_match(section) {
                    undated.push(format!("{name}: {}", section.lines().next().unwrap()));
                }
            }
        }
    }
    // Its table of build times says in what it was measured.
    undated.retain(|section| !section.starts_with("architecture.md"));
    assert!(undated.is_empty(), "measured figures without a date: {undated:#?}");
    assert!(seen >= 8, "{seen}");
}

#[test]
fn the_oldest_rust_is_that_of_the_manifest() {
    let workspace = manifest(&root());
    let version = workspace["workspace"]["package"]["rust-version"].as_str().unwrap();
    for page in ["README.md", "docs/install.md"] {
        says(page, &format!("Rust {version} or later"));
    }
}
