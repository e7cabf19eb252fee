//! A scenario that is ready to run: its methods, and their twins without faults.

use super::once;
use super::sessions::BothSessions;
use super::twin::run_with_twin;
use crate::bench::ended::Ended;
use crate::bench::error::{MethodError, SetupError};
use crate::bench::plan::Plan;
use crate::bench::recording::StreamKeeping;
use crate::bench::set_up::SetUp;
use crate::results::method::MethodRun;
use octant_base::attendance::Attendance;
use octant_base::control::Control;
use octant_base::failing::{Failing, FailureKind};
use octant_base::pool::spawn;
use octant_fmu_bind::OpenedFmus;
use octant_scenario::{Method, Scenario};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::ScopedJoinHandle;

/// Name of the recording of a method in the folder of its run.
fn recording(method: Method) -> &'static str {
    match method {
        Method::Primary => "recording.mcap",
        Method::Baseline => "baseline.mcap",
    }
}

/// Methods and twins of a scenario, set up and not yet run.
#[derive(Debug)]
pub struct Prepared<'a> {
    scenario: &'a Scenario,
    /// Scenario of the twins.
    clean: Option<Scenario>,
    seed: u64,
    methods: Vec<Method>,
    /// FMUs of all methods and twins, each opened once.
    fmus: OpenedFmus,
    /// Each method as it was checked, for its first run.
    set_up: Vec<Mutex<Option<SetUp>>>,
    /// Of each method, followed by that of its twin where there are twins.
    controls: Vec<Control>,
}

/// Reasons why a prepared scenario gave no result.
#[derive(Debug, thiserror::Error)]
pub enum PreparedError {
    /// A method gave no result.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The thread of a method panicked: an error in this program.
    #[error("run a method: its thread panicked")]
    Panicked,
}

/// Reason why no run can be ended at the loss of its bench.
#[derive(Debug, thiserror::Error)]
#[error(
    "--stop-when-lost: found a run in simulated time, whose bench can't be late; expected --realtime with it, or \
     realtime.pace = \"clock\" in the scenario"
)]
pub struct NeverLost;

impl Failing for PreparedError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Method(error) => error.kind(),
            Self::Panicked => FailureKind::Bench,
        }
    }
}

impl<'a> Prepared<'a> {
    /// Prepares the methods of a scenario. With `twins`, each is compared with the same run without
    /// the scenario's faults, if there are any.
    ///
    /// Each method is set up here, so that contradictions, and sources that can't be opened, are found before anything
    /// is written; its run begins with what was set up. `fmus` are FMUs that are opened or get opened.
    ///
    /// # Errors
    /// If a method can't be set up.
    pub fn of(
        scenario: &'a Scenario,
        seed: u64,
        twins: bool,
        fmus: &OpenedFmus,
    ) -> Result<Self, SetupError> {
        let methods: Vec<Method> = scenario.methods().collect();
        let mut set_up = Vec::with_capacity(methods.len());
        for method in &methods {
            let mut one = SetUp::of(scenario, *method, seed, fmus)?;
            one.check(scenario)?;
            set_up.push(Mutex::new(Some(one)));
        }
        let clean = has_twins(scenario, twins).then(|| {
            // Results don't depend on the clock, so a twin needn't run in real time.
            let mut clean = scenario.without_faults();
            clean.realtime.by_clock = false;
            // Nor on what a person answers.
            clean.operator.clear();
            clean
        });
        let controls = (0..tasks(scenario, twins)).map(|_| Control::default()).collect();
        Ok(Self { scenario, clean, seed, methods, fmus: fmus.clone(), set_up, controls })
    }

    /// Lets a person attend to the methods. Twins are compared with them, and ask nobody.
    pub fn attend(&self, attendance: &Arc<Attendance>) {
        let each = self.controls.len() / self.methods.len().max(1);
        for control in self.controls.iter().step_by(each.max(1)) {
            // A second person at the same run has no part in it.
            let _ = control.attendance.set(Arc::clone(attendance));
        }
    }

    /// Ends all runs at the moment at which the bench of one breaks a real-time limit.
    ///
    /// # Errors
    /// If none goes by the clock.
    pub fn stop_when_lost(&self) -> Result<(), NeverLost> {
        for control in &self.controls {
            control.stop_when_lost.store(true, Ordering::Relaxed);
        }
        self.scenario.realtime.by_clock.then_some(()).ok_or(NeverLost)
    }

    /// Keeps runs from beginning after one whose bench was lost.
    fn note_lost(&self, run: &MethodRun) {
        if run.ended == Ended::Lost {
            self.controls.iter().for_each(|control| control.lost.store(true, Ordering::Relaxed));
        }
    }

    /// Progress of each method and twin, and the requests to end them.
    #[must_use]
    pub fn controls(&self) -> &[Control] {
        &self.controls
    }

    /// Epochs of all methods and twins together; `None` where the source doesn't know them.
    #[must_use]
    pub fn epochs(&self) -> Option<u64> {
        self.scenario.samples().map(|samples| samples * self.controls.len() as u64)
    }

    /// Runs the methods and their twins at the same time; by the clock, and with a device, one after another.
    /// A twin shares the beginning of its run where it can. Recordings go to `folder`; a twin is kept with
    /// the run it belongs to.
    ///
    /// # Errors
    /// If a method gave no result; recordings stay.
    pub fn run(&self, folder: &Path) -> Result<Vec<MethodRun>, PreparedError> {
        // By the clock, one method would delay another. A device can only do one run at a time.
        let alone = self.scenario.realtime.by_clock || self.scenario.endpoint.device().is_some();
        let each = self.controls.len() / self.methods.len().max(1);
        let one =
            |(number, controls): &(usize, &[Control])| self.one(*number, folder, controls, alone);
        let tasks: Vec<(usize, &[Control])> =
            (0..self.methods.len()).zip(self.controls.chunks(each)).collect();
        if alone {
            return tasks.iter().map(|task| one(task).inspect(|run| self.note_lost(run))).collect();
        }
        std::thread::scope(|scope| {
            let one = &one;
            let threads: Vec<_> =
                tasks.iter().map(|task| spawn(scope, move || one(task))).collect();
            threads.into_iter().map(joined).collect()
        })
    }

    /// Runs the method with this number, and its twin.
    fn one(
        &self,
        number: usize,
        folder: &Path,
        controls: &[Control],
        alone: bool,
    ) -> Result<MethodRun, PreparedError> {
        let (method, seed) = (self.methods[number], self.seed);
        let path = folder.join(recording(method));
        let file = StreamKeeping::File(&path);
        let run = |plan: &Plan<'_>, set_up: Option<SetUp>| {
            let Plan { scenario, method, seed, .. } = *plan;
            let set_up = match set_up {
                Some(set_up) => set_up,
                None => SetUp::of(scenario, method, seed, &self.fmus).map_err(MethodError::from)?,
            };
            Ok(once::set_up(plan, set_up)?)
        };
        let checked = self.set_up[number].lock().unwrap_or_else(PoisonError::into_inner).take();
        let (control, clean) = match (controls, &self.clean) {
            ([control, of_twin], Some(clean)) => (control, Some((clean, of_twin))),
            ([control, ..], _) => (control, None),
            // Every method has one.
            ([], _) => return Err(PreparedError::Panicked),
        };
        let this = Plan::of(self.scenario, method, seed, file, control);
        let Some((clean, of_twin)) = clean else { return run(&this, checked) };
        let twin = Plan::of(clean, method, seed, StreamKeeping::Hash, of_twin);
        if let Some(both) = run_with_twin(&this, &twin) {
            return Ok(both?);
        }
        let sessions = BothSessions::of(self.scenario, method, seed);
        let this = Plan { session: sessions.map(|both| both.faulted), ..this };
        let twin = Plan { session: sessions.map(|both| both.twin), ..twin };
        let lost = |run: &MethodRun| self.note_lost(run);
        let (faulted, twin) = match sessions {
            Some(both) if both.twin.is_first => {
                let twin = run(&twin, None);
                (run(&this, checked).inspect(lost), twin)
            }
            None if !alone => std::thread::scope(|scope| {
                let twin = spawn(scope, || run(&twin, None));
                (run(&this, checked), joined(twin))
            }),
            _ => (run(&this, checked).inspect(lost), run(&twin, None)),
        };
        Ok(MethodRun { twin: Some(Arc::new(twin?)), ..faulted? })
    }
}

/// Number of the runs that take place for a scenario: methods and twins.
#[must_use]
pub fn tasks(scenario: &Scenario, twins: bool) -> usize {
    scenario.methods().count() * if has_twins(scenario, twins) { 2 } else { 1 }
}

fn has_twins(scenario: &Scenario, twins: bool) -> bool {
    twins && !scenario.faults.is_empty()
}

fn joined<T>(thread: ScopedJoinHandle<'_, Result<T, PreparedError>>) -> Result<T, PreparedError> {
    thread.join().unwrap_or(Err(PreparedError::Panicked))
}
