//! Every parsed option is obeyed: option structs are destructured by name, without `..`.

use super::sources::rust_files;
use regex::Regex;
use std::path::Path;

/// An option that `..` stands for may be left out, and the compiler doesn't see it.
#[test]
fn arguments_are_destructured_by_name() {
    let of_struct = r"#\[derive\([^)]*\b(?:Args|Parser)\b[^)]*\)\](?:\s*#\[[^\n]*\])*\s*(?:pub(?:\([a-z]+\))? )?struct (\w+)";
    let of_struct = Regex::new(of_struct).unwrap();
    let of_variant = r"(?s)\b(?:Command|Action)::\w+ \{[^{}]*\.\.\s*\}";
    let of_variant = Regex::new(of_variant).unwrap();
    let sources = rust_files(Path::new("src"));
    let mut structs = 0;
    for (path, text) in &sources {
        let file = path.display();
        if let Some(found) = of_variant.find(text) {
            panic!("{file}: found {}, expected each option by name", found.as_str());
        }
        // A module of options is taken apart in the files beside it.
        let folder = path.parent().filter(|folder| *folder != Path::new("src"));
        let beside = sources.iter().filter(|(other, _)| {
            other == path
                || folder.is_some_and(|folder| {
                    other.starts_with(folder) || *other == folder.with_extension("rs")
                })
        });
        let beside: Vec<&String> = beside.map(|(_, text)| text).collect();
        for found in of_struct.captures_iter(text) {
            structs += 1;
            let name = &found[1];
            let pattern =
                Regex::new(&format!(r"(?s)(?:let |\(|: |of\()(?:{name}|Self) \{{([^{{}}]*)"))
                    .unwrap();
            let mut patterns = beside.iter().flat_map(|text| pattern.captures_iter(text));
            assert!(
                patterns.any(|pattern| !pattern[1].contains("..")),
                "{file}: {name} is never destructured, expected let {name} {{ each option }}"
            );
        }
    }
    assert!(structs > 30, "found {structs} structs of arguments");
}
