//! Parsing of one ReqIF file: objects, relations and hierarchies, without their meaning.

use super::identifier::decoded;
use super::types::{Types, Wrong, child, reference, within};
use super::{NAMESPACE, NAMESPACE_2010};
use crate::error::Note;
use crate::foreign::{Attribute, Object};
use crate::ledger::{LeftOut, Lost, Repair, Whereabouts};
use crate::lines::Lines;
use crate::mapping::DeclaredType;
use crate::xhtml;
use octant_verdict::text::{control, normal};
use octant_verdict::{RequirementsError, RequirementsProblem};
use roxmltree::{Document, Node};
use std::borrow::Cow;
use std::collections::HashMap;
use std::rc::Rc;

/// Most levels of nested sections; no real document is deeper.
const DEPTH: usize = 100;

/// A relation between two objects.
pub(super) struct Relation {
    pub(super) line: usize,
    pub(super) source: String,
    pub(super) target: String,
    pub(super) role: Option<String>,
}

/// A document: objects in their order, with their depth from 1.
pub(super) struct Specification {
    pub(super) title: String,
    pub(super) document: Vec<(String, String)>,
    pub(super) nodes: Vec<(usize, usize, String)>,
}

/// Content of a file.
#[derive(Default)]
pub(super) struct ParsedFile {
    /// Name in an archive; empty for a file of its own.
    pub(super) name: String,
    /// True for a file that this program wrote.
    pub(super) is_own: bool,
    pub(super) objects: Vec<Object>,
    /// Objects that can't be read.
    pub(super) lost: Vec<Lost>,
    /// True for the namespace of 2010.
    pub(super) is_of_2010: bool,
    pub(super) relations: Vec<Relation>,
    pub(super) specifications: Vec<Specification>,
    pub(super) types: Vec<DeclaredType>,
    pub(super) notes: Vec<Note>,
}

/// Parses a file; `name` is that in an archive.
pub(super) fn parse(text: &str, file: &str, name: &str) -> Result<ParsedFile, RequirementsError> {
    let fail = |line: usize, column: usize, message: String| {
        RequirementsError::one(file, RequirementsProblem::new((line, column), "", message))
    };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let text = &*without_late_declaration(text);
    let document = Document::parse(text).map_err(|error| {
        let at = error.pos();
        fail(at.row as usize, at.col as usize, format!("not XML: {error}"))
    })?;
    Parser::parse(&document, &Lines::of(text), name)
        .map_err(|(line, message)| fail(line, 1, message))
}

/// Text without its XML declaration, if that comes after space, where XML doesn't allow one; places stay.
fn without_late_declaration(text: &str) -> Cow<'_, str> {
    let begin = text.len() - text.trim_start().len();
    let rest = &text[begin..];
    match rest.find("?>").filter(|_| begin > 0 && rest.starts_with("<?xml")) {
        None => Cow::Borrowed(text),
        Some(end) => {
            let blank = |c: char| if c == '\n' { '\n' } else { ' ' };
            let (declaration, rest) = rest.split_at(end + 2);
            let head: String = declaration.chars().map(blank).collect();
            Cow::Owned(format!("{}{head}{rest}", &text[..begin]))
        }
    }
}

struct Parser<'a> {
    lines: &'a Lines,
    types: Types,
    /// True for a file of StrictDoc, which writes strings with the escapes of Python.
    escaped: bool,
    /// Attributes of each object type.
    declared: HashMap<String, Rc<Vec<String>>>,
    found: ParsedFile,
}

impl<'a> Parser<'a> {
    fn parse(document: &Document<'_>, lines: &'a Lines, name: &str) -> Result<ParsedFile, Wrong> {
        let line = |node: Node<'_, '_>| lines.number(node.range().start);
        let root = document.root_element();
        let tag = root.tag_name();
        if tag.name() == "RIF" {
            let message = "found RIF, the format before ReqIF: export the document as ReqIF";
            return Err((line(root), message.to_owned()));
        }
        let is_of_2010 = tag.namespace() == Some(NAMESPACE_2010);
        if tag.name() != "REQ-IF" || !(is_of_2010 || tag.namespace() == Some(NAMESPACE)) {
            let found = format!(
                "found {} of the namespace {:?}",
                tag.name(),
                tag.namespace().unwrap_or("")
            );
            return Err((line(root), format!("{found}, expected REQ-IF of {NAMESPACE}")));
        }
        let header = child(root, "THE-HEADER").and_then(|n| child(n, "REQ-IF-HEADER"));
        let tool = header.and_then(|n| child(n, "REQ-IF-TOOL-ID")).and_then(|n| n.text());
        let content = child(root, "CORE-CONTENT").and_then(|n| child(n, "REQ-IF-CONTENT"));
        let Some(content) = content else {
            return Err((line(root), "there is no CORE-CONTENT with a REQ-IF-CONTENT".to_owned()));
        };
        let (types, undefined) = Types::read(content, &line);
        let escaped = tool.is_some_and(|tool| tool.trim().eq_ignore_ascii_case("strictdoc"));
        let is_own = tool.is_some_and(|tool| tool.trim() == super::TOOL);
        let found =
            ParsedFile { name: name.to_owned(), is_own, is_of_2010, ..ParsedFile::default() };
        let mut parser = Parser { lines, types, escaped, declared: HashMap::new(), found };
        for (line, message) in undefined {
            parser.note(line, message);
        }
        parser.declare();
        for node in within(content, "SPEC-OBJECTS") {
            match parser.object(node) {
                Ok(object) => parser.found.objects.push(object),
                Err(lost) => parser.found.lost.push(lost),
            }
        }
        parser.relations(content);
        for node in within(content, "SPECIFICATIONS") {
            let specification = parser.specification(node)?;
            parser.found.specifications.push(specification);
        }
        parser.left_out(root, content);
        Ok(parser.found)
    }

    fn line(&self, node: Node<'_, '_>) -> usize {
        self.lines.number(node.range().start)
    }

    fn note(&mut self, line: usize, message: impl Into<String>) {
        let note = Note::new(line, message).in_file(&self.found.name);
        self.found.notes.push(note);
    }

    /// Lists the types of objects, for mappings.
    fn declare(&mut self) {
        let mut ids: Vec<&String> = self.types.objects.keys().collect();
        ids.sort();
        for id in ids {
            let object_type = &self.types.objects[id];
            let known =
                object_type.attributes.iter().filter_map(|id| self.types.attributes.get(id));
            let attributes = known.map(|definition| {
                let options = definition.kind.options().map(<[String]>::to_vec);
                (definition.name.clone(), options)
            });
            let attributes: Vec<_> = attributes.collect();
            let names = attributes.iter().map(|(name, _)| name.clone()).collect();
            self.declared.insert(id.clone(), Rc::new(names));
            self.found.types.push(DeclaredType { name: object_type.name.clone(), attributes });
        }
    }

    /// Notes the parts of a file that have no place among requirements.
    fn left_out(&mut self, root: Node<'_, '_>, content: Node<'_, '_>) {
        if child(root, "TOOL-EXTENSIONS").is_some() {
            self.note(self.line(root), "tool extensions are left out");
        }
        if let Some(groups) = child(content, "SPEC-RELATION-GROUPS").filter(Node::has_children) {
            self.note(self.line(groups), "groups of relations are left out");
        }
        let defaults: Vec<_> =
            content.descendants().filter(|n| n.tag_name().name() == "DEFAULT-VALUE").collect();
        if let Some(first) = defaults.first() {
            let attribute = first.parent().and_then(|n| n.attribute("LONG-NAME")).unwrap_or("?");
            let number = defaults.len();
            let message = format!(
                "{number} default values of attributes are left out, the first of {attribute}"
            );
            self.note(self.line(*first), message);
        }
    }

    fn object(&mut self, node: Node<'_, '_>) -> Result<Object, Lost> {
        let line = self.line(node);
        let name = node.attribute("IDENTIFIER").filter(|id| !id.is_empty());
        let at = Whereabouts::new(name.unwrap_or("without an IDENTIFIER"), &self.found.name, line);
        let Some(id) = name else {
            let message = "has no IDENTIFIER".to_owned();
            return Err(Lost { why: LeftOut::NoId, at, message });
        };
        let id = id.to_owned();
        let of = reference(node, "TYPE").unwrap_or_default();
        let Some(object_type) = self.types.objects.get(of) else {
            let message = format!("is of a type {of:?} that isn't in the file");
            return Err(Lost { why: LeftOut::Undefined, at, message });
        };
        let kind = object_type.name.clone();
        let (mut attributes, repairs) = match self.values(node, &id) {
            Ok(found) => found,
            Err((why, message)) => return Err(Lost { why, at, message }),
        };
        // Attributes are sorted in the order of the type, not of the object.
        let rank: HashMap<&str, usize> = self.types.objects[of]
            .attributes
            .iter()
            .enumerate()
            .filter_map(|(i, id)| Some((self.types.attributes.get(id)?.name.as_str(), i)))
            .collect();
        attributes.sort_by_key(|attribute| rank.get(attribute.name.as_str()).copied());
        let long_name = node.attribute("LONG-NAME").map(normal).filter(|name| !name.is_empty());
        Ok(Object {
            file: self.found.name.clone(),
            line,
            kept_identifier: Some(decoded(&id)),
            identifier: id,
            has_identifier: true,
            kind,
            long_name,
            attributes,
            declared: self.declared.get(of).cloned().unwrap_or_default(),
            is_title_enough: false,
            repairs,
        })
    }

    /// Attributes of an object, or of a document, and the repairs of their texts.
    fn values(
        &mut self,
        node: Node<'_, '_>,
        id: &str,
    ) -> Result<(Vec<Attribute>, Vec<Repair>), (LeftOut, String)> {
        let (mut values, mut repairs): (Vec<Attribute>, Vec<Repair>) = Default::default();
        for value in within(node, "VALUES") {
            let line = self.line(value);
            let definition = reference(value, "DEFINITION").unwrap_or_default();
            let Some(known) = self.types.attributes.get(definition) else {
                let message =
                    format!("has an attribute {definition:?} that no type in the file has");
                return Err((LeftOut::Undefined, message));
            };
            let (name, kind) = (known.name.clone(), known.kind.clone());
            let (texts, formatted) = self.value(value, &name, &mut repairs)?;
            let known = values.iter().find(|known| known.name == name);
            if texts.iter().all(String::is_empty) {
                // A picture without a word of its own is no text.
                if formatted.is_some_and(|xhtml| !xhtml::references(&xhtml).is_empty()) {
                    self.note(line, format!("{name} of {id} is a picture without a text"));
                }
            } else if let Some(known) = known {
                if known.values != texts {
                    let kind = "with several values of one attribute, of which the first is kept";
                    let (before, after) = (texts.join(", "), known.values.join(", "));
                    let repair = Repair::of_text(kind, &format!("{name}: {before}"), &after);
                    repairs.push(Repair { is_doubt: true, ..repair });
                }
            } else {
                values.push(Attribute { name, kind, values: texts, formatted, line });
            }
        }
        Ok((values, repairs))
    }

    /// Texts of an attribute's value, and its formatting.
    fn value(
        &self,
        value: Node<'_, '_>,
        name: &str,
        repairs: &mut Vec<Repair>,
    ) -> Result<(Vec<String>, Option<String>), (LeftOut, String)> {
        let tag = value.tag_name().name();
        let mut formatted = None;
        let texts = match tag.strip_prefix("ATTRIBUTE-VALUE-") {
            Some("XHTML") => {
                let plain = child(value, "THE-VALUE").map(xhtml::read).unwrap_or_default();
                if !plain.foreign.is_empty() {
                    repairs.push(Repair {
                        kind: "with elements that aren't XHTML, of which the text is kept",
                        detail: format!("{name}: {}", plain.foreign.join(", ")),
                        is_doubt: false,
                    });
                }
                if let Some(before) = &plain.undeleted {
                    let kind = "with text that is marked as deleted, which is left out";
                    repairs.push(Repair::of_text(kind, before, &plain.text));
                }
                formatted = plain.formatted;
                vec![plain.text]
            }
            Some("ENUMERATION") => {
                let mut options = Vec::new();
                for option in within(value, "VALUES") {
                    let of = option.text().unwrap_or_default().trim();
                    let Some(option) = self.types.options.get(of) else {
                        let message = format!(
                            "has the value {of:?} of {name}, which no enumeration in the file has"
                        );
                        return Err((LeftOut::Undefined, message));
                    };
                    options.push(option.clone());
                }
                options
            }
            Some("STRING" | "INTEGER" | "REAL" | "BOOLEAN" | "DATE") => {
                let text = value.attribute("THE-VALUE").unwrap_or_default();
                let string = tag.ends_with("STRING");
                let text =
                    if string && self.escaped { super::unescape(text) } else { text.to_owned() };
                vec![boolean(tag, normal(&text))]
            }
            _ => return Err((LeftOut::Damaged, format!("has {tag}, expected an ATTRIBUTE-VALUE"))),
        };
        match texts.iter().find_map(|text| control(text)) {
            Some(c) => {
                Err((LeftOut::Damaged, format!("has the control character {c:?} in {name}")))
            }
            None => Ok((texts, formatted)),
        }
    }

    /// Reads relations: one goes from the derived object to its parent.
    fn relations(&mut self, content: Node<'_, '_>) {
        let mut described = 0;
        for relation in within(content, "SPEC-RELATIONS") {
            let end = |name: &str| reference(relation, name).unwrap_or_default().to_owned();
            let (source, target) = (end("SOURCE"), end("TARGET"));
            let of = reference(relation, "TYPE").and_then(|of| self.types.relations.get(of));
            let role = of.filter(|role| *role != "Parent").cloned();
            described += usize::from(within(relation, "VALUES").next().is_some());
            let line = self.line(relation);
            self.found.relations.push(Relation { line, source, target, role });
        }
        if described > 0 {
            let line = child(content, "SPEC-RELATIONS").map_or(0, |node| self.line(node));
            self.note(line, format!("attributes of {described} relations are left out"));
        }
    }

    fn specification(&mut self, node: Node<'_, '_>) -> Result<Specification, Wrong> {
        let title = node.attribute("LONG-NAME").map(normal).filter(|title| !title.is_empty());
        let line = self.line(node);
        let values = self.values(node, "the document");
        let (values, _) =
            values.map_err(|(_, message)| (line, format!("the specification {message}")))?;
        if values.iter().any(|value| value.formatted.is_some()) {
            let message = "the formatting of the attributes of the document is left out";
            self.note(self.line(node), message);
        }
        let document = values.into_iter().map(|value| (value.name, value.values.join(", ")));
        Ok(Specification {
            title: title.unwrap_or_else(|| "Requirements".to_owned()),
            document: document.collect(),
            nodes: self.hierarchy(node)?,
        })
    }

    /// Nodes of a specification with their depth, from 1, in the order of the document.
    fn hierarchy(&self, specification: Node<'_, '_>) -> Result<Vec<(usize, usize, String)>, Wrong> {
        let mut nodes = Vec::new();
        let mut open: Vec<(usize, Node<'_, '_>)> =
            within(specification, "CHILDREN").map(|node| (1, node)).collect();
        open.reverse();
        while let Some((depth, node)) = open.pop() {
            let line = self.line(node);
            if depth > DEPTH {
                return Err((line, format!("more than {DEPTH} levels of sections")));
            }
            nodes.push((depth, line, reference(node, "OBJECT").unwrap_or_default().to_owned()));
            let mut children: Vec<_> = within(node, "CHILDREN").map(|n| (depth + 1, n)).collect();
            children.reverse();
            open.append(&mut children);
        }
        Ok(nodes)
    }
}

/// A boolean of XML Schema has two names for each value.
fn boolean(tag: &str, text: String) -> String {
    match (tag.ends_with("BOOLEAN"), text.as_str()) {
        (true, "1") => "true".to_owned(),
        (true, "0") => "false".to_owned(),
        _ => text,
    }
}
