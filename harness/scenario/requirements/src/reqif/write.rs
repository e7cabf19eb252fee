//! Writing of ReqIF files.

use super::columns::{Column, columns};
use super::identifier::{identifier, object_id};
use super::{CHAPTER, FOREIGN_ID, NAME, NAMESPACE, TEXT, TOOL};
use crate::error::ExportError;
use crate::hierarchy::{Step, steps};
use crate::sdoc::REQUIREMENT;
use crate::xhtml;
use octant_verdict::fields::own_fields;
use octant_verdict::file::misfit;
use octant_verdict::requirement::{AttributeKind, Requirement, Requirements};
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use quick_xml::writer::Writer;
use std::collections::{HashMap, HashSet};
use std::io;

/// Writes requirements as ReqIF; [`super::read()`] gives back the same ones.
///
/// `time` is the time of the export in the form of XML Schema, `2026-01-31T12:00:00Z`: the same
/// requirements and time give the same bytes.
///
/// # Errors
/// If an attribute has a value that doesn't fit its kind, or an identifier is invalid in XML or occurs
/// twice.
pub fn write(requirements: &Requirements, time: &str) -> Result<String, ExportError> {
    let mut seen = HashSet::new();
    for requirement in &requirements.requirements {
        let wrong = |message| ExportError { format: "ReqIF", id: requirement.id.clone(), message };
        let id = object_id(requirement);
        for attribute in &requirement.attributes {
            let kind = requirements.kind(&attribute.name);
            if let Some(expected) = misfit(&kind, &attribute.values) {
                let found = attribute.values.join(", ");
                return Err(wrong(format!("{} is {found:?}, expected {expected}", attribute.name)));
            }
        }
        if !seen.insert(id.clone()) {
            return Err(wrong(format!("its identifier {id:?} is there a second time")));
        }
    }
    let mut file = File {
        out: Writer::new_with_indent(Vec::new(), b' ', 1),
        time,
        requirements,
        columns: columns(requirements),
    };
    let failed =
        |error: String| ExportError { format: "ReqIF", id: "(all)".to_owned(), message: error };
    file.document().map_err(|error| failed(error.to_string()))?;
    String::from_utf8(file.out.into_inner()).map_err(|error| failed(error.to_string()))
}

/// Attributes of a requirement in ReqIF, with their values.
fn values_of(requirement: &Requirement) -> Vec<(&str, Vec<String>)> {
    let mut values: Vec<(&str, Vec<String>)> =
        vec![(FOREIGN_ID, vec![requirement.id.clone()]), (TEXT, vec![requirement.text.clone()])];
    values.extend(requirement.title.iter().map(|title| (NAME, vec![title.clone()])));
    values.extend(own_fields(requirement).into_iter().map(|(name, value)| (name, vec![value])));
    values.extend(requirement.attributes.iter().map(|a| (a.name.as_str(), a.values.clone())));
    values
}

/// Text of an attribute in ReqIF.
pub(crate) fn text_of(requirement: &Requirement, name: &str) -> Option<String> {
    let values = values_of(requirement).into_iter().find(|(known, _)| *known == name)?;
    Some(values.1.join("\n\n"))
}

struct File<'a> {
    out: Writer<Vec<u8>>,
    time: &'a str,
    requirements: &'a Requirements,
    columns: Vec<Column>,
}

fn named<'a>(time: &'a str, id: &'a str, name: &'a str) -> [(&'a str, &'a str); 3] {
    [("IDENTIFIER", id), ("LAST-CHANGE", time), ("LONG-NAME", name)]
}

type Attributes<'a> = &'a [(&'a str, &'a str)];

impl File<'_> {
    fn open(&mut self, name: &str, attributes: Attributes<'_>) -> io::Result<()> {
        let start = BytesStart::new(name).with_attributes(attributes.iter().copied());
        self.out.write_event(Event::Start(start))
    }

    fn close(&mut self, name: &str) -> io::Result<()> {
        self.out.write_event(Event::End(BytesEnd::new(name)))
    }

    fn empty(&mut self, name: &str, attributes: Attributes<'_>) -> io::Result<()> {
        let start = BytesStart::new(name).with_attributes(attributes.iter().copied());
        self.out.write_event(Event::Empty(start))
    }

    fn text(&mut self, name: &str, text: &str) -> io::Result<()> {
        self.open(name, &[])?;
        self.out.write_event(Event::Text(BytesText::new(text)))?;
        self.close(name)
    }

    /// Writes an element that holds a reference: `<TYPE><…-REF>id</…-REF></TYPE>`.
    fn reference(&mut self, name: &str, to: &str, id: &str) -> io::Result<()> {
        self.open(name, &[])?;
        self.text(to, id)?;
        self.close(name)
    }

    fn document(&mut self) -> io::Result<()> {
        self.out.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        self.open("REQ-IF", &[("xmlns", NAMESPACE), ("xmlns:xhtml", xhtml::NAMESPACE)])?;
        self.open("THE-HEADER", &[])?;
        self.open("REQ-IF-HEADER", &[("IDENTIFIER", "octant-header")])?;
        self.text("CREATION-TIME", self.time)?;
        self.text("REQ-IF-TOOL-ID", TOOL)?;
        // The schema of ReqIF 1.2 fixes the version to that of 1.0.
        self.text("REQ-IF-VERSION", "1.0")?;
        self.text("SOURCE-TOOL-ID", TOOL)?;
        self.text("TITLE", &self.requirements.title)?;
        self.close("REQ-IF-HEADER")?;
        self.close("THE-HEADER")?;
        self.open("CORE-CONTENT", &[])?;
        self.open("REQ-IF-CONTENT", &[])?;
        self.datatypes()?;
        self.types()?;
        self.objects()?;
        self.relations()?;
        self.specification()?;
        self.close("REQ-IF-CONTENT")?;
        self.close("CORE-CONTENT")?;
        self.close("REQ-IF")
    }

    fn datatypes(&mut self) -> io::Result<()> {
        let time = self.time;
        self.open("DATATYPES", &[])?;
        for (tag, id, more) in [
            ("STRING", "octant-d-text", &[("MAX-LENGTH", "1000000")][..]),
            ("XHTML", "octant-d-xhtml", &[]),
            (
                "INTEGER",
                "octant-d-integer",
                &[("MIN", "-9223372036854775808"), ("MAX", "9223372036854775807")],
            ),
            ("REAL", "octant-d-real", &[("ACCURACY", "17"), ("MIN", "-1e308"), ("MAX", "1e308")]),
            ("BOOLEAN", "octant-d-boolean", &[]),
            ("DATE", "octant-d-date", &[]),
        ] {
            let name = format!("DATATYPE-DEFINITION-{tag}");
            let mut attributes =
                vec![("IDENTIFIER", id), ("LAST-CHANGE", time), ("LONG-NAME", tag)];
            attributes.extend(more);
            self.empty(&name, &attributes)?;
        }
        for index in 0..self.columns.len() {
            let Some(options) = self.columns[index].kind.options().map(<[String]>::to_vec) else {
                continue;
            };
            let id = format!("octant-d-{index}");
            let name = self.columns[index].name.clone();
            let attributes =
                [("IDENTIFIER", id.as_str()), ("LAST-CHANGE", time), ("LONG-NAME", &name)];
            self.open("DATATYPE-DEFINITION-ENUMERATION", &attributes)?;
            self.open("SPECIFIED-VALUES", &[])?;
            for (number, option) in options.iter().enumerate() {
                let id = format!("octant-d-{index}-v-{number}");
                let key = number.to_string();
                let attributes =
                    [("IDENTIFIER", id.as_str()), ("LAST-CHANGE", time), ("LONG-NAME", option)];
                self.open("ENUM-VALUE", &attributes)?;
                self.open("PROPERTIES", &[])?;
                self.empty("EMBEDDED-VALUE", &[("KEY", &key), ("OTHER-CONTENT", "")])?;
                self.close("PROPERTIES")?;
                self.close("ENUM-VALUE")?;
            }
            self.close("SPECIFIED-VALUES")?;
            self.close("DATATYPE-DEFINITION-ENUMERATION")?;
        }
        self.close("DATATYPES")
    }

    fn kinds(&self) -> Vec<String> {
        let mut kinds: Vec<String> = Vec::new();
        for requirement in &self.requirements.requirements {
            let kind = requirement.kind.as_deref().unwrap_or(REQUIREMENT);
            if !kinds.iter().any(|known| known == kind) {
                kinds.push(kind.to_owned());
            }
        }
        kinds
    }

    fn types(&mut self) -> io::Result<()> {
        let time = self.time;
        self.open("SPEC-TYPES", &[])?;
        let chapter = "ATTRIBUTE-DEFINITION-STRING";
        self.open("SPECIFICATION-TYPE", &named(time, "octant-t-specification", "Specification"))?;
        if !self.requirements.document.is_empty() {
            self.open("SPEC-ATTRIBUTES", &[])?;
            for (index, (key, _)) in self.requirements.document.iter().enumerate() {
                let id = format!("octant-t-specification-a-{index}");
                self.open("ATTRIBUTE-DEFINITION-XHTML", &named(time, &id, key))?;
                self.reference("TYPE", "DATATYPE-DEFINITION-XHTML-REF", "octant-d-xhtml")?;
                self.close("ATTRIBUTE-DEFINITION-XHTML")?;
            }
            self.close("SPEC-ATTRIBUTES")?;
        }
        self.close("SPECIFICATION-TYPE")?;
        self.open("SPEC-OBJECT-TYPE", &named(time, "octant-t-section", "SECTION"))?;
        self.open("SPEC-ATTRIBUTES", &[])?;
        self.open(chapter, &named(time, "octant-t-section-a-title", CHAPTER))?;
        self.reference("TYPE", "DATATYPE-DEFINITION-STRING-REF", "octant-d-text")?;
        self.close(chapter)?;
        self.close("SPEC-ATTRIBUTES")?;
        self.close("SPEC-OBJECT-TYPE")?;
        for kind in self.kinds() {
            let of = format!("octant-t-{}", identifier(&kind));
            self.open("SPEC-OBJECT-TYPE", &named(time, &of, &kind))?;
            self.open("SPEC-ATTRIBUTES", &[])?;
            for index in 0..self.columns.len() {
                let (tag, datatype) = self.datatype(index);
                let id = format!("{of}-a-{index}");
                let name = self.columns[index].name.clone();
                let element = format!("ATTRIBUTE-DEFINITION-{tag}");
                let mut attributes = named(time, &id, &name).to_vec();
                if tag == "ENUMERATION" {
                    let multi = matches!(self.columns[index].kind, AttributeKind::Choices(_));
                    attributes.push(("MULTI-VALUED", if multi { "true" } else { "false" }));
                }
                self.open(&element, &attributes)?;
                self.reference("TYPE", &format!("DATATYPE-DEFINITION-{tag}-REF"), &datatype)?;
                self.close(&element)?;
            }
            self.close("SPEC-ATTRIBUTES")?;
            self.close("SPEC-OBJECT-TYPE")?;
        }
        for (index, role) in self.roles().iter().enumerate() {
            let name = role.as_deref().unwrap_or("Parent");
            self.empty(
                "SPEC-RELATION-TYPE",
                &named(time, &format!("octant-t-relation-{index}"), name),
            )?;
        }
        self.close("SPEC-TYPES")
    }

    /// Tag and identifier of a column's datatype.
    fn datatype(&self, index: usize) -> (&'static str, String) {
        let column = &self.columns[index];
        let (tag, id) = match &column.kind {
            AttributeKind::Text if column.formatted => ("XHTML", "octant-d-xhtml"),
            AttributeKind::Text => ("STRING", "octant-d-text"),
            AttributeKind::Integer => ("INTEGER", "octant-d-integer"),
            AttributeKind::Real => ("REAL", "octant-d-real"),
            AttributeKind::Boolean => ("BOOLEAN", "octant-d-boolean"),
            AttributeKind::Date => ("DATE", "octant-d-date"),
            AttributeKind::Choice(_) | AttributeKind::Choices(_) => {
                return ("ENUMERATION", format!("octant-d-{index}"));
            }
        };
        (tag, id.to_owned())
    }

    fn roles(&self) -> Vec<Option<String>> {
        let mut roles: Vec<Option<String>> = vec![None];
        for parent in self.requirements.requirements.iter().flat_map(|r| &r.parents) {
            if !roles.contains(&parent.role) {
                roles.push(parent.role.clone());
            }
        }
        roles
    }

    /// Writes the objects, and the heads of sections between them.
    fn objects(&mut self) -> io::Result<()> {
        let (time, requirements) = (self.time, self.requirements);
        self.open("SPEC-OBJECTS", &[])?;
        for step in steps(requirements) {
            match step {
                Step::End => {}
                Step::Requirement(index) => self.object(&requirements.requirements[index])?,
                Step::Section(title, number) => {
                    let id = format!("octant-section-{number}");
                    self.open("SPEC-OBJECT", &[("IDENTIFIER", &id), ("LAST-CHANGE", time)])?;
                    self.open("VALUES", &[])?;
                    self.open("ATTRIBUTE-VALUE-STRING", &[("THE-VALUE", title)])?;
                    let definition = "ATTRIBUTE-DEFINITION-STRING-REF";
                    self.reference("DEFINITION", definition, "octant-t-section-a-title")?;
                    self.close("ATTRIBUTE-VALUE-STRING")?;
                    self.close("VALUES")?;
                    self.reference("TYPE", "SPEC-OBJECT-TYPE-REF", "octant-t-section")?;
                    self.close("SPEC-OBJECT")?;
                }
            }
        }
        self.close("SPEC-OBJECTS")
    }

    fn object(&mut self, requirement: &Requirement) -> io::Result<()> {
        let id = object_id(requirement);
        let kind = requirement.kind.as_deref().unwrap_or(REQUIREMENT);
        let of = format!("octant-t-{}", identifier(kind));
        let values = values_of(requirement);
        self.open("SPEC-OBJECT", &[("IDENTIFIER", &id), ("LAST-CHANGE", self.time)])?;
        self.open("VALUES", &[])?;
        for index in 0..self.columns.len() {
            let name = self.columns[index].name.clone();
            if let Some((_, values)) = values.iter().find(|(n, _)| *n == name) {
                let formatted = requirement.formatted.iter().find(|text| text.name == name);
                let xhtml = formatted.map(|text| text.xhtml.as_str());
                self.value(index, &format!("{of}-a-{index}"), values, xhtml)?;
            }
        }
        self.close("VALUES")?;
        self.reference("TYPE", "SPEC-OBJECT-TYPE-REF", &of)?;
        self.close("SPEC-OBJECT")
    }

    /// Writes a text as XHTML: with its formatting, if that is still the formatting of this text.
    fn formatted(&mut self, formatted: Option<&str>, text: &str) -> io::Result<()> {
        let formatted = formatted.and_then(|xhtml| xhtml::of_formatted(xhtml, text));
        let content = formatted.unwrap_or_else(|| xhtml::of_plain(text));
        self.open("THE-VALUE", &[])?;
        // As text, because indentation would add space to it.
        self.out.write_event(Event::Text(BytesText::from_escaped(content)))?;
        self.close("THE-VALUE")
    }

    fn value(
        &mut self,
        index: usize,
        definition: &str,
        values: &[String],
        formatted: Option<&str>,
    ) -> io::Result<()> {
        let (tag, datatype) = self.datatype(index);
        let element = format!("ATTRIBUTE-VALUE-{tag}");
        let joined = values.join("\n\n");
        let inside = matches!(tag, "XHTML" | "ENUMERATION");
        let attributes = [("THE-VALUE", joined.as_str())];
        self.open(&element, if inside { &[] } else { &attributes })?;
        self.reference("DEFINITION", &format!("ATTRIBUTE-DEFINITION-{tag}-REF"), definition)?;
        match tag {
            "XHTML" => {
                self.formatted(formatted, &joined)?;
            }
            "ENUMERATION" => {
                self.open("VALUES", &[])?;
                let options = self.columns[index].kind.options().unwrap_or_default().to_vec();
                for value in values {
                    if let Some(number) = options.iter().position(|option| option == value) {
                        self.text("ENUM-VALUE-REF", &format!("{datatype}-v-{number}"))?;
                    }
                }
                self.close("VALUES")?;
            }
            _ => {}
        }
        self.close(&element)
    }

    fn relations(&mut self) -> io::Result<()> {
        let (requirements, roles) = (self.requirements, self.roles());
        let ids: HashMap<&str, String> =
            requirements.requirements.iter().map(|r| (r.id.as_str(), object_id(r))).collect();
        self.open("SPEC-RELATIONS", &[])?;
        let mut number = 0;
        for requirement in &requirements.requirements {
            for parent in &requirement.parents {
                // A relation has both ends in one file: crate::losses names the others.
                let Some(target) = ids.get(parent.id.as_str()) else { continue };
                let role = roles.iter().position(|role| *role == parent.role).unwrap_or(0);
                let id = format!("octant-relation-{number}");
                number += 1;
                self.open("SPEC-RELATION", &[("IDENTIFIER", &id), ("LAST-CHANGE", self.time)])?;
                self.reference(
                    "TYPE",
                    "SPEC-RELATION-TYPE-REF",
                    &format!("octant-t-relation-{role}"),
                )?;
                self.reference("SOURCE", "SPEC-OBJECT-REF", &object_id(requirement))?;
                self.reference("TARGET", "SPEC-OBJECT-REF", target)?;
                self.close("SPEC-RELATION")?;
            }
        }
        self.close("SPEC-RELATIONS")
    }

    fn specification(&mut self) -> io::Result<()> {
        let (time, requirements) = (self.time, self.requirements);
        self.open("SPECIFICATIONS", &[])?;
        let title = requirements.title.as_str();
        let attributes =
            [("IDENTIFIER", "octant-specification"), ("LAST-CHANGE", time), ("LONG-NAME", title)];
        self.open("SPECIFICATION", &attributes)?;
        if !requirements.document.is_empty() {
            self.open("VALUES", &[])?;
            for (index, (_, value)) in requirements.document.iter().enumerate() {
                let id = format!("octant-t-specification-a-{index}");
                self.open("ATTRIBUTE-VALUE-XHTML", &[])?;
                self.reference("DEFINITION", "ATTRIBUTE-DEFINITION-XHTML-REF", &id)?;
                self.formatted(None, value)?;
                self.close("ATTRIBUTE-VALUE-XHTML")?;
            }
            self.close("VALUES")?;
        }
        self.reference("TYPE", "SPECIFICATION-TYPE-REF", "octant-t-specification")?;
        self.open("CHILDREN", &[])?;
        self.hierarchy(&steps(requirements))?;
        self.close("CHILDREN")?;
        self.close("SPECIFICATION")?;
        self.close("SPECIFICATIONS")
    }

    fn hierarchy(&mut self, steps: &[Step<'_>]) -> io::Result<()> {
        let (time, requirements) = (self.time, self.requirements);
        // For each open node, whether it has children.
        let mut open: Vec<bool> = Vec::new();
        for (at, step) in steps.iter().enumerate() {
            let object = match step {
                Step::Section(_, number) => format!("octant-section-{number}"),
                Step::Requirement(index) => object_id(&requirements.requirements[*index]),
                Step::End => {
                    if open.pop() == Some(true) {
                        self.close("CHILDREN")?;
                    }
                    self.close("SPEC-HIERARCHY")?;
                    continue;
                }
            };
            let id = format!("{object}-place");
            self.open("SPEC-HIERARCHY", &[("IDENTIFIER", &id), ("LAST-CHANGE", time)])?;
            self.reference("OBJECT", "SPEC-OBJECT-REF", &object)?;
            let has_children = steps.get(at + 1).is_some_and(|next| *next != Step::End);
            if has_children {
                self.open("CHILDREN", &[])?;
            }
            open.push(has_children);
        }
        Ok(())
    }
}
