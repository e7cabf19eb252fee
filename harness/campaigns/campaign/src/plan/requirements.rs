//! Requirements of a campaign: read from their file and put into its cases.

use octant_account::AccountEntry;
use octant_requirements::Imported;
use octant_requirements::exchange::{self, ExchangeError};
use octant_requirements::format::ExchangeFormat;
use octant_scenario::read::requirement::{MeasureTextError, limit_of, path_of};
use octant_verdict::file::{Checker, read};
use octant_verdict::requirement::{Check, EnsembleRequirement, Limit, Requirement, Requirements};
use octant_verdict::signed;
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{RequirementsError, RequirementsProblem};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Requirement of a campaign's file that is verified by runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Planned {
    /// Check of a case.
    pub check: LimitCheck,
    /// Requirement on all cases together; without it every case must pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ensemble: Option<EnsembleRequirement>,
}

/// Provides the measures of a summary, and their units; formatted texts are those of ReqIF.
#[derive(Clone, Copy, Debug)]
pub struct Measures;

impl Checker for Measures {
    fn measure(&self, measure: &str) -> Result<(), String> {
        path_of(measure).map(|_| ()).map_err(|error| error.to_string())
    }

    fn limit(&self, measure: &str, limit: &Limit) -> Result<(), String> {
        number(measure, limit).map(|_| ()).map_err(|error| error.to_string())
    }

    fn formatted(&self, xhtml: &str) -> Result<(), String> {
        octant_requirements::xhtml::check(xhtml).map_err(|error| error.to_string())
    }
}

fn number(measure: &str, limit: &Limit) -> Result<f64, MeasureTextError> {
    match limit {
        Limit::Number(number) => Ok(*number),
        Limit::Quantity(text) => limit_of(path_of(measure)?, text),
    }
}

/// Reads a file of requirements, whose measures and limits must be those of a run: a `requirements.toml`, or a document of
/// another tool, whose account and hash are among the accounts then.
///
/// # Errors
/// If it can't be read or isn't valid: every problem with its place.
pub fn load(path: &Path) -> Result<Requirements, RequirementsError> {
    let file = path.display().to_string();
    if !path.is_dir() && matches!(ExchangeFormat::of(path), Some(format) if is_document(format)) {
        return document(path, &file);
    }
    let text = std::fs::read_to_string(path).map_err(|error| RequirementsError {
        file: file.clone(),
        problems: vec![RequirementsProblem {
            line: 1,
            column: 1,
            path: String::new(),
            message: error.to_string(),
        }],
    })?;
    let requirements = read(&text, &file, &Measures)?;
    let problems = one_sided(&requirements, &text);
    if problems.is_empty() { Ok(requirements) } else { Err(RequirementsError { file, problems }) }
}

/// Returns whether a format is one of another tool, in one file.
fn is_document(format: ExchangeFormat) -> bool {
    !matches!(format, ExchangeFormat::Toml | ExchangeFormat::Doorstop)
}

/// Reads a document of another tool, with the usual names of attributes.
fn document(path: &Path, file: &str) -> Result<Requirements, RequirementsError> {
    let fail = |message: String| RequirementsError {
        file: file.to_owned(),
        problems: vec![RequirementsProblem::new((1, 1), "", message)],
    };
    let imported = exchange::read(path, None, &Measures).map_err(|error| match error {
        ExchangeError::Requirements(error) => error,
        other => fail(other.to_string()),
    })?;
    let bytes = std::fs::read(path).map_err(|error| fail(error.to_string()))?;
    let Imported { mut requirements, account, .. } = imported;
    // A document can be in another folder where the plan is read again.
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let hash = format!("BLAKE3 of the document {}", blake3::hash(&bytes).to_hex());
    let names = "its attributes have the usual names";
    let account = account
        .renamed(name)
        .note(AccountEntry::fact(true, hash))
        .note(AccountEntry::fact(true, names));
    requirements.accounts.push(account);
    let mut problems = Vec::new();
    for requirement in &requirements.requirements {
        let Some(check) = requirement.check() else { continue };
        let measure = Measures.measure(&check.measure);
        if let Err(error) = measure.and_then(|()| Measures.limit(&check.measure, &check.limit)) {
            let of = format!("requirements.{}.measure", requirement.id);
            problems.push(RequirementsProblem::new((1, 1), of, error));
        }
    }
    problems.extend(one_sided(&requirements, ""));
    if problems.is_empty() {
        Ok(requirements)
    } else {
        Err(RequirementsError { file: file.to_owned(), problems })
    }
}

/// Finds limits on only one side of a signed measure, and limits that no value breaks.
fn one_sided(requirements: &Requirements, text: &str) -> Vec<RequirementsProblem> {
    let checks = || requirements.requirements.iter().filter_map(|r| Some((&r.id, r.check()?)));
    let both = || checks().map(|(_, check)| (check.measure.as_str(), check.comparison));
    let problem = |(id, check): (&String, &Check)| {
        let this = (check.measure.as_str(), check.comparison);
        let limit = number(&check.measure, &check.limit).unwrap_or(f64::NAN);
        let message =
            signed::one_sided(this, both()).or_else(|| signed::unbreakable(this, limit))?;
        let quoted = format!("\"{}\"", check.measure);
        let at = |line: &str| Some(line.find(&quoted)? + 1);
        let (line, column) = (text.lines().enumerate())
            .find_map(|(line, text)| Some((line + 1, at(text)?)))
            .unwrap_or((1, 1));
        Some(RequirementsProblem {
            line,
            column,
            path: format!("requirements.{id}.measure"),
            message,
        })
    };
    checks().filter_map(problem).collect()
}

/// Lists the requirements of a file that are verified by runs.
pub(crate) fn planned(requirements: &Requirements) -> Vec<Planned> {
    let of = |requirement: &Requirement| {
        let check = requirement.check()?;
        Some(Planned {
            check: LimitCheck {
                id: requirement.id.clone(),
                measure: check.measure.clone(),
                comparison: check.comparison,
                // The limit was checked when the file was read.
                limit: number(&check.measure, &check.limit).unwrap_or(f64::NAN),
                secant_latitude: check.secant_latitude,
            },
            ensemble: check.ensemble,
        })
    };
    requirements.requirements.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;

    #[test]
    fn a_limit_that_no_value_breaks_is_refused_at_its_line() {
        let text = "schema = 1\ntitle = \"Short\"\n\n[[requirements]]\nid = \"NAV-1\"\ntext = \"No drift.\"\n\
                    measure = \"navigation.radial_error_nmi.max\"\ncomparison = \">=\"\nlimit = \"0 nmi\"\n";
        let requirements = read(text, "short.toml", &Measures).unwrap();
        let problems = one_sided(&requirements, text);
        assert_eq!((problems.len(), problems[0].line), (1, 7), "{problems:?}");
        assert!(problems[0].message.contains("every value would pass"), "{problems:?}");
    }

    #[test]
    fn a_limit_on_one_side_of_a_sign_is_refused_at_its_line() {
        let text = "schema = 1\ntitle = \"Short\"\n\n[[requirements]]\nid = \"NAV-1\"\ntext = \"No drift.\"\n\
                    measure = \"navigation.latitude_error_arcmin.final\"\nlimit = \"10 arcmin\"\n";
        let requirements = read(text, "short.toml", &Measures).unwrap();
        let problems = one_sided(&requirements, text);
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert_eq!((problems[0].line, problems[0].column), (7, 11));
        assert_eq!(problems[0].path, "requirements.NAV-1.measure");
    }
}
