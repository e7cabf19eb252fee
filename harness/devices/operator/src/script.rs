//! Files of answers, for runs in which nobody is asked: written by hand as TOML, or the journal of another run.

use crate::journal;
use crate::record::{Act, OperatorRecord};
use crate::step::{OnNo, OperatorStep};
use octant_base::names::suggestion;
use octant_toml_tree::error::{Place, Problem};
use serde::Deserialize;
use std::path::Path;

/// Error of a file of answers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("read {file}: {problem}")]
pub struct ScriptError {
    /// The file.
    pub file: String,
    /// Reason: found and expected.
    pub problem: String,
}

/// An answer of a file.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScriptAnswer {
    /// Step of the scenario.
    pub id: String,
    /// The answer.
    pub value: String,
    /// Who gives it.
    #[serde(default)]
    pub by: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnswerFile {
    #[serde(default)]
    answer: Vec<ScriptAnswer>,
}

/// Reads the answers of a file to the steps of a scenario, in the order of the steps. A file that ends with `.jsonl` is a
/// journal, any other is TOML.
///
/// # Errors
/// If the file can't be read, a step has no answer or two, or an answer doesn't fit its step.
pub fn read(path: &Path, steps: &[OperatorStep]) -> Result<Vec<ScriptAnswer>, ScriptError> {
    let wrong = |problem: String| ScriptError { file: path.display().to_string(), problem };
    let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    let answers = if path.extension().is_some_and(|extension| extension == "jsonl") {
        let records = journal::parse(&text)
            .map_err(|(line, problem)| wrong(format!("line {line}: {problem}")))?;
        same_questions(&records, steps).map_err(wrong)?;
        records.into_iter().filter_map(answer_of).collect()
    } else {
        octant_toml_tree::read_as::<AnswerFile>(&text)
            .map_err(|problem| wrong(told(&problem)))?
            .answer
    };
    in_order(answers, steps).map_err(wrong)
}

/// A problem in one line, behind its place.
fn told(problem: &Problem) -> String {
    let message = problem.message.lines().collect::<Vec<_>>().join(", ");
    match problem.place {
        Place::File { line, column } => format!("line {line}, column {column}: {message}"),
        _ => message,
    }
}

/// Checks that a journal has the questions of these steps: an answer to another one is none.
fn same_questions(records: &[OperatorRecord], steps: &[OperatorStep]) -> Result<(), String> {
    for record in records {
        let OperatorRecord { act: Act::Asked, step: Some(id), ask: Some(ask), .. } = record else {
            continue;
        };
        if let Some(step) = steps.iter().find(|step| step.id == *id && step.ask != *ask) {
            return Err(format!("answer to {id:?}: it was asked {ask:?}, expected {:?}", step.ask));
        }
    }
    Ok(())
}

fn answer_of(record: OperatorRecord) -> Option<ScriptAnswer> {
    let OperatorRecord { act: Act::Answered, step: Some(id), value: Some(value), by, .. } = record
    else {
        return None;
    };
    Some(ScriptAnswer { id, value, by })
}

fn in_order(
    answers: Vec<ScriptAnswer>,
    steps: &[OperatorStep],
) -> Result<Vec<ScriptAnswer>, String> {
    for (index, answer) in answers.iter().enumerate() {
        let id = &answer.id;
        if !steps.iter().any(|step| step.id == *id) {
            let known = suggestion(id, steps.iter().map(|step| step.id.as_str()), "steps");
            return Err(format!("answer to {id:?}, which is no step of the scenario, {known}"));
        }
        if answers[..index].iter().any(|other| other.id == *id) {
            return Err(format!("a second answer to {id:?}, expected one to each step"));
        }
    }
    let mut all = Vec::with_capacity(steps.len());
    for step in steps {
        let id = &step.id;
        let Some(answer) = answers.iter().find(|answer| answer.id == *id) else {
            return Err(format!("no answer to {id:?}: expected one to each step of the scenario"));
        };
        let value =
            step.form.read(&answer.value).map_err(|unfit| format!("answer to {id:?}: {unfit}"))?;
        if value == "no" && step.on_no == OnNo::AskAgain {
            return Err(format!("answer to {id:?}: found \"no\", after which it is asked again"));
        }
        if step.named && answer.by.as_ref().is_none_or(|by| by.trim().is_empty()) {
            return Err(format!("answer to {id:?}: expected by, since who = \"required\""));
        }
        all.push(ScriptAnswer { value, ..answer.clone() });
    }
    Ok(all)
}
