//! Reading of ReqIF files: one, or all of an archive together.

use super::identifier::identifier;
use super::parse::{ParsedFile, Relation, parse};
use crate::error::{Imported, Note, listed};
use crate::foreign::{Assembly, Object, Place, Role};
use crate::ledger::{LeftOut, Lost, Whereabouts};
use crate::mapping::Mapping;
use octant_verdict::RequirementsError;
use octant_verdict::requirement::Parent;
use std::collections::{HashMap, HashSet};

/// Reads a `.reqif` with the usual names of attributes.
///
/// # Errors
/// As [`read_mapped`].
pub fn read(text: &str, file: &str) -> Result<Imported, RequirementsError> {
    read_mapped(text, file, &Mapping::default())
}

/// Reads a `.reqif`.
///
/// Several specifications in one file become one document, in which the title of each is a section of
/// the first level. An object without an id or a text, with the id of another, or with parts that the file
/// doesn't define, is left out: the account counts it, and a note names it. A requirement whose
/// attributes make no complete check is read with an open verification, with a note.
///
/// # Errors
/// If the text isn't XML or not ReqIF, with the line, or if the mapping names what the file doesn't have.
pub fn read_mapped(
    text: &str,
    file: &str,
    mapping: &Mapping,
) -> Result<Imported, RequirementsError> {
    combine(vec![parse(text, file, "")?], file, mapping)
}

/// Reads the files of an archive, which can refer to each other: names and texts.
pub(super) fn read_all(
    files: &[(String, String)],
    archive: &str,
    mapping: &Mapping,
) -> Result<Imported, RequirementsError> {
    let parsed: Result<Vec<ParsedFile>, RequirementsError> =
        files.iter().map(|(name, text)| parse(text, &inside(archive, name), name)).collect();
    combine(parsed?, archive, mapping)
}

/// Name of a file in an archive.
pub(super) fn inside(archive: &str, name: &str) -> String {
    if name.is_empty() { archive.to_owned() } else { format!("{archive}/{name}") }
}

/// All objects of the files, by their identifiers.
struct Objects {
    all: HashMap<String, Object>,
    order: Vec<String>,
    /// Identifiers of objects that were left out.
    lost: HashSet<String>,
}

impl Objects {
    /// Collects the objects of all files; those that can't be used are left out.
    fn collect(files: &mut [ParsedFile], assembly: &mut Assembly<'_>) -> Self {
        let mut objects = Objects { all: HashMap::new(), order: Vec::new(), lost: HashSet::new() };
        for file in files {
            for lost in file.lost.drain(..) {
                assembly.lost(&lost);
                objects.lost.insert(lost.at.name);
            }
            for object in file.objects.drain(..) {
                let id = object.identifier.clone();
                let Some(first) = objects.all.get(&id) else {
                    objects.order.push(id.clone());
                    objects.all.insert(id, object);
                    continue;
                };
                let at = object.at();
                // Tools export what two documents share with both of them.
                let is_copy = first.file != object.file && object.is_copy_of(first);
                let (why, message) = if is_copy {
                    (LeftOut::Copy, format!("is in {} too, which is kept", first.file))
                } else if first.file == object.file {
                    (
                        LeftOut::Again,
                        format!("is there a second time, the first is in line {}", first.line),
                    )
                } else {
                    (
                        LeftOut::Again,
                        format!("is in {} with another content, which is kept", first.file),
                    )
                };
                assembly.lost(&Lost { why, at, message });
            }
        }
        objects
    }
}

/// A node above the present one in a hierarchy.
enum Above {
    Section(String),
    Requirement(String),
    /// An object that is no requirement, or that was left out.
    Nothing,
}

struct Combiner<'a> {
    objects: Objects,
    mapping: &'a Mapping,
    assembly: Assembly<'a>,
    /// Relations of each object, with the name of their file.
    relations: HashMap<String, Vec<(Relation, String)>>,
    /// Ids of the requirements, by identifier.
    ids: HashMap<String, String>,
}

fn combine(
    mut files: Vec<ParsedFile>,
    archive: &str,
    mapping: &Mapping,
) -> Result<Imported, RequirementsError> {
    let own = Mapping::own();
    let is_own = mapping.is_usual() && files.iter().all(|file| file.is_own);
    let mapping = if is_own { &own } else { mapping };
    let types: Vec<_> = files.iter_mut().flat_map(|file| file.types.drain(..)).collect();
    mapping.check(&types)?;
    let mut assembly = Assembly::new(mapping, archive);
    assembly.notes = files.iter_mut().flat_map(|file| file.notes.drain(..)).collect();
    if files.iter().any(|file| file.is_of_2010) {
        assembly.ledger.fact("the namespace of 2010 is read as that of ReqIF 1.2");
    }
    let objects = Objects::collect(&mut files, &mut assembly);
    let mut combiner =
        Combiner { objects, mapping, assembly, relations: HashMap::new(), ids: HashMap::new() };
    for file in &mut files {
        for relation in file.relations.drain(..) {
            let source = relation.source.clone();
            combiner.relations.entry(source).or_default().push((relation, file.name.clone()));
        }
    }
    combiner.title(&mut files);
    combiner.place(&files);
    combiner.unplaced();
    combiner.relate();
    Ok(combiner.assembly.finish())
}

impl Combiner<'_> {
    /// Sets title and head of the document.
    fn title(&mut self, files: &mut [ParsedFile]) {
        let mut all = files.iter_mut().flat_map(|file| &mut file.specifications);
        let found = &mut self.assembly.found;
        found.title = "Requirements".to_owned();
        match (all.next(), all.next()) {
            (Some(only), None) => {
                found.title.clone_from(&only.title);
                found.document = std::mem::take(&mut only.document);
            }
            (Some(first), Some(second)) => {
                let attributes = all.chain([first, second]).any(|s| !s.document.is_empty());
                let left_out = if attributes { ", and their attributes are left out" } else { "" };
                let message =
                    format!("several documents become one, in which each is a section{left_out}");
                self.assembly.notes.push(Note::new(0, message));
            }
            _ => {}
        }
    }

    /// Adds the objects of all hierarchies in their order.
    fn place(&mut self, files: &[ParsedFile]) {
        let several = files.iter().map(|file| file.specifications.len()).sum::<usize>() > 1;
        let mut placed: HashSet<&str> = HashSet::new();
        for file in files {
            for specification in &file.specifications {
                let mut above: Vec<(usize, Above)> = Vec::new();
                if several {
                    above.push((0, Above::Section(specification.title.clone())));
                }
                for (depth, line, id) in &specification.nodes {
                    above.retain(|(at, _)| at < depth);
                    if !placed.insert(id) {
                        let message = format!("the object {id} is in the hierarchy again");
                        let note = Note::new(*line, message).in_file(&file.name);
                        self.assembly.notes.push(note);
                        continue;
                    }
                    let node = match self.objects.all.remove(id) {
                        Some(object) => self.object(object, &above),
                        None => {
                            self.absent(&Whereabouts::new(id, &file.name, *line));
                            Above::Nothing
                        }
                    };
                    above.push((*depth, node));
                }
            }
        }
    }

    /// Notes an object that a hierarchy has and the file doesn't.
    fn absent(&mut self, at: &Whereabouts) {
        if self.objects.lost.contains(&at.name) {
            return;
        }
        self.assembly.ledger.missing(at);
        let message = format!("the hierarchy has an object {:?} that isn't in the file", at.name);
        self.assembly.notes.push(Note::new(at.line, message).in_file(&at.file));
    }

    /// Adds the objects that no hierarchy has.
    fn unplaced(&mut self) {
        let mut names = Vec::new();
        for id in std::mem::take(&mut self.objects.order) {
            let Some(object) = self.objects.all.remove(&id) else { continue };
            names.push(id);
            self.object(object, &[]);
        }
        if !names.is_empty() {
            let message =
                format!("in no specification, and so at the end: the objects {}", listed(&names));
            self.assembly.notes.push(Note::new(0, message));
        }
    }

    fn object(&mut self, object: Object, above: &[(usize, Above)]) -> Above {
        match object.role(self.mapping) {
            Role::Heading(title, false) => {
                self.assembly.heading(&object);
                return Above::Section(title);
            }
            Role::Heading(title, true) => {
                self.assembly.informative(&object);
                return Above::Section(title);
            }
            Role::Informative => {
                self.assembly.informative(&object);
                return Above::Nothing;
            }
            Role::Requirement => {}
        }
        let section = above.iter().filter_map(|(_, above)| match above {
            Above::Section(title) => Some(title.clone()),
            _ => None,
        });
        let under = above.iter().rev().find_map(|(_, above)| match above {
            Above::Requirement(id) => Some(id.clone()),
            _ => None,
        });
        let place = Place { section: section.collect(), under };
        let key = object.identifier.clone();
        let Some(id) = self.assembly.add(object, place, Vec::new()) else { return Above::Nothing };
        if let Some(last) = self.assembly.found.requirements.last_mut() {
            // An identifier that this program made from the id adds nothing.
            last.identifier = last.identifier.take().filter(|of| *of != identifier(&id));
        }
        self.ids.insert(key, id.clone());
        Above::Requirement(id)
    }

    /// Sets the parents of all requirements.
    fn relate(&mut self) {
        let by_id: HashMap<&str, usize> = (self.assembly.found.requirements.iter().enumerate())
            .map(|(index, requirement)| (requirement.id.as_str(), index))
            .collect();
        let mut parents: Vec<(usize, Parent)> = Vec::new();
        let mut notes: Vec<(String, usize, String)> = Vec::new();
        for (source, relations) in &self.relations {
            for (Relation { target, role, line, .. }, file) in relations {
                match (self.ids.get(source), self.ids.get(target)) {
                    (Some(id), Some(parent)) => {
                        let parent = Parent { id: parent.clone(), role: role.clone() };
                        parents.extend(by_id.get(id.as_str()).map(|index| (*index, parent)));
                    }
                    (None, _) | (_, None) => {
                        let message = format!(
                            "the relation from {source:?} to {target:?} is left out: both ends have to \
                             be requirements of the file"
                        );
                        notes.push((file.clone(), *line, message));
                    }
                }
            }
        }
        for (index, parent) in parents {
            self.assembly.found.requirements[index].parents.push(parent);
        }
        notes.sort();
        let notes =
            notes.into_iter().map(|(file, line, message)| Note::new(line, message).in_file(&file));
        self.assembly.notes.extend(notes);
    }
}
