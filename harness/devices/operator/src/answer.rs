//! Forms of answers: what counts as one, and its stored text.

use octant_base::names::suggestion;

/// Kind of an answer, as a scenario names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnswerKind {
    /// Yes, or the run ends.
    Confirm,
    /// Yes or no.
    YesNo,
    /// A number within bounds.
    Number,
    /// A text.
    Text,
    /// One of several texts.
    Choice,
}

/// What counts as an answer.
#[derive(Clone, Debug, PartialEq)]
pub enum AnswerForm {
    /// Yes, or the run ends.
    Confirm,
    /// Yes or no.
    YesNo,
    /// A number within bounds.
    Number {
        /// Unit, for the reader.
        unit: Option<String>,
        /// Least value.
        least: Option<f64>,
        /// Greatest value.
        most: Option<f64>,
    },
    /// A text.
    Text,
    /// One of these texts.
    Choice(Vec<String>),
}

/// Most characters of an answer.
pub const LONGEST: usize = 1000;

/// Error of an answer: what was found, and what is expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UnfitAnswer(pub String);

impl AnswerForm {
    /// Name of the kind.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Confirm => "confirm",
            Self::YesNo => "yes-no",
            Self::Number { .. } => "number",
            Self::Text => "text",
            Self::Choice(_) => "choice",
        }
    }

    /// Describes what is expected, for the person who is asked.
    #[must_use]
    pub fn expected(&self) -> String {
        match self {
            Self::Confirm | Self::YesNo => "yes or no".to_owned(),
            Self::Number { unit, least, most } => {
                let bounds = match (least, most) {
                    (Some(least), Some(most)) => format!(" from {least} to {most}"),
                    (Some(least), None) => format!(" of {least} or more"),
                    (None, Some(most)) => format!(" of {most} or less"),
                    (None, None) => String::new(),
                };
                let unit = unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
                format!("a number{bounds}{unit}")
            }
            Self::Text => "a text".to_owned(),
            Self::Choice(choices) => format!("one of {}", choices.join(", ")),
        }
    }

    /// Reads an answer as it is stored: `yes` or `no`, a number, a text, the choice.
    ///
    /// # Errors
    /// If it is none.
    pub fn read(&self, text: &str) -> Result<String, UnfitAnswer> {
        let text = text.trim();
        let expected = || Err(UnfitAnswer(format!("found {text:?}, expected {}", self.expected())));
        if text.chars().count() > LONGEST {
            return Err(UnfitAnswer(format!("found more than {LONGEST} characters")));
        }
        if text.is_empty() || text.chars().any(char::is_control) {
            return expected();
        }
        match self {
            Self::Confirm | Self::YesNo => match text.to_ascii_lowercase().as_str() {
                "yes" | "y" => Ok("yes".to_owned()),
                "no" | "n" => Ok("no".to_owned()),
                _ => expected(),
            },
            Self::Number { unit, least, most } => {
                // The unit may be repeated, and no other.
                let number = unit.as_ref().and_then(|unit| text.strip_suffix(unit.as_str()));
                let number = number.unwrap_or(text).trim();
                let Ok(value) = number.parse::<f64>() else { return expected() };
                let within = value.is_finite()
                    && least.is_none_or(|least| value >= least)
                    && most.is_none_or(|most| value <= most);
                if within { Ok(number.to_owned()) } else { expected() }
            }
            Self::Text => Ok(text.to_owned()),
            Self::Choice(choices) => match choices.iter().find(|choice| *choice == text) {
                Some(choice) => Ok(choice.clone()),
                None => {
                    let known = suggestion(text, choices.iter().map(String::as_str), "possible");
                    Err(UnfitAnswer(format!("found {text:?}, {known}")))
                }
            },
        }
    }
}
