//! Writing of Doorstop's documents.

use super::yaml::{block, quoted};
use super::{DoorstopFile, HEAD, SETTINGS, STANDARD, TITLE};
use crate::error::ExportError;
use crate::hierarchy::{Step, steps};
use octant_verdict::fields::own_fields;
use octant_verdict::file::misfit;
use octant_verdict::requirement::{AttributeKind, Requirement, Requirements};
use std::collections::HashSet;
use std::fmt::Write as _;

/// Writes requirements as the files of a folder; [`super::read()`] gives back the same ones, but for what
/// [`crate::losses`] names.
///
/// # Errors
/// If an id is none of Doorstop's, an attribute has the name of another, or a value doesn't fit its kind.
pub fn write(requirements: &Requirements) -> Result<Vec<DoorstopFile>, ExportError> {
    let of = |key: &str| {
        let entry = requirements.document.iter().find(|(name, _)| name == key);
        entry.map(|(_, value)| value.as_str())
    };
    let mut settings = String::from("settings:\n");
    for (name, key) in HEAD {
        let usual = match name {
            "prefix" => Some("REQ"),
            "digits" => Some("3"),
            "sep" => Some(""),
            _ => None,
        };
        if let Some(value) = of(key).or(usual) {
            let value = if name == "digits" { value.to_owned() } else { quoted(value) };
            _ = writeln!(settings, "  {name}: {value}");
        }
    }
    _ = writeln!(settings, "extensions:\n  {TITLE}: {}", quoted(&requirements.title));
    let mut files = vec![(SETTINGS.to_owned(), settings)];
    let ids: HashSet<String> =
        requirements.requirements.iter().map(|r| r.id.to_lowercase()).collect();
    let mut headings = 0;
    // Numbers of the open nodes, and of the last child at the level below.
    let mut level: Vec<u32> = Vec::new();
    let mut next: Vec<u32> = vec![1];
    for step in steps(requirements) {
        if step == Step::End {
            level.pop();
            next.pop();
            continue;
        }
        let number = next.last().copied().unwrap_or(1);
        if let Some(last) = next.last_mut() {
            *last += 1;
        }
        level.push(number);
        next.push(1);
        let parts = level.iter().map(u32::to_string).collect::<Vec<_>>().join(".");
        match step {
            Step::Section(title, _) => {
                let id = loop {
                    headings += 1;
                    let id = format!("SECTION-{headings:03}");
                    if !ids.contains(&id.to_lowercase()) {
                        break id;
                    }
                };
                files.push((format!("{id}.yml"), heading(title, &parts)));
            }
            Step::Requirement(index) => {
                let requirement = &requirements.requirements[index];
                let text = item(requirements, requirement, &parts).map_err(|message| {
                    ExportError { format: "Doorstop", id: requirement.id.clone(), message }
                })?;
                files.push((format!("{}.yml", requirement.id), text));
            }
            Step::End => {}
        }
    }
    let mut seen = HashSet::new();
    if let Some((name, _)) = files.iter().find(|(name, _)| !seen.insert(name.to_lowercase())) {
        let message = format!("the file {name} would be there twice, in capitals or not");
        return Err(ExportError { format: "Doorstop", id: name.clone(), message });
    }
    Ok(files)
}

fn heading(title: &str, level: &str) -> String {
    format!(
        "active: true\nderived: false\nheader: ''\nlevel: '{level}.0'\nlinks: []\nnormative: false\nref: ''\n\
         reviewed: null\ntext: {}\n",
        quoted(title)
    )
}

/// True if Doorstop accepts this as an id: a word with a number at its end, or after a separator a word.
fn is_legal(id: &str) -> bool {
    let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let all = id.chars().all(|c| word(c) || c == '-' || c == '.');
    let head = id.trim_end_matches(|c: char| c.is_ascii_digit());
    let numbered = head.len() < id.len() && !head.is_empty();
    let named =
        id.rsplit_once(['-', '_', '.']).is_some_and(|(a, b)| !a.is_empty() && !b.is_empty());
    all && id.starts_with(word) && (numbered || named)
}

fn item(
    requirements: &Requirements,
    requirement: &Requirement,
    level: &str,
) -> Result<String, String> {
    if !is_legal(&requirement.id) {
        let form =
            "letters, digits, _, - and ., with a number or a separator and a word at the end";
        return Err(format!("its id {:?} is none of Doorstop's: {form}", requirement.id));
    }
    let derived =
        requirement.attributes.iter().any(|a| a.name == "derived" && a.values == ["true"]);
    let reference = requirement.attributes.iter().find(|a| a.name == "ref");
    let reference = reference.and_then(|a| a.values.first()).map_or("", String::as_str);
    let title = requirement.title.as_deref().unwrap_or("");
    let mut out =
        format!("active: true\nderived: {derived}\nheader: {}\nlevel: '{level}'\n", quoted(title));
    if requirement.parents.is_empty() {
        out.push_str("links: []\n");
    } else {
        out.push_str("links:\n");
    }
    for parent in &requirement.parents {
        _ = writeln!(out, "- {}", quoted(&parent.id));
    }
    _ = writeln!(out, "normative: true\nref: {}\nreviewed: null", quoted(reference));
    _ = writeln!(out, "text: {}", block(&requirement.text));
    let mut taken: Vec<&str> = STANDARD.to_vec();
    taken.extend(["id", "kind", "identifier"]);
    let own = own_fields(requirement);
    let own: Vec<(String, &str)> =
        own.iter().map(|(name, value)| (name.to_ascii_lowercase(), value.as_str())).collect();
    let more = [("kind", &requirement.kind), ("identifier", &requirement.identifier)];
    for (name, value) in more {
        if let Some(value) = value {
            _ = writeln!(out, "{name}: {}", quoted(value));
        }
    }
    for (name, value) in &own {
        _ = writeln!(out, "{name}: {}", quoted(value));
        taken.push(name);
    }
    for attribute in &requirement.attributes {
        let name = attribute.name.as_str();
        if ["derived", "ref"].contains(&name) {
            continue;
        }
        if taken.contains(&name) {
            return Err(format!("the attribute {name:?} has the name of another"));
        }
        let kind = requirements.kind(name);
        if let Some(expected) = misfit(&kind, &attribute.values) {
            let found = attribute.values.join(", ");
            return Err(format!("{name} is {found:?}, expected {expected}"));
        }
        match attribute.values.as_slice() {
            [value] => _ = writeln!(out, "{}: {}", quoted(name), typed(&kind, value)),
            values => {
                _ = writeln!(out, "{}:", quoted(name));
                for value in values {
                    _ = writeln!(out, "- {}", quoted(value));
                }
            }
        }
    }
    Ok(out)
}

/// A value without quotes where YAML takes it for one of its kind.
fn typed(kind: &AttributeKind, value: &str) -> String {
    let is_plain = match kind {
        AttributeKind::Boolean | AttributeKind::Integer => true,
        AttributeKind::Real => value.contains('.'),
        _ => false,
    };
    if is_plain { value.to_owned() } else { quoted(value) }
}
