//! Names of variables: unique, and in the grammar of structured names.

use super::finding::Findings;
use super::model::{Declared, Model};
use super::rules::{
    VARIABLE_ARRAY_GAPS, VARIABLE_DESCRIPTION, VARIABLE_NAME, VARIABLE_STRUCTURED, VARIABLE_UNIQUE,
};
use octant_fmu_host::description::Causality;
use std::collections::{BTreeMap, BTreeSet};

/// Checks the names.
pub(super) fn check(model: &Model<'_, '_>, findings: &mut Findings) {
    let mut lines: BTreeMap<&str, u32> = BTreeMap::new();
    let mut arrays = SingleElements::default();
    for declared in &model.variables {
        let variable = declared.variable;
        let aliases = variable.aliases.iter().map(|alias| alias.name.as_str());
        for name in std::iter::once(variable.name.as_str()).chain(aliases) {
            if let Some(line) = lines.get(name) {
                let found = format!("{name:?} is the name of line {line} as well");
                model.broken(findings, &VARIABLE_UNIQUE, declared, found, "another name");
            } else {
                lines.insert(name, variable.line);
            }
            one(model, declared, name, findings);
        }
        if model.description.structured_names {
            arrays.add(&variable.name);
        }
    }
    let mut firsts: BTreeMap<&str, &Declared<'_, '_>> = BTreeMap::new();
    for declared in &model.variables {
        if let Some((base, _)) = declared.variable.name.rsplit_once('[') {
            firsts.entry(base).or_insert(declared);
        }
    }
    for (base, missing, present) in arrays.gaps() {
        if let Some(declared) = firsts.get(base.as_str()) {
            let found = format!("{base}[…] has {present} elements, but no {base}[{missing}]");
            model.broken(findings, &VARIABLE_ARRAY_GAPS, declared, found, "all elements");
        }
    }
    without_description(model, findings);
}

fn one(model: &Model<'_, '_>, declared: &Declared<'_, '_>, name: &str, findings: &mut Findings) {
    if name.is_empty() {
        model.broken(findings, &VARIABLE_NAME, declared, "an empty name", "a name");
    } else if let Some(c) = name.chars().find(|c| matches!(c, '\n' | '\r' | '\t')) {
        let found = format!("a name with U+{:04X}", c as u32);
        model.broken(findings, &VARIABLE_NAME, declared, found, "a name of one line, without tabs");
    } else if model.description.structured_names
        && let Err(at) = structured(name)
    {
        let found = format!(
            "{:?} at character {} of {name:?}",
            &name[at..],
            name[..at].chars().count() + 1
        );
        let expected = "identifiers or 'quoted names' with [indices], separated by dots, or der(…)";
        model.broken(findings, &VARIABLE_STRUCTURED, declared, found, expected);
    }
}

/// Adds one note on all variables without description.
fn without_description(model: &Model<'_, '_>, findings: &mut Findings) {
    let public = |declared: &&Declared<'_, '_>| {
        matches!(
            declared.variable.causality,
            Causality::Input
                | Causality::Output
                | Causality::Parameter
                | Causality::StructuralParameter
        )
    };
    let all: Vec<&Declared<'_, '_>> = model.variables.iter().filter(public).collect();
    let bare: Vec<_> = all.iter().filter(|d| d.variable.description.trim().is_empty()).collect();
    if let Some(first) = bare.first() {
        let found = format!(
            "{} of {} inputs, outputs and parameters have no description",
            bare.len(),
            all.len()
        );
        model.broken(findings, &VARIABLE_DESCRIPTION, first, found, "what each is");
    }
}

/// Checks that a name follows the grammar of structured names; `Err`: the byte at which it
/// deviates.
///
/// # Errors
/// If it doesn't follow.
pub fn structured(name: &str) -> Result<(), usize> {
    let mut reader = Reader { name, at: 0 };
    if name.starts_with("der(") {
        reader.at = 4;
        reader.identifier()?;
        if reader.eat(b',') {
            // The grammar has no blank here; nor has its own example.
            reader.digits()?;
        }
        reader.expect(b')')?;
    } else {
        reader.identifier()?;
    }
    if reader.at == name.len() { Ok(()) } else { Err(reader.at) }
}

struct Reader<'a> {
    name: &'a str,
    at: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<u8> {
        self.name.as_bytes().get(self.at).copied()
    }

    fn eat(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, byte: u8) -> Result<(), usize> {
        if self.eat(byte) { Ok(()) } else { Err(self.at) }
    }

    fn digits(&mut self) -> Result<(), usize> {
        let start = self.at;
        while self.peek().is_some_and(|b| b.is_ascii_digit()) {
            self.at += 1;
        }
        if self.at > start { Ok(()) } else { Err(start) }
    }

    fn identifier(&mut self) -> Result<(), usize> {
        loop {
            self.part()?;
            if self.eat(b'[') {
                self.digits()?;
                while self.eat(b',') {
                    self.digits()?;
                }
                self.expect(b']')?;
            }
            if !self.eat(b'.') {
                return Ok(());
            }
        }
    }

    fn part(&mut self) -> Result<(), usize> {
        if self.eat(b'\'') {
            let start = self.at;
            loop {
                match self.peek() {
                    Some(b'\'') if self.at > start => {
                        self.at += 1;
                        return Ok(());
                    }
                    Some(b'\\') => {
                        self.at += 1;
                        match self.peek() {
                            Some(
                                b'\'' | b'"' | b'?' | b'\\' | b'a' | b'b' | b'f' | b'n' | b'r'
                                | b't' | b'v',
                            ) => self.at += 1,
                            _ => return Err(self.at),
                        }
                    }
                    Some(b)
                        if b.is_ascii_alphanumeric()
                            || b"_!#$%&()*+,-./:;<>=?@[]^{}|~ ".contains(&b) =>
                    {
                        self.at += 1;
                    }
                    _ => return Err(self.at),
                }
            }
        }
        match self.peek() {
            Some(b) if b.is_ascii_alphabetic() || b == b'_' => self.at += 1,
            _ => return Err(self.at),
        }
        while self.peek().is_some_and(|b| b.is_ascii_alphanumeric() || b == b'_') {
            self.at += 1;
        }
        Ok(())
    }
}

/// Elements of arrays that are separate variables: `a.b[1,2]`.
#[derive(Clone, Debug, Default)]
pub struct SingleElements {
    /// Indices by the part of the name before the last bracket.
    indices: BTreeMap<String, BTreeSet<Vec<u32>>>,
}

impl SingleElements {
    /// Takes the name of a variable; one that is no element is passed over.
    pub fn add(&mut self, name: &str) {
        let Some((base, rest)) = name.rsplit_once('[') else { return };
        let Some(list) = rest.strip_suffix(']') else { return };
        let indices: Result<Vec<u32>, _> = list.split(',').map(str::parse).collect();
        if let Ok(indices) = indices {
            self.indices.entry(base.to_owned()).or_default().insert(indices);
        }
    }

    /// Arrays with gaps: name, the first missing indices, number of existing elements.
    #[must_use]
    pub fn gaps(&self) -> Vec<(String, String, usize)> {
        let mut gaps = Vec::new();
        for (base, present) in &self.indices {
            let Some(first) = present.first() else { continue };
            let rank = first.len();
            if present.iter().any(|indices| indices.len() != rank) {
                continue;
            }
            let limit = |of: fn(u32, u32) -> u32, axis: usize| {
                present.iter().map(|indices| indices[axis]).reduce(of).unwrap_or(0)
            };
            // The indices start at 0 or at 1, depending on the tool.
            let low: Vec<u32> = (0..rank).map(|axis| limit(u32::min, axis).min(1)).collect();
            let high: Vec<u32> = (0..rank).map(|axis| limit(u32::max, axis)).collect();
            let sizes =
                low.iter().zip(&high).map(|(&low, &high)| u64::from(high) - u64::from(low) + 1);
            let expected = sizes.fold(1u64, u64::saturating_mul);
            if expected == present.len() as u64 {
                continue;
            }
            // The first gap comes at the latest after all existing elements.
            let mut indices = low.clone();
            while present.contains(&indices) {
                for axis in (0..rank).rev() {
                    if indices[axis] < high[axis] {
                        indices[axis] += 1;
                        break;
                    }
                    indices[axis] = low[axis];
                }
            }
            let missing: Vec<String> = indices.iter().map(u32::to_string).collect();
            gaps.push((base.clone(), missing.join(","), present.len()));
        }
        gaps
    }
}
