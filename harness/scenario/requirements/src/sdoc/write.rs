//! Writing of StrictDoc's documents.

use super::grammar::field_of;
use super::markup;
use super::{HEAD, OPTIONS, REQUIREMENT, legal_field, legal_kind, legal_uid};
use crate::error::ExportError;
use octant_verdict::fields::{ALL, OF_FORMATS, own_fields};
use octant_verdict::requirement::{AttributeKind, Requirement, Requirements};
use std::collections::HashMap;
use std::fmt::Write as _;

/// Writes requirements as an `.sdoc`; [`super::read()`] gives back the same ones. A document that names
/// no markup is written, and comes back, as one of plain text.
///
/// # Errors
/// If StrictDoc can't hold a part of a requirement: an id or type that it refuses, a line `<<<` in a
/// text.
pub fn write(requirements: &Requirements) -> Result<String, ExportError> {
    let mut out = String::from("[DOCUMENT]\n");
    let whole = |message: String| ExportError { format: "sdoc", id: "(all)".to_owned(), message };
    head(&mut out, requirements);
    for definition in &requirements.definitions {
        for option in definition.kind.options().unwrap_or_default() {
            if option.contains([',', '(', ')', '"', '\n']) {
                let message = format!("the option {option:?} of {}", definition.name);
                return Err(whole(format!("{message} has a comma, bracket, quote or line break")));
            }
        }
    }
    let columns = columns(requirements);
    let rst = markup::is_rst(&requirements.document);
    grammar(&mut out, requirements, &columns);
    let mut open: Vec<&str> = Vec::new();
    for requirement in &requirements.requirements {
        let wrong =
            |message: String| ExportError { format: "sdoc", id: requirement.id.clone(), message };
        let shared =
            open.iter().zip(&requirement.section).take_while(|(a, b)| **a == b.as_str()).count();
        for _ in shared..open.len() {
            out.push_str("\n[[/SECTION]]\n");
        }
        open.truncate(shared);
        for title in &requirement.section[shared..] {
            if title.contains('\n') {
                return Err(wrong(format!("the section {title:?} has several lines")));
            }
            _ = write!(out, "\n[[SECTION]]\nTITLE: {title}\n");
            open.push(title);
        }
        node(&mut out, requirement, &columns, rst).map_err(wrong)?;
    }
    for _ in open {
        out.push_str("\n[[/SECTION]]\n");
    }
    Ok(out)
}

fn head(out: &mut String, requirements: &Requirements) {
    let entry = |key: &str| {
        requirements
            .document
            .iter()
            .find(|(k, _)| k == key)
            .map(|(_, value)| value.replace('\n', " "))
    };
    let line = |out: &mut String, indent: &str, key: &str, value: &str| {
        _ = writeln!(out, "{indent}{key}: {value}");
    };
    if let Some(mid) = entry("MID") {
        line(out, "", "MID", &mid);
    }
    line(out, "", "TITLE", &requirements.title);
    for key in &HEAD[1..] {
        if let Some(value) = entry(key) {
            line(out, "", key, &value);
        }
    }
    let options: Vec<_> = OPTIONS
        .iter()
        .filter_map(|key| {
            let name = format!("OPTIONS.{key}");
            let default = || (name == markup::OPTION).then(|| markup::PLAIN.to_owned());
            entry(&name).or_else(default).map(|value| (*key, value))
        })
        .collect();
    out.push_str("OPTIONS:\n");
    for (key, value) in options {
        line(out, "  ", key, &value);
    }
    // Fields unknown to StrictDoc become metadata, which every document may have.
    let known = |key: &str| {
        HEAD.contains(&key) || key.strip_prefix("OPTIONS.").is_some_and(|o| OPTIONS.contains(&o))
    };
    let mut metadata = requirements.document.iter().filter(|(key, _)| !known(key)).peekable();
    if metadata.peek().is_some() {
        out.push_str("METADATA:\n");
    }
    for (key, value) in metadata {
        line(out, "  ", &metadata_name(key), &value.replace('\n', " "));
    }
}

/// Name of a field of the head as metadata: a letter or `_`, then also digits and `-`.
pub(crate) fn metadata_name(key: &str) -> String {
    let key = key.strip_prefix("METADATA.").unwrap_or(key);
    let word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let mut name: String = key.chars().map(|c| if word(c) { c } else { '_' }).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        name.insert(0, '_');
    }
    name
}

/// Attributes with their fields.
fn columns(requirements: &Requirements) -> Vec<(&str, String, AttributeKind)> {
    let mut taken: Vec<String> = Vec::new();
    let mut columns = Vec::new();
    let reserved = |field: &str| OF_FORMATS.contains(&field);
    for name in requirements.attribute_names() {
        let definition = requirements.definitions.iter().find(|d| d.name == name);
        let wanted = definition.and_then(|d| d.field.clone()).filter(|field| legal_field(field));
        let wanted = wanted.unwrap_or_else(|| field_of(name));
        let mut field = wanted.clone();
        let mut number = 2;
        // A field of Octant can be an attribute: of a requirement whose own key is missing.
        let ours = |field: &str| ALL.contains(&field) && field != name;
        while reserved(&field) || ours(&field) || taken.contains(&field) {
            field = format!("{wanted}_{number}");
            number += 1;
        }
        taken.push(field.clone());
        columns.push((name, field, requirements.kind(name)));
    }
    columns
}

fn grammar(
    out: &mut String,
    requirements: &Requirements,
    columns: &[(&str, String, AttributeKind)],
) {
    out.push_str("\n[GRAMMAR]\nELEMENTS:\n");
    out.push_str(
        "- TAG: TEXT\n  FIELDS:\n  - TITLE: UID\n    TYPE: String\n    REQUIRED: False\n  \
         - TITLE: STATEMENT\n    TYPE: String\n    REQUIRED: True\n\
         - TAG: SECTION\n  PROPERTIES:\n    IS_COMPOSITE: True\n  FIELDS:\n  \
         - TITLE: UID\n    TYPE: String\n    REQUIRED: False\n  \
         - TITLE: TITLE\n    TYPE: String\n    REQUIRED: True\n",
    );
    let mut kinds: Vec<String> = Vec::new();
    // Every role of a parent has to be declared.
    let mut roles: HashMap<String, Vec<Option<&str>>> = HashMap::new();
    for requirement in &requirements.requirements {
        let kind = tag(requirement);
        if !kinds.contains(&kind) {
            kinds.push(kind.clone());
        }
        let roles = roles.entry(kind).or_insert_with(|| vec![None]);
        for parent in &requirement.parents {
            if !roles.contains(&parent.role.as_deref()) {
                roles.push(parent.role.as_deref());
            }
        }
    }
    if kinds.is_empty() {
        kinds.push(REQUIREMENT.to_owned());
    }
    for tag in kinds {
        _ = writeln!(out, "- TAG: {tag}\n  FIELDS:");
        let mut field = |title: &str, human: Option<&str>, kind: &AttributeKind, required: &str| {
            _ = writeln!(out, "  - TITLE: {title}");
            if let Some(human) = human {
                _ = writeln!(out, "    HUMAN_TITLE: {human}");
            }
            let of = match kind {
                AttributeKind::Choice(options) => format!("SingleChoice({})", choices(options)),
                AttributeKind::Choices(options) => format!("MultipleChoice({})", choices(options)),
                _ => "String".to_owned(),
            };
            _ = writeln!(out, "    TYPE: {of}\n    REQUIRED: {required}");
        };
        for (title, required) in
            [("MID", "False"), ("UID", "True"), ("TITLE", "False"), ("STATEMENT", "True")]
        {
            field(title, None, &AttributeKind::Text, required);
        }
        for title in ALL {
            if !columns.iter().any(|(_, column, _)| column == title) {
                field(title, None, &AttributeKind::Text, "False");
            }
        }
        for (name, column, kind) in columns {
            field(column, (name != column).then_some(name), kind, "False");
        }
        out.push_str("  RELATIONS:\n");
        for role in roles.get(&tag).map_or(&[None][..], Vec::as_slice) {
            out.push_str("  - TYPE: Parent\n");
            if let Some(role) = role {
                _ = writeln!(out, "    ROLE: {role}");
            }
        }
    }
}

/// Type of a requirement with only capitals and `_`.
fn tag(requirement: &Requirement) -> String {
    let Some(kind) = &requirement.kind else { return REQUIREMENT.to_owned() };
    if legal_kind(kind) {
        return kind.clone();
    }
    let words = kind.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| !word.is_empty());
    let tag = words.map(str::to_ascii_uppercase).collect::<Vec<_>>().join("_");
    if legal_kind(&tag) { tag } else { REQUIREMENT.to_owned() }
}

fn choices(options: &[String]) -> String {
    options.join(", ")
}

fn node(
    out: &mut String,
    requirement: &Requirement,
    columns: &[(&str, String, AttributeKind)],
    rst: bool,
) -> Result<(), String> {
    if !legal_uid(&requirement.id) {
        return Err(format!(
            "its id {:?} is none of StrictDoc's: a letter, digit or _, then those, ()-/.: or space",
            requirement.id
        ));
    }
    let kind = tag(requirement);
    _ = write!(out, "\n[{kind}]\n");
    let mut own: Vec<(&str, String)> = Vec::new();
    own.extend(requirement.identifier.iter().map(|text| ("MID", text.clone())));
    own.push(("UID", requirement.id.clone()));
    own.extend(requirement.title.iter().map(|text| ("TITLE", text.clone())));
    own.push(("STATEMENT", requirement.text.clone()));
    own.extend(own_fields(requirement));
    for (_, value) in own.iter_mut().filter(|(field, _)| rst && markup::made(field)) {
        *value = markup::escaped(value);
    }
    let of = |field: &str| own.iter().find(|(name, _)| *name == field);
    // Fields are written in the order of the grammar: StrictDoc accepts no other.
    let before = OF_FORMATS.into_iter().chain(ALL);
    for field in before.filter(|field| !columns.iter().any(|(_, column, _)| column == field)) {
        if let Some((_, value)) = of(field) {
            entry(out, field, value)?;
        }
    }
    for (name, column, kind) in columns {
        if let Some((_, value)) = of(column) {
            entry(out, column, value)?;
        }
        let Some(attribute) = requirement.attributes.iter().find(|a| a.name == *name) else {
            continue;
        };
        if matches!(kind, AttributeKind::Choices(_)) {
            entry(out, column, &choices(&attribute.values))?;
        } else {
            for value in &attribute.values {
                entry(out, column, value)?;
            }
        }
    }
    if !requirement.parents.is_empty() {
        out.push_str("RELATIONS:\n");
    }
    for parent in &requirement.parents {
        _ = writeln!(out, "- TYPE: Parent\n  VALUE: {}", parent.id);
        if let Some(role) = &parent.role {
            _ = writeln!(out, "  ROLE: {role}");
        }
    }
    Ok(())
}

fn entry(out: &mut String, field: &str, value: &str) -> Result<(), String> {
    if value.split('\n').any(|line| line.starts_with("<<<")) {
        return Err(format!("{field} has a line that begins with <<<, which ends a text there"));
    }
    if value.contains('\n') || value.starts_with(">>>") {
        _ = writeln!(out, "{field}: >>>\n{value}\n<<<");
    } else {
        _ = writeln!(out, "{field}: {value}");
    }
    Ok(())
}
