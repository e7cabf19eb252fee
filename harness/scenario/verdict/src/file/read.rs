//! Reads `requirements.toml`.

use super::{Checker, SCHEMA};
use crate::error::RequirementsError;
use crate::fields::{self, misnamed, own_fields};
use crate::measures::without_secant;
use crate::requirement::{
    AttributeKind, Check, Definition, EnsembleRequirement, ForeignAttribute, FormattedText, Limit,
    Parent, Requirement, Requirements, Verification, confidence, probability,
};
use crate::table::{Problems, Reader, schema};
use crate::verdict::Comparison;
use octant_base::names::suggestion;
use octant_toml_tree::Value;
use std::collections::HashMap;

const ROOT: [&str; 6] = ["schema", "title", "document", "attributes", "requirements", "accounts"];
const DEFINITION: [&str; 4] = ["name", "type", "options", "field"];
const REQUIREMENT: [&str; 20] = [
    "id",
    "title",
    "text",
    "measure",
    "comparison",
    "limit",
    "secant_latitude",
    "pass",
    "confidence",
    "verification",
    "tests",
    "clause",
    "rationale",
    "parents",
    "section",
    "under",
    "kind",
    "identifier",
    "attributes",
    "formatted",
];
const KINDS: [&str; 7] = ["text", "integer", "real", "boolean", "date", "choice", "choices"];

/// Reads the text of a `requirements.toml`.
///
/// # Errors
/// All problems, each with line, column and field.
pub fn read(
    text: &str,
    file: &str,
    checker: &dyn Checker,
) -> Result<Requirements, RequirementsError> {
    let problems = Problems::new(text);
    let table = problems.table(file)?;
    let root = Reader::root(&table, &problems);
    // A newer schema may have other keys: unknown ones in it are not reported.
    let found =
        if schema(&root, SCHEMA) { document(&root, checker) } else { Requirements::default() };
    let mut problems = problems.all.into_inner();
    problems.sort_by_key(|p| (p.line, p.column));
    if problems.is_empty() {
        Ok(found)
    } else {
        Err(RequirementsError { file: file.to_owned(), problems })
    }
}

fn document(root: &Reader<'_>, checker: &dyn Checker) -> Requirements {
    root.known(&ROOT);
    let mut document = Vec::new();
    if let Some(head) = root.table("document") {
        for (key, value) in head.entries() {
            document.extend(head.text_of(key, value).map(|text| (key.to_owned(), text)));
        }
    }
    let mut definitions: Vec<Definition> = Vec::new();
    for table in root.tables("attributes") {
        let Some(definition) = definition(&table) else { continue };
        if definitions.iter().any(|d| d.name == definition.name) {
            let found = format!("found {:?} a second time", definition.name);
            table.problem("name", format!("{found}, expected unique names"));
        }
        definitions.push(definition);
    }
    let mut requirements = Vec::new();
    let mut lines: HashMap<String, usize> = HashMap::new();
    for table in root.tables("requirements") {
        let id = table.line_of("id");
        let name = id.as_ref().map(|id| format!("requirements.{id}"));
        let table = match name {
            Some(name) => table.with_path(name),
            None => table,
        };
        if !table.has("id") {
            table.problem("id", "missing, expected an identifier");
        }
        if let Some(id) = &id {
            if let Some(line) = lines.get(id) {
                let found = format!("found {id:?} a second time, the first is in line {line}");
                table.problem("id", format!("{found}; expected unique ids"));
            } else {
                lines.insert(id.clone(), table.line());
            }
        }
        let read = requirement(&table, id, &definitions, checker);
        if let Some(under) = read.as_ref().and_then(|read| read.under.as_ref())
            && (!lines.contains_key(under) || id_of(read.as_ref()) == Some(under))
        {
            let message =
                format!("found {under:?}, expected the id of a requirement before this one");
            table.problem("under", message);
        }
        requirements.extend(read);
    }
    let title = root.line_of("title").unwrap_or_else(|| "Requirements".to_owned());
    let accounts = super::accounts::read(root);
    Requirements { title, document, definitions, requirements, accounts }
}

fn id_of(requirement: Option<&Requirement>) -> Option<&String> {
    requirement.map(|requirement| &requirement.id)
}

fn definition(table: &Reader<'_>) -> Option<Definition> {
    table.known(&DEFINITION);
    let name = table.required("name", "the name of an attribute")?;
    let kind = table.optional("type").unwrap_or_else(|| "text".to_owned());
    let options: Vec<String> =
        table.get("options").map(|v| table.texts_of("options", v)).unwrap_or_default();
    let choice = matches!(kind.as_str(), "choice" | "choices");
    if choice && options.is_empty() {
        table.problem("options", "missing, a choice has options");
    }
    if !choice && table.has("options") {
        table.problem("options", format!("found options, and {kind} has none"));
    }
    let kind = match kind.as_str() {
        "text" => AttributeKind::Text,
        "integer" => AttributeKind::Integer,
        "real" => AttributeKind::Real,
        "boolean" => AttributeKind::Boolean,
        "date" => AttributeKind::Date,
        "choice" => AttributeKind::Choice(options),
        "choices" => AttributeKind::Choices(options),
        other => {
            let known = suggestion(other, KINDS.into_iter(), "known");
            table.problem("type", format!("found {other:?}, {known}"));
            return None;
        }
    };
    Some(Definition { name, kind, field: table.line_of("field") })
}

fn requirement(
    table: &Reader<'_>,
    id: Option<String>,
    definitions: &[Definition],
    checker: &dyn Checker,
) -> Option<Requirement> {
    table.known(&REQUIREMENT);
    let text = table.required("text", "what is required, as a sentence");
    let verification = verification(table, checker);
    let section = table.get("section").map(|v| table.texts_of("section", v)).unwrap_or_default();
    let parents = parents(table);
    for (key, mut texts) in [
        ("section", Box::new(section.iter()) as Box<dyn Iterator<Item = &String>>),
        ("parents", Box::new(parents.iter().flat_map(|p| p.role.iter().chain([&p.id])))),
    ] {
        if texts.any(|text| text.contains('\n')) {
            table.problem(key, "found several lines, expected one");
        }
    }
    let mut read = Requirement {
        title: table.line_of("title"),
        clause: table.optional("clause"),
        rationale: table.optional("rationale"),
        parents,
        section,
        under: table.line_of("under"),
        kind: table.line_of("kind"),
        identifier: table.line_of("identifier"),
        ..Requirement::new(&id?, &text?, verification?)
    };
    let own = own_fields(&read);
    if let Some(attributes) = table.table("attributes") {
        for (name, value) in attributes.entries() {
            if fields::OF_FORMATS.contains(&name) || own.iter().any(|(own, _)| *own == name) {
                let message = "stands for a key that the requirement itself has";
                attributes.problem(name, message);
                continue;
            }
            let values = attributes.texts_of(name, value);
            fits(&attributes, name, &values, definitions);
            read.attributes.push(ForeignAttribute { name: name.to_owned(), values });
        }
    }
    read.formatted = formatted(table, checker);
    Some(read)
}

fn formatted(table: &Reader<'_>, checker: &dyn Checker) -> Vec<FormattedText> {
    let Some(table) = table.table("formatted") else { return Vec::new() };
    let mut all = Vec::new();
    for (name, value) in table.entries() {
        let Some(xhtml) = table.text_of(name, value) else { continue };
        match checker.formatted(&xhtml) {
            Ok(()) => all.push(FormattedText { name: name.to_owned(), xhtml }),
            Err(message) => table.problem(name, message),
        }
    }
    all
}

/// Reports values that don't fit the kind of their attribute.
fn fits(table: &Reader<'_>, name: &str, values: &[String], definitions: &[Definition]) {
    let Some(definition) = definitions.iter().find(|d| d.name == name) else { return };
    if let Some(expected) = misfit(&definition.kind, values) {
        table.problem(name, format!("found {}, expected {expected}", values.join(", ")));
    }
}

/// Text of the expected values, if these don't fit a kind.
#[must_use]
pub fn misfit(kind: &AttributeKind, values: &[String]) -> Option<String> {
    let all = |legal: &dyn Fn(&String) -> bool| values.iter().all(legal);
    let one_of = |options: &[String]| format!("of {}", options.join(", "));
    let (legal, expected) = match kind {
        AttributeKind::Text => (true, String::new()),
        AttributeKind::Integer => {
            (values.len() == 1 && all(&|v| v.parse::<i64>().is_ok()), "a whole number".to_owned())
        }
        AttributeKind::Real => {
            let legal = |v: &String| v.parse::<f64>().is_ok_and(f64::is_finite);
            (values.len() == 1 && all(&legal), "a number".to_owned())
        }
        AttributeKind::Boolean => {
            let legal = |v: &String| v == "true" || v == "false";
            (values.len() == 1 && all(&legal), "\"true\" or \"false\"".to_owned())
        }
        AttributeKind::Date => (values.len() == 1 && all(&|v| v.len() >= 10), "a date".to_owned()),
        AttributeKind::Choice(options) => {
            (values.len() == 1 && all(&|v| options.contains(v)), format!("one {}", one_of(options)))
        }
        AttributeKind::Choices(options) => {
            (all(&|v| options.contains(v)), format!("some {}", one_of(options)))
        }
    };
    (!legal).then_some(expected)
}

fn parents(table: &Reader<'_>) -> Vec<Parent> {
    let Some(value) = table.get("parents") else { return Vec::new() };
    let Value::Array(entries) = &value.value else {
        let found = table.describe(value);
        table.problem("parents", format!("found {found}, expected an array of ids"));
        return Vec::new();
    };
    let mut parents = Vec::new();
    for entry in entries {
        match &entry.value {
            Value::Table(inner) => {
                let path = "requirements.parents";
                let reader = Reader::new(inner, &entry.place, path, table.problems());
                reader.known(&["id", "role"]);
                let id = reader.required("id", "the id of the parent");
                let role = reader.line_of("role");
                parents.extend(id.map(|id| Parent { id, role }));
            }
            _ => {
                parents.extend(table.text_of("parents", entry).map(|id| Parent { id, role: None }))
            }
        }
    }
    parents
}

fn none_with(verification: &Verification) -> String {
    match verification {
        Verification::Open => "a requirement whose verification is open has none".to_owned(),
        how => format!("a requirement that is verified by {} has none", how.name()),
    }
}

fn verification(table: &Reader<'_>, checker: &dyn Checker) -> Option<Verification> {
    let how = table.optional("verification");
    if table.has("verification") && how.is_none() {
        return None;
    }
    let tested = ["measure", "comparison", "limit", "secant_latitude", "pass", "confidence"];
    let elsewhere = match how.as_deref() {
        None | Some("test") => None,
        Some("open") => Some(Verification::Open),
        Some("analysis") => Some(Verification::Analysis),
        Some("inspection") => Some(Verification::Inspection),
        Some(other) => {
            let known =
                suggestion(other, ["test", "analysis", "inspection", "open"].into_iter(), "known");
            table.problem("verification", format!("found {other:?}, {known}"));
            return None;
        }
    };
    if let Some(verification) = elsewhere {
        for key in tested.into_iter().filter(|key| table.has(key)) {
            table.problem(key, none_with(&verification));
        }
        if table.has("tests") {
            table.problem("tests", none_with(&verification));
        }
        return Some(verification);
    }
    if let Some(names) = table.get("tests") {
        for key in tested.into_iter().filter(|key| table.has(key)) {
            table.problem(key, "a requirement that other tests verify has none".to_owned());
        }
        let tests = table.texts_of("tests", names);
        if let Some(message) = misnamed(&tests) {
            table.problem("tests", message);
            return None;
        }
        return Some(Verification::Tests(tests));
    }
    if !table.has("measure") {
        table.problem(
            "measure",
            "missing: a requirement has a measure, or says how else it is verified \
             (verification = \"analysis\", \"inspection\" or \"open\", or the names of tests in tests)",
        );
        return None;
    }
    let measure = table.line_of("measure");
    if let Some(Err(message)) = measure.as_ref().map(|measure| checker.measure(measure)) {
        table.problem("measure", message);
        return None;
    }
    let limit = limit(table);
    if let (Some(measure), Some(limit)) = (&measure, &limit)
        && let Err(message) = checker.limit(measure, limit)
    {
        table.problem("limit", message);
    }
    let secant_latitude = secant_latitude(table, measure.as_deref());
    let sign =
        if table.has("comparison") { table.optional("comparison") } else { Some("<=".into()) };
    let comparison = sign.and_then(|sign| {
        let comparison = Comparison::of_sign(&sign);
        if comparison.is_none() {
            table.problem("comparison", format!("found {sign:?}, expected <=, <, >= or >"));
        }
        comparison
    });
    let ensemble = ensemble(table);
    Some(Verification::Test(Check {
        measure: measure?,
        comparison: comparison?,
        limit: limit?,
        secant_latitude,
        ensemble,
    }))
}

/// Reads whether the limit has the factor sec φ, which few measures take.
fn secant_latitude(table: &Reader<'_>, measure: Option<&str>) -> bool {
    let key = "secant_latitude";
    match table.get(key).map(|node| (node, &node.value)) {
        None => false,
        Some((_, Value::Boolean(flag))) => {
            if *flag && let Some(message) = measure.and_then(without_secant) {
                table.problem(key, message);
            }
            *flag
        }
        Some((node, _)) => {
            table.problem(key, format!("found {}, expected true or false", table.describe(node)));
            false
        }
    }
}

fn limit(table: &Reader<'_>) -> Option<Limit> {
    let Some(value) = table.get("limit") else {
        table.problem("limit", "missing, expected a quantity, or a number in the measure's unit");
        return None;
    };
    let number = match &value.value {
        Value::Integer(number) => Some(*number as f64),
        Value::Number(number) => Some(*number),
        _ => {
            let text = table.line_of("limit")?;
            return match Limit::of_text(&text) {
                Ok(limit @ Limit::Quantity(_)) => Some(limit),
                Ok(Limit::Number(_)) => {
                    let message = format!("found {text:?}, expected a unit, or a bare number");
                    table.problem("limit", message);
                    None
                }
                Err(error) => {
                    table.problem("limit", error.to_string());
                    None
                }
            };
        }
    };
    match number {
        Some(number) if number.is_finite() => Some(Limit::Number(number)),
        _ => {
            table.problem("limit", "found a number that isn't finite");
            None
        }
    }
}

fn ensemble(table: &Reader<'_>) -> Option<EnsembleRequirement> {
    let part = |key: &str| {
        let text = table.line_of(key)?;
        let parse = if key == "confidence" { confidence } else { probability };
        parse(&text).map_err(|error| table.problem(key, error.to_string())).ok()
    };
    let (pass, confidence) = (part("pass"), part("confidence"));
    for (key, other) in [("pass", "confidence"), ("confidence", "pass")] {
        if table.has(key) && !table.has(other) {
            let message = format!("missing: {key} says something only together with {other}");
            table.problem(other, message);
        }
    }
    Some(EnsembleRequirement { pass: pass?, confidence: confidence? })
}
