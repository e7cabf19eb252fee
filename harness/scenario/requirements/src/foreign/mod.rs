//! Objects of other tools, and the requirements that they are.
//!
//! A reader of a format makes an [`Object`] of each entry; [`Assembly`] makes requirements of them, by the
//! names of a [`Mapping`]. An object without an id or a text is reported, and the others are read.

mod definitions;
mod object;

pub(crate) use object::{Attribute, Object, Role};

use crate::error::{Imported, Note, listed};
use crate::mapping::{IDENTIFIER, Mapping, RequirementPart};
use definitions::Definitions;
use octant_verdict::fields;
use octant_verdict::requirement::{
    ForeignAttribute, FormattedText, Parent, Requirement, Requirements, Verification,
};
use octant_verdict::{RequirementsError, RequirementsProblem};
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
    pub(crate) fn new(mapping: &'a Mapping) -> Self {
        Self {
            mapping,
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

    /// Notes that an object is no requirement.
    pub(crate) fn informative(&mut self, object: &Object) {
        self.informative.push(object.name(self.mapping));
    }

    /// Notes what a heading has beside its title and id, which is all that a section keeps.
    pub(crate) fn heading(&mut self, object: &Object) {
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

    /// Adds the requirement that an object is, or a note why it is none; returns its id.
    ///
    /// # Errors
    /// If its id is there already.
    pub(crate) fn add(
        &mut self,
        mut object: Object,
        place: Place,
        parents: Vec<Parent>,
    ) -> Result<Option<String>, RequirementsError> {
        let (line, file) = (object.line, object.file.clone());
        let identifier = object.identifier.clone();
        let skip = |what: &str| {
            let message = format!("the object {identifier} has {what}: it is left out");
            Note::new(line, message).in_file(&file).skipped()
        };
        let Some(id) = self.id(&mut object) else {
            self.notes.push(skip("no id"));
            return Ok(None);
        };
        if let Some((file, first)) = self.ids.get(&id) {
            let file = if file.is_empty() { String::new() } else { format!("{file}, ") };
            let found = format!("the id {id:?} is there a second time, the first is in {file}");
            let message = match first {
                0 => format!("{}; expected unique ids", found.trim_end_matches(", ")),
                first => format!("{found}line {first}; expected unique ids"),
            };
            let at = (line.max(1), 1);
            let problem = RequirementsProblem::new(at, "", message);
            return Err(RequirementsError::one(&object.file, problem));
        }
        let title = self.title(&mut object);
        let Some((text, formatted)) = self.text(&mut object, &id, title.as_deref()) else {
            self.notes.push(skip("no text"));
            return Ok(None);
        };
        self.ids.insert(id.clone(), (file, line));
        let requirement = self.requirement(object, id.clone(), (text, formatted), title);
        self.found.requirements.push(Requirement {
            section: place.section,
            under: place.under,
            parents,
            ..requirement
        });
        Ok(Some(id))
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

    fn title(&mut self, object: &mut Object) -> Option<String> {
        let found = object.take(self.mapping, RequirementPart::Title);
        if found.as_ref().is_some_and(|found| found.formatted.is_some()) {
            let message =
                format!("the formatting of the title of {} is left out", object.identifier);
            self.notes.push(Note::new(object.line, message).in_file(&object.file));
        }
        let title = found.map(|found| found.text);
        title.or_else(|| object.long_name.take()).map(|title| title.replace('\n', " "))
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
        id: String,
        (text, formatted): (String, Option<String>),
        title: Option<String>,
    ) -> Requirement {
        let mut formats: Vec<FormattedText> = Vec::new();
        let mut format = |name: &str, xhtml: Option<String>| {
            let name = name.to_owned();
            formats.extend(xhtml.map(|xhtml| FormattedText { name, xhtml }));
        };
        format(TEXT, formatted);
        let mut taken = |part: RequirementPart, name: &str| {
            let found = object.take(self.mapping, part)?;
            format(name, found.formatted);
            Some(found.text)
        };
        let clause = taken(RequirementPart::Clause, fields::CLAUSE);
        let rationale = taken(RequirementPart::Rationale, fields::RATIONALE);
        let verification = self.verification(&mut object, &id);
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
            ..Requirement::new(&id, &text, verification)
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
        let of = |field: &str| {
            let (index, part) = *places.get(field)?;
            let attribute = object.attributes.get(index)?;
            let value = attribute.values.first()?;
            Some((attribute.line, self.mapping.value(&object.kind, part, value)))
        };
        match fields::verification(&of) {
            Ok(Some((verification, used))) => {
                let mut used: Vec<usize> =
                    used.iter().filter_map(|field| Some(places.get(field)?.0)).collect();
                // The first of several methods counts; the attribute keeps all of them.
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
        Imported { requirements: self.found, notes: self.notes, attachments: Vec::new() }
    }
}
