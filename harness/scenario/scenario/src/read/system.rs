//! Requirements on a system of FMUs: reading of everything that needs no system.

use super::faults::connection::Given;
use crate::error::{FileProblems, Place, Problem};
use crate::keys::{Keys, RequirementKeys, SystemRequirementsKeys};
use octant_verdict::Comparison;

/// A requirement on a signal of a system, as far as it is known without the system.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemRequirement {
    /// Id.
    pub id: String,
    /// Text of the requirement.
    pub text: String,
    /// Measure: `signal.NAME.max`, perhaps between bars.
    pub measure: String,
    /// Comparison with the limit.
    pub comparison: Comparison,
    /// Limit: a number in the unit of the signal, or a quantity.
    pub limit: Given,
    /// Place and path of the measure and of the limit.
    places: [(Place, String); 2],
}

impl SystemRequirement {
    /// Makes a problem of the measure.
    #[must_use]
    pub fn measure_problem(&self, message: impl Into<String>) -> Problem {
        let (place, path) = self.places[0].clone();
        Problem { place, path, message: message.into() }
    }

    /// Makes a problem of the limit.
    #[must_use]
    pub fn limit_problem(&self, message: impl Into<String>) -> Problem {
        let (place, path) = self.places[1].clone();
        Problem { place, path, message: message.into() }
    }
}

/// Reads a list of requirements on a system. `file` names it in errors.
///
/// # Errors
/// If it isn't TOML or not such a list: every problem with its place.
pub fn system_requirements(text: &str, file: &str) -> Result<Vec<SystemRequirement>, FileProblems> {
    SystemRequirementsKeys::parse(
        text,
        file,
        |_, _| (),
        |keys| read(keys.requirements.as_deref().unwrap_or_default()),
    )
}

fn read(keys: &[RequirementKeys]) -> Result<Vec<SystemRequirement>, Problem> {
    let mut all: Vec<SystemRequirement> = Vec::with_capacity(keys.len());
    for RequirementKeys { id, text, measure, limit, comparison, .. } in keys {
        if id.trim().is_empty() {
            return Err(id.problem("found an empty text, expected an identifier"));
        }
        if all.iter().any(|other| other.id == **id) {
            let message = format!("found {:?} a second time, expected unique ids", **id);
            return Err(id.problem(message));
        }
        let of = |problem: Problem| (problem.place, problem.path);
        all.push(SystemRequirement {
            id: id.to_string(),
            text: text.clone(),
            measure: measure.to_string(),
            comparison: *comparison,
            limit: match limit.text.as_str() {
                "" => Given::Number(**limit),
                text => Given::Text(text.to_owned()),
            },
            places: [of(measure.problem("")), of(limit.problem(""))],
        });
    }
    Ok(all)
}
