//! Reads mapping files.
//!
//! ```toml
//! schema = 1
//!
//! [attributes]
//! id = "Object Identifier"
//! text = ["Object Text", "ReqIF.Text"]
//! verification = "Verification Method"
//!
//! [values.verification]
//! Review = "inspection"
//!
//! [informative]
//! types = ["Heading"]
//! values = { "Object Type" = ["Information", "Heading"] }
//!
//! [types."System Requirement".attributes]
//! measure = "Octant Measure"
//! ```

use super::{Mapping, Named, Names, RequirementPart};
use octant_base::names::suggestion;
use octant_toml_tree::{Node, Value};
use octant_verdict::RequirementsError;
use octant_verdict::table::{Problems, Reader, position};

/// Version of the schema of mapping files.
pub const SCHEMA: i64 = 1;

/// Reads the text of a mapping file.
///
/// # Errors
/// All problems, each with line, column and field.
pub fn read(text: &str, file: &str) -> Result<Mapping, RequirementsError> {
    let problems = Problems::new(text);
    let table = problems.table(file)?;
    let root = Reader::root(&table, &problems);
    let mut found = Mapping { file: file.to_owned(), ..Mapping::default() };
    // A newer schema may have other keys: unknown ones in it are not reported.
    if octant_verdict::table::schema(&root, SCHEMA) {
        root.known(&["schema", "attributes", "values", "types", "informative"]);
        found.all = names(&root);
        types(&root, &mut found);
        informative(&root, &mut found);
    }
    let mut problems = problems.all.into_inner();
    problems.sort_by_key(|p| (p.line, p.column));
    if problems.is_empty() {
        Ok(found)
    } else {
        Err(RequirementsError { file: file.to_owned(), problems })
    }
}

fn part(table: &Reader<'_>, key: &str) -> Option<RequirementPart> {
    let part = RequirementPart::ALL.into_iter().find(|part| part.name() == key);
    if part.is_none() {
        let known = RequirementPart::ALL.map(RequirementPart::name);
        table.problem(
            key,
            format!("unknown key, {}", suggestion(key, known.iter().copied(), "known")),
        );
    }
    part
}

/// A text, or several, with their places.
fn named(table: &Reader<'_>, key: &str, value: &Node) -> Vec<Named> {
    let one = |value: &Node| {
        let name = table.text_of(key, value)?;
        Some(Named { name, place: position(&value.place), path: table.path_of(key) })
    };
    match &value.value {
        Value::Array(entries) => entries.iter().filter_map(one).collect(),
        _ => one(value).into_iter().collect(),
    }
}

fn names(table: &Reader<'_>) -> Names {
    let mut names = Names::default();
    if let Some(attributes) = table.table("attributes") {
        for (key, value) in attributes.entries() {
            let Some(part) = part(&attributes, key) else { continue };
            let all = named(&attributes, key, value);
            if all.is_empty() && matches!(value.value, Value::Array(_)) {
                attributes.problem(key, "found no name, expected the name of an attribute");
            }
            names.attributes.insert(part, all);
        }
    }
    if let Some(values) = table.table("values") {
        for (key, _) in values.entries() {
            let (Some(part), Some(of)) = (part(&values, key), values.table(key)) else { continue };
            let mut all = Vec::new();
            for (from, value) in of.entries() {
                let Some(to) = of.text_of(from, value) else { continue };
                if let Some(expected) = misvalued(part, &to) {
                    of.problem(from, format!("found {to:?}, expected {expected}"));
                }
                let (place, path) = (position(&value.place), of.path_of(from));
                all.push((Named { name: from.to_owned(), place, path }, to));
            }
            names.values.insert(part, all);
        }
    }
    names
}

/// Expected values of a part that has a fixed list, if this isn't one.
fn misvalued(part: RequirementPart, value: &str) -> Option<&'static str> {
    let legal: (&[&str], &str) = match part {
        RequirementPart::Verification => (
            &["test", "analysis", "inspection", "open"],
            "\"test\", \"analysis\", \"inspection\" or \"open\"",
        ),
        RequirementPart::Comparison => (&["<=", "<", ">=", ">"], "<=, <, >= or >"),
        _ => return None,
    };
    (!legal.0.contains(&value)).then_some(legal.1)
}

fn types(root: &Reader<'_>, found: &mut Mapping) {
    let Some(types) = root.table("types") else { return };
    for (key, value) in types.entries() {
        let Some(table) = types.table(key) else { continue };
        table.known(&["attributes", "values"]);
        let place = position(&value.place);
        let name = Named { name: key.to_owned(), place, path: types.path_of(key) };
        found.types.push((name, names(&table)));
    }
}

fn informative(root: &Reader<'_>, found: &mut Mapping) {
    let Some(table) = root.table("informative") else { return };
    table.known(&["types", "values"]);
    if let Some(value) = table.get("types") {
        found.informative_types = Some(named(&table, "types", value));
    }
    let Some(value) = table.get("values") else { return };
    if !matches!(value.value, Value::Table(_)) {
        let found = table.describe(value);
        table.problem("values", format!("found {found}, expected a table of attributes"));
        return;
    }
    let Some(values) = table.table("values") else { return };
    let of = |(key, value): (&str, &Node)| {
        let name = key.to_owned();
        let (place, path) = (position(&value.place), values.path_of(key));
        (Named { name, place, path }, named(&values, key, value))
    };
    found.informative_values = Some(values.entries().into_iter().map(of).collect());
}
