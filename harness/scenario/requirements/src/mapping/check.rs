//! Checks a mapping against a file: every name in it has to exist there.

use super::{IDENTIFIER, Mapping, Named, Names, RequirementPart};
use octant_base::names::suggestion;
use octant_verdict::{RequirementsError, RequirementsProblem};

/// A type of objects in a file of another tool.
#[derive(Clone, Debug, Default)]
pub(crate) struct DeclaredType {
    pub(crate) name: String,
    /// Names of its attributes, with the options of those that are enumerations.
    pub(crate) attributes: Vec<(String, Option<Vec<String>>)>,
}

impl Mapping {
    /// Checks that every type, attribute and value that the mapping names exists.
    pub(crate) fn check(&self, types: &[DeclaredType]) -> Result<(), RequirementsError> {
        let mut problems = Vec::new();
        let names: Vec<&str> = types.iter().map(|kind| kind.name.as_str()).collect();
        let every: Vec<&DeclaredType> = types.iter().collect();
        checked(&self.all, &every, &mut problems);
        for (named, own) in &self.types {
            let of: Vec<&DeclaredType> = types.iter().filter(|t| t.name == named.name).collect();
            if of.is_empty() {
                problems.push(missing(named, "type", &names));
            } else {
                checked(own, &of, &mut problems);
            }
        }
        for named in self.informative_types.iter().flatten() {
            if !names.contains(&named.name.as_str()) {
                problems.push(missing(named, "type", &names));
            }
        }
        for (attribute, values) in self.informative_values.iter().flatten() {
            exists(attribute, &every, &mut problems);
            options(std::slice::from_ref(&attribute.name), values, &every, &mut problems);
        }
        problems.sort_by_key(|p| (p.line, p.column));
        if problems.is_empty() {
            Ok(())
        } else {
            Err(RequirementsError { file: self.file.clone(), problems })
        }
    }
}

fn missing(named: &Named, what: &str, known: &[&str]) -> RequirementsProblem {
    let mut unique: Vec<&str> = Vec::new();
    for name in known {
        if !unique.contains(name) {
            unique.push(name);
        }
    }
    let known = suggestion(&named.name, unique.iter().copied(), "known");
    let message = format!("the file has no {what} {:?}, {known}", named.name);
    RequirementsProblem::new(named.place, named.path.clone(), message)
}

fn exists(named: &Named, types: &[&DeclaredType], problems: &mut Vec<RequirementsProblem>) {
    let known: Vec<&str> =
        types.iter().flat_map(|t| &t.attributes).map(|(name, _)| name.as_str()).collect();
    if named.name != IDENTIFIER && !known.contains(&named.name.as_str()) {
        problems.push(missing(named, "attribute", &known));
    }
}

fn checked(names: &Names, types: &[&DeclaredType], problems: &mut Vec<RequirementsProblem>) {
    for part in RequirementPart::ALL {
        let attributes = names.attributes.get(&part);
        for named in attributes.into_iter().flatten() {
            exists(named, types, problems);
        }
        let attributes: Vec<String> =
            attributes.into_iter().flatten().map(|named| named.name.clone()).collect();
        let values: Vec<Named> =
            names.values.get(&part).into_iter().flatten().map(|(named, _)| named.clone()).collect();
        options(&attributes, &values, types, problems);
    }
}

/// Checks values of attributes that are enumerations.
fn options(
    attributes: &[String],
    values: &[Named],
    types: &[&DeclaredType],
    problems: &mut Vec<RequirementsProblem>,
) {
    let of = types.iter().flat_map(|t| &t.attributes).filter(|(name, _)| attributes.contains(name));
    let mut known: Vec<&str> = Vec::new();
    for (_, options) in of {
        // A text can have any value.
        let Some(options) = options else { return };
        known.extend(options.iter().map(String::as_str));
    }
    for named in values {
        if !known.is_empty() && !known.contains(&named.name.as_str()) {
            problems.push(missing(named, "value", &known));
        }
    }
}
