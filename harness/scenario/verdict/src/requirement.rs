//! Definition of a requirement: a statement with an id and a verification.

use crate::verdict::Comparison;
use octant_account::Account;
use serde::{Deserialize, Serialize};

/// A limit as it was written. Its value is known to the code that knows the units.
#[derive(Clone, Debug, PartialEq)]
pub enum Limit {
    /// A quantity, `3 arcmin`.
    Quantity(String),
    /// A number in the unit of the measure.
    Number(f64),
}

/// Reason why a text is neither a quantity nor a number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {found:?}, expected a quantity such as \"3 arcmin\", or a number")]
pub struct LimitError {
    /// Text found.
    pub found: String,
}

impl Limit {
    /// Text of the limit; [`Limit::of_text`] parses it.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Quantity(text) => text.clone(),
            Self::Number(number) => format!("{number:?}"),
        }
    }

    /// Parses a number, or a number with a unit.
    ///
    /// # Errors
    /// If it doesn't begin with a number, or the number isn't finite.
    pub fn of_text(text: &str) -> Result<Self, LimitError> {
        let text = text.trim();
        if let Ok(number) = text.parse::<f64>() {
            return if number.is_finite() {
                Ok(Self::Number(number))
            } else {
                Err(LimitError { found: text.to_owned() })
            };
        }
        let first = text.trim_start_matches(['+', '-']).trim_start_matches('.');
        if first.starts_with(|c: char| c.is_ascii_digit()) && !text.contains('\n') {
            Ok(Self::Quantity(text.to_owned()))
        } else {
            Err(LimitError { found: text.to_owned() })
        }
    }
}

/// Required probability for an ensemble of runs: a run passes with at least this probability, shown
/// with this confidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnsembleRequirement {
    /// Probability that a run passes, above 0 and below 1.
    pub pass: f64,
    /// One-sided confidence, at least 0.5 and below 1.
    pub confidence: f64,
}

/// Reason why a text is no probability.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProbabilityError {
    /// The text is no percentage.
    #[error("found {found:?}, expected a percentage such as \"95 %\"")]
    Percentage {
        /// Text found.
        found: String,
    },
    /// The percentage is out of range.
    #[error("found {found:?}, expected more than 0 % and less than 100 %")]
    Range {
        /// Text found.
        found: String,
    },
    /// The percentage is too low for a confidence.
    #[error(
        "found {found:?}, expected a confidence of at least 50 %: with less the opposite is as likely"
    )]
    Confidence {
        /// Text found.
        found: String,
    },
    /// The number can't be shifted by two digits.
    #[error("found {found:?}")]
    Number {
        /// Text found.
        found: String,
    },
}

/// Parses a probability in percent, `95 %`.
///
/// # Errors
/// If it is no probability, or not between 0 and 100 %.
pub fn probability(text: &str) -> Result<f64, ProbabilityError> {
    let found = || text.to_owned();
    let percent = text.trim().strip_suffix('%').and_then(|n| n.trim_end().parse::<f64>().ok());
    match percent {
        // The decimal point is shifted in the text, so that 86.4 % is the double written as 0.864.
        Some(percent) if percent > 0.0 && percent < 100.0 => {
            format!("{percent}e-2").parse().map_err(|_| ProbabilityError::Number { found: found() })
        }
        Some(_) => Err(ProbabilityError::Range { found: found() }),
        None => Err(ProbabilityError::Percentage { found: found() }),
    }
}

/// Parses a confidence in percent, `95 %`.
///
/// # Errors
/// If it is no probability, or below 50 %.
pub fn confidence(text: &str) -> Result<f64, ProbabilityError> {
    let found = probability(text)?;
    if found < 0.5 {
        return Err(ProbabilityError::Confidence { found: text.to_owned() });
    }
    Ok(found)
}

/// Text of a probability above 0 and below 1, which [`probability`] parses to the same number.
#[must_use]
pub fn percent(probability: f64) -> String {
    let decimal = probability.to_string();
    let digits = decimal.strip_prefix("0.").unwrap_or(&decimal);
    let (whole, part) = match digits.split_at_checked(2) {
        Some(split) => split,
        None => return format!("{digits}0 %"),
    };
    let whole = whole.trim_start_matches('0');
    let whole = if whole.is_empty() { "0" } else { whole };
    if part.is_empty() { format!("{whole} %") } else { format!("{whole}.{part} %") }
}

/// A measure with its limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Path of the measure in the summary of a run.
    pub measure: String,
    /// Comparison with the limit.
    pub comparison: Comparison,
    /// The limit.
    pub limit: Limit,
    /// True if the limit is multiplied by the secant of the site's latitude.
    pub secant_latitude: bool,
    /// Required probability for many runs; without it every run has to pass.
    pub ensemble: Option<EnsembleRequirement>,
}

/// Verification of a requirement.
#[derive(Clone, Debug, PartialEq)]
pub enum Verification {
    /// Verified by runs.
    Test(Check),
    /// Verified by tests outside of this program's runs, by their names: at least one, none with `;` in
    /// it.
    Tests(Vec<String>),
    /// Verified by analysis outside of this program.
    Analysis,
    /// Verified by inspection.
    Inspection,
    /// Not yet decided: it is listed, and inconclusive, until somebody says how it is verified.
    Open,
}

impl Verification {
    /// Name used in files.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Test(_) | Self::Tests(_) => "test",
            Self::Analysis => "analysis",
            Self::Inspection => "inspection",
            Self::Open => "open",
        }
    }
}

/// Requirement that another one is derived from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parent {
    /// Id of the parent.
    pub id: String,
    /// Kind of the relation, if stated.
    pub role: Option<String>,
}

/// An attribute of another tool, which this program doesn't interpret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForeignAttribute {
    /// Name.
    pub name: String,
    /// Values: several for a multiple choice, or for a field that occurs several times.
    pub values: Vec<String>,
}

/// Formatting of a text, as XHTML. It counts as long as its plain text is the text itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormattedText {
    /// Attribute of ReqIF with the text: `ReqIF.Text`, or the name of another attribute.
    pub name: String,
    /// Elements of XHTML, without a prefix.
    pub xhtml: String,
}

/// A requirement.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// Id for people, unique: checks and reports name it.
    pub id: String,
    /// Statement of the requirement, a sentence.
    pub text: String,
    /// Short name.
    pub title: Option<String>,
    /// Verification.
    pub verification: Verification,
    /// Document and clause of its origin.
    pub clause: Option<String>,
    /// Reason for the requirement.
    pub rationale: Option<String>,
    /// Requirements that it is derived from.
    pub parents: Vec<Parent>,
    /// Titles of its sections, from the outermost.
    pub section: Vec<String>,
    /// Id of the requirement before it that it stands below, as an indented one.
    pub under: Option<String>,
    /// Type, if it is not simply a requirement: `SYSTEM_REQUIREMENT`.
    pub kind: Option<String>,
    /// Identifier for machines: the MID of StrictDoc, the IDENTIFIER of ReqIF.
    pub identifier: Option<String>,
    /// Attributes of other tools.
    pub attributes: Vec<ForeignAttribute>,
    /// Formatting of its texts, where they have one.
    pub formatted: Vec<FormattedText>,
}

impl Requirement {
    /// Makes a requirement with only the mandatory parts.
    #[must_use]
    pub fn new(id: &str, text: &str, verification: Verification) -> Self {
        Self {
            id: id.to_owned(),
            text: text.to_owned(),
            title: None,
            verification,
            clause: None,
            rationale: None,
            parents: Vec::new(),
            section: Vec::new(),
            under: None,
            kind: None,
            identifier: None,
            attributes: Vec::new(),
            formatted: Vec::new(),
        }
    }

    /// Check by which runs verify it, if there is one.
    #[must_use]
    pub const fn check(&self) -> Option<&Check> {
        match &self.verification {
            Verification::Test(check) => Some(check),
            _ => None,
        }
    }
}

/// Kind of an attribute's values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AttributeKind {
    /// Text, with or without formatting.
    Text,
    /// A whole number.
    Integer,
    /// A number.
    Real,
    /// True or false.
    Boolean,
    /// A date in the form of XML Schema.
    Date,
    /// One of several options.
    Choice(Vec<String>),
    /// Any of several options.
    Choices(Vec<String>),
}

impl AttributeKind {
    /// Name used in files.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Integer => "integer",
            Self::Real => "real",
            Self::Boolean => "boolean",
            Self::Date => "date",
            Self::Choice(_) => "choice",
            Self::Choices(_) => "choices",
        }
    }

    /// Options of a choice.
    #[must_use]
    pub fn options(&self) -> Option<&[String]> {
        match self {
            Self::Choice(options) | Self::Choices(options) => Some(options),
            _ => None,
        }
    }
}

/// Definition of an attribute of other tools, for all requirements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// Name.
    pub name: String,
    /// Kind of its values.
    pub kind: AttributeKind,
    /// Name in StrictDoc, which allows only capitals, digits and `_`, if it is another one.
    pub field: Option<String>,
}

/// A document of requirements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Requirements {
    /// Title of the document.
    pub title: String,
    /// Other fields in the head of the document: `VERSION`, `OPTIONS.MARKUP`.
    pub document: Vec<(String, String)>,
    /// Definitions of attributes of other tools; an attribute without one is plain text.
    pub definitions: Vec<Definition>,
    /// The requirements.
    pub requirements: Vec<Requirement>,
    /// Accounts of the documents of other tools that they came from.
    pub accounts: Vec<Account>,
}

impl Requirements {
    /// Lists the reasons why what rests on these requirements is inconclusive: parts of their documents are missing.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        self.accounts.iter().flat_map(Account::doubts).collect()
    }

    /// Requirement with an id.
    #[must_use]
    pub fn get(&self, id: &str) -> Option<&Requirement> {
        self.requirements.iter().find(|r| r.id == id)
    }

    /// Kind of an attribute's values.
    #[must_use]
    pub fn kind(&self, name: &str) -> AttributeKind {
        self.definitions
            .iter()
            .find(|d| d.name == name)
            .map_or(AttributeKind::Text, |d| d.kind.clone())
    }

    /// Names of all attributes used or defined, in the order of their occurrence.
    #[must_use]
    pub fn attribute_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.definitions.iter().map(|d| d.name.as_str()).collect();
        let mut seen: std::collections::HashSet<&str> = names.iter().copied().collect();
        for attribute in self.requirements.iter().flat_map(|r| &r.attributes) {
            if seen.insert(&attribute.name) {
                names.push(&attribute.name);
            }
        }
        names
    }
}
