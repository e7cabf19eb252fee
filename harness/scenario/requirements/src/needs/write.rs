//! Writing of `needs.json`.

use super::schema::{links, property};
use super::{ESCAPED, FORMAT, LINKS, LISTS, PARENT_NEEDS, REQ, VERSION};
use crate::error::ExportError;
use crate::sdoc::markup;
use octant_verdict::fields::own_fields;
use octant_verdict::file::misfit;
use octant_verdict::requirement::{AttributeKind, Requirement, Requirements};
use serde_json::{Map, Value, json};
use std::collections::HashSet;

/// Fields of a need that an attribute can't have.
const RESERVED: [&str; 9] =
    ["id", "title", "content", "type", "sections", "doctype", LINKS, PARENT_NEEDS, "identifier"];

/// Writes requirements as a `needs.json`; [`super::read()`] gives back the same ones, of texts without
/// formatting. `time` is the time of the export.
///
/// # Errors
/// If an attribute has the name of a field that every need has, or a value that doesn't fit its kind.
pub fn write(requirements: &Requirements, time: &str) -> Result<String, ExportError> {
    let of = |key: &str| {
        let entry = requirements.document.iter().find(|(name, _)| name == key);
        entry.map_or("", |(_, value)| value.as_str())
    };
    let escaped = !markup::is_rst(&requirements.document);
    let lists = lists(requirements);
    let mut needs: Vec<(String, Value)> = Vec::new();
    for requirement in &requirements.requirements {
        let value = need(requirements, requirement, &lists, escaped).map_err(|message| {
            ExportError { format: "needs.json", id: requirement.id.clone(), message }
        })?;
        needs.push((requirement.id.clone(), value));
    }
    let version = Value::from(of(VERSION)).to_string();
    let creator = json!({ "program": "octant", "version": env!("CARGO_PKG_VERSION") });
    // By hand, because the needs keep their order.
    let mut out = format!(
        "{{\n \"format_version\": {FORMAT},\n \"current_version\": {version},\n \"project\": {},\n \
         \"versions\": {{\n  {version}: {{\n   \"created\": {},\n   \"creator\": {creator},\n   \
         \"{ESCAPED}\": {escaped},\n   \"needs_amount\": {},\n   \"needs_schema\": {},\n   \"needs\": {{",
        Value::from(requirements.title.as_str()),
        Value::from(time),
        needs.len(),
        schema(requirements, &lists),
    );
    for (index, (id, value)) in needs.iter().enumerate() {
        let comma = if index > 0 { "," } else { "" };
        out.push_str(&format!("{comma}\n    {}: {value}", Value::from(id.as_str())));
    }
    out.push_str("\n   }\n  }\n }\n}\n");
    Ok(out)
}

/// Attributes whose values are lists.
fn lists(requirements: &Requirements) -> HashSet<&str> {
    let all = requirements.requirements.iter().flat_map(|r| &r.attributes);
    let several = all.filter(|a| {
        a.values.len() != 1
            || LISTS.contains(&a.name.as_str())
            || matches!(requirements.kind(&a.name), AttributeKind::Choices(_))
    });
    several.map(|a| a.name.as_str()).collect()
}

fn schema(requirements: &Requirements, lists: &HashSet<&str>) -> Value {
    let mut properties = Map::new();
    for name in requirements.attribute_names() {
        let kind = requirements.kind(name);
        properties.insert(name.to_owned(), property(&kind, lists.contains(name)));
    }
    for requirement in &requirements.requirements {
        for (field, _) in own_fields(requirement) {
            let name = field.to_ascii_lowercase();
            properties.entry(name).or_insert_with(|| property(&AttributeKind::Text, false));
        }
        for role in requirement.parents.iter().filter_map(|parent| parent.role.as_ref()) {
            properties.insert(role.clone(), links());
        }
    }
    properties.insert("identifier".to_owned(), property(&AttributeKind::Text, false));
    properties.insert(LINKS.to_owned(), links());
    properties.insert(PARENT_NEEDS.to_owned(), links());
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "type": "object",
        "properties": properties,
    })
}

fn need(
    requirements: &Requirements,
    requirement: &Requirement,
    lists: &HashSet<&str>,
    escaped: bool,
) -> Result<Value, String> {
    let mut fields = Map::new();
    let text = &requirement.text;
    let content = if escaped { markup::escaped(text) } else { text.clone() };
    let kind = requirement.kind.as_deref().unwrap_or(REQ);
    let sections: Vec<&String> = requirement.section.iter().rev().collect();
    fields.insert("id".to_owned(), json!(requirement.id));
    // Every need has a title.
    fields.insert("title".to_owned(), json!(requirement.title.as_deref().unwrap_or("")));
    fields.insert("content".to_owned(), json!(content));
    fields.insert("type".to_owned(), json!(kind));
    fields.insert("sections".to_owned(), json!(sections));
    if let Some(identifier) = &requirement.identifier {
        fields.insert("identifier".to_owned(), json!(identifier));
    }
    for (field, value) in own_fields(requirement) {
        fields.insert(field.to_ascii_lowercase(), json!(value));
    }
    let mut parents = vec![(LINKS.to_owned(), Vec::new()), (PARENT_NEEDS.to_owned(), Vec::new())];
    parents[1].1.extend(requirement.under.iter().cloned());
    for parent in &requirement.parents {
        let role = parent.role.as_deref().unwrap_or(LINKS);
        match parents.iter_mut().find(|(name, _)| name == role) {
            Some((_, ids)) => ids.push(parent.id.clone()),
            None => parents.push((role.to_owned(), vec![parent.id.clone()])),
        }
    }
    for (role, ids) in parents {
        if fields.contains_key(&role) {
            return Err(format!("the role {role:?} of a parent is the name of another field"));
        }
        fields.insert(role, json!(ids));
    }
    for attribute in &requirement.attributes {
        let name = attribute.name.as_str();
        if RESERVED.contains(&name) || fields.contains_key(name) {
            return Err(format!("the attribute {name:?} has the name of another field"));
        }
        let kind = requirements.kind(name);
        if let Some(expected) = misfit(&kind, &attribute.values) {
            let found = attribute.values.join(", ");
            return Err(format!("{name} is {found:?}, expected {expected}"));
        }
        let value = if lists.contains(name) {
            json!(attribute.values)
        } else {
            let value = attribute.values.first().map_or("", String::as_str);
            typed(&kind, value)
        };
        fields.insert(name.to_owned(), value);
    }
    Ok(Value::Object(fields))
}

/// A value of the kind, if JSON writes it in the same way.
fn typed(kind: &AttributeKind, value: &str) -> Value {
    let typed = match kind {
        AttributeKind::Boolean => return json!(value == "true"),
        AttributeKind::Integer => value.parse::<i64>().ok().map(Value::from),
        AttributeKind::Real => value.parse::<f64>().ok().map(Value::from),
        _ => None,
    };
    let is_same = |typed: &Value| {
        let text = typed.to_string();
        text == value
    };
    typed.filter(is_same).unwrap_or_else(|| json!(value))
}
