//! Signal dictionaries of a system: an entry is one place, which connections reach by way of any
//! reference to the dictionary.
//!
//! SSP 1.0 and 2.0, clauses "SignalDictionaries", "SignalDictionaryReference" and "Allowed
//! Connections": a name is looked up in the system of the reference, then in those around it; the
//! kind inout takes its direction from its connections; an entry has one writer.

use super::{Element, FlatReference, Flattener, HopEntry, Place, Role};
use crate::ssp::SspError;
use crate::ssp::structure::{DictionaryReference, SspSystem};
use octant_base::names::suggestion;

impl<'a> Flattener<'a> {
    /// Adds the dictionaries of a system, for references in it.
    pub(super) fn dictionaries(&mut self, system: &'a SspSystem, path: &str) {
        for dictionary in &system.dictionaries {
            self.scopes.push((&dictionary.name, self.elements.len()));
            self.elements.push(Element {
                path: super::join(path, &dictionary.name),
                connectors: &dictionary.entries,
                component: None,
                role: Role::Dictionary(dictionary),
            });
        }
    }

    /// Adds a reference to a dictionary; returns its number.
    pub(super) fn reference(
        &mut self,
        reference: &'a DictionaryReference,
        path: String,
    ) -> Result<usize, SspError> {
        let element = format!("SignalDictionaryReference {:?}", reference.name);
        let name = reference.dictionary.as_str();
        let found = self.scopes.iter().rev().find(|(known, _)| *known == name);
        let Some((_, number)) = found.copied() else {
            let known = suggestion(name, self.scopes.iter().map(|(known, _)| *known), "they have");
            let message = format!(
                "found the dictionary {name:?}, expected one of this system or of those around it, \
                 {known}"
            );
            return Err(self.error(reference.line, &element, message));
        };
        let target = &self.elements[number];
        let Role::Dictionary(dictionary) = target.role else {
            return Err(self.error(reference.line, &element, "it is no dictionary".to_owned()));
        };
        let mut connectors = Vec::with_capacity(reference.connectors.len());
        for connector in &reference.connectors {
            let entry = dictionary.entries.iter().find(|entry| entry.name == connector.name);
            let Some(entry) = entry else {
                let names = dictionary.entries.iter().map(|entry| entry.name.as_str());
                let message = format!(
                    "found no entry of this name in the signal dictionary {} ({}), {}",
                    target.path,
                    dictionary.file,
                    suggestion(&connector.name, names, "expected one of its entries")
                );
                let element = format!("Connector {:?} of {path}", connector.name);
                return Err(self.error(connector.line, &element, message));
            };
            connectors.push((connector.clone(), entry.clone()));
        }
        self.references.push(FlatReference {
            name: path.clone(),
            connectors,
            dictionary: target.path.clone(),
            units: dictionary.units.clone(),
        });
        let own = self.elements.len();
        self.elements.push(Element {
            path,
            connectors: &reference.connectors,
            component: None,
            role: Role::Reference(number),
        });
        for binding in &reference.bindings {
            for parameter in self.bound(binding) {
                self.give(own, &[], parameter);
            }
        }
        Ok(own)
    }

    /// Returns the place that a connector means: for one of a reference, the entry.
    pub(super) fn meant(&self, place: Place) -> Place {
        match self.elements[place.0].role {
            Role::Reference(dictionary) => (dictionary, place.1),
            Role::Plain | Role::Dictionary(_) => place,
        }
    }

    /// Describes the entry at a place, if it is one.
    pub(super) fn entry(&self, place: &Place) -> Option<HopEntry> {
        let element = &self.elements[place.0];
        let Role::Dictionary(dictionary) = element.role else { return None };
        let entry = dictionary.entries.iter().find(|entry| entry.name == place.1)?;
        Some(HopEntry::of(&element.path, dictionary, entry))
    }

    /// Returns the name of a place for messages.
    pub(super) fn named(&self, place: &Place) -> String {
        match self.entry(place) {
            Some(entry) => entry.to_string(),
            None => super::join(&self.elements[place.0].path, &place.1),
        }
    }
}
