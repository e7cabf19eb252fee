//! Steps of a person in the procedure of a run.

use crate::answer::{AnswerForm, AnswerKind};
use octant_faults::trigger::Trigger;
use std::time::Duration;

/// What follows a no.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnNo {
    /// The run ends.
    Abort,
    /// The question stays open.
    AskAgain,
    /// The run goes on: no is an answer as another.
    GoOn,
}

/// What follows a question that nobody answered in time. It never counts as an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnTimeout {
    /// The run ends.
    Abort,
    /// It is recorded, and the question stays open.
    Wait,
}

/// A step of a person in the procedure of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorStep {
    /// Name, unique in the scenario.
    pub id: String,
    /// The question, or what is to be done.
    pub ask: String,
    /// When it is asked; `None`: before the start, before a port is opened or a table turns.
    pub trigger: Option<Trigger>,
    /// What counts as an answer.
    pub form: AnswerForm,
    /// What follows a no.
    pub on_no: OnNo,
    /// How long the answer is waited for; `None`: as long as it takes.
    pub timeout: Option<Duration>,
    /// What follows then.
    pub on_timeout: OnTimeout,
    /// True if an answer without a name doesn't count.
    pub named: bool,
    /// True if the run stands still until the answer is there.
    pub holds: bool,
}

/// Parts of a step as a scenario has them.
#[derive(Clone, Debug)]
pub struct StepParts {
    /// Name.
    pub id: String,
    /// The question.
    pub ask: String,
    /// When it is asked.
    pub trigger: Option<Trigger>,
    /// Kind of answer.
    pub kind: AnswerKind,
    /// Unit of a number.
    pub unit: Option<String>,
    /// Least and greatest number.
    pub bounds: [Option<f64>; 2],
    /// Choices.
    pub choices: Option<Vec<String>>,
    /// What follows a no.
    pub on_no: Option<OnNo>,
    /// How long the answer is waited for, s.
    pub timeout_s: Option<f64>,
    /// What follows then.
    pub on_timeout: OnTimeout,
    /// True if the answer needs a name.
    pub named: bool,
    /// True if the run stands still.
    pub holds: bool,
}

/// Longest question, characters.
const ASK_LONGEST: usize = 1000;

impl OperatorStep {
    /// Makes a step after those before it. `runs_on` says why samples can't be stopped in the run; `last` is the number of
    /// its last sample, where that is known.
    ///
    /// # Errors
    /// If the parts contradict each other: the key, and what was found and expected.
    pub fn new(
        parts: StepParts,
        before: &[Self],
        runs_on: Option<&str>,
        last: Option<u64>,
    ) -> Result<Self, (&'static str, String)> {
        let is_name = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        let StepParts { id, ask, trigger, timeout_s, on_timeout, named, holds, .. } = &parts;
        if id.is_empty() || !id.chars().all(is_name) {
            let expected =
                "expected letters, digits, and - _ . only: it is written on a command line";
            return Err(("id", format!("found {id:?}, {expected}")));
        }
        if before.iter().any(|other| other.id == *id) {
            return Err(("id", format!("found {id:?} a second time, expected unique ids")));
        }
        if ask.trim().is_empty() || ask.chars().count() > ASK_LONGEST {
            return Err(("ask", format!("expected a text of up to {ASK_LONGEST} characters")));
        }
        if let Some(trigger) = trigger {
            check_trigger(trigger, last).map_err(|message| ("trigger", message))?;
        }
        if !holds && trigger.is_none() {
            let message = "found false without trigger: a run doesn't begin before its first questions are answered";
            return Err(("hold", message.to_owned()));
        }
        if let (true, Some(_), Some(why)) = (*holds, trigger, runs_on) {
            return Err((
                "hold",
                format!(
                    "samples can't be stopped: {why}. Expected hold = false, with which they go on while the \
                     question is open, or no trigger: then it is asked before the start"
                ),
            ));
        }
        let form = parts.form()?;
        let is_no = matches!(form, AnswerForm::Confirm | AnswerForm::YesNo);
        let on_no = match (&form, parts.on_no) {
            (AnswerForm::Confirm, Some(OnNo::GoOn)) => {
                let expected = "expected answer = \"yes-no\": a run doesn't go on without what is to be confirmed";
                return Err(("on_no", format!("found \"go-on\", {expected}")));
            }
            (_, Some(_)) if !is_no => {
                let expected = "which has no \"no\": expected answer = \"confirm\" or \"yes-no\"";
                return Err((
                    "on_no",
                    format!("found with answer = {:?}, {expected}", form.name()),
                ));
            }
            (_, Some(on_no)) => on_no,
            (AnswerForm::Confirm, None) => OnNo::Abort,
            (_, None) => OnNo::GoOn,
        };
        let timeout = timeout_s.map(Duration::try_from_secs_f64).transpose();
        let timeout = timeout.map_err(|error| ("timeout", error.to_string()))?;
        if timeout.is_none() && *on_timeout == OnTimeout::Wait {
            return Err((
                "on_timeout",
                "found without timeout, after which it would follow".to_owned(),
            ));
        }
        let (on_timeout, named, holds) = (*on_timeout, *named, *holds);
        let StepParts { id, ask, trigger, .. } = parts;
        Ok(Self { id, ask, trigger, form, on_no, timeout, on_timeout, named, holds })
    }
}

/// Reason why samples can't be stopped in the middle of a run with an instrument as its source, or by the clock.
#[must_use]
pub fn runs_on(instrument: bool, by_clock: bool) -> Option<&'static str> {
    let instrument = instrument.then_some("an instrument sends by a clock of its own");
    instrument.or(by_clock.then_some("they leave by the clock"))
}

impl StepParts {
    fn form(&self) -> Result<AnswerForm, (&'static str, String)> {
        let only = |key, kind| Err((key, format!("found without answer = {kind:?}, whose it is")));
        if self.kind != AnswerKind::Number {
            let [least, most] = self.bounds;
            let given = [
                ("unit", self.unit.is_some()),
                ("least", least.is_some()),
                ("most", most.is_some()),
            ];
            if let Some((key, _)) = given.into_iter().find(|(_, given)| *given) {
                return only(key, "number");
            }
        }
        if self.kind != AnswerKind::Choice && self.choices.is_some() {
            return only("choices", "choice");
        }
        Ok(match self.kind {
            AnswerKind::Confirm => AnswerForm::Confirm,
            AnswerKind::YesNo => AnswerForm::YesNo,
            AnswerKind::Text => AnswerForm::Text,
            AnswerKind::Number => {
                let [least, most] = self.bounds;
                if let (Some(least), Some(most)) = (least, most)
                    && !(least <= most)
                {
                    return Err((
                        "most",
                        format!("found {most}, expected {least} or more, which is least"),
                    ));
                }
                AnswerForm::Number { unit: self.unit.clone(), least, most }
            }
            AnswerKind::Choice => {
                let choices = self.choices.clone().unwrap_or_default();
                let is_bad = |text: &String| text.trim() != *text || text.is_empty();
                let twice = |i: usize| choices[..i].contains(&choices[i]);
                if choices.len() < 2 || choices.iter().any(is_bad) || (0..choices.len()).any(twice)
                {
                    return Err((
                        "choices",
                        "expected two or more texts, each once, with answer = \"choice\""
                            .to_owned(),
                    ));
                }
                AnswerForm::Choice(choices)
            }
        })
    }
}

/// Refuses triggers that come more than once, and those that never come.
fn check_trigger(trigger: &Trigger, last: Option<u64>) -> Result<(), String> {
    match trigger {
        Trigger::Epoch(first) if last.is_some_and(|last| *first > last) => Err(format!(
            "it is never asked: found sample {first}, and the run ends with sample {}",
            last.unwrap_or_default()
        )),
        Trigger::Epoch(_)
        | Trigger::Position { .. }
        | Trigger::Move { .. }
        | Trigger::Mode { .. } => Ok(()),
        Trigger::Condition { signal, .. } if !signal.needs_truth() => Ok(()),
        Trigger::Condition { .. } => Err(
            "found a signal of the truth, which nobody at a bench knows: expected one of the core"
                .to_owned(),
        ),
        _ => Err("a step comes once: expected one of at, sample, position, moving_to, mode, when"
            .to_owned()),
    }
}
