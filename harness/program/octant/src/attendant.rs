//! The operator of a run: whether somebody can be asked, on which ways, and what they are told.

use crate::failure::Failure;
use crate::operator_page::{BoundOperatorPage, OperatorPage};
use crate::operator_terminal::{OperatorTerminal, TypedLine};
use crate::terminal::note;
use octant_base::control::{Control, SetAtEnd};
use octant_evidence::manifest::shell_path;
use octant_operator::mailbox::Mailbox;
use octant_operator::script::{self, ScriptAnswer};
use octant_operator::step::runs_on;
use octant_operator::{AnswerWay, Desk, OperatorRecord};
use octant_scenario::Scenario;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Pause between two looks at the desk and its ways.
const LOOK: Duration = Duration::from_millis(20);

/// Ways on which the operator of a run can be reached.
#[derive(Clone, Debug, Default)]
pub struct OperatorWays {
    /// The run has a person: it was begun by `octant run`.
    pub attended: bool,
    /// Questions are answered elsewhere, and not on the terminal.
    pub elsewhere: bool,
    /// File of answers.
    pub answers: Option<PathBuf>,
    /// Address of the page.
    pub page: Option<String>,
}

/// Operator's ways of a run, checked before anything is written.
#[derive(Debug)]
pub(crate) struct OperatorPlan {
    script: Option<Vec<ScriptAnswer>>,
    terminal: bool,
    page: Option<BoundOperatorPage>,
    runs_on: Option<String>,
}

impl OperatorWays {
    /// Checks that somebody can be asked, before anything is written; `None`: nobody attends to the run.
    pub(crate) fn plan(&self, scenario: &Scenario) -> Result<Option<OperatorPlan>, Failure> {
        let instrument =
            scenario.source.instrument().is_some() || scenario.solution_line().is_some();
        let by_clock = scenario.realtime.by_clock;
        let is_bench = instrument || by_clock || scenario.endpoint.device().is_some();
        let Some(first) = scenario.operator.first().map(|step| &step.id) else {
            if self.answers.is_some() {
                let message = "--answers: the scenario has no steps in [[operator]]";
                return Err(Failure::input(message));
            }
            if self.page.is_none() && !(self.attended && is_bench) {
                return Ok(None);
            }
            return self.with(None, false, runs_on(instrument, by_clock)).map(Some);
        };
        let refused =
            |why: &str| Err(Failure::input(format!("failed to ask step {first:?}: {why}")));
        let mut terminal = false;
        let script = match &self.answers {
            Some(_) if scenario.drive.is_some() => {
                return refused(
                    "a table turns in this run, and a file doesn't see it: expected a person, without --answers",
                );
            }
            Some(file) => Some(
                script::read(file, &scenario.operator)
                    .map_err(|problem| Failure::input(format!("failed to {problem}")))?,
            ),
            None if !self.attended => {
                return refused(
                    "nobody is asked here; expected octant run with a person or --answers FILE",
                );
            }
            None if !is_bench => {
                return refused(
                    "nobody stands at a bench that is simulated: expected --answers FILE, a device or an \
                     instrument, or --realtime",
                );
            }
            None => {
                terminal = !self.elsewhere && std::io::stdin().is_terminal();
                if !terminal && !self.elsewhere && self.page.is_none() {
                    return refused(
                        "stdin is no terminal: expected one, --answers FILE, --page, or --no-terminal where \
                         octant answer is used from another process",
                    );
                }
                None
            }
        };
        self.with(script, terminal, runs_on(instrument, by_clock)).map(Some)
    }

    fn with(
        &self,
        script: Option<Vec<ScriptAnswer>>,
        terminal: bool,
        runs_on: Option<&str>,
    ) -> Result<OperatorPlan, Failure> {
        let page = self.page.as_deref().map(BoundOperatorPage::bind).transpose()?;
        Ok(OperatorPlan { script, terminal, page, runs_on: runs_on.map(str::to_owned) })
    }
}

/// The operator's desk of a run that has a folder, with the ways to it.
pub(crate) struct Attendant {
    desk: Arc<Desk>,
    mailbox: Mailbox,
    terminal: bool,
    /// Served until the run is over.
    _page: Option<OperatorPage>,
    /// The folder under the name that it keeps when the run ends, as a word of a command line.
    folder: String,
}

impl Attendant {
    /// Opens the desk of a run in its folder.
    pub(crate) fn open(
        plan: OperatorPlan,
        scenario: &Scenario,
        folder: &Path,
    ) -> Result<Self, Failure> {
        let OperatorPlan { script, terminal, page, runs_on } = plan;
        let desk = Arc::new(Desk::new(&scenario.operator, folder, runs_on, script));
        let mailbox =
            Mailbox::open(folder).map_err(|error| Failure::bench(format!("failed to {error}")))?;
        let page = page.map(|page| page.serve(&scenario.title, &desk));
        let _page = page.transpose()?;
        let name = folder.display().to_string();
        let folder = shell_path(Path::new(name.strip_suffix(".partial").unwrap_or(&name)));
        Ok(Self { desk, mailbox, terminal, _page, folder })
    }

    /// Returns the desk.
    pub(crate) fn desk(&self) -> &Desk {
        &self.desk
    }

    /// Serves the desk while `work` is done; a run that is aborted there is cancelled here.
    pub(crate) fn during<T>(&self, controls: &[Control], work: impl FnOnce() -> T) -> T {
        let done = AtomicBool::new(false);
        let done = &done;
        std::thread::scope(|scope| {
            scope.spawn(move || self.serve(controls, done));
            let _done = SetAtEnd(done);
            work()
        })
    }

    fn serve(&self, controls: &[Control], done: &AtomicBool) {
        let mut terminal = self.terminal.then(OperatorTerminal::start);
        let (mut told, mut stopped) = (0, false);
        loop {
            let is_last = done.load(Ordering::Relaxed);
            if !is_last {
                self.desk.look();
            }
            let problems =
                self.mailbox.serve(|request| request.apply(&self.desk, AnswerWay::Command));
            for problem in problems {
                note!("octant: {problem}");
            }
            for record in self.desk.records_from(told) {
                told += 1;
                self.tell(&record);
            }
            if let Some(open) = &mut terminal {
                let questions = self.desk.questions();
                if let TypedLine::Ended = open.look(&self.desk, &questions) {
                    note!(
                        "octant: the terminal's input has ended; octant answer {} ID VALUE --by NAME still counts",
                        self.folder
                    );
                    terminal = None;
                }
            }
            if let Some(reason) = self.desk.aborted()
                && !std::mem::replace(&mut stopped, true)
            {
                // A table is stopped at once, before the run notices.
                octant_turntable::stop_all("the operator aborted the run");
                for control in controls {
                    control.cancel.store(true, Ordering::Relaxed);
                }
                note!("octant: aborted: {reason}");
            }
            if is_last {
                break;
            }
            std::thread::sleep(LOOK);
        }
        OperatorTerminal::leave();
    }

    /// Prints a record on stderr.
    fn tell(&self, record: &OperatorRecord) {
        use octant_operator::Act;
        OperatorTerminal::clear();
        if record.act != Act::Asked {
            note!("octant: operator: {}", record.text());
            return;
        }
        let (step, ask) = (record.step.as_deref(), record.ask.as_deref());
        let (step, ask) = (step.unwrap_or_default(), ask.unwrap_or_default());
        note!("octant: operator, step {step}: {ask}");
        let expected = record.expected.as_deref().unwrap_or_default();
        if self.terminal {
            note!("octant: expected {expected}; /abort ends the run");
        } else {
            let folder = &self.folder;
            note!("octant: expected {expected}: octant answer {folder} {step} VALUE --by NAME");
        }
    }
}
