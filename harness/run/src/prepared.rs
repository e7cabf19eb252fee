//! A scenario that is ready to run: its methods, and their twins without faults.

use super::method::{MethodError, MethodRun, SetupError, StreamKeeping, run_as_far_as_it_goes};
use octant_base::control::Control;
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use std::path::Path;
use std::sync::Arc;

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
    /// Methods, each followed by its twin where there are twins.
    tasks: Vec<(Method, bool)>,
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
            clean
        });
        let tasks: Vec<(Method, bool)> = (methods.into_iter())
            .flat_map(|method| {
                let twin = clean.as_ref().map(|_| (method, true));
                std::iter::once((method, false)).chain(twin)
            })
            .collect();
        let controls = tasks.iter().map(|_| Control::default()).collect();
        Ok(Self { scenario, clean, seed, tasks, controls })
    }

    /// Progress of each method and twin, and the requests to end them.
    #[must_use]
    pub fn controls(&self) -> &[Control] {
        &self.controls
    }

    /// Epochs of all methods and twins together; `None` where the source doesn't know them.
    #[must_use]
    pub fn epochs(&self) -> Option<u64> {
        self.scenario.samples().map(|samples| samples * self.tasks.len() as u64)
    }

    /// Runs the methods and their twins, each on a thread of its own; by the clock, and with a device,
    /// one after another. Recordings go to `folder`; a twin is kept with the run it belongs to.
    ///
    /// # Errors
    /// If a method gave no result; recordings stay.
    pub fn run(&self, folder: &Path) -> Result<Vec<MethodRun>, PreparedError> {
        let one = |(method, is_twin): (Method, bool), control: &Control| {
            let path = folder.join(recording(method));
            let (scenario, recording) = match &self.clean {
                Some(clean) if is_twin => (clean, StreamKeeping::Hash),
                _ => (self.scenario, StreamKeeping::File(&path)),
            };
            run_as_far_as_it_goes(scenario, method, self.seed, recording, control)
        };
        // By the clock, one method would delay another. A device can only do one run at a time.
        let alone = self.scenario.realtime.by_clock || self.scenario.endpoint.device().is_some();
        let at_once = if alone { 1 } else { self.tasks.len() };
        let mut results = Vec::with_capacity(self.tasks.len());
        for (tasks, controls) in self.tasks.chunks(at_once).zip(self.controls.chunks(at_once)) {
            std::thread::scope(|scope| {
                let one = &one;
                let threads: Vec<_> = (tasks.iter().zip(controls))
                    .map(|(task, control)| scope.spawn(move || one(*task, control)))
                    .collect();
                results.extend(threads.into_iter().map(|thread| match thread.join() {
                    Ok(result) => result.map_err(PreparedError::from),
                    Err(_) => Err(PreparedError::Panicked),
                }));
            });
        }
        let runs = results.into_iter().collect::<Result<Vec<_>, _>>()?;
        let mut paired: Vec<MethodRun> = Vec::with_capacity(runs.len());
        for (run, (_, is_twin)) in runs.into_iter().zip(&self.tasks) {
            match paired.last_mut() {
                Some(faulted) if *is_twin => faulted.twin = Some(Arc::new(run)),
                _ => paired.push(run),
            }
        }
        Ok(paired)
    }

    /// Runs that take place: methods and twins.
    #[must_use]
    pub fn tasks(&self) -> usize {
        self.tasks.len()
    }
}

/// Sets up a method as a run does, and discards it again.
fn set_up(scenario: &Scenario, method: Method, seed: u64) -> Result<(), SetupError> {
    let (plant, core, _) = configurations(scenario, method, seed)?;
    octant_calibration::Core::new(&core)?;
    octant_source::check(scenario, &plant)?;
    Ok(octant_endpoint::check(scenario, &core)?)
}
