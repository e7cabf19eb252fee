//! Finds variables by the names in scenarios, and builds the message where there is none.

use super::convert::article;
use octant_fmu_host::description::{Causality, Description, Variability, Variable};

/// Direction of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueWay {
    /// Out of the FMU.
    Out,
    /// Into the FMU, at every step.
    In,
}

impl ValueWay {
    /// Variable that this direction needs, with its article.
    const fn expected(self) -> &'static str {
        match self {
            Self::Out => "an output",
            Self::In => "an input",
        }
    }
}

/// Elements to which a name refers.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundElements<'a> {
    /// Variable of each element, with the index of the element in it, from 0.
    pub elements: Vec<(&'a Variable, usize)>,
    /// True if a minus sign stood before the name.
    pub negated: bool,
}

/// Looks up a name: a variable, all elements `name[1]` … of an array whose elements are scalars in
/// the file, or one element `name[2]` of an array; each also after a minus sign.
#[must_use]
pub fn find<'a>(
    description: &'a Description,
    name: &str,
    elements: usize,
) -> Option<FoundElements<'a>> {
    let found = |name: &str| plain(description, name.trim(), elements);
    if let Some(elements) = found(name) {
        return Some(FoundElements { elements, negated: false });
    }
    let elements = found(name.trim().strip_prefix('-')?)?;
    Some(FoundElements { elements, negated: true })
}

fn plain<'a>(
    description: &'a Description,
    name: &str,
    elements: usize,
) -> Option<Vec<(&'a Variable, usize)>> {
    let named = |name: &str| description.variable(name);
    if let Some(variable) = named(name) {
        let count = count(description, variable);
        return Some((0..count).map(|element| (variable, element)).collect());
    }
    if elements > 1 {
        let each = (1..=elements).map(|n| Some((named(&format!("{name}[{n}]"))?, 0)));
        if let Some(all) = each.collect() {
            return Some(all);
        }
    }
    let (array, index) = name.strip_suffix(']')?.rsplit_once('[')?;
    let (variable, index) = (named(array)?, index.trim().parse::<usize>().ok()?);
    (1..=count(description, variable)).contains(&index).then(|| vec![(variable, index - 1)])
}

/// Counts the elements of a variable, with the start values of structural parameters; 0 if it isn't
/// known.
#[must_use]
pub fn count(description: &Description, variable: &Variable) -> usize {
    description.elements(variable).unwrap_or(0)
}

/// A variable that can't be used in a direction.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{variable} is {} of the FMU, expected {}", article(in_words(*.causality)), .way.expected())]
pub struct DirectionError {
    /// Name of the variable.
    pub variable: String,
    /// Causality found.
    pub causality: Causality,
    /// Direction expected.
    pub way: ValueWay,
}

fn in_words(causality: Causality) -> &'static str {
    match causality {
        Causality::StructuralParameter => "structural parameter",
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculated parameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local variable",
        Causality::Independent => "independent variable",
    }
}

/// Checks that a variable can be used in a direction.
///
/// # Errors
/// If its causality doesn't allow it: found and expected.
pub fn allowed(variable: &Variable, way: ValueWay) -> Result<(), DirectionError> {
    match (way, variable.causality) {
        (ValueWay::Out, Causality::Output | Causality::Local | Causality::CalculatedParameter)
        | (ValueWay::In, Causality::Input) => Ok(()),
        (ValueWay::In, Causality::Parameter) if variable.variability == Variability::Tunable => {
            Ok(())
        }
        (way, causality) => Err(DirectionError { variable: variable.name.clone(), causality, way }),
    }
}

/// A name that no variable has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct UnknownVariable {
    /// Name found.
    pub name: String,
    /// Suitable names that exist, the nearest first; three at most.
    pub nearest: Vec<String>,
    /// True if the nearest one is similar to the name.
    pub is_similar: bool,
}

impl std::fmt::Display for UnknownVariable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = &self.name;
        let list =
            || self.nearest.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
        if self.nearest.is_empty() {
            write!(f, "the FMU has no variable {name:?}, and none that could be meant")
        } else if self.is_similar {
            write!(f, "the FMU has no variable {name:?}; nearest are {}", list())
        } else {
            write!(f, "the FMU has no variable {name:?}; it has {}, …", list())
        }
    }
}

/// Finds the suitable names nearest to one that no variable has.
#[must_use]
pub fn unknown(
    description: &Description,
    name: &str,
    could: impl Fn(&Variable) -> bool,
) -> UnknownVariable {
    let name = name.trim();
    let mut near: Vec<(f64, &str)> = description
        .variables
        .iter()
        .filter(|variable| could(variable))
        .map(|variable| {
            let like = strsim::jaro_winkler(
                &name.to_ascii_lowercase(),
                &variable.name.to_ascii_lowercase(),
            );
            (like, variable.name.as_str())
        })
        .collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    near.truncate(3);
    UnknownVariable {
        name: name.to_owned(),
        is_similar: near.first().is_some_and(|(like, _)| *like > 0.75),
        nearest: near.into_iter().map(|(_, name)| name.to_owned()).collect(),
    }
}

/// Describes a variable for messages: `the Boolean x`.
pub(crate) fn described(variable: &Variable) -> String {
    format!("the {} {}", variable.kind.name(), variable.name)
}
