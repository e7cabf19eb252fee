//! Reading of `needs.json`.

use super::json::{NeedsFile, NeedsVersion};
use super::schema::NeedSchema;
use super::{COMPUTED, CORE, FORMAT, LINKS, NO_REQUIREMENTS, PARENT_NEEDS, REQ, VERSION};
use crate::error::{Imported, Note, listed};
use crate::foreign::{Assembly, Attribute, FOREIGN_ID, NAME, Object, Place, Role, TEXT};
use crate::ledger::{LeftOut, Lost, Repair, Whereabouts};
use crate::lines::Lines;
use crate::mapping::{DeclaredType, Mapping};
use crate::sdoc::markup;
use octant_base::names::suggestion;
use octant_verdict::requirement::{AttributeKind, Parent};
use octant_verdict::text::{control, normal};
use octant_verdict::{RequirementsError, RequirementsProblem};
use serde_json::Value;
use std::collections::{BTreeSet, HashMap, HashSet, VecDeque};
use std::rc::Rc;

/// Reads a `needs.json`: the needs of its current version.
///
/// # Errors
/// If the text isn't JSON, or JSON of another form, or if the mapping names what the file doesn't have.
pub fn read(text: &str, file: &str, mapping: &Mapping) -> Result<Imported, RequirementsError> {
    let fail = |line: usize, column: usize, message: String| {
        RequirementsError::one(file, RequirementsProblem::new((line, column), "", message))
    };
    let first = text.trim_start().chars().next();
    if let Some(first) = first.filter(|first| *first != '{') {
        let message = "not a needs.json of sphinx-needs";
        return Err(fail(1, 1, format!("{message}: found \"{first}\", expected an object")));
    }
    let parsed: NeedsFile = serde_json::from_str(text).map_err(|error| {
        let what = if error.is_data() { "not a needs.json of sphinx-needs" } else { "not JSON" };
        let message = error.to_string();
        let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(text, _)| text);
        fail(error.line().max(1), error.column().max(1), format!("{what}: {message}"))
    })?;
    let named = parsed_version(&parsed).map_err(|message| fail(1, 1, message))?;
    let (name, version, others) = current(named, parsed).map_err(|message| fail(1, 1, message))?;
    let own = Mapping::own();
    let program = version.creator.get("program").and_then(Value::as_str);
    let is_own = mapping.is_usual() && program == Some(crate::reqif::TOOL);
    let mapping = if is_own { &own } else { mapping };
    let mut reader = Reader::new(text, file, mapping, &version);
    if !others.is_empty() {
        reader.note(format!(
            "the versions {} are left out: {:?} is current",
            listed(&others),
            name.1
        ));
    }
    reader.head(&name, &version);
    reader.needs(version)
}

/// Checks the version of the format.
fn parsed_version(file: &NeedsFile) -> Result<String, String> {
    match &file.format_version {
        None => {}
        Some(found) if found.as_u64() == Some(FORMAT) => {}
        Some(found) => {
            return Err(format!(
                "format_version is {found}, and this Octant reads version {FORMAT}: it takes a newer Octant"
            ));
        }
    }
    if file.versions.is_none() {
        return Err("there is no \"versions\", expected a needs.json of sphinx-needs".to_owned());
    }
    let current = file.current_version.clone();
    current.ok_or_else(|| "there is no \"current_version\"".to_owned())
}

/// Project or version, the current version, and the names of the others.
type Current = ((String, String), NeedsVersion, Vec<String>);

fn current(current: String, file: NeedsFile) -> Result<Current, String> {
    let mut versions = file.versions.unwrap_or_default().0;
    let mut seen = HashSet::new();
    if let Some((name, _)) = versions.iter().find(|(name, _)| !seen.insert(name.clone())) {
        return Err(format!(
            "the version {name:?} is there a second time, expected unique versions"
        ));
    }
    let Some(at) = versions.iter().position(|(name, _)| *name == current) else {
        let names: Vec<&str> = versions.iter().map(|(name, _)| name.as_str()).collect();
        let known = suggestion(&current, names.iter().copied(), "known");
        return Err(format!(
            "current_version is {current:?}, which isn't among \"versions\", {known}"
        ));
    };
    let (name, version) = versions.swap_remove(at);
    if version.needs.is_none() {
        return Err(format!("the version {name:?} has no \"needs\""));
    }
    let mut others: Vec<String> = versions.into_iter().map(|(name, _)| name).collect();
    others.sort();
    let project = file.project.unwrap_or_default();
    Ok(((project, name), version, others))
}

struct Reader<'a> {
    file: &'a str,
    mapping: &'a Mapping,
    assembly: Assembly<'a>,
    escaped: bool,
    /// Fields that are left out, because sphinx-needs computes them.
    computed: BTreeSet<String>,
    /// Lines of the objects of the file, by their keys.
    keys: HashMap<String, VecDeque<usize>>,
}

/// A need as an object, with its links.
struct Need {
    object: Object,
    section: Vec<String>,
    under: Option<String>,
    parents: Vec<Parent>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str, file: &'a str, mapping: &'a Mapping, version: &NeedsVersion) -> Self {
        Self {
            file,
            mapping,
            assembly: Assembly::new(mapping, file),
            escaped: version.octant_escaped,
            computed: BTreeSet::new(),
            keys: keys(text),
        }
    }

    fn note(&mut self, message: impl Into<String>) {
        self.assembly.notes.push(Note::new(0, message));
    }

    fn head(&mut self, (project, version): &(String, String), of: &NeedsVersion) {
        let found = &mut self.assembly.found;
        let title = normal(project).replace('\n', " ");
        found.title = if title.is_empty() { "Requirements".to_owned() } else { title };
        if !version.trim().is_empty() {
            found.document.push((VERSION.to_owned(), normal(version).replace('\n', " ")));
        }
        if !of.octant_escaped {
            // Said, so that a document that is written from this one means the same.
            let option = (markup::OPTION.to_owned(), markup::DEFAULT.to_owned());
            found.document.push(option);
        }
    }

    /// Line of a need, from 1; 0 if it isn't found.
    fn line(&mut self, id: &str) -> usize {
        self.keys.get_mut(id).and_then(VecDeque::pop_front).unwrap_or(0)
    }

    fn needs(mut self, version: NeedsVersion) -> Result<Imported, RequirementsError> {
        let schema = NeedSchema::new(&version.needs_schema);
        if version.needs_defaults_removed && !schema.is_known() {
            let message =
                "needs_defaults_removed is true, and there is no needs_schema with the defaults";
            let problem = RequirementsProblem::new((1, 1), "", message);
            return Err(RequirementsError::one(self.file, problem));
        }
        let (mut needs, mut ids): (Vec<Need>, HashMap<String, usize>) = Default::default();
        for (id, mut value) in version.needs.unwrap_or_default().0 {
            if version.needs_defaults_removed
                && let Some(fields) = value.as_object_mut()
            {
                for (name, default) in schema.defaults() {
                    fields.entry(name.clone()).or_insert_with(|| default.clone());
                }
            }
            let line = self.line(&id);
            let at = Whereabouts::new(&*id, "", line);
            if let Some(first) = ids.get(&id) {
                let message = format!("is there a second time, the first is in line {first}");
                self.assembly.lost(&Lost { why: LeftOut::Again, at, message });
                continue;
            }
            match self.need(&id, &value, line, &schema) {
                Ok(need) => needs.push(need),
                Err(message) => {
                    self.assembly.lost(&Lost { why: LeftOut::Damaged, at, message });
                }
            }
            ids.insert(id, line);
        }
        self.mapping.check(&declared(&needs))?;
        self.assemble(needs);
        if !self.computed.is_empty() {
            let names: Vec<String> = std::mem::take(&mut self.computed).into_iter().collect();
            self.note(format!("computed by sphinx-needs, and left out: {}", names.join(", ")));
        }
        Ok(self.assembly.finish())
    }

    /// Reads a need.
    fn need(
        &mut self,
        id: &str,
        value: &Value,
        line: usize,
        schema: &NeedSchema<'_>,
    ) -> Result<Need, String> {
        let Some(fields) = value.as_object() else {
            return Err("is no object".to_owned());
        };
        let kind = fields.get("type").and_then(Value::as_str).unwrap_or(REQ).to_owned();
        let mut need = Need {
            object: Object {
                line,
                identifier: id.to_owned(),
                has_identifier: true,
                is_title_enough: true,
                kind,
                attributes: vec![attribute(
                    self.named("id"),
                    AttributeKind::Text,
                    vec![id.to_owned()],
                    line,
                )],
                ..Object::default()
            },
            section: Vec::new(),
            under: None,
            parents: Vec::new(),
        };
        if let Some(sections) = fields.get("sections").and_then(Value::as_array) {
            let titles = sections.iter().rev().filter_map(Value::as_str);
            need.section = titles.map(|title| normal(title).replace('\n', " ")).collect();
            need.section.retain(|title| !title.is_empty());
        }
        let mut lost = Vec::new();
        for (name, value) in fields {
            if schema.is_backlinks(name) || COMPUTED.contains(&name.as_str()) {
                if !is_empty(value) {
                    self.computed.insert(name.clone());
                }
            } else if schema.is_links(name) {
                links(&mut need, name, value);
            } else if !CORE.contains(&name.as_str()) {
                match self.attribute(name, value, line, schema) {
                    Ok(Some(found)) if name == "identifier" => {
                        need.object.kept_identifier = found.values.first().cloned();
                    }
                    Ok(found) => need.object.attributes.extend(found),
                    Err(message) if ["title", "content", "description"].contains(&&**name) => {
                        return Err(format!("has {message}"));
                    }
                    Err(message) => lost.push(message),
                }
            }
        }
        if let Some(other) =
            fields.get("doctype").and_then(Value::as_str).filter(|of| *of != ".rst")
        {
            lost.push(format!("the markup of its text, {other}"));
        }
        if !lost.is_empty() {
            need.object.repairs.push(Repair {
                kind: "with fields that are left out",
                detail: lost.join(", "),
                is_doubt: false,
            });
        }
        Ok(need)
    }

    /// Name of a field for the mapping: that of ReqIF in a file that this program wrote.
    fn named<'n>(&self, field: &'n str) -> &'n str {
        match field {
            "id" if self.mapping.own => FOREIGN_ID,
            "title" if self.mapping.own => NAME,
            "content" if self.mapping.own => TEXT,
            other => other,
        }
    }

    fn attribute(
        &self,
        name: &str,
        value: &Value,
        line: usize,
        schema: &NeedSchema<'_>,
    ) -> Result<Option<Attribute>, String> {
        if is_empty(value) {
            return Ok(None);
        }
        let text = |value: &Value| match value {
            Value::String(text) => Some(text.clone()),
            Value::Number(number) => Some(number.to_string()),
            Value::Bool(value) => Some(value.to_string()),
            _ => None,
        };
        let (texts, natural): (Option<Vec<String>>, AttributeKind) = match value {
            Value::Array(entries) => (entries.iter().map(text).collect(), AttributeKind::Text),
            Value::Bool(_) => (text(value).map(|text| vec![text]), AttributeKind::Boolean),
            Value::Number(number) => {
                let is_integer = number.as_i64().is_some();
                let kind = if is_integer { AttributeKind::Integer } else { AttributeKind::Real };
                (text(value).map(|text| vec![text]), kind)
            }
            other => (text(other).map(|text| vec![text]), AttributeKind::Text),
        };
        let Some(texts) = texts else { return Err(format!("{name}, which is no text")) };
        let is_content = ["content", "description"].contains(&name);
        let texts: Vec<String> = texts
            .iter()
            .map(|text| if is_content && self.escaped { markup::plain(text) } else { text.clone() })
            .map(|text| normal(&text))
            .filter(|text| !text.is_empty())
            .collect();
        if let Some(c) = texts.iter().find_map(|text| control(text)) {
            return Err(format!("{name}, which has the control character {c:?}"));
        }
        // An older or newer program may have written other values than the schema says.
        let kind =
            schema.kind(name).filter(|kind| octant_verdict::file::misfit(kind, &texts).is_none());
        let kind = kind.unwrap_or(natural);
        Ok((!texts.is_empty()).then(|| attribute(self.named(name), kind, texts, line)))
    }

    fn assemble(&mut self, needs: Vec<Need>) {
        let declared = declared(&needs);
        let mut before: HashSet<String> = HashSet::new();
        for mut need in needs {
            let of = declared.iter().find(|of| of.name == need.object.kind);
            let names = of.into_iter().flat_map(|of| &of.attributes).map(|(name, _)| name.clone());
            need.object.declared = Rc::new(names.collect());
            let usual = self.mapping.has_usual_information();
            let is_other = usual && NO_REQUIREMENTS.contains(&need.object.kind.as_str());
            if is_other || need.object.role(self.mapping) != Role::Requirement {
                self.assembly.informative(&need.object);
                continue;
            }
            let mut parents = Vec::new();
            let mut under = need.under;
            if let Some(id) = under.take_if(|id| !before.contains(id)) {
                parents.push(Parent { id, role: Some(PARENT_NEEDS.to_owned()) });
            }
            parents.extend(need.parents);
            let place = Place { section: need.section, under };
            let added = self.assembly.add(need.object, place, parents);
            if let Some(last) =
                self.assembly.found.requirements.last_mut().filter(|_| added.is_some())
                && last.kind.as_deref() == Some(REQ)
            {
                last.kind = None;
            }
            before.extend(added);
        }
    }
}

fn attribute(name: &str, kind: AttributeKind, values: Vec<String>, line: usize) -> Attribute {
    Attribute { name: name.to_owned(), kind, values, formatted: None, line }
}

/// Lines of the objects after the first `"needs"`, by their keys.
fn keys(text: &str) -> HashMap<String, VecDeque<usize>> {
    let lines = Lines::of(text);
    let mut keys: HashMap<String, VecDeque<usize>> = HashMap::new();
    let mut at = text.find("\"needs\"").unwrap_or(text.len());
    while let Some(found) = text[at..].find('"') {
        let begin = at + found;
        let Some(end) = end_of_string(text, begin) else { break };
        let rest = text[end..].trim_start();
        let is_key = rest.strip_prefix(':').is_some_and(|rest| rest.trim_start().starts_with('{'));
        if is_key && let Ok(key) = serde_json::from_str::<String>(&text[begin..end]) {
            keys.entry(key).or_default().push_back(lines.number(begin));
        }
        at = end;
    }
    keys
}

/// End of a JSON string that begins with a quote.
fn end_of_string(text: &str, begin: usize) -> Option<usize> {
    let mut at = begin + 1;
    loop {
        at += text.get(at..)?.find(['"', '\\'])?;
        if text.as_bytes().get(at) == Some(&b'"') {
            return Some(at + 1);
        }
        // The escaped character, which is one of ASCII.
        at += 2;
    }
}

fn is_empty(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::String(text) => text.trim().is_empty(),
        Value::Array(entries) => entries.is_empty(),
        Value::Object(entries) => entries.is_empty(),
        _ => false,
    }
}

/// Adds the parents of a field of links.
fn links(need: &mut Need, field: &str, value: &Value) {
    let ids = value.as_array().into_iter().flatten().filter_map(Value::as_str);
    for id in ids {
        let id = normal(id).replace('\n', " ");
        if id.is_empty() {
            continue;
        }
        if field == PARENT_NEEDS && need.under.is_none() {
            need.under = Some(id);
            continue;
        }
        let role = (field != LINKS).then(|| field.to_owned());
        need.parents.push(Parent { id, role });
    }
}

/// Types of the needs, with their fields.
fn declared(needs: &[Need]) -> Vec<DeclaredType> {
    let mut types: Vec<DeclaredType> = Vec::new();
    for need in needs {
        let kind = &need.object.kind;
        let at = types.iter().position(|of| of.name == *kind).unwrap_or_else(|| {
            types.push(DeclaredType { name: kind.clone(), attributes: Vec::new() });
            types.len() - 1
        });
        for attribute in &need.object.attributes {
            let attributes = &mut types[at].attributes;
            if !attributes.iter().any(|(name, _)| *name == attribute.name) {
                let options = attribute.kind.options().map(<[String]>::to_vec);
                attributes.push((attribute.name.clone(), options));
            }
        }
        // Every need has a text, even an empty one.
        if !types[at].attributes.iter().any(|(name, _)| name == "content") {
            types[at].attributes.push(("content".to_owned(), None));
        }
    }
    types
}
