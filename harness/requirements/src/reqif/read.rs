//! Reading of ReqIF files.

use super::types::{Types, Wrong, child, identifier, reference, within};
use super::{CHAPTER, FOREIGN_ID, NAME, NAMESPACE, TEXT, xhtml};
use crate::document::{control, normal};
use crate::error::{Imported, Note, RequirementsError, RequirementsProblem};
use crate::fields;
use crate::requirement::{
    AttributeKind, Definition, ForeignAttribute, Parent, Requirement, Requirements, Verification,
};
use roxmltree::{Document, Node};
use std::collections::{HashMap, HashSet};

/// Most levels of nested sections; no real document is deeper.
const DEPTH: usize = 100;

/// Reads a `.reqif`.
///
/// Several specifications in one file become one document, in which the title of each is a section of
/// the first level. A requirement whose attributes make no complete check is read as it is, with a
/// note.
///
/// # Errors
/// If the text isn't XML or not ReqIF, with the line; if a reference has no target in the file; or if
/// an id occurs twice.
pub fn read(text: &str, file: &str) -> Result<Imported, RequirementsError> {
    let fail = |line: usize, column: usize, message: String| {
        RequirementsError::one(file, RequirementsProblem::new((line, column), "", message))
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document = Document::parse(text).map_err(|error| {
        let at = error.pos();
        fail(at.row as usize, at.col as usize, format!("not XML: {error}"))
    })?;
    Reader::read(&document).map_err(|(line, message)| fail(line, 1, message))
}

/// Name and kind of an attribute, its values, and its line.
type Attributed = (String, AttributeKind, Vec<String>, usize);

/// An object of the file.
#[derive(Default)]
struct Object {
    line: usize,
    identifier: String,
    /// Name of the object's type.
    kind: String,
    values: Vec<Attributed>,
}

impl Object {
    fn take(&mut self, name: &str) -> Option<String> {
        let at = self.values.iter().position(|(n, ..)| n == name)?;
        Some(self.values.remove(at).2.join("\n\n")).filter(|text| !text.is_empty())
    }

    fn get(&self, name: &str) -> Option<(usize, &str)> {
        let (.., values, line) = self.values.iter().find(|(n, ..)| n == name)?;
        Some((*line, values.first()?.as_str()))
    }
}

struct Reader<'a> {
    document: &'a Document<'a>,
    types: Types,
    /// True for a file of StrictDoc, which writes strings with the escapes of Python.
    escaped: bool,
    found: Requirements,
    notes: Vec<Note>,
}

impl<'a> Reader<'a> {
    fn read(document: &'a Document<'a>) -> Result<Imported, Wrong> {
        let line = |node: Node<'_, '_>| document.text_pos_at(node.range().start).row as usize;
        let root = document.root_element();
        let name = root.tag_name();
        if name.name() != "REQ-IF" || name.namespace() != Some(NAMESPACE) {
            let found = format!(
                "found {} of the namespace {:?}",
                name.name(),
                name.namespace().unwrap_or("")
            );
            return Err((line(root), format!("{found}, expected REQ-IF of {NAMESPACE}")));
        }
        let header = child(root, "THE-HEADER").and_then(|n| child(n, "REQ-IF-HEADER"));
        let tool = header.and_then(|n| child(n, "REQ-IF-TOOL-ID")).and_then(|n| n.text());
        let content = child(root, "CORE-CONTENT").and_then(|n| child(n, "REQ-IF-CONTENT"));
        let Some(content) = content else {
            return Err((line(root), "there is no CORE-CONTENT with a REQ-IF-CONTENT".to_owned()));
        };
        let types = Types::read(content, &line)?;
        let escaped = tool.is_some_and(|tool| tool.trim().eq_ignore_ascii_case("strictdoc"));
        let mut reader =
            Reader { document, types, escaped, found: Requirements::default(), notes: Vec::new() };
        reader.content(content)?;
        if child(root, "TOOL-EXTENSIONS").is_some() {
            reader
                .notes
                .push(Note { line: line(root), message: "tool extensions are left out".into() });
        }
        Ok(Imported { requirements: reader.found, notes: reader.notes })
    }

    fn line(&self, node: Node<'_, '_>) -> usize {
        self.document.text_pos_at(node.range().start).row as usize
    }

    fn note(&mut self, line: usize, message: impl Into<String>) {
        self.notes.push(Note { line, message: message.into() });
    }

    fn content(&mut self, content: Node<'_, '_>) -> Result<(), Wrong> {
        let mut objects: HashMap<String, Object> = HashMap::new();
        let mut order = Vec::new();
        for node in within(content, "SPEC-OBJECTS") {
            let object = self.object(node)?;
            let id = object.identifier.clone();
            order.push(id.clone());
            if let Some(first) = objects.insert(id.clone(), object) {
                let found = format!("the object {id:?} is there a second time");
                return Err((
                    self.line(node),
                    format!("{found}, the first is in line {}", first.line),
                ));
            }
        }
        let ids: HashMap<String, String> =
            objects.values().map(|object| (object.identifier.clone(), id_of(object))).collect();
        let mut parents = self.parents(content, &ids)?;
        let specifications: Vec<_> = within(content, "SPECIFICATIONS").collect();
        let several = specifications.len() > 1;
        let title = |node: Node<'_, '_>| {
            node.attribute("LONG-NAME").map_or_else(|| "Requirements".to_owned(), normal)
        };
        self.found.title =
            specifications.first().map_or_else(|| "Requirements".to_owned(), |node| title(*node));
        if several {
            self.found.title = "Requirements".to_owned();
            self.note(
                self.line(content),
                "several documents become one, their attributes are left out",
            );
        } else if let [node] = specifications.as_slice() {
            let values = self.values(*node, "the document")?;
            let document = values.into_iter().map(|(name, _, texts, _)| (name, texts.join(", ")));
            self.found.document = document.collect();
        }
        let mut placed: HashSet<String> = HashSet::new();
        for specification in &specifications {
            let mut section: Vec<(usize, String)> = Vec::new();
            if several {
                section.push((0, title(*specification)));
            }
            for (depth, node) in self.hierarchy(*specification)? {
                section.retain(|(at, _)| *at < depth);
                let id = reference(node, "OBJECT").unwrap_or_default();
                if !placed.insert(id.to_owned()) {
                    self.note(
                        self.line(node),
                        format!("the object {id} is in the hierarchy again"),
                    );
                    continue;
                }
                let Some(object) = objects.remove(id) else {
                    let found = format!("the hierarchy has an object {id:?}");
                    return Err((self.line(node), format!("{found} that isn't in the file")));
                };
                match chapter(&object) {
                    Some(title) => section.push((depth, title)),
                    None => {
                        let titles = section.iter().map(|(_, title)| title.clone()).collect();
                        let parents = parents.remove(id).unwrap_or_default();
                        self.requirement(object, titles, parents)?;
                    }
                }
            }
        }
        for id in order {
            let Some(object) = objects.remove(&id) else { continue };
            self.note(
                object.line,
                format!("the object {id} is in no specification: it stands at the end"),
            );
            let parents = parents.remove(&id).unwrap_or_default();
            if chapter(&object).is_none() {
                self.requirement(object, Vec::new(), parents)?;
            }
        }
        Ok(())
    }

    /// Nodes of a specification with their depth, from 1, in the order of the document.
    fn hierarchy<'n>(
        &self,
        specification: Node<'n, 'n>,
    ) -> Result<Vec<(usize, Node<'n, 'n>)>, Wrong> {
        let mut nodes = Vec::new();
        let mut open: Vec<(usize, Node<'n, 'n>)> =
            within(specification, "CHILDREN").map(|node| (1, node)).collect();
        open.reverse();
        while let Some((depth, node)) = open.pop() {
            if depth > DEPTH {
                return Err((self.line(node), format!("more than {DEPTH} levels of sections")));
            }
            nodes.push((depth, node));
            let mut children: Vec<_> = within(node, "CHILDREN").map(|n| (depth + 1, n)).collect();
            children.reverse();
            open.append(&mut children);
        }
        Ok(nodes)
    }

    fn object(&mut self, node: Node<'_, '_>) -> Result<Object, Wrong> {
        let line = self.line(node);
        let id = identifier(node, &|n| self.line(n))?.to_owned();
        let of = reference(node, "TYPE").unwrap_or_default();
        let Some(object_type) = self.types.objects.get(of) else {
            return Err((
                line,
                format!("the object {id:?} is of a type {of:?} that isn't in the file"),
            ));
        };
        let kind = object_type.name.clone();
        let mut values = self.values(node, &id)?;
        // Attributes are sorted in the order of the type, not of the object.
        let rank: HashMap<&str, usize> = self.types.objects[of]
            .attributes
            .iter()
            .enumerate()
            .filter_map(|(i, id)| Some((self.types.attributes.get(id)?.name.as_str(), i)))
            .collect();
        values.sort_by_key(|(name, ..)| rank.get(name.as_str()).copied());
        Ok(Object { line, identifier: id, kind, values })
    }

    /// Attributes of an object, or of a document.
    fn values(&mut self, node: Node<'_, '_>, id: &str) -> Result<Vec<Attributed>, Wrong> {
        let mut values = Vec::new();
        for value in within(node, "VALUES") {
            let at = self.line(value);
            let definition = reference(value, "DEFINITION").unwrap_or_default();
            let Some(known) = self.types.attributes.get(definition) else {
                let found = format!("{id} has an attribute {definition:?}");
                return Err((at, format!("{found} that no type in the file has")));
            };
            let (name, kind) = (known.name.clone(), known.kind.clone());
            let texts = self.value(value, &name, id)?;
            if texts.iter().any(|text| !text.is_empty()) {
                values.push((name, kind, texts, at));
            }
        }
        Ok(values)
    }

    /// Texts of an attribute's value.
    fn value(&mut self, value: Node<'_, '_>, name: &str, id: &str) -> Result<Vec<String>, Wrong> {
        let line = self.line(value);
        let tag = value.tag_name().name();
        let texts = match tag.strip_prefix("ATTRIBUTE-VALUE-") {
            Some("XHTML") => {
                let plain = child(value, "THE-VALUE").map(xhtml::read).unwrap_or_default();
                if !plain.lost.is_empty() {
                    let lost = plain.lost.join(", ");
                    self.note(line, format!("{name} of {id}: its formatting is left out: {lost}"));
                }
                vec![plain.text]
            }
            Some("ENUMERATION") => {
                let mut options = Vec::new();
                for option in within(value, "VALUES") {
                    let of = option.text().unwrap_or_default().trim();
                    let Some(option) = self.types.options.get(of) else {
                        let found = format!("{name} of {id} has the value {of:?}");
                        return Err((line, format!("{found} that no enumeration in the file has")));
                    };
                    options.push(option.clone());
                }
                options
            }
            Some("STRING" | "INTEGER" | "REAL" | "BOOLEAN" | "DATE") => {
                let text = value.attribute("THE-VALUE").unwrap_or_default();
                let string = tag.ends_with("STRING");
                let text = if string && self.escaped { unescape(text) } else { text.to_owned() };
                vec![normal(&text)]
            }
            _ => return Err((line, format!("found {tag}, expected an ATTRIBUTE-VALUE"))),
        };
        match texts.iter().find_map(|text| control(text)) {
            Some(c) => Err((line, format!("{name} of {id} has the control character {c:?}"))),
            None => Ok(texts),
        }
    }

    /// Reads the parents of objects: a relation goes from the derived object to its parent.
    fn parents(
        &mut self,
        content: Node<'_, '_>,
        ids: &HashMap<String, String>,
    ) -> Result<HashMap<String, Vec<Parent>>, Wrong> {
        let mut parents: HashMap<String, Vec<Parent>> = HashMap::new();
        for relation in within(content, "SPEC-RELATIONS") {
            let line = self.line(relation);
            let source = reference(relation, "SOURCE").unwrap_or_default();
            let target = reference(relation, "TARGET").unwrap_or_default();
            for end in [source, target] {
                if !ids.contains_key(end) {
                    let found = format!("a relation has an end {end:?}");
                    return Err((line, format!("{found} that isn't in the file")));
                }
            }
            let of = reference(relation, "TYPE").and_then(|of| self.types.relations.get(of));
            let role = of.filter(|role| *role != "Parent").cloned();
            parents
                .entry(source.to_owned())
                .or_default()
                .push(Parent { id: ids[target].clone(), role });
        }
        Ok(parents)
    }

    fn requirement(
        &mut self,
        mut object: Object,
        section: Vec<String>,
        parents: Vec<Parent>,
    ) -> Result<(), Wrong> {
        let line = object.line;
        let id = id_of(&object);
        if object.take(FOREIGN_ID).is_none() {
            self.note(line, format!("the object has no {FOREIGN_ID}: it is called {id}"));
        }
        if self.found.requirements.iter().any(|r| r.id == id) {
            return Err((
                line,
                format!("the id {id:?} is there a second time, expected unique ids"),
            ));
        }
        let title = object.take(NAME).map(|title| title.replace('\n', " "));
        let Some(text) = object.take(TEXT).or_else(|| title.clone()) else {
            return Err((line, format!("{id} has neither {TEXT} nor {NAME}")));
        };
        let (clause, rationale) = (object.take(fields::CLAUSE), object.take(fields::RATIONALE));
        let verification = match fields::verification(&|name| object.get(name)) {
            Ok(Some((verification, used))) => {
                object.values.retain(|(name, ..)| !used.contains(&name.as_str()));
                verification
            }
            Ok(None) => {
                let open = "has no MEASURE and no VERIFICATION: how it is verified has to be added";
                self.note(line, format!("{id} {open}"));
                Verification::Open
            }
            Err((at, message)) => {
                self.note(at, format!("{id}: {message}: how it is verified has to be added"));
                Verification::Open
            }
        };
        let mut attributes = Vec::new();
        for (name, kind, values, _) in object.values {
            if kind != AttributeKind::Text && !self.found.definitions.iter().any(|d| d.name == name)
            {
                let name = name.clone();
                self.found.definitions.push(Definition { name, kind, field: None });
            }
            attributes.push(ForeignAttribute { name, values });
        }
        let kind = (object.kind != crate::sdoc::REQUIREMENT).then_some(object.kind);
        // An identifier that this program made from the id adds nothing.
        let identifier =
            (object.identifier != super::identifier::identifier(&id)).then_some(object.identifier);
        self.found.requirements.push(Requirement {
            title,
            clause,
            rationale,
            parents,
            section,
            kind,
            identifier,
            attributes,
            ..Requirement::new(&id, &text, verification)
        });
        Ok(())
    }
}

/// Title of an object that is the head of a section.
fn chapter(object: &Object) -> Option<String> {
    let title = object.get(CHAPTER)?.1.replace('\n', " ");
    object.get(TEXT).is_none().then_some(title)
}

/// Id of an object for people.
fn id_of(object: &Object) -> String {
    let id = object.get(FOREIGN_ID).map_or(object.identifier.as_str(), |(_, id)| id);
    id.replace('\n', " ")
}

/// Reverts the escapes of Python's `unicode_escape`, with which StrictDoc writes strings.
#[must_use]
pub fn unescape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('\\') {
        out.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let Some(first) = rest.chars().next() else {
            out.push('\\');
            break;
        };
        let digits = match first {
            'x' => 2,
            'u' => 4,
            'U' => 8,
            _ => 0,
        };
        let code = rest.get(1..=digits).filter(|_| digits > 0);
        let code = code.and_then(|hex| u32::from_str_radix(hex, 16).ok()).and_then(char::from_u32);
        match (first, code) {
            (_, Some(c)) => {
                out.push(c);
                rest = &rest[1 + digits..];
                continue;
            }
            ('n', _) => out.push('\n'),
            ('r', _) => out.push('\r'),
            ('t', _) => out.push('\t'),
            ('\\', _) => out.push('\\'),
            (other, _) => {
                out.push('\\');
                out.push(other);
            }
        }
        rest = &rest[first.len_utf8()..];
    }
    out.push_str(rest);
    out
}
