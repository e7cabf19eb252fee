//! Reading of StrictDoc's documents.

use super::grammar::{Field, kind};
use super::markup;
use super::{HEAD, OPTIONS, REQUIREMENT};
use crate::error::{Imported, Note};
use octant_verdict::fields as field;
use octant_verdict::requirement::{
    AttributeKind, ForeignAttribute, Parent, Requirement, Requirements, Verification,
};
use octant_verdict::text::{control, normal};
use octant_verdict::{RequirementsError, RequirementsProblem};
use std::collections::HashMap;

/// Reads an `.sdoc`.
///
/// A node whose fields make no complete check is read with an open verification, and a note says so.
///
/// # Errors
/// If the text isn't a document of StrictDoc, with the line; if a requirement has no UID or no
/// statement; or if a UID occurs twice.
pub fn read(text: &str, file: &str) -> Result<Imported, RequirementsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut parser = Parser {
        lines: text.split('\n').map(|line| line.strip_suffix('\r').unwrap_or(line)).collect(),
        at: 0,
        found: Requirements::default(),
        notes: Vec::new(),
        fields: HashMap::new(),
        ids: HashMap::new(),
        open: Vec::new(),
    };
    match parser.document() {
        Ok(()) => Ok(Imported {
            requirements: parser.found,
            notes: parser.notes,
            attachments: Vec::new(),
        }),
        Err((line, message)) => {
            Err(RequirementsError::one(file, RequirementsProblem::new((line, 1), "", message)))
        }
    }
}

/// Line and text of an error.
type Wrong = (usize, String);

/// A node whose children follow.
struct Open {
    kind: String,
    line: usize,
    /// Title of a section; `None` for another node.
    section: Option<String>,
    /// UID of a requirement in which others are nested.
    requirement: Option<String>,
}

/// A field of a node.
struct Written {
    name: String,
    value: String,
    line: usize,
}

struct Parser<'a> {
    lines: Vec<&'a str>,
    at: usize,
    found: Requirements,
    notes: Vec<Note>,
    /// Fields of the grammar, by type of node and name.
    fields: HashMap<(String, String), Field>,
    /// Lines of the UIDs.
    ids: HashMap<String, usize>,
    open: Vec<Open>,
}

impl<'a> Parser<'a> {
    fn peek(&self) -> Option<&'a str> {
        self.lines.get(self.at).copied()
    }

    /// Number of the present line, from 1.
    fn line(&self) -> usize {
        self.at + 1
    }

    fn wrong<T>(&self, message: impl Into<String>) -> Result<T, Wrong> {
        Err((self.line().min(self.lines.len()), message.into()))
    }

    fn note(&mut self, line: usize, message: impl Into<String>) {
        self.notes.push(Note::new(line, message));
    }

    fn found(&self) -> String {
        match self.peek() {
            Some(line) => format!("found {:?}", line.chars().take(60).collect::<String>()),
            None => "the file ends here".to_owned(),
        }
    }

    fn document(&mut self) -> Result<(), Wrong> {
        while self.peek() == Some("") {
            self.at += 1;
        }
        if self.peek() != Some("[DOCUMENT]") {
            return self.wrong(format!("{}, expected [DOCUMENT]", self.found()));
        }
        self.at += 1;
        self.head()?;
        while let Some(line) = self.peek() {
            if line.is_empty() {
                self.at += 1;
            } else if line == "[GRAMMAR]" {
                self.at += 1;
                self.grammar()?;
            } else {
                self.node()?;
            }
        }
        match self.open.first() {
            None => Ok(()),
            Some(open) => self.wrong(format!(
                "the file ends, and [[{}]] of line {} isn't closed",
                open.kind, open.line
            )),
        }
    }

    /// Reads the lines after `[DOCUMENT]`, up to the first empty one.
    fn head(&mut self) -> Result<(), Wrong> {
        let mut title = None;
        let mut block = "";
        while let Some(line) = self.peek().filter(|line| !line.is_empty()) {
            let indented = line.starts_with(' ') || line.starts_with('-');
            if !indented && let Some(name) = line.strip_suffix(':') {
                block = name;
                if !["OPTIONS", "METADATA", "VIEWS"].contains(&block) {
                    return self.wrong(format!("{}, expected a field with a value", self.found()));
                }
                if block == "VIEWS" {
                    self.note(self.line(), "views are left out");
                }
            } else if block == "VIEWS" && indented {
                // A note was already made above.
            } else if let Some((key, value)) = line.trim_start().split_once(": ") {
                let value = value.trim().to_owned();
                match (indented, block) {
                    (false, _) if key == "TITLE" => title = Some(value),
                    (false, _) if HEAD.contains(&key) => {
                        self.found.document.push((key.to_owned(), value));
                    }
                    (true, "METADATA") => {
                        self.found.document.push((format!("METADATA.{key}"), value));
                    }
                    (true, "OPTIONS") if OPTIONS.contains(&key) => {
                        self.found.document.push((format!("OPTIONS.{key}"), value));
                    }
                    _ => {
                        let known: Vec<&str> = HEAD.into_iter().chain(OPTIONS).collect();
                        let like =
                            octant_base::names::suggestion(key, known.iter().copied(), "known");
                        return self
                            .wrong(format!("unknown field {key:?} of the document, {like}"));
                    }
                }
            } else {
                return self.wrong(format!("{}, expected a field NAME: value", self.found()));
            }
            self.at += 1;
        }
        let Some(title) = title.filter(|title| !title.is_empty()) else {
            return self.wrong("the document has no TITLE");
        };
        self.found.title = title;
        let document = &mut self.found.document;
        if !document.iter().any(|(key, _)| key == markup::OPTION) {
            // Said, so that a document that is written from this one means the same.
            let at = document.iter().position(|(key, _)| key.starts_with("METADATA."));
            let option = (markup::OPTION.to_owned(), markup::DEFAULT.to_owned());
            document.insert(at.unwrap_or(document.len()), option);
        }
        Ok(())
    }

    fn grammar(&mut self) -> Result<(), Wrong> {
        let mut tag = String::new();
        let mut field: Option<Field> = None;
        let mut relations = false;
        while let Some(line) = self.peek().filter(|line| !line.is_empty()) {
            let trimmed = line.trim_start();
            if line.starts_with("IMPORT_FROM_FILE: ") {
                let message = format!("the grammar of another file is not read: {line}");
                self.note(self.line(), message);
            } else if let Some(name) = line.strip_prefix("- TAG: ") {
                self.declare(&tag, field.take());
                tag = name.trim().to_owned();
                relations = false;
            } else if line == "  RELATIONS:" {
                self.declare(&tag, field.take());
                relations = true;
            } else if let Some(title) = line.strip_prefix("  - TITLE: ") {
                self.declare(&tag, field.take());
                let title = title.trim().to_owned();
                field = Some(Field { title, human: None, kind: AttributeKind::Text });
            } else if let (Some(text), Some(field), false) =
                (trimmed.strip_prefix("HUMAN_TITLE: "), &mut field, relations)
            {
                field.human = Some(text.trim().to_owned());
            } else if let (Some(text), Some(field), false) =
                (trimmed.strip_prefix("TYPE: "), &mut field, relations)
            {
                let Some(kind) = kind(text.trim()) else {
                    return self.wrong(format!(
                        "found the type {text:?}, expected String, SingleChoice(…), MultipleChoice(…) or Tag"
                    ));
                };
                field.kind = kind;
            } else if !(line == "ELEMENTS:"
                || line.starts_with(' ') && (trimmed.ends_with(':') || trimmed.contains(": ")))
            {
                return self.wrong(format!("{}, expected a line of the grammar", self.found()));
            }
            self.at += 1;
        }
        self.declare(&tag, field);
        Ok(())
    }

    fn declare(&mut self, tag: &str, field: Option<Field>) {
        let Some(field) = field else { return };
        let ours = field::ALL.contains(&field.title.as_str())
            || field::OF_FORMATS.contains(&field.title.as_str());
        if !ours && let Some(definition) = field.definition() {
            let known = &mut self.found.definitions;
            if !known.iter().any(|d| d.name == definition.name) {
                known.push(definition);
            }
        }
        self.fields.insert((tag.to_owned(), field.title.clone()), field);
    }

    /// Reads a node, or the end of one.
    fn node(&mut self) -> Result<(), Wrong> {
        let (line, head) = (self.line(), self.peek().unwrap_or_default());
        let inner = |open: &str, close: &str| {
            head.strip_prefix(open).and_then(|rest| rest.strip_suffix(close)).map(str::to_owned)
        };
        if let Some(kind) = inner("[[/", "]]").or_else(|| inner("[/", "]")) {
            self.at += 1;
            return match self.open.pop() {
                Some(open) if open.kind == kind => Ok(()),
                Some(open) => Err((
                    line,
                    format!(
                        "found the end of {kind}, expected that of {} of line {}",
                        open.kind, open.line
                    ),
                )),
                None => Err((line, format!("found the end of {kind}, and none is open"))),
            };
        }
        let (composite, kind) = match (inner("[[", "]]"), inner("[", "]")) {
            (Some(kind), _) => (true, kind),
            // `SECTION` in single brackets is the older form of a section.
            (None, Some(kind)) => (kind == "SECTION", kind),
            (None, None) => return self.wrong(format!("{}, expected a node [NAME]", self.found())),
        };
        self.at += 1;
        if kind == "DOCUMENT_FROM_FILE" {
            let message =
                format!("another document is not read: {}", self.peek().unwrap_or_default());
            self.note(line, message);
            self.at += 1;
            return Ok(());
        }
        let (fields, parents) = self.fields()?;
        let title = fields.iter().find(|f| f.name == "TITLE").map(|f| f.value.clone());
        match kind.as_str() {
            "TEXT" => self.note(line, "free text is left out"),
            "SECTION" => {}
            _ => self.requirement(line, &kind, fields, parents)?,
        }
        if composite {
            let section = if kind == "SECTION" { title } else { None };
            let last = self.found.requirements.last().map(|last| last.id.clone());
            let requirement = last.filter(|_| kind != "SECTION" && kind != "TEXT");
            self.open.push(Open { kind, line, section, requirement });
        }
        Ok(())
    }

    /// Reads fields and parents of a node, up to the empty line after it.
    fn fields(&mut self) -> Result<(Vec<Written>, Vec<Parent>), Wrong> {
        let (mut fields, mut parents) = (Vec::new(), Vec::new());
        while let Some(text) = self.peek().filter(|line| !line.is_empty()) {
            let line = self.line();
            if text == "RELATIONS:" {
                self.at += 1;
                parents = self.relations()?;
                break;
            }
            let Some((name, value)) = text.split_once(": ") else {
                return self.wrong(format!("{}, expected a field NAME: value", self.found()));
            };
            let capital = name.starts_with(|c: char| c.is_ascii_uppercase());
            if !capital || !name.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c)) {
                return self.wrong(format!("{}, expected a field NAME: value", self.found()));
            }
            self.at += 1;
            let value = if value == ">>>" { self.block(line, name)? } else { normal(value) };
            if let Some(c) = control(&value) {
                return Err((line, format!("{name} has the control character {c:?}")));
            }
            if value.is_empty() {
                return Err((line, format!("{name} is empty")));
            }
            fields.push(Written { name: name.to_owned(), value, line });
        }
        Ok((fields, parents))
    }

    /// Reads the lines of a value up to `<<<`.
    fn block(&mut self, line: usize, name: &str) -> Result<String, Wrong> {
        let mut lines = Vec::new();
        while let Some(text) = self.peek() {
            self.at += 1;
            if text == "<<<" {
                return Ok(normal(&lines.join("\n")));
            }
            lines.push(text);
        }
        Err((line, format!("{name} begins with >>> and isn't closed by a line <<<")))
    }

    fn relations(&mut self) -> Result<Vec<Parent>, Wrong> {
        let mut parents: Vec<Parent> = Vec::new();
        let (mut kind, mut began) = ("", self.line());
        while let Some(text) = self.peek().filter(|line| !line.is_empty()) {
            if let Some(of) = text.strip_prefix("- TYPE: ") {
                (kind, began) = (of, self.line());
                if !["Parent", "Child", "File"].contains(&of) {
                    return self.wrong(format!("found {of:?}, expected Parent, Child or File"));
                }
                if of != "Parent" {
                    self.note(began, format!("a relation of type {of} is left out"));
                }
            } else if let Some((key, value)) =
                text.strip_prefix("  ").and_then(|rest| rest.split_once(": "))
            {
                match (kind, key, parents.last_mut()) {
                    ("Parent", "VALUE", _) => {
                        parents.push(Parent { id: value.trim().to_owned(), role: None });
                    }
                    ("Parent", "ROLE", Some(parent)) => parent.role = Some(value.trim().to_owned()),
                    ("Parent", ..) => {
                        return self.wrong(format!("{}, expected VALUE or ROLE", self.found()));
                    }
                    _ => {}
                }
            } else {
                return self.wrong(format!(
                    "{}, expected a line of the relation of line {began}",
                    self.found()
                ));
            }
            self.at += 1;
        }
        Ok(parents)
    }

    fn requirement(
        &mut self,
        line: usize,
        kind: &str,
        fields: Vec<Written>,
        parents: Vec<Parent>,
    ) -> Result<(), Wrong> {
        let mut fields = fields;
        let mut take = |name: &str| {
            let at = fields.iter().position(|f| f.name == name)?;
            Some(fields.remove(at))
        };
        let (mid, uid, title) = (take("MID"), take("UID"), take("TITLE"));
        let (statement, clause, rationale) =
            (take("STATEMENT"), take(field::CLAUSE), take(field::RATIONALE));
        let Some(uid) = uid else {
            return Err((line, format!("this {kind} has no UID, by which it could be named")));
        };
        if let Some(first) = self.ids.insert(uid.value.clone(), uid.line) {
            let found = format!("the UID {:?} is there a second time", uid.value);
            return Err((uid.line, format!("{found}, the first is in line {first}")));
        }
        let Some(text) = statement.or_else(|| title.as_ref().map(Written::copy)) else {
            return Err((line, format!("{} has neither STATEMENT nor TITLE", uid.value)));
        };
        if markup::is_rst(&self.found.document) {
            for written in fields.iter_mut().filter(|written| markup::made(&written.name)) {
                written.value = markup::plain(&written.value);
            }
        }
        let verification = match check(&fields) {
            Ok(Some((verification, used))) => {
                fields.retain(|f| !used.contains(&f.name.as_str()));
                verification
            }
            Ok(None) => {
                let open = "has no MEASURE and no VERIFICATION: how it is verified has to be added";
                self.note(line, format!("{} {open}", uid.value));
                Verification::Open
            }
            Err((at, message)) => {
                self.note(
                    at,
                    format!("{}: {message}: how it is verified has to be added", uid.value),
                );
                Verification::Open
            }
        };
        let mut attributes: Vec<ForeignAttribute> = Vec::new();
        for written in fields {
            let known = self.fields.get(&(kind.to_owned(), written.name.clone()));
            let name = known.map_or(written.name.as_str(), Field::name).to_owned();
            let values = match known.map(|field| &field.kind) {
                Some(AttributeKind::Choices(_)) => {
                    written.value.split(", ").map(str::to_owned).collect()
                }
                _ => vec![written.value],
            };
            match attributes.iter_mut().find(|a| a.name == name) {
                Some(attribute) => attribute.values.extend(values),
                None => attributes.push(ForeignAttribute { name, values }),
            }
        }
        let plain = |w: Option<Written>| w.map(|w| w.value);
        self.found.requirements.push(Requirement {
            title: plain(title),
            clause: plain(clause),
            rationale: plain(rationale),
            parents,
            section: self.open.iter().filter_map(|open| open.section.clone()).collect(),
            under: self.open.iter().rev().find_map(|open| open.requirement.clone()),
            kind: (kind != REQUIREMENT).then(|| kind.to_owned()),
            identifier: plain(mid),
            attributes,
            ..Requirement::new(&uid.value, &text.value, verification)
        });
        Ok(())
    }
}

impl Written {
    fn copy(&self) -> Self {
        Self { name: self.name.clone(), value: self.value.clone(), line: self.line }
    }
}

/// Verification of a node, and the fields that describe it; `None`: there are none.
fn check(fields: &[Written]) -> Result<Option<field::Said>, Wrong> {
    let of =
        |name: &str| fields.iter().find(|f| f.name == name).map(|f| (f.line, f.value.as_str()));
    octant_verdict::fields::verification(&of)
}
