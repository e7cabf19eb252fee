//! The terminal of a run as a way to its operator: lines of stdin are answers to the question that was asked first.

use crate::terminal::{note, set_asking};
use octant_operator::desk::OpenQuestion;
use octant_operator::{AnswerWay, Desk};
use std::io::{IsTerminal, Write};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Variable with the operator's name, which manifests have too.
pub(crate) const OPERATOR: &str = "OCTANT_OPERATOR";

/// Lines that a person types while a run goes on.
pub(crate) struct OperatorTerminal {
    lines: Receiver<String>,
    name: Option<String>,
    /// Answer to a step that waits for the name.
    held_back: Option<(String, String)>,
}

/// Result of a look for typed lines.
pub(crate) enum TypedLine {
    /// The terminal is there.
    Open,
    /// Its input has ended.
    Ended,
}

/// Reads the operator's name from the environment.
pub(crate) fn operator_name() -> Option<String> {
    std::env::var(OPERATOR).ok().filter(|name| !name.trim().is_empty())
}

impl OperatorTerminal {
    /// Begins to read lines. The thread that reads stays behind: a read of a terminal can't be ended.
    pub(crate) fn start() -> Self {
        let (to, lines) = channel();
        let read = move || {
            let mut line = String::new();
            while std::io::stdin().read_line(&mut line).is_ok_and(|bytes| bytes > 0) {
                if to.send(std::mem::take(&mut line)).is_err() {
                    break;
                }
            }
        };
        // Without the thread nothing is typed, as after the end of the input.
        let _ = std::thread::Builder::new().name("terminal".to_owned()).spawn(read);
        Self { lines, name: operator_name(), held_back: None }
    }

    /// Takes what was typed.
    pub(crate) fn look(&mut self, desk: &Desk, questions: &[OpenQuestion]) -> TypedLine {
        set_asking(!questions.is_empty());
        loop {
            match self.lines.try_recv() {
                Ok(line) => self.take(line.trim(), desk),
                Err(TryRecvError::Empty) => return TypedLine::Open,
                Err(TryRecvError::Disconnected) => {
                    set_asking(false);
                    return TypedLine::Ended;
                }
            }
        }
    }

    fn take(&mut self, line: &str, desk: &Desk) {
        let name = self.name.clone().unwrap_or_default();
        let way = AnswerWay::Terminal;
        let done = match line {
            "/hold" => desk.hold(&name, way),
            "/resume" => desk.resume(&name, way),
            "/abort" => desk.abort(&name, way),
            "" => return,
            _ => return self.answer(line, &name, desk),
        };
        if let Err(refusal) = done {
            note!("octant: {refusal}");
        }
    }

    fn answer(&mut self, line: &str, name: &str, desk: &Desk) {
        let answer = match self.held_back.take() {
            Some((id, value)) => desk.answer(&id, &value, line, AnswerWay::Terminal),
            None => {
                let Some(question) = desk.questions().into_iter().next() else {
                    note!("octant: no question is open; /hold, /resume and /abort are known");
                    return;
                };
                let is_fit = question.form.read(line).is_ok();
                if question.named && name.is_empty() && is_fit {
                    note!("octant: your name?");
                    self.held_back = Some((question.id, line.to_owned()));
                    return;
                }
                desk.answer(&question.id, line, name, AnswerWay::Terminal)
            }
        };
        if let Err(refusal) = answer {
            note!("octant: {refusal}");
        }
    }

    /// Takes the bar of progress off its line.
    pub(crate) fn clear() {
        if std::io::stderr().is_terminal() {
            // A terminal that has gone is no failure of the run.
            let _ = std::io::stderr().write_all(b"\r\x1b[K");
        }
    }

    /// Leaves the terminal to the bar of progress.
    pub(crate) fn leave() {
        set_asking(false);
    }
}
