//! Writing of `requirements.toml`.

use super::SCHEMA;
use super::entries::{array, entry, quoted};
use crate::requirement::{Limit, Requirement, Requirements, Verification, percent};
use std::fmt::Write as _;

/// Writes a `requirements.toml`; [`super::read()`] gives back the same requirements.
#[must_use]
pub fn write(requirements: &Requirements) -> String {
    let mut out = format!("schema = {SCHEMA}\n");
    entry(&mut out, "title", &requirements.title);
    if !requirements.document.is_empty() {
        out.push_str("\n[document]\n");
        for (key, value) in &requirements.document {
            entry(&mut out, key, value);
        }
    }
    for definition in &requirements.definitions {
        out.push_str("\n[[attributes]]\n");
        entry(&mut out, "name", &definition.name);
        entry(&mut out, "type", definition.kind.name());
        if let Some(options) = definition.kind.options() {
            array(&mut out, "options", options);
        }
        optional(&mut out, "field", &definition.field);
    }
    for requirement in &requirements.requirements {
        one(&mut out, requirement);
    }
    super::accounts::write(&mut out, &requirements.accounts);
    out
}

fn one(out: &mut String, requirement: &Requirement) {
    out.push_str("\n[[requirements]]\n");
    entry(out, "id", &requirement.id);
    optional(out, "title", &requirement.title);
    entry(out, "text", &requirement.text);
    match &requirement.verification {
        Verification::Test(check) => {
            entry(out, "measure", &check.measure);
            entry(out, "comparison", check.comparison.sign());
            match &check.limit {
                Limit::Quantity(text) => entry(out, "limit", text),
                Limit::Number(number) => _ = writeln!(out, "limit = {number:?}"),
            }
            if check.secant_latitude {
                out.push_str("secant_latitude = true\n");
            }
            if let Some(ensemble) = &check.ensemble {
                entry(out, "pass", &percent(ensemble.pass));
                entry(out, "confidence", &percent(ensemble.confidence));
            }
        }
        Verification::Tests(tests) => {
            entry(out, "verification", requirement.verification.name());
            array(out, "tests", tests);
        }
        other => entry(out, "verification", other.name()),
    }
    optional(out, "clause", &requirement.clause);
    optional(out, "rationale", &requirement.rationale);
    if !requirement.parents.is_empty() {
        let parents: Vec<String> = requirement
            .parents
            .iter()
            .map(|parent| match &parent.role {
                None => quoted(&parent.id),
                Some(role) => format!("{{ id = {}, role = {} }}", quoted(&parent.id), quoted(role)),
            })
            .collect();
        _ = writeln!(out, "parents = [{}]", parents.join(", "));
    }
    if !requirement.section.is_empty() {
        array(out, "section", &requirement.section);
    }
    optional(out, "under", &requirement.under);
    optional(out, "kind", &requirement.kind);
    optional(out, "identifier", &requirement.identifier);
    if !requirement.attributes.is_empty() {
        out.push_str("[requirements.attributes]\n");
        for attribute in &requirement.attributes {
            match attribute.values.as_slice() {
                [value] => entry(out, &attribute.name, value),
                values => array(out, &attribute.name, values),
            }
        }
    }
    if !requirement.formatted.is_empty() {
        out.push_str("[requirements.formatted]\n");
        for text in &requirement.formatted {
            entry(out, &text.name, &text.xhtml);
        }
    }
}

fn optional(out: &mut String, key: &str, value: &Option<String>) {
    if let Some(value) = value {
        entry(out, key, value);
    }
}
