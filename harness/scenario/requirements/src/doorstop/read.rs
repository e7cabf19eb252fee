//! Reading of Doorstop's documents.

use super::yaml::{Node, Yaml, parse};
use super::{DoorstopFile, HEAD, SETTINGS, STANDARD, TITLE};
use crate::error::{Imported, Note, listed};
use crate::foreign::{Assembly, Attribute, FOREIGN_ID, NAME, Object, Place, TEXT};
use crate::mapping::{DeclaredType, Mapping};
use octant_verdict::requirement::{AttributeKind, Parent};
use octant_verdict::text::{control, normal};
use octant_verdict::{RequirementsError, RequirementsProblem};
use std::rc::Rc;

/// Reads the files of a folder of Doorstop: `.doorstop.yml` and the items, by their names.
///
/// # Errors
/// If there is no `.doorstop.yml`, a file isn't YAML or no mapping, with file and line, or the mapping names
/// what no item has.
pub fn read(
    files: &[DoorstopFile],
    folder: &str,
    mapping: &Mapping,
) -> Result<Imported, RequirementsError> {
    let own = Mapping::own();
    let mapping = if mapping.is_usual() { &own } else { mapping };
    let mut reader = Reader { folder, mapping, assembly: Assembly::new(mapping), stamps: false };
    let Some((_, settings)) = files.iter().find(|(name, _)| name == SETTINGS) else {
        return Err(reader.wrong("", 1, format!("there is no {SETTINGS} in the folder")));
    };
    reader.settings(settings)?;
    let mut items = Vec::new();
    for (name, text) in files.iter().filter(|(name, _)| name != SETTINGS) {
        items.push(reader.item(name, text)?);
    }
    items.sort_by(|a, b| {
        let heading = b.heading.cmp(&a.heading);
        a.level
            .cmp(&b.level)
            .then(heading)
            .then_with(|| a.object.identifier.cmp(&b.object.identifier))
    });
    reader.assemble(items)
}

/// An item of the folder.
struct Item {
    object: Object,
    level: Vec<u32>,
    /// True for the heading of a section.
    heading: bool,
    is_requirement: bool,
    parents: Vec<Parent>,
}

struct Reader<'a> {
    folder: &'a str,
    mapping: &'a Mapping,
    assembly: Assembly<'a>,
    /// True if there were reviews or stamps of links.
    stamps: bool,
}

impl Reader<'_> {
    fn wrong(&self, file: &str, line: usize, message: String) -> RequirementsError {
        let name = if file.is_empty() {
            self.folder.to_owned()
        } else {
            format!("{}/{file}", self.folder)
        };
        RequirementsError::one(&name, RequirementsProblem::new((line, 1), "", message))
    }

    fn map(&self, file: &str, text: &str) -> Result<Node, RequirementsError> {
        let node = parse(text).map_err(|(line, message)| self.wrong(file, line, message))?;
        match node.value {
            Yaml::Map(_) => Ok(node),
            _ => {
                let message =
                    format!("found {}, expected a mapping of attributes", node.describe());
                Err(self.wrong(file, node.line, message))
            }
        }
    }

    fn settings(&mut self, text: &str) -> Result<(), RequirementsError> {
        let root = self.map(SETTINGS, text)?;
        let setting = |name: &str| root.get("settings")?.get(name)?.text();
        let found = &mut self.assembly.found;
        for (name, key) in HEAD {
            let value = setting(name).map(normal).filter(|value| !value.is_empty());
            found.document.extend(value.map(|value| (key.to_owned(), value.replace('\n', " "))));
        }
        if setting("itemformat").is_some_and(|format| format != "yaml") {
            let message = "the items are in Markdown, expected itemformat: yaml".to_owned();
            return Err(self.wrong(SETTINGS, 1, message));
        }
        let title = root.get("extensions").and_then(|e| e.get(TITLE)).and_then(Node::text);
        let title = title.or_else(|| setting("prefix")).map(normal).unwrap_or_default();
        found.title =
            if title.is_empty() { "Requirements".to_owned() } else { title.replace('\n', " ") };
        if root.get("attributes").is_some() {
            let message = "the settings of attributes are left out";
            self.assembly.notes.push(Note::new(0, message).in_file(SETTINGS));
        }
        Ok(())
    }

    /// Name of an attribute for the mapping: that of ReqIF without a mapping file.
    fn named<'n>(&self, name: &'n str) -> &'n str {
        match name {
            "id" if self.mapping.own => FOREIGN_ID,
            "header" if self.mapping.own => NAME,
            "text" if self.mapping.own => TEXT,
            other => other,
        }
    }

    fn item(&mut self, file: &str, text: &str) -> Result<Item, RequirementsError> {
        let root = self.map(file, text)?;
        let id = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        let truth = |name: &str, usual: bool| match root.get(name) {
            None => Ok(usual),
            Some(node) => node.truth().ok_or((node.line, format!("{name} is no truth value"))),
        };
        let fail = |(line, message): (usize, String)| self.wrong(file, line, message);
        let normative = truth("normative", true).map_err(fail)?;
        let active = truth("active", true).map_err(fail)?;
        let (level, ends) = level(root.get("level")).map_err(fail)?;
        let mut object = Object {
            file: file.to_owned(),
            line: root.line,
            identifier: id.to_owned(),
            has_identifier: true,
            attributes: vec![self.text_attribute("id", id, root.line)],
            ..Object::default()
        };
        for name in ["header", "text", "ref"] {
            let Some(node) = root.get(name) else { continue };
            let Some(text) = node.text().map(normal).filter(|text| !text.is_empty()) else {
                continue;
            };
            object.attributes.push(self.text_attribute(name, &text, node.line));
        }
        if truth("derived", false).map_err(fail)? {
            let mut derived = self.text_attribute("derived", "true", root.line);
            derived.kind = AttributeKind::Boolean;
            object.attributes.push(derived);
        }
        self.extended(&root, &mut object, file);
        let control = object.attributes.iter().find_map(|attribute| {
            let c = attribute.values.iter().find_map(|text| control(text))?;
            Some((attribute.line, format!("{} has the control character {c:?}", attribute.name)))
        });
        if let Some((line, message)) = control {
            return Err(self.wrong(file, line, message));
        }
        self.stamps |= root.get("reviewed").and_then(Node::text).is_some();
        Ok(Item {
            object,
            level,
            heading: active && !normative && ends,
            is_requirement: active && normative,
            parents: self.links(&root),
        })
    }

    fn text_attribute(&self, name: &str, text: &str, line: usize) -> Attribute {
        Attribute {
            name: self.named(name).to_owned(),
            kind: AttributeKind::Text,
            values: vec![text.to_owned()],
            formatted: None,
            line,
        }
    }

    /// Adds the attributes that a project added to those of Doorstop.
    fn extended(&mut self, root: &Node, object: &mut Object, file: &str) {
        let Yaml::Map(entries) = &root.value else { return };
        // Doorstop sorts them when it writes.
        let mut entries: Vec<&(String, Node)> = entries.iter().collect();
        entries.sort_by(|a, b| a.0.cmp(&b.0));
        for (name, node) in entries {
            let is_references = name == "references" && node.text().is_some();
            if STANDARD.contains(&name.as_str()) && name != "references" || is_references {
                continue;
            }
            let values: Option<Vec<String>> = match &node.value {
                Yaml::Scalar(..) => Some(node.text().map(normal).into_iter().collect()),
                Yaml::List(all) => all.iter().map(|one| one.text().map(normal)).collect(),
                Yaml::Map(_) => None,
            };
            let Some(mut values) = values else {
                let message = format!("{name} is left out, because it is no text");
                self.assembly.notes.push(Note::new(node.line, message).in_file(file));
                continue;
            };
            values.retain(|text| !text.is_empty());
            if values.is_empty() {
                continue;
            }
            match (name.as_str(), &values[..]) {
                ("kind", [kind]) => object.kind.clone_from(kind),
                ("identifier", [identifier]) => object.kept_identifier = Some(identifier.clone()),
                _ => {
                    let kind = kind(node);
                    if kind == AttributeKind::Boolean {
                        values = vec![node.truth().unwrap_or_default().to_string()];
                    }
                    let (name, line) = (name.clone(), node.line);
                    object.attributes.push(Attribute { name, kind, values, formatted: None, line });
                }
            }
        }
    }

    /// Reads the links: ids, or ids with the stamps of their reviews.
    fn links(&mut self, root: &Node) -> Vec<Parent> {
        let mut parents = Vec::new();
        let Some(Yaml::List(links)) = root.get("links").map(|node| &node.value) else {
            return parents;
        };
        for link in links {
            let id = match &link.value {
                Yaml::Map(entries) => {
                    self.stamps |= entries.iter().any(|(_, stamp)| stamp.text().is_some());
                    entries.first().map(|(id, _)| id.as_str())
                }
                _ => link.text(),
            };
            let id = id.map(normal).filter(|id| !id.is_empty());
            parents.extend(id.map(|id| Parent { id, role: None }));
        }
        parents
    }

    fn assemble(mut self, items: Vec<Item>) -> Result<Imported, RequirementsError> {
        let mut attributes: Vec<(String, Option<Vec<String>>)> =
            vec![(self.named("text").to_owned(), None)];
        for attribute in items.iter().flat_map(|item| &item.object.attributes) {
            if !attributes.iter().any(|(name, _)| *name == attribute.name) {
                attributes.push((attribute.name.clone(), None));
            }
        }
        let names = Rc::new(attributes.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>());
        self.mapping.check(&[DeclaredType { name: String::new(), attributes }])?;
        // Levels of the headings and requirements above, with their titles or ids.
        let mut above: Vec<(Vec<u32>, Result<String, String>)> = Vec::new();
        let mut inactive = Vec::new();
        for mut item in items {
            above.retain(|(level, _)| {
                item.level.len() > level.len() && item.level.starts_with(level)
            });
            if item.heading {
                above.push((item.level, Ok(title(&item.object))));
                continue;
            }
            if !item.is_requirement {
                inactive.push(item.object.identifier.clone());
                continue;
            }
            let section = above.iter().filter_map(|(_, above)| above.as_ref().ok().cloned());
            let under = above.iter().rev().find_map(|(_, above)| above.as_ref().err().cloned());
            let place = Place { section: section.collect(), under };
            item.object.declared = Rc::clone(&names);
            let (folder, file) = (self.folder, item.object.file.clone());
            let added = self.assembly.add(item.object, place, item.parents);
            let added =
                added.map_err(|e| RequirementsError { file: format!("{folder}/{file}"), ..e })?;
            if let Some(id) = added {
                above.push((item.level, Err(id)));
            }
        }
        if !inactive.is_empty() {
            let message = "left out, because they are not active or not normative";
            self.assembly.notes.push(Note::new(0, format!("{message}: {}", listed(&inactive))));
        }
        if self.stamps {
            let message = "reviews and the stamps of links are left out";
            self.assembly.notes.push(Note::new(0, message));
        }
        Ok(self.assembly.finish())
    }
}

/// Title of a heading: its header, or the first line of its text.
fn title(object: &Object) -> String {
    let of = |names: [&str; 2]| {
        let mut all = object.attributes.iter();
        let found = all.find(|a| names.contains(&a.name.as_str()))?;
        found.values.first().and_then(|text| text.lines().next()).map(str::to_owned)
    };
    let title = of([NAME, "header"]).or_else(|| of([TEXT, "text"]));
    title.unwrap_or_else(|| object.identifier.clone())
}

/// Kind of a value without quotes, by the rules of YAML 1.1.
fn kind(node: &Node) -> AttributeKind {
    let Yaml::Scalar(text, true) = &node.value else { return AttributeKind::Text };
    let word = text.to_ascii_lowercase();
    match word.as_str() {
        "true" | "false" | "yes" | "no" | "on" | "off" => AttributeKind::Boolean,
        _ if text.parse::<i64>().is_ok() => AttributeKind::Integer,
        _ if text.contains('.') && text.parse::<f64>().is_ok_and(f64::is_finite) => {
            AttributeKind::Real
        }
        _ => AttributeKind::Text,
    }
}

/// Parts of a level, and whether it ends in 0.
fn level(node: Option<&Node>) -> Result<(Vec<u32>, bool), (usize, String)> {
    let Some(node) = node else { return Ok((vec![1], false)) };
    let wrong = || (node.line, "level is no outline number such as 1.2.3".to_owned());
    let Yaml::Scalar(text, is_plain) = &node.value else { return Err(wrong()) };
    let mut text = text.trim();
    // Without quotes it is a number, in which 1.10 is 1.1.
    if *is_plain && text.matches('.').count() == 1 && !text.ends_with(".0") {
        text = text.trim_end_matches('0');
    }
    let parts: Result<Vec<u32>, _> = text.split('.').map(str::parse).collect();
    let mut parts = parts.map_err(|_| wrong())?;
    let ends = parts.last() == Some(&0);
    while parts.last() == Some(&0) {
        parts.pop();
    }
    if parts.is_empty() {
        parts.push(1);
    }
    Ok((parts, ends))
}
