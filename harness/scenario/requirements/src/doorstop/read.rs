//! Reading of Doorstop's documents.

use super::yaml::{Node, Yaml, parse, quoted};
use super::{DoorstopFile, HEAD, SETTINGS, STANDARD, TITLE};
use crate::error::{Imported, Note, listed};
use crate::foreign::{Assembly, Attribute, FOREIGN_ID, NAME, Object, Place, TEXT};
use crate::ledger::{LeftOut, Lost, Repair, Whereabouts};
use crate::mapping::{DeclaredType, Mapping};
use octant_verdict::requirement::{AttributeKind, Parent};
use octant_verdict::text::{control, normal};
use octant_verdict::{RequirementsError, RequirementsProblem};
use std::borrow::Cow;
use std::rc::Rc;

/// Reads the files of a folder of Doorstop: `.doorstop.yml` and the items, by their names. An item that can't be read is
/// left out: the account counts it, and a note names it.
///
/// # Errors
/// If there is no `.doorstop.yml`, it isn't YAML or no mapping, with file and line, or the mapping names what no item
/// has.
pub fn read(
    files: &[DoorstopFile],
    folder: &str,
    mapping: &Mapping,
) -> Result<Imported, RequirementsError> {
    let own = Mapping::own();
    let mapping = if mapping.is_usual() { &own } else { mapping };
    let assembly = Assembly::new(mapping, folder);
    let mut reader = Reader { folder, mapping, assembly, stamps: false };
    let Some((_, settings)) = files.iter().find(|(name, _)| name == SETTINGS) else {
        return Err(reader.wrong("", 1, format!("there is no {SETTINGS} in the folder")));
    };
    let is_markdown = reader.settings(settings)?;
    let mut items = Vec::new();
    for (name, text) in files.iter().filter(|(name, _)| name != SETTINGS) {
        let is_of_markdown = name.ends_with(".md");
        if is_of_markdown != is_markdown {
            let format = if is_markdown { "markdown" } else { "yaml" };
            let message = format!("{name} is not read: the items are in itemformat {format}");
            reader.assembly.notes.push(Note::new(0, message));
            continue;
        }
        let text = if is_markdown { markdown(text) } else { Ok(Cow::Borrowed(text.as_str())) };
        let read = text.map_err(|message| (1, message)).and_then(|text| reader.item(name, &text));
        match read {
            Ok(item) => items.push(item),
            Err((line, message)) => {
                let id = name.rsplit_once('.').map_or(name.as_str(), |(stem, _)| stem);
                let at = Whereabouts::new(id, name, line);
                let message = format!("can't be read: {message}");
                reader.assembly.lost(&Lost { why: LeftOut::Damaged, at, message });
            }
        }
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

    /// Reads the settings; returns whether the items are in Markdown.
    fn settings(&mut self, text: &str) -> Result<bool, RequirementsError> {
        let root = map(text).map_err(|(line, message)| self.wrong(SETTINGS, line, message))?;
        let setting = |name: &str| root.get("settings")?.get(name)?.text();
        let found = &mut self.assembly.found;
        for (name, key) in HEAD {
            let value = setting(name).map(normal).filter(|value| !value.is_empty());
            found.document.extend(value.map(|value| (key.to_owned(), value.replace('\n', " "))));
        }
        let is_markdown = match setting("itemformat") {
            None | Some("yaml") => false,
            Some("markdown") => true,
            Some(other) => {
                let message = format!("itemformat is {other:?}, expected \"yaml\" or \"markdown\"");
                return Err(self.wrong(SETTINGS, 1, message));
            }
        };
        let title = root.get("extensions").and_then(|e| e.get(TITLE)).and_then(Node::text);
        let title = title.or_else(|| setting("prefix")).map(normal).unwrap_or_default();
        found.title =
            if title.is_empty() { "Requirements".to_owned() } else { title.replace('\n', " ") };
        if root.get("attributes").is_some() {
            let message = "the settings of attributes are left out";
            self.assembly.notes.push(Note::new(0, message).in_file(SETTINGS));
        }
        Ok(is_markdown)
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

    fn item(&mut self, file: &str, text: &str) -> Result<Item, (usize, String)> {
        let root = map(text)?;
        let id = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        let truth = |name: &str, usual: bool| match root.get(name) {
            None => Ok(usual),
            Some(node) => node.truth().ok_or((node.line, format!("{name} is no truth value"))),
        };
        let normative = truth("normative", true)?;
        let active = truth("active", true)?;
        let (level, ends) = level(root.get("level"))?;
        let mut object = Object {
            file: file.to_owned(),
            line: root.line,
            identifier: id.to_owned(),
            has_identifier: true,
            is_title_enough: true,
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
        if truth("derived", false)? {
            let mut derived = self.text_attribute("derived", "true", root.line);
            derived.kind = AttributeKind::Boolean;
            object.attributes.push(derived);
        }
        self.extended(&root, &mut object);
        let control = object.attributes.iter().find_map(|attribute| {
            let c = attribute.values.iter().find_map(|text| control(text))?;
            Some((attribute.line, format!("{} has the control character {c:?}", attribute.name)))
        });
        if let Some((line, message)) = control {
            return Err((line, message));
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
    fn extended(&self, root: &Node, object: &mut Object) {
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
                object.repairs.push(Repair {
                    kind: "with attributes that are left out",
                    detail: format!("{name}, which is no text"),
                    is_doubt: false,
                });
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
                let notes = self.assembly.ledger.kept(&item.object.at(), &item.object.repairs);
                self.assembly.notes.extend(notes);
                above.push((item.level, Ok(title(&item.object))));
                continue;
            }
            if !item.is_requirement {
                self.assembly.ledger.left_out(LeftOut::Inactive, &item.object.at());
                inactive.push(item.object.identifier);
                continue;
            }
            let section = above.iter().filter_map(|(_, above)| above.as_ref().ok().cloned());
            let under = above.iter().rev().find_map(|(_, above)| above.as_ref().err().cloned());
            let place = Place { section: section.collect(), under };
            item.object.declared = Rc::clone(&names);
            if let Some(id) = self.assembly.add(item.object, place, item.parents) {
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

/// Parses the mapping that a file is; errors have a line.
fn map(text: &str) -> Result<Node, (usize, String)> {
    let node = parse(text)?;
    match node.value {
        Yaml::Map(_) => Ok(node),
        _ => {
            let found = node.describe();
            Err((node.line, format!("found {found}, expected a mapping of attributes")))
        }
    }
}

/// Item in Markdown as one in YAML: attributes between two lines `---`, then the header as a heading, and the text.
fn markdown(text: &str) -> Result<Cow<'_, str>, String> {
    let text = text.replace("\r\n", "\n");
    let head = text.trim_start().strip_prefix("---\n").and_then(|rest| {
        let (head, body) = rest.split_once("\n---")?;
        Some((head, body.split_once('\n').map_or("", |(_, body)| body)))
    });
    let Some((head, body)) = head else {
        return Err("found no attributes between two lines ---".to_owned());
    };
    let body = body.trim();
    let (header, body) = match body.strip_prefix("# ") {
        Some(rest) => rest.split_once('\n').unwrap_or((rest, "")),
        None => ("", body),
    };
    let mut item = format!("\n{head}\n");
    for (name, text) in [("header", header), ("text", body)] {
        if !text.trim().is_empty() {
            item += &format!("{name}: {}\n", quoted(text.trim()));
        }
    }
    Ok(Cow::Owned(item))
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
