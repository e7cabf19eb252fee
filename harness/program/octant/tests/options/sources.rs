//! Sources of this program and of its tests, as text.

use std::path::{Path, PathBuf};

/// Returns the text of a test of this program, `module::function`.
pub(super) fn test_body(test: &str) -> Option<String> {
    let (mut module, function) = test.rsplit_once("::")?;
    let text = loop {
        let path = Path::new("tests").join(module.replace("::", "/"));
        let files = [path.with_extension("rs"), path.join("mod.rs")];
        match files.into_iter().find_map(|file| std::fs::read_to_string(file).ok()) {
            Some(text) => break text,
            // A module inside its parent's file.
            None => module = module.rsplit_once("::")?.0,
        }
    };
    let lines: Vec<&str> = text.lines().collect();
    let begin = lines.iter().position(|line| {
        line.trim_start().strip_prefix("fn ").is_some_and(|rest| {
            rest.strip_prefix(function).is_some_and(|rest| rest.starts_with('('))
        })
    })?;
    let is_test = lines[..begin]
        .iter()
        .rev()
        .take_while(|line| line.trim_start().starts_with("#["))
        .any(|line| line.trim() == "#[test]");
    let indent = lines[begin].len() - lines[begin].trim_start().len();
    let last = format!("{:indent$}}}", "");
    let body: Vec<&str> = lines[begin..].iter().copied().take_while(|line| *line != last).collect();
    is_test.then(|| body.join("\n"))
}

/// Returns whether a text has an option, and not just one whose name begins like it.
pub(super) fn mentions(text: &str, option: &str) -> bool {
    text.match_indices(option).any(|(at, _)| {
        let next = text[at + option.len()..].chars().next();
        !next.is_some_and(|c| c.is_ascii_alphanumeric() || c == '-')
    })
}

/// Lists the files of Rust below a folder with their texts.
pub(super) fn rust_files(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            all.push((path, text));
        }
    }
    all.sort();
    all
}
