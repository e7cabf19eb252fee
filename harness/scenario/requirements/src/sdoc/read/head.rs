//! Head and grammar of a document.

use super::{Parser, Wrong};
use crate::sdoc::grammar::{Field, kind};
use crate::sdoc::{HEAD, OPTIONS, markup};
use octant_verdict::fields as field;
use octant_verdict::requirement::AttributeKind;

impl Parser<'_> {
    /// Reads the lines after `[DOCUMENT]`, up to the first empty one.
    pub(super) fn head(&mut self) -> Result<(), Wrong> {
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

    pub(super) fn grammar(&mut self) -> Result<(), Wrong> {
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
}
