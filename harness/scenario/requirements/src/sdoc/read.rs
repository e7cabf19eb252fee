//! Reading of StrictDoc's documents.

mod head;

use super::REQUIREMENT;
use super::grammar::Field;
use super::markup;
use crate::error::{Imported, Note};
use crate::ledger::{Ledger, LeftOut, Lost, Repair, Whereabouts};
use octant_verdict::fields as field;
use octant_verdict::requirement::{
    AttributeKind, ForeignAttribute, Parent, Requirement, Requirements, Verification,
};
use octant_verdict::text::{control, normal};
use octant_verdict::{RequirementsError, RequirementsProblem};
use std::collections::HashMap;

/// Reads an `.sdoc`.
///
/// A node whose fields make no complete check is read with an open verification, and a note says so. A node
/// without a UID or a statement, with the UID of another, or that can't be read, is left out: the account counts it,
/// and a note names it. A node without a UID is called by its MID.
///
/// # Errors
/// If the text isn't a document of StrictDoc, with the line.
pub fn read(text: &str, file: &str) -> Result<Imported, RequirementsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut parser = Parser {
        lines: text.split('\n').map(|line| line.strip_suffix('\r').unwrap_or(line)).collect(),
        at: 0,
        found: Requirements::default(),
        notes: Vec::new(),
        ledger: Ledger::new(file),
        fields: HashMap::new(),
        ids: HashMap::new(),
        open: Vec::new(),
    };
    match parser.document() {
        Ok(()) => Ok(Imported {
            requirements: parser.found,
            notes: parser.notes,
            attachments: Vec::new(),
            account: parser.ledger.finish(),
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
    ledger: Ledger,
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
            (None, None) => {
                let message = format!("is no node: {}, expected [NAME]", self.found());
                self.lost(LeftOut::Damaged, "between the nodes".to_owned(), line, message);
                self.at += 1;
                self.skip();
                return Ok(());
            }
        };
        self.at += 1;
        if kind == "DOCUMENT_FROM_FILE" {
            let file = self.peek().unwrap_or_default().trim_start_matches("FILE: ").to_owned();
            let message = "is another document: read it by itself".to_owned();
            self.lost(LeftOut::Document, file, line, message);
            self.at += 1;
            return Ok(());
        }
        let (mut section, mut requirement) = (None, None);
        match (self.fields(), kind.as_str()) {
            (Err((at, message)), _) => {
                let message = format!("can't be read in line {at}: {message}");
                self.lost(LeftOut::Damaged, kind.clone(), line, message);
                self.skip();
            }
            (Ok(_), "TEXT") => {
                self.ledger.left_out(LeftOut::Information, &Whereabouts::new(&*kind, "", line));
                self.note(line, "free text is left out");
            }
            (Ok((fields, _)), "SECTION") => {
                self.ledger.kept(&Whereabouts::new(&*kind, "", line), &[]);
                section = fields.into_iter().find(|f| f.name == "TITLE").map(|f| f.value);
            }
            (Ok((fields, parents)), _) => {
                requirement = self.requirement(line, &kind, fields, parents);
            }
        }
        if composite {
            self.open.push(Open { kind, line, section, requirement });
        }
        Ok(())
    }

    /// Leaves out an object.
    fn lost(&mut self, why: LeftOut, name: String, line: usize, message: String) {
        let lost = Lost { why, at: Whereabouts::new(name, "", line), message };
        let note = self.ledger.lost(&lost);
        self.notes.push(note);
    }

    /// Goes to the next node after an empty line.
    fn skip(&mut self) {
        while let Some(line) = self.peek() {
            if line.starts_with('[') && self.at > 0 && self.lines[self.at - 1].is_empty() {
                return;
            }
            self.at += 1;
        }
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
            if !value.is_empty() {
                fields.push(Written { name: name.to_owned(), value, line });
            }
        }
        Ok((fields, parents))
    }

    /// Reads the lines of a value up to `<<<`.
    fn block(&mut self, line: usize, name: &str) -> Result<String, Wrong> {
        let mut lines: Vec<&str> = Vec::new();
        let mut has_node = false;
        while let Some(text) = self.peek() {
            self.at += 1;
            if text == "<<<" {
                return Ok(normal(&lines.join("\n")));
            }
            // A value that begins in another node: the end of this one is missing, and it would swallow that node.
            let field = text.strip_suffix(": >>>");
            if has_node
                && field
                    .is_some_and(|name| name.chars().all(|c| c.is_ascii_uppercase() || c == '_'))
            {
                break;
            }
            has_node |= text.starts_with('[') && text.ends_with(']') && lines.last() == Some(&"");
            lines.push(text);
        }
        // The nodes that follow are read.
        self.at = line;
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

    /// Adds the requirement that a node is, or leaves it out; returns its id.
    fn requirement(
        &mut self,
        line: usize,
        kind: &str,
        fields: Vec<Written>,
        parents: Vec<Parent>,
    ) -> Option<String> {
        let mut fields = fields;
        let mut take = |name: &str| {
            let at = fields.iter().position(|f| f.name == name)?;
            Some(fields.remove(at))
        };
        let (mid, uid, title) = (take("MID"), take("UID"), take("TITLE"));
        let (statement, clause, rationale) =
            (take("STATEMENT"), take(field::CLAUSE), take(field::RATIONALE));
        let mut repairs = Vec::new();
        if let (None, Some(mid)) = (&uid, &mid) {
            let detail = format!("{kind}: {}", mid.value);
            let is_doubt = false;
            repairs.push(Repair { kind: "without a UID, called by the MID", detail, is_doubt });
        }
        let Some(uid) = uid.or_else(|| mid.as_ref().map(Written::copy)) else {
            let message = "has no UID and no MID, by which it could be named".to_owned();
            self.lost(LeftOut::NoId, kind.to_owned(), line, message);
            return None;
        };
        if let Some(first) = self.ids.get(&uid.value) {
            let message = format!("has the UID of another, that of line {first}");
            self.lost(LeftOut::Again, uid.value, uid.line, message);
            return None;
        }
        let Some(text) = statement.or_else(|| title.as_ref().map(Written::copy)) else {
            let message = "has neither STATEMENT nor TITLE".to_owned();
            self.lost(LeftOut::NoText, uid.value, line, message);
            return None;
        };
        let notes = self.ledger.kept(&Whereabouts::new(&*uid.value, "", line), &repairs);
        self.notes.extend(notes);
        self.ids.insert(uid.value.clone(), uid.line);
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
            let mut name = known.map_or(written.name.as_str(), Field::name).to_owned();
            let is_said = !matches!(verification, Verification::Open | Verification::Test(_));
            if name == field::VERIFICATION && is_said {
                // Several methods, of which the requirement keeps the one that decides.
                name += " (other)";
            }
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
        Some(uid.value)
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
