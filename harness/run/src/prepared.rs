//! A scenario that is ready to run: its methods, and their twins without faults.

use super::beginning::BranchPlan;
use super::method::{MethodError, MethodRun, SetupError, StreamKeeping, run_as_far_as_it_goes};
use super::with_twin::run_with_twin;
use octant_base::attendance::Attendance;
use octant_base::control::Control;
use octant_base::failing::{Failing, FailureKind};
use octant_base::pool::spawn;
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use std::path::Path;
use std::sync::Arc;
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
    /// Each method is set up as in a run and discarded again, so that contradictions, and sources that
    /// can't be opened, are found before anything is written.
    ///
    /// # Errors
    /// If a method can't be set up.
    pub fn of(scenario: &'a Scenario, seed: u64, twins: bool) -> Result<Self, SetupError> {
        let baseline = scenario.baseline.as_ref().map(|_| Method::Baseline);
        let methods: Vec<Method> = std::iter::once(Method::Primary).chain(baseline).collect();
        for method in &methods {
            set_up(scenario, *method, seed)?;
        }
        let clean = (twins && !scenario.faults.is_empty()).then(|| {
            // Results don't depend on the clock, so a twin needn't run in real time.
            let mut clean = scenario.without_faults();
            clean.realtime.by_clock = false;
            // Nor on what a person answers.
            clean.operator.clear();
            clean
        });
        let tasks = methods.len() * if clean.is_some() { 2 } else { 1 };
        let controls = (0..tasks).map(|_| Control::default()).collect();
        Ok(Self { scenario, clean, seed, methods, controls })
    }

    /// Lets a person attend to the methods. Twins are compared with them, and ask nobody.
    pub fn attend(&self, attendance: &Arc<Attendance>) {
        let each = self.controls.len() / self.methods.len().max(1);
        for control in self.controls.iter().step_by(each.max(1)) {
            // A second person at the same run has no part in it.
            let _ = control.attendance.set(Arc::clone(attendance));
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
        let one = |(method, controls): &(Method, &[Control])| {
            let path = folder.join(recording(*method));
            self.one(*method, &path, controls, alone)
        };
        let tasks: Vec<(Method, &[Control])> =
            self.methods.iter().copied().zip(self.controls.chunks(each)).collect();
        if alone {
            return tasks.iter().map(one).collect();
        }
        std::thread::scope(|scope| {
            let one = &one;
            let threads: Vec<_> =
                tasks.iter().map(|task| spawn(scope, move || one(task))).collect();
            threads.into_iter().map(joined).collect()
        })
    }

    /// Runs a method, and its twin.
    fn one(
        &self,
        method: Method,
        path: &Path,
        controls: &[Control],
        alone: bool,
    ) -> Result<MethodRun, PreparedError> {
        let (seed, recording) = (self.seed, StreamKeeping::File(path));
        let plan = |scenario, control| BranchPlan { scenario, method, seed, control };
        let run = |plan: BranchPlan<'_>, keeping| {
            let BranchPlan { scenario, method, seed, control } = plan;
            Ok(run_as_far_as_it_goes(scenario, method, seed, keeping, control)?)
        };
        let (control, clean) = match (controls, &self.clean) {
            ([control, of_twin], Some(clean)) => (control, Some(plan(clean, of_twin))),
            ([control, ..], _) => (control, None),
            // Every method has one.
            ([], _) => return Err(PreparedError::Panicked),
        };
        let this = plan(self.scenario, control);
        let Some(clean) = clean else { return run(this, recording) };
        if let Some(both) = run_with_twin(this, clean, recording) {
            return Ok(both?);
        }
        let (faulted, twin) = if alone {
            let faulted = run(this, recording);
            (faulted, run(clean, StreamKeeping::Hash))
        } else {
            std::thread::scope(|scope| {
                let twin = spawn(scope, || run(clean, StreamKeeping::Hash));
                (run(this, recording), joined(twin))
            })
        };
        Ok(MethodRun { twin: Some(Arc::new(twin?)), ..faulted? })
    }

    /// Runs that take place: methods and twins.
    #[must_use]
    pub fn tasks(&self) -> usize {
        self.controls.len()
    }
}

fn joined<T>(thread: ScopedJoinHandle<'_, Result<T, PreparedError>>) -> Result<T, PreparedError> {
    thread.join().unwrap_or(Err(PreparedError::Panicked))
}

/// Sets up a method as a run does, and discards it again.
fn set_up(scenario: &Scenario, method: Method, seed: u64) -> Result<(), SetupError> {
    let (plant, core, _) = configurations(scenario, method, seed)?;
    octant_calibration::Core::new(&core)?;
    octant_source::check(scenario, &plant)?;
    Ok(octant_endpoint::check(scenario, &core)?)
}
