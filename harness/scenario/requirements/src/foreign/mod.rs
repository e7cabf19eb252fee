//! Objects of other tools, and the requirements that they are.
//!
//! A reader of a format makes an [`Object`] of each entry; [`Assembly`] makes requirements of them, by the
//! names of a [`Mapping`]. An object without an id or a text is reported, and the others are read.

mod definitions;
mod object;

pub(crate) use object::{Attribute, Object, Role};

use crate::error::{Imported, Note, listed};
use crate::ledger::{Ledger, LeftOut, Lost};
use crate::mapping::{IDENTIFIER, Mapping, RequirementPart};
use definitions::Definitions;
use octant_verdict::fields;
use octant_verdict::requirement::{
    ForeignAttribute, FormattedText, Parent, Requirement, Requirements, Verification,
};
use std::collections::{HashMap, HashSet};

/// Names of ReqIF that the writer gives to parts of a requirement.
pub(crate) const FOREIGN_ID: &str = "ReqIF.ForeignID";
pub(crate) const NAME: &str = "ReqIF.Name";
pub(crate) const TEXT: &str = "ReqIF.Text";
pub(crate) const CHAPTER: &str = "ReqIF.ChapterName";

/// Place of a requirement in its document.
#[derive(Clone, Debug, Default)]
pub(crate) struct Place {
    pub(crate) section: Vec<String>,
    pub(crate) under: Option<String>,
}

/// Makes requirements of objects.
pub(crate) struct Assembly<'a> {
    mapping: &'a Mapping,
    pub(crate) found: Requirements,
    pub(crate) notes: Vec<Note>,
    pub(crate) ledger: Ledger,
    definitions: Definitions,
    /// File and line of each id.
    ids: HashMap<String, (String, usize)>,
    /// Requirements without a stated verification.
    open: Vec<String>,
    /// Objects that are no requirements.
    informative: Vec<String>,
    /// Headings with more than a title and an id.
    headings: Vec<String>,
    /// Types about which a note was made.
    noted: HashSet<(String, RequirementPart)>,
}

impl<'a> Assembly<'a> {
    pub(crate) fn new(mapping: &'a Mapping, document: &str) -> Self {
        Self {
            mapping,
            ledger: Ledger::new(document),
            found: Requirements::default(),
            notes: Vec::new(),
            definitions: Definitions::default(),
            ids: HashMap::new(),
            open: Vec::new(),
            informative: Vec::new(),
            headings: Vec::new(),
            noted: HashSet::new(),
        }
    }

    /// Leaves out an object of which no requirement can be made.
    pub(crate) fn lost(&mut self, lost: &Lost) {
        let note = self.ledger.lost(lost);
        self.notes.push(note);
    }

    /// Leaves out an object that is no requirement.
    pub(crate) fn informative(&mut self, object: &Object) {
        self.ledger.left_out(LeftOut::Information, &object.at());
        self.informative.push(object.name(self.mapping));
    }

    /// Uses a heading, of which a section keeps the title and the id, and notes what else it has.
    pub(crate) fn heading(&mut self, object: &Object) {
        let notes = self.ledger.kept(&object.at(), &object.repairs);
        self.notes.extend(notes);
        let parts = [RequirementPart::Id, RequirementPart::Title, RequirementPart::Heading];
        let is_kept = |attribute: &Attribute| {
            let of =
                |part: &RequirementPart| self.mapping.rank(&object.kind, *part, &attribute.name);
            let says_so =
                |value: &String| self.mapping.is_informative_value(&attribute.name, value);
            attribute.formatted.is_none() && parts.iter().any(|part| of(part).is_some())
                || attribute.values.iter().any(says_so)
        };
        if !object.attributes.iter().all(is_kept) {
            self.headings.push(object.name(self.mapping));
        }
    }

    /// Adds the requirement that an object is, or leaves it out with a note; returns its id.
    pub(crate) fn add(
        &mut self,
        mut object: Object,
        place: Place,
        parents: Vec<Parent>,
    ) -> Option<String> {
        let at = object.at();
        let lost = |why: LeftOut, message: String| Lost { why, at: at.clone(), message };
        let Some(id) = self.id(&mut object) else {
            self.lost(&lost(LeftOut::NoId, "has no id".to_owned()));
            return None;
        };
        if let Some((file, line)) = self.ids.get(&id) {
            let place = match (file.as_str(), line) {
                ("", 0) => String::new(),
                ("", line) => format!(", that of line {line}"),
                (file, 0) => format!(", that of {file}"),
                (file, line) => format!(", that of {file}, line {line}"),
            };
            let message = format!("has the id {id:?} of another{place}");
            self.lost(&lost(LeftOut::Again, message));
            return None;
        }
        let (title, formatted_title) = self.title(&mut object);
        let Some((text, formatted)) = self.text(&mut object, &id, title.as_deref()) else {
            self.lost(&lost(LeftOut::NoText, "has no text".to_owned()));
            return None;
        };
        self.ids.insert(id.clone(), (object.file.clone(), object.line));
        let repairs = std::mem::take(&mut object.repairs);
        let requirement =
            self.requirement(object, &id, (text, title), [formatted, formatted_title]);
        let notes = self.ledger.kept(&at, &repairs);
        self.notes.extend(notes);
        self.found.requirements.push(Requirement {
            section: place.section,
            under: place.under,
            parents,
            ..requirement
        });
        Some(id)
    }

    fn id(&mut self, object: &mut Object) -> Option<String> {
        let kind = object.kind.clone();
        if let Some(id) = object.take(self.mapping, RequirementPart::Id) {
            return Some(id.text.replace('\n', " "));
        }
        if object.declares(self.mapping, RequirementPart::Id)
            || self.mapping.is_named(&kind, RequirementPart::Id)
                && self.mapping.rank(&kind, RequirementPart::Id, IDENTIFIER).is_none()
        {
            return None;
        }
        let named = self.mapping.is_named(&kind, RequirementPart::Id);
        if !named && object.has_identifier && self.noted.insert((kind.clone(), RequirementPart::Id))
        {
            let message = format!("objects of the type {kind:?} have no attribute for an id");
            let message = format!("{message}: they are called by their {IDENTIFIER}");
            self.notes.push(Note::new(object.line, message).in_file(&object.file));
        }
        object.has_identifier.then(|| object.identifier.clone())
    }

    /// Title of an object, and its formatting.
    fn title(&self, object: &mut Object) -> (Option<String>, Option<String>) {
        let found = object.take(self.mapping, RequirementPart::Title);
        let (title, formatted) = match found {
            Some(found) => (Some(found.text), found.formatted),
            None => (object.long_name.take(), None),
        };
        (title.map(|title| title.replace('\n', " ")), formatted)
    }

    /// Text of an object, and its formatting; its title, where objects of its type have no text.
    fn text(
        &mut self,
        object: &mut Object,
        id: &str,
        title: Option<&str>,
    ) -> Option<(String, Option<String>)> {
        if let Some(found) = object.take(self.mapping, RequirementPart::Text) {
            return Some((found.text, found.formatted));
        }
        if object.is_title_enough {
            return Some((title?.to_owned(), None));
        }
        let kind = object.kind.clone();
        if object.declares(self.mapping, RequirementPart::Text)
            || self.mapping.is_named(&kind, RequirementPart::Text)
        {
            return None;
        }
        let title = title?.to_owned();
        if self.noted.insert((kind.clone(), RequirementPart::Text)) {
            let message = format!("objects of the type {kind:?} have no attribute for a text");
            let message = format!("{message}: that of {id} and others is their title");
            self.notes.push(Note::new(object.line, message).in_file(&object.file));
        }
        Some((title, None))
    }

    fn requirement(
        &mut self,
        mut object: Object,
        id: &str,
        (text, title): (String, Option<String>),
        [formatted, formatted_title]: [Option<String>; 2],
    ) -> Requirement {
        let mut formats: Vec<FormattedText> = Vec::new();
        let mut format = |name: &str, xhtml: Option<String>| {
            let name = name.to_owned();
            formats.extend(xhtml.map(|xhtml| FormattedText { name, xhtml }));
        };
        format(NAME, formatted_title);
        format(TEXT, formatted);
        let mut taken = |part: RequirementPart, name: &str| {
            let found = object.take(self.mapping, part)?;
            format(name, found.formatted);
            Some(found.text)
        };
        let clause = taken(RequirementPart::Clause, fields::CLAUSE);
        let rationale = taken(RequirementPart::Rationale, fields::RATIONALE);
        let verification = self.verification(&mut object, id);
        let mut attributes = Vec::new();
        for attribute in object.attributes {
            let name = self.free_name(&attribute.name, &verification, &object.file, object.line);
            self.definitions.add(&name, &attribute.kind);
            format(&name, attribute.formatted);
            attributes.push(ForeignAttribute { name, values: attribute.values });
        }
        let kind = (object.kind != crate::sdoc::REQUIREMENT && !object.kind.is_empty())
            .then_some(object.kind);
        Requirement {
            title,
            clause,
            rationale,
            kind,
            identifier: object.kept_identifier,
            attributes,
            formatted: formats,
            ..Requirement::new(id, &text, verification)
        }
    }

    /// Name for an attribute that isn't that of a part which the requirement has itself.
    fn free_name(
        &mut self,
        name: &str,
        verification: &Verification,
        file: &str,
        line: usize,
    ) -> String {
        // Without a verification its fields can be attributes.
        let own = fields::ALL.contains(&name) && !matches!(verification, Verification::Open)
            || fields::OF_FORMATS.contains(&name)
            || [FOREIGN_ID, NAME, TEXT].contains(&name);
        if !own {
            return name.to_owned();
        }
        let free = format!("{name} (other)");
        if self.noted.insert((free.clone(), RequirementPart::Id)) {
            let message = format!("the attribute {name} is not used, and kept as {free:?}");
            self.notes.push(Note::new(line, message).in_file(file));
        }
        free
    }

    fn verification(&mut self, object: &mut Object, id: &str) -> Verification {
        let parts = [
            (fields::MEASURE, RequirementPart::Measure),
            (fields::COMPARISON, RequirementPart::Comparison),
            (fields::LIMIT, RequirementPart::Limit),
            (fields::SECANT_LATITUDE, RequirementPart::SecantLatitude),
            (fields::PASS, RequirementPart::Pass),
            (fields::CONFIDENCE, RequirementPart::Confidence),
            (fields::VERIFICATION, RequirementPart::Verification),
            (fields::TESTS, RequirementPart::Tests),
        ];
        let mut places = HashMap::new();
        for (field, part) in parts {
            if let Some(index) = object.index(self.mapping, part) {
                places.insert(field, (index, part));
            }
        }
        let mut values = HashMap::new();
        for (field, (index, part)) in &places {
            let Some(attribute) = object.attributes.get(*index) else { continue };
            let of = |value: &String| self.mapping.value(&object.kind, *part, value).to_owned();
            let of: Vec<String> = attribute.values.iter().map(of).collect();
            values.insert(*field, (attribute.line, of.join(", ")));
        }
        let of = |field: &str| values.get(field).map(|(line, value)| (*line, value.as_str()));
        match fields::verification(&of) {
            Ok(Some((verification, used))) => {
                let mut used: Vec<usize> =
                    used.iter().filter_map(|field| Some(places.get(field)?.0)).collect();
                // The attribute keeps all of several methods.
                used.retain(|index| object.attributes[*index].values.len() == 1);
                used.sort_unstable();
                for index in used.into_iter().rev() {
                    object.attributes.remove(index);
                }
                verification
            }
            Ok(None) => {
                self.open.push(id.to_owned());
                Verification::Open
            }
            Err((line, message)) => {
                let message = format!("{id}: {message}: how it is verified has to be added");
                self.notes.push(Note::new(line, message).in_file(&object.file));
                Verification::Open
            }
        }
    }

    /// Gives attributes one order in all requirements, which a file that is written from them has.
    fn sort_attributes(&mut self) {
        let names = self.found.attribute_names();
        let ranks: HashMap<String, usize> =
            names.into_iter().enumerate().map(|(rank, name)| (name.to_owned(), rank)).collect();
        for requirement in &mut self.found.requirements {
            requirement.attributes.sort_by_key(|attribute| ranks.get(&attribute.name).copied());
        }
    }

    /// Ends the import: requirements with their definitions, and all notes.
    pub(crate) fn finish(mut self) -> Imported {
        let (definitions, changed) =
            std::mem::take(&mut self.definitions).finish(&mut self.found.requirements);
        self.found.definitions = definitions;
        self.sort_attributes();
        self.notes.extend(changed.into_iter().map(|message| Note::new(0, message)));
        for (words, ids) in [
            ("left out, because they are no requirements but information", &self.informative),
            (
                "of these headings the title is kept, and the formatting and other attributes are left out",
                &self.headings,
            ),
            (
                "without a measure or a stated verification, and open until somebody says how they are verified",
                &self.open,
            ),
        ] {
            if !ids.is_empty() {
                self.notes.push(Note::new(0, format!("{words}: {}", listed(ids))));
            }
        }
        Imported {
            requirements: self.found,
            notes: self.notes,
            attachments: Vec::new(),
            account: self.ledger.finish(),
        }
    }
}
