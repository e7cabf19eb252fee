//! Records of what a person was asked, answered and did.

use serde::{Deserialize, Serialize};

/// Version of the layout of a record.
pub const SCHEMA: u32 = 1;

/// Way on which an answer or a request came.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AnswerWay {
    /// Terminal of the run.
    Terminal,
    /// Command in another process.
    Command,
    /// Page in a browser.
    Page,
    /// File of answers.
    File,
}

impl AnswerWay {
    /// Name in records.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Terminal => "terminal",
            Self::Command => "command",
            Self::Page => "page",
            Self::File => "file",
        }
    }
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Act {
    /// A question was asked.
    Asked,
    /// It was answered.
    Answered,
    /// Nobody answered it in time.
    Overdue,
    /// The run was held.
    Held,
    /// It went on.
    Resumed,
    /// It was aborted.
    Aborted,
    /// It ended while the question was open.
    Unanswered,
    /// It ended before the question was asked.
    NeverAsked,
}

impl Act {
    /// Name in records.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Asked => "asked",
            Self::Answered => "answered",
            Self::Overdue => "overdue",
            Self::Held => "held",
            Self::Resumed => "resumed",
            Self::Aborted => "aborted",
            Self::Unanswered => "unanswered",
            Self::NeverAsked => "never-asked",
        }
    }
}

/// One event of a person's part in a run: a line of `operator.jsonl`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OperatorRecord {
    /// Version of this layout.
    pub schema: u32,
    /// Number of the record, from 1.
    pub number: u32,
    /// Host time, UTC, RFC 3339.
    pub at: String,
    /// What happened.
    pub act: Act,
    /// Step of the scenario; `null` where the act belongs to none.
    pub step: Option<String>,
    /// The question, when it was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ask: Option<String>,
    /// What was expected as an answer, when it was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expected: Option<String>,
    /// The answer, or the reason of an end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<String>,
    /// Unit of a number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Name that the person gave; `null` without one, and where nobody acted.
    pub by: Option<String>,
    /// Way on which it came; `null` where nobody acted.
    pub way: Option<AnswerWay>,
    /// Time from the question to this, or of a hold, s of the host.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after_s: Option<f64>,
    /// Sample before which it was asked or held, from 1; `null` before the start, and where it isn't known.
    pub sample: Option<u64>,
}

impl OperatorRecord {
    /// Describes it in a line, without its time.
    #[must_use]
    pub fn text(&self) -> String {
        let step = self.step.as_ref().map_or(String::new(), |step| format!(" {step}"));
        let mut text = format!("{}{step}", self.act.name());
        for value in [&self.ask, &self.value].into_iter().flatten() {
            text += &format!(": {value}");
        }
        text += &self.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
        text += &self.by.as_ref().map_or(String::new(), |by| format!(", by {by}"));
        text += &self.way.map_or(String::new(), |way| format!(" ({})", way.name()));
        text += &self.after_s.map_or(String::new(), |after_s| format!(", after {after_s:.1} s"));
        text
    }
}
