//! The desk of a run: its open questions, the answers of which the first counts, and the requests of the operator.

use crate::answer::AnswerForm;
use crate::journal::Journal;
use crate::record::{Act, AnswerWay, OperatorRecord, SCHEMA};
use crate::script::ScriptAnswer;
use crate::step::{OnNo, OnTimeout, OperatorStep};
use octant_base::attendance::Attendance;
use octant_base::names::suggestion;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Instant, SystemTime};

/// Most characters of a name.
const NAME_LONGEST: usize = 200;

/// The desk of a run. Every way to a person goes through it.
#[derive(Debug)]
pub struct Desk {
    state: Mutex<DeskState>,
    attendance: Arc<Attendance>,
}

#[derive(Debug)]
struct DeskState {
    questions: Vec<Question>,
    records: Vec<OperatorRecord>,
    journal: Journal,
    /// Reason why the run can't be held.
    runs_on: Option<String>,
    /// Answers of a file, in the order of the steps.
    script: Option<Vec<ScriptAnswer>>,
    held: Option<Instant>,
    aborted: Option<String>,
    over: bool,
}

#[derive(Debug)]
struct Question {
    step: OperatorStep,
    state: QuestionState,
    sample: Option<u64>,
}

#[derive(Clone, Debug)]
enum QuestionState {
    Waiting,
    Open { since: Instant, overdue: bool },
    Closed { answer: String },
}

/// A question that is open.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenQuestion {
    /// Step of the scenario.
    pub id: String,
    /// The question.
    pub ask: String,
    /// What counts as an answer.
    pub form: AnswerForm,
    /// True if the answer needs a name.
    pub named: bool,
    /// True if the run stands still until the answer is there.
    pub holds: bool,
    /// Time since it was asked, s.
    pub asked_s: f64,
    /// Time until it is overdue, s; `None`: it waits for as long as it takes.
    pub left_s: Option<f64>,
}

/// Reasons why the desk doesn't take an answer or a request.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeskRefusal {
    /// The scenario has no such step.
    #[error("no step {id:?} in the scenario, {known}")]
    Unknown {
        /// The step.
        id: String,
        /// Steps that there are.
        known: String,
    },
    /// The step isn't asked yet.
    #[error("step {id:?} isn't asked yet")]
    NotYet {
        /// The step.
        id: String,
    },
    /// Somebody was faster.
    #[error("step {id:?} is answered already: {answer}; the first answer counts")]
    Late {
        /// The step.
        id: String,
        /// The answer that counts.
        answer: String,
    },
    /// The answer doesn't fit.
    #[error("answer to {id:?}: {problem}")]
    Unfit {
        /// The step.
        id: String,
        /// Reason: found and expected.
        problem: String,
    },
    /// The request isn't possible now.
    #[error("{0}")]
    Impossible(String),
}

impl Desk {
    /// Makes the desk of a run in this folder. `runs_on` says why it can't be held, `script` has the answers of a file,
    /// in the order of the steps.
    #[must_use]
    pub fn new(
        steps: &[OperatorStep],
        folder: &Path,
        runs_on: Option<String>,
        script: Option<Vec<ScriptAnswer>>,
    ) -> Self {
        let question = |step: &OperatorStep| Question {
            step: step.clone(),
            state: QuestionState::Waiting,
            sample: None,
        };
        let state = DeskState {
            questions: steps.iter().map(question).collect(),
            records: Vec::new(),
            journal: Journal::new(folder),
            runs_on,
            script,
            held: None,
            aborted: None,
            over: false,
        };
        Self { state: Mutex::new(state), attendance: Arc::new(Attendance::new(steps.len())) }
    }

    /// Returns what the run and the desk have in common.
    #[must_use]
    pub fn attendance(&self) -> Arc<Attendance> {
        Arc::clone(&self.attendance)
    }

    fn lock(&self) -> MutexGuard<'_, DeskState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks what is due, takes answers of the file, and notes what is overdue. To be called many times a second.
    pub fn look(&self) {
        let mut state = self.lock();
        if state.over || state.aborted.is_some() {
            return;
        }
        for index in 0..state.questions.len() {
            let is = state.questions[index].state.clone();
            match is {
                QuestionState::Waiting => {
                    let Some(sample) = self.attendance.due(index) else { continue };
                    self.open(&mut state, index, Some(sample).filter(|sample| *sample > 0));
                    if let Some(answer) =
                        state.script.as_ref().and_then(|all| all.get(index)).cloned()
                    {
                        // It was checked when the file was read.
                        let by = answer.by.unwrap_or_default();
                        let _ = self.take(&mut state, index, &answer.value, &by, AnswerWay::File);
                    }
                }
                QuestionState::Open { .. } => self.overdue(&mut state, index),
                QuestionState::Closed { .. } => {}
            }
            if state.aborted.is_some() {
                return;
            }
        }
    }

    fn open(&self, state: &mut DeskState, index: usize, sample: Option<u64>) {
        let question = &mut state.questions[index];
        question.state = QuestionState::Open { since: Instant::now(), overdue: false };
        question.sample = sample;
        let step = question.step.clone();
        self.keep(state, Act::Asked, |record| {
            record.expected = Some(step.form.expected());
            (record.step, record.ask, record.sample) = (Some(step.id), Some(step.ask), sample);
        });
    }

    /// Notes that nobody answered a question in time, once, and ends the run where that follows.
    fn overdue(&self, state: &mut DeskState, index: usize) {
        let Question { step, state: is, .. } = &mut state.questions[index];
        let QuestionState::Open { since, overdue: overdue @ false } = is else { return };
        if step.timeout.is_none_or(|timeout| since.elapsed() < timeout) {
            return;
        }
        *overdue = true;
        let (id, follows, since) = (step.id.clone(), step.on_timeout, *since);
        self.keep(state, Act::Overdue, |record| {
            (record.step, record.after_s) = (Some(id.clone()), Some(seconds(since)));
        });
        if follows == OnTimeout::Abort {
            let reason = format!("nobody answered step {id:?} in time");
            self.end(state, &reason, None, None);
        }
    }

    /// Takes an answer to a step, if it is the first one. An empty name is none.
    ///
    /// # Errors
    /// If the step isn't open, or the answer doesn't fit it.
    pub fn answer(
        &self,
        id: &str,
        value: &str,
        by: &str,
        way: AnswerWay,
    ) -> Result<String, DeskRefusal> {
        let mut state = self.lock();
        let Some(index) = state.questions.iter().position(|question| question.step.id == id) else {
            let ids = state.questions.iter().map(|question| question.step.id.as_str());
            let known = if state.questions.is_empty() {
                "which has none".to_owned()
            } else {
                suggestion(id, ids, "steps")
            };
            return Err(DeskRefusal::Unknown { id: id.to_owned(), known });
        };
        self.take(&mut state, index, value, by, way)
    }

    fn take(
        &self,
        state: &mut DeskState,
        index: usize,
        value: &str,
        by: &str,
        way: AnswerWay,
    ) -> Result<String, DeskRefusal> {
        if way != AnswerWay::File {
            // A process that stood still may see an answer before it sees that its time is over.
            self.overdue(state, index);
        }
        let Question { step, state: is, sample } = &state.questions[index];
        let (id, sample) = (step.id.clone(), *sample);
        let since = match is {
            QuestionState::Waiting => return Err(DeskRefusal::NotYet { id }),
            QuestionState::Closed { answer } => {
                return Err(DeskRefusal::Late { id, answer: answer.clone() });
            }
            QuestionState::Open { since, .. } => *since,
        };
        going(state)?;
        let unfit = |problem| DeskRefusal::Unfit { id: id.clone(), problem };
        let by = name(by).map_err(unfit)?;
        if step.named && by.is_none() {
            return Err(unfit("expected a name with it: it doesn't count without".to_owned()));
        }
        let value = step.form.read(value).map_err(|error| unfit(error.to_string()))?;
        let unit = match &step.form {
            AnswerForm::Number { unit, .. } => unit.clone(),
            _ => None,
        };
        let is_no = value == "no" && matches!(step.form, AnswerForm::Confirm | AnswerForm::YesNo);
        let follows = step.on_no;
        self.keep(state, Act::Answered, |record| {
            (record.step, record.value, record.unit) =
                (Some(id.clone()), Some(value.clone()), unit);
            (record.by, record.way, record.sample) = (by.clone(), Some(way), sample);
            record.after_s = Some(seconds(since));
        });
        // Where the disk doesn't have it, it doesn't count.
        going(state)?;
        let from = by.as_ref().map_or(String::new(), |by| format!(" by {by}"));
        let answer = format!("{value}{from} ({})", way.name());
        if is_no && follows == OnNo::AskAgain {
            self.open(state, index, sample);
            return Ok(answer);
        }
        state.questions[index].state = QuestionState::Closed { answer: answer.clone() };
        if is_no && follows == OnNo::Abort {
            let reason = format!("the answer to step {id:?} was no");
            self.end(state, &reason, by, Some(way));
        } else if state.aborted.is_none() {
            // Only now the run may go on: the disk has the answer.
            self.attendance.close(index);
        }
        Ok(answer)
    }

    /// Holds the run before its next sample.
    ///
    /// # Errors
    /// If it is held already, or can't be held.
    pub fn hold(&self, by: &str, way: AnswerWay) -> Result<(), DeskRefusal> {
        let mut state = self.lock();
        going(&state)?;
        let impossible = |reason: String| Err(DeskRefusal::Impossible(reason));
        if let Some(why) = &state.runs_on {
            return impossible(format!("the run can't be held: {why}; it can be aborted"));
        }
        if state.held.is_some() {
            return impossible("the run is held already".to_owned());
        }
        let by = name(by).map_err(DeskRefusal::Impossible)?;
        self.keep(&mut state, Act::Held, |record| (record.by, record.way) = (by, Some(way)));
        state.held = Some(Instant::now());
        self.attendance.hold(true);
        Ok(())
    }

    /// Lets a run go on that is held.
    ///
    /// # Errors
    /// If it isn't held.
    pub fn resume(&self, by: &str, way: AnswerWay) -> Result<(), DeskRefusal> {
        let mut state = self.lock();
        going(&state)?;
        let by = name(by).map_err(DeskRefusal::Impossible)?;
        let Some(since) = state.held.take() else {
            return Err(DeskRefusal::Impossible("the run isn't held".to_owned()));
        };
        let sample = self.attendance.stands();
        self.keep(&mut state, Act::Resumed, |record| {
            (record.by, record.way, record.sample) = (by, Some(way), sample);
            record.after_s = Some(seconds(since));
        });
        if state.aborted.is_none() {
            self.attendance.hold(false);
        }
        Ok(())
    }

    /// Ends the run: it is inconclusive.
    ///
    /// # Errors
    /// If it has ended already.
    pub fn abort(&self, by: &str, way: AnswerWay) -> Result<(), DeskRefusal> {
        let mut state = self.lock();
        going(&state)?;
        let by = name(by).map_err(DeskRefusal::Impossible)?;
        self.end(&mut state, "the operator ended it", by, Some(way));
        Ok(())
    }

    fn end(&self, state: &mut DeskState, reason: &str, by: Option<String>, way: Option<AnswerWay>) {
        let from = by.as_ref().map_or(String::new(), |by| format!(", {by}"));
        state.aborted.get_or_insert(format!("{reason}{from}"));
        self.keep(state, Act::Aborted, |record| {
            (record.value, record.by, record.way) = (Some(reason.to_owned()), by, way);
        });
    }

    /// Writes a record, and ends the run if the disk doesn't take it: what isn't recorded doesn't count.
    fn keep(&self, state: &mut DeskState, act: Act, fill: impl FnOnce(&mut OperatorRecord)) {
        let mut record = OperatorRecord {
            schema: SCHEMA,
            number: u32::try_from(state.records.len() + 1).unwrap_or(u32::MAX),
            at: octant_base::utc::millis(SystemTime::now()),
            act,
            step: None,
            ask: None,
            expected: None,
            value: None,
            unit: None,
            by: None,
            way: None,
            after_s: None,
            sample: None,
        };
        fill(&mut record);
        match state.journal.add(&record) {
            Ok(line) => {
                self.attendance.tell(line);
                state.records.push(record);
            }
            Err(error) => {
                state.aborted.get_or_insert(format!("failed to {error}"));
            }
        }
    }

    /// Questions that are open, in the order of the scenario.
    #[must_use]
    pub fn questions(&self) -> Vec<OpenQuestion> {
        let state = self.lock();
        let open = |question: &Question| {
            let Question { step, state: QuestionState::Open { since, .. }, .. } = question else {
                return None;
            };
            let left = step.timeout.map(|timeout| timeout.saturating_sub(since.elapsed()));
            Some(OpenQuestion {
                id: step.id.clone(),
                ask: step.ask.clone(),
                form: step.form.clone(),
                named: step.named,
                holds: step.holds,
                asked_s: seconds(*since),
                left_s: left.map(|left| left.as_secs_f64()),
            })
        };
        let all = if state.aborted.is_some() { &[][..] } else { &state.questions };
        all.iter().filter_map(open).collect()
    }

    /// Records so far, from this number of them on.
    #[must_use]
    pub fn records_from(&self, from: usize) -> Vec<OperatorRecord> {
        self.lock().records.get(from..).unwrap_or_default().to_vec()
    }

    /// Reason why the run has to end, if it has.
    #[must_use]
    pub fn aborted(&self) -> Option<String> {
        self.lock().aborted.clone()
    }

    /// Returns whether a person holds the run.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.lock().held.is_some()
    }

    /// Ends the desk with its run, and returns why the run is no evidence, as far as its steps go. A step that wasn't
    /// answered, or not asked, is recorded.
    pub fn close(&self) -> Vec<String> {
        let mut state = self.lock();
        let mut reasons: Vec<String> = Vec::new();
        if !std::mem::replace(&mut state.over, true) {
            for index in 0..state.questions.len() {
                let Question { step, state: is, .. } = &state.questions[index];
                let (id, since) = (
                    step.id.clone(),
                    match is {
                        QuestionState::Closed { .. } => continue,
                        QuestionState::Open { since, .. } => Some(*since),
                        QuestionState::Waiting => None,
                    },
                );
                let act = since.map_or(Act::NeverAsked, |_| Act::Unanswered);
                reasons.push(match since {
                    Some(_) => format!("the run ended while step {id:?} was not answered"),
                    None => format!("the run ended before step {id:?} was asked"),
                });
                self.keep(&mut state, act, |record| {
                    (record.step, record.after_s) = (Some(id), since.map(seconds));
                });
            }
        }
        if let Some(aborted) = &state.aborted {
            reasons.insert(0, format!("aborted: {aborted}"));
        }
        reasons
    }
}

/// Refuses what comes after the end.
fn going(state: &DeskState) -> Result<(), DeskRefusal> {
    let reason = match &state.aborted {
        Some(reason) => format!("the run is aborted already: {reason}"),
        None if state.over => "the run has ended already".to_owned(),
        None => return Ok(()),
    };
    Err(DeskRefusal::Impossible(reason))
}

/// Reads a name; `None`: none was given.
fn name(text: &str) -> Result<Option<String>, String> {
    let text = text.trim();
    if text.chars().count() > NAME_LONGEST || text.chars().any(char::is_control) {
        return Err(format!("expected a name of up to {NAME_LONGEST} characters"));
    }
    Ok(Some(text.to_owned()).filter(|text| !text.is_empty()))
}

/// Time since then, s, to the millisecond.
fn seconds(since: Instant) -> f64 {
    since.elapsed().as_millis() as f64 / 1e3
}
