//! Parsing of one ReqIF file: objects, relations and hierarchies, without their meaning.

use super::NAMESPACE;
use super::types::{Types, Wrong, child, identifier, reference, within};
use crate::error::Note;
use crate::foreign::{Attribute, Object};
use crate::mapping::DeclaredType;
use crate::xhtml;
use octant_verdict::text::{control, normal};
use octant_verdict::{RequirementsError, RequirementsProblem};
use roxmltree::{Document, Node};
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
    let document = Document::parse(text).map_err(|error| {
        let at = error.pos();
        fail(at.row as usize, at.col as usize, format!("not XML: {error}"))
    })?;
    Parser::parse(&document, name).map_err(|(line, message)| fail(line, 1, message))
}

struct Parser<'a> {
    document: &'a Document<'a>,
    types: Types,
    /// True for a file of StrictDoc, which writes strings with the escapes of Python.
    escaped: bool,
    /// Attributes of each object type.
    declared: HashMap<String, Rc<Vec<String>>>,
    found: ParsedFile,
}

impl<'a> Parser<'a> {
    fn parse(document: &'a Document<'a>, name: &str) -> Result<ParsedFile, Wrong> {
        let line = |node: Node<'_, '_>| document.text_pos_at(node.range().start).row as usize;
        let root = document.root_element();
        let tag = root.tag_name();
        if tag.name() != "REQ-IF" || tag.namespace() != Some(NAMESPACE) {
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
        let types = Types::read(content, &line)?;
        let escaped = tool.is_some_and(|tool| tool.trim().eq_ignore_ascii_case("strictdoc"));
        let is_own = tool.is_some_and(|tool| tool.trim() == super::TOOL);
        let found = ParsedFile { name: name.to_owned(), is_own, ..ParsedFile::default() };
        let mut parser = Parser { document, types, escaped, declared: HashMap::new(), found };
        parser.declare();
        for node in within(content, "SPEC-OBJECTS") {
            let object = parser.object(node)?;
            parser.found.objects.push(object);
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
        self.document.text_pos_at(node.range().start).row as usize
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
        let mut attributes = self.values(node, &id)?;
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
            kept_identifier: Some(id.clone()),
            identifier: id,
            has_identifier: true,
            kind,
            long_name,
            attributes,
            declared: self.declared.get(of).cloned().unwrap_or_default(),
        })
    }

    /// Attributes of an object, or of a document.
    fn values(&mut self, node: Node<'_, '_>, id: &str) -> Result<Vec<Attribute>, Wrong> {
        let mut values: Vec<Attribute> = Vec::new();
        for value in within(node, "VALUES") {
            let line = self.line(value);
            let definition = reference(value, "DEFINITION").unwrap_or_default();
            let Some(known) = self.types.attributes.get(definition) else {
                let found = format!("{id} has an attribute {definition:?}");
                return Err((line, format!("{found} that no type in the file has")));
            };
            let (name, kind) = (known.name.clone(), known.kind.clone());
            let (texts, formatted) = self.value(value, &name, id)?;
            if texts.iter().all(String::is_empty) {
                // A picture without a word of its own is no text.
                if formatted.is_some_and(|xhtml| !xhtml::references(&xhtml).is_empty()) {
                    self.note(line, format!("{name} of {id} is a picture without a text"));
                }
            } else if values.iter().any(|known| known.name == name) {
                self.note(line, format!("{name} of {id} is there again: the first is kept"));
            } else {
                values.push(Attribute { name, kind, values: texts, formatted, line });
            }
        }
        Ok(values)
    }

    /// Texts of an attribute's value, and its formatting.
    fn value(
        &mut self,
        value: Node<'_, '_>,
        name: &str,
        id: &str,
    ) -> Result<(Vec<String>, Option<String>), Wrong> {
        let line = self.line(value);
        let tag = value.tag_name().name();
        let mut formatted = None;
        let texts = match tag.strip_prefix("ATTRIBUTE-VALUE-") {
            Some("XHTML") => {
                let plain = child(value, "THE-VALUE").map(xhtml::read).unwrap_or_default();
                if !plain.foreign.is_empty() {
                    let foreign = plain.foreign.join(", ");
                    let message = format!(
                        "{name} of {id}: elements that aren't XHTML become text: {foreign}"
                    );
                    self.note(line, message);
                }
                formatted = plain.formatted;
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
                let text =
                    if string && self.escaped { super::unescape(text) } else { text.to_owned() };
                vec![boolean(tag, normal(&text))]
            }
            _ => return Err((line, format!("found {tag}, expected an ATTRIBUTE-VALUE"))),
        };
        match texts.iter().find_map(|text| control(text)) {
            Some(c) => Err((line, format!("{name} of {id} has the control character {c:?}"))),
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
        let values = self.values(node, "the document")?;
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
