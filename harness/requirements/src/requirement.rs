//! What a requirement is: a statement with an id, and how it is verified.

use crate::verdict::Comparison;
use serde::{Deserialize, Serialize};

/// A limit as it was written. What it is worth is known to who knows the units.
#[derive(Clone, Debug, PartialEq)]
pub enum Limit {
    /// A quantity, `3 arcmin`.
    Quantity(String),
    /// A number in the unit of the measure.
    Number(f64),
}

impl Limit {
    /// The limit as text; [`Limit::of_text`] takes it back.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Quantity(text) => text.clone(),
            Self::Number(number) => format!("{number:?}"),
        }
    }

    /// A number, or a number with what follows it.
    ///
    /// # Errors
    /// In plain words, if it doesn't begin with a number, or that isn't finite.
    pub fn of_text(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let expected = "expected a quantity such as \"3 arcmin\", or a number";
        if let Ok(number) = text.parse::<f64>() {
            return if number.is_finite() {
                Ok(Self::Number(number))
            } else {
                Err(format!("found {text:?}, {expected}"))
            };
        }
        let first = text.trim_start_matches(['+', '-']).trim_start_matches('.');
        if first.starts_with(|c: char| c.is_ascii_digit()) && !text.contains('\n') {
            Ok(Self::Quantity(text.to_owned()))
        } else {
            Err(format!("found {text:?}, {expected}"))
        }
    }
}

/// What has to hold of an ensemble of runs: a run passes with at least this probability, shown with
/// this confidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ensemble {
    /// Probability that a run passes, above 0 and below 1.
    pub pass: f64,
    /// One-sided confidence, above 0 and below 1.
    pub confidence: f64,
}

/// A probability as it is written, `95 %`.
///
/// # Errors
/// In plain words, if it isn't one, or not between 0 and 100 %.
pub fn probability(text: &str) -> Result<f64, String> {
    let percent = text.trim().strip_suffix('%').and_then(|n| n.trim_end().parse::<f64>().ok());
    match percent {
        // Shifted as a decimal: 86.4 % is the double that is written 0.864.
        Some(percent) if percent > 0.0 && percent < 100.0 => {
            format!("{percent}e-2").parse().map_err(|_| format!("found {text:?}"))
        }
        Some(_) => Err(format!("found {text:?}, expected more than 0 % and less than 100 %")),
        None => Err(format!("found {text:?}, expected a percentage such as \"95 %\"")),
    }
}

/// A probability above 0 and below 1 as [`probability`] takes it back, to the same number.
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

/// A measure, and the limit that it has to keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Path of the measure in the summary of a run.
    pub measure: String,
    /// How it is held against the limit.
    pub comparison: Comparison,
    /// The limit.
    pub limit: Limit,
    /// What has to hold of many runs; without it every run has to pass.
    pub ensemble: Option<Ensemble>,
}

/// How a requirement is verified.
#[derive(Clone, Debug, PartialEq)]
pub enum Verification {
    /// By runs.
    Test(Check),
    /// By tests outside of this program's runs, by their names: at least one, none with `;` in it.
    Tests(Vec<String>),
    /// By reasoning outside of this program.
    Analysis,
    /// By looking at it.
    Inspection,
    /// Nobody has said yet. Imports have it; `requirements.toml` is refused with it.
    Open,
}

impl Verification {
    /// The name used in files.
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

/// The requirement that another one is derived from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parent {
    /// Its id.
    pub id: String,
    /// What kind of relation it is, where that is said.
    pub role: Option<String>,
}

/// An attribute that this program doesn't know, of the tool where the requirement is at home.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attribute {
    /// Its name.
    pub name: String,
    /// Its values; several of a multiple choice, or of a field that is there several times.
    pub values: Vec<String>,
}

/// A requirement.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// Id that people use, unique: checks and reports name it.
    pub id: String,
    /// What is required, as a sentence.
    pub text: String,
    /// A short name.
    pub title: Option<String>,
    /// How it is verified.
    pub verification: Verification,
    /// Document and clause where it comes from.
    pub clause: Option<String>,
    /// Why it is required.
    pub rationale: Option<String>,
    /// What it is derived from.
    pub parents: Vec<Parent>,
    /// Titles of the sections that it stands in, from the outermost.
    pub section: Vec<String>,
    /// What it is called where it is not plainly a requirement: `SYSTEM_REQUIREMENT`.
    pub kind: Option<String>,
    /// Identifier that machines use: the MID of StrictDoc, the IDENTIFIER of ReqIF.
    pub identifier: Option<String>,
    /// Attributes of other tools.
    pub attributes: Vec<Attribute>,
}

impl Requirement {
    /// A requirement with nothing but what it has to have.
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
            kind: None,
            identifier: None,
            attributes: Vec::new(),
        }
    }

    /// How it is verified by runs, if it is.
    #[must_use]
    pub const fn check(&self) -> Option<&Check> {
        match &self.verification {
            Verification::Test(check) => Some(check),
            _ => None,
        }
    }
}

/// What an attribute of another tool takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Text, with or without formatting.
    Text,
    /// A whole number.
    Integer,
    /// A number.
    Real,
    /// True or false.
    Boolean,
    /// A date, as XML Schema writes it.
    Date,
    /// One of several options.
    Choice(Vec<String>),
    /// Any of several options.
    Choices(Vec<String>),
}

impl Kind {
    /// The name used in files.
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

    /// The options, of a choice.
    #[must_use]
    pub fn options(&self) -> Option<&[String]> {
        match self {
            Self::Choice(options) | Self::Choices(options) => Some(options),
            _ => None,
        }
    }
}

/// An attribute of other tools, for all requirements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// Its name.
    pub name: String,
    /// What it takes.
    pub kind: Kind,
    /// Its name in StrictDoc, where only capitals, digits and `_` are legal, if that is another one.
    pub field: Option<String>,
}

/// A document of requirements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Requirements {
    /// Title of the document.
    pub title: String,
    /// What else the head of the document says: `VERSION`, `OPTIONS.MARKUP`.
    pub document: Vec<(String, String)>,
    /// Attributes of other tools that aren't plain text; one that isn't here is.
    pub definitions: Vec<Definition>,
    /// The requirements.
    pub requirements: Vec<Requirement>,
}

impl Requirements {
    /// The requirement of an id.
    #[must_use]
    pub fn get(&self, id: &str) -> Option<&Requirement> {
        self.requirements.iter().find(|r| r.id == id)
    }

    /// What an attribute takes.
    #[must_use]
    pub fn kind(&self, name: &str) -> Kind {
        self.definitions.iter().find(|d| d.name == name).map_or(Kind::Text, |d| d.kind.clone())
    }

    /// Names of all attributes that are used or defined, in the order in which they come.
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
