//! Parts of requirements for which a format has no place, in words.

use crate::error::{Imported, listed};
use crate::format::ExchangeFormat;
use crate::xhtml;
use octant_verdict::requirement::{AttributeKind, Requirement, Requirements};
use std::collections::HashSet;

/// Lists the parts that a file of this format can't keep.
#[must_use]
pub fn losses(imported: &Imported, format: ExchangeFormat) -> Vec<String> {
    let requirements = &imported.requirements;
    let mut found = Vec::new();
    if format != ExchangeFormat::ReqIfArchive && !imported.attachments.is_empty() {
        let names: Vec<&str> = imported.attachments.iter().map(|a| a.name.as_str()).collect();
        found.push(format!(
            "left out, because only .reqifz has files beside it: {}",
            listed(&names)
        ));
    }
    if format != ExchangeFormat::Toml {
        let doubts: Vec<String> =
            imported.accounts().iter().flat_map(octant_account::Account::doubts).collect();
        let doubts: Vec<&str> = doubts.iter().map(String::as_str).collect();
        name(
            &mut found,
            "only .toml keeps the accounts of the documents before it, with their doubts",
            &doubts,
        );
    }
    match format {
        ExchangeFormat::Toml => {}
        ExchangeFormat::ReqIf | ExchangeFormat::ReqIfArchive => reqif(requirements, &mut found),
        ExchangeFormat::StrictDoc => sdoc(requirements, &mut found),
        ExchangeFormat::Needs => needs(requirements, &mut found),
        ExchangeFormat::Doorstop => doorstop(requirements, &mut found),
    }
    found
}

/// Ids of the requirements of which something is true.
fn ids(requirements: &Requirements, of: impl Fn(&Requirement) -> bool) -> Vec<&str> {
    requirements.requirements.iter().filter(|r| of(r)).map(|r| r.id.as_str()).collect()
}

fn name(found: &mut Vec<String>, what: &str, names: &[&str]) {
    if !names.is_empty() {
        found.push(format!("{what}: {}", listed(names)));
    }
}

fn formatted(requirements: &Requirements, found: &mut Vec<String>) {
    let ids = ids(requirements, |r| !r.formatted.is_empty());
    name(found, "the formatting of texts is left out", &ids);
}

fn under(requirements: &Requirements, found: &mut Vec<String>) {
    let ids = ids(requirements, |r| r.under.is_some());
    name(found, "what stands below another requirement stands beside it", &ids);
}

fn kinds(requirements: &Requirements, found: &mut Vec<String>) {
    let lost = |kind: &AttributeKind| {
        !matches!(kind, AttributeKind::Text | AttributeKind::Choice(_) | AttributeKind::Choices(_))
    };
    let definitions = requirements.definitions.iter().filter(|d| lost(&d.kind));
    let names: Vec<&str> = definitions.map(|d| d.name.as_str()).collect();
    name(found, "the types of these attributes become text", &names);
}

fn reqif(requirements: &Requirements, found: &mut Vec<String>) {
    let changed = |requirement: &Requirement| {
        requirement.formatted.iter().any(|text| {
            let own = crate::reqif::text_of(requirement, &text.name);
            own.is_none_or(|own| xhtml::of_formatted(&text.xhtml, &own).is_none())
        })
    };
    let changed = ids(requirements, changed);
    let what = "the formatting is left out, because the text was changed and the formatting not";
    name(found, what, &changed);
    let all: HashSet<&str> = requirements.requirements.iter().map(|r| r.id.as_str()).collect();
    let parents: Vec<String> = requirements
        .requirements
        .iter()
        .flat_map(|r| r.parents.iter().map(move |parent| (r, parent)))
        .filter(|(_, parent)| !all.contains(parent.id.as_str()))
        .map(|(r, parent)| format!("{} of {}", parent.id, r.id))
        .collect();
    let parents: Vec<&str> = parents.iter().map(String::as_str).collect();
    name(
        found,
        "parents in other documents are left out, since a relation has both ends in one file",
        &parents,
    );
    let several = |requirement: &Requirement| {
        let mut attributes = requirement.attributes.iter();
        attributes.any(|a| a.values.len() > 1 && requirements.kind(&a.name) == AttributeKind::Text)
    };
    let ids = ids(requirements, several);
    name(found, "several texts of one attribute become one", &ids);
    let fields = requirements.definitions.iter().filter(|d| d.field.is_some());
    let fields: Vec<&str> = fields.map(|d| d.name.as_str()).collect();
    name(found, "the names of these attributes in StrictDoc are left out", &fields);
}

fn sdoc(requirements: &Requirements, found: &mut Vec<String>) {
    formatted(requirements, found);
    under(requirements, found);
    kinds(requirements, found);
    let changed = |r: &Requirement| r.kind.as_ref().is_some_and(|k| !crate::sdoc::legal_kind(k));
    let ids = ids(requirements, changed);
    name(found, "the kind becomes capitals", &ids);
    let renamed = |key: &&str| {
        let own = key.strip_prefix("METADATA.").unwrap_or(key);
        !key.starts_with("OPTIONS.") && crate::sdoc::metadata_name(key) != own
    };
    let head = requirements.document.iter().map(|(key, _)| key.as_str());
    let head: Vec<&str> = head.filter(renamed).collect();
    name(found, "these names in the head of the document get _ for other characters", &head);
}

fn head(requirements: &Requirements, found: &mut Vec<String>, kept: impl Fn(&str) -> bool) {
    let head = requirements.document.iter().map(|(key, _)| key.as_str());
    let head: Vec<&str> = head.filter(|key| !kept(key)).collect();
    name(found, "of the head of the document is left out", &head);
    let fields = requirements.definitions.iter().filter(|d| d.field.is_some());
    let fields: Vec<&str> = fields.map(|d| d.name.as_str()).collect();
    name(found, "the names of these attributes in StrictDoc are left out", &fields);
}

fn needs(requirements: &Requirements, found: &mut Vec<String>) {
    formatted(requirements, found);
    head(requirements, found, |key| ["VERSION", "OPTIONS.MARKUP"].contains(&key));
}

fn doorstop(requirements: &Requirements, found: &mut Vec<String>) {
    formatted(requirements, found);
    head(requirements, found, |key| key.starts_with("DOORSTOP_"));
    let lost = |kind: &AttributeKind| {
        let choice = kind.options().is_some();
        choice || *kind == AttributeKind::Date
    };
    let definitions = requirements.definitions.iter().filter(|d| lost(&d.kind));
    let names: Vec<&str> = definitions.map(|d| d.name.as_str()).collect();
    name(found, "the types of these attributes become text", &names);
    let ids = ids(requirements, |r| r.parents.iter().any(|parent| parent.role.is_some()));
    name(found, "the roles of the parents are left out", &ids);
}
