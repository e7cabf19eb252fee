//! Definitions of attributes, which objects of several types can have in common.

use octant_verdict::file::misfit;
use octant_verdict::requirement::{AttributeKind, Definition, Requirement};

/// Definitions in the order of their first use.
#[derive(Default)]
pub(super) struct Definitions {
    all: Vec<(String, AttributeKind)>,
    /// Attributes whose kinds contradict each other.
    mixed: Vec<String>,
}

impl Definitions {
    /// Adds the kind that an attribute has in one type.
    pub(super) fn add(&mut self, name: &str, kind: &AttributeKind) {
        let Some((_, known)) = self.all.iter_mut().find(|(known, _)| known == name) else {
            self.all.push((name.to_owned(), kind.clone()));
            return;
        };
        if known == kind {
            return;
        }
        let choices =
            matches!(kind, AttributeKind::Choices(_)) || matches!(known, AttributeKind::Choices(_));
        match (known.options(), kind.options()) {
            (Some(first), Some(second)) => {
                let mut options = first.to_vec();
                options.extend(second.iter().filter(|o| !first.contains(o)).cloned());
                *known = if choices {
                    AttributeKind::Choices(options)
                } else {
                    AttributeKind::Choice(options)
                };
            }
            _ => {
                if !self.mixed.iter().any(|mixed| mixed == name) {
                    self.mixed.push(name.to_owned());
                }
                *known = AttributeKind::Text;
            }
        }
    }

    /// Returns the definitions that have to be kept, and messages about those that became text.
    pub(super) fn finish(self, requirements: &mut [Requirement]) -> (Vec<Definition>, Vec<String>) {
        let mut messages: Vec<String> = self
            .mixed
            .iter()
            .map(|name| format!("{name} has different types in different objects: it becomes text"))
            .collect();
        let mut definitions = Vec::new();
        for (name, kind) in self.all {
            if kind == AttributeKind::Text {
                continue;
            }
            let values = || {
                let attributes = requirements.iter().flat_map(|r| &r.attributes);
                attributes.filter(|a| a.name == name).map(|a| &a.values)
            };
            let bad = values().find_map(|values| Some((values, misfit(&kind, values)?)));
            match bad {
                // A number such as 1e400 is legal there, and none here.
                Some((values, expected)) => messages.push(format!(
                    "{name} is {:?}, expected {expected}: it becomes text",
                    values.join(", ")
                )),
                None => definitions.push(Definition { name, kind, field: None }),
            }
        }
        (definitions, messages)
    }
}
