//! Runs inside another program: the Python package.
//!
//! A run is the one of `octant run`, with the same folder of evidence; only the terminal is left out.

pub use crate::asked::Evidence;
pub use crate::attendant::OperatorWays;
pub use crate::failure::Failure;
pub use crate::run_request::RunRequest;

use crate::asked::{Answers, Asked, Begun, without_fmus};
use crate::evidenced::evidence;
use crate::progress::Follower;
use octant_base::control::Control;
use octant_fmu_bind::OpenedFmus;
use octant_run::{Parts, SteppedRun, StreamKeeping};
use octant_scenario::{Method, Scenario};

/// Names the build in the manifests that this process writes.
pub fn say_build() {
    crate::commands::say_build();
}

/// Runs the program with the arguments of this process; its exit status.
#[must_use]
pub fn program() -> u8 {
    crate::commands::status()
}

/// Runs a scenario and writes its evidence. `look` is called 50 times a second with the controls of
/// the methods and twins, and the total that their epochs will count.
///
/// # Errors
/// If the request is refused, or the bench fails.
pub fn run(
    request: &RunRequest,
    look: &(dyn Fn(&[Control], Option<u64>) + Sync),
) -> Result<Evidence, Failure> {
    evidence(request, &Follower::Host(look))
}

/// Reads the scenario of a request.
///
/// # Errors
/// If it is refused.
pub fn scenario(request: &RunRequest) -> Result<Scenario, Failure> {
    Ok(Asked::of(request)?.scenario)
}

/// A run of one method that another program steps.
#[derive(Debug)]
pub struct Bench {
    request: RunRequest,
    asked: Asked,
    begun: Begun,
    /// The run between two steps.
    pub stepped: SteppedRun,
}

impl Bench {
    /// Makes the folder of the run and sets up its first method.
    ///
    /// # Errors
    /// If the request is refused, or the run can't be set up.
    pub fn new(request: RunRequest, parts: Parts) -> Result<Self, Failure> {
        let asked = Asked::of(&request)?;
        if asked.scenario.realtime.by_clock {
            return Err(Failure::input(
                "failed to step a run by the clock: expected realtime.pace = \"simulated\"",
            ));
        }
        let opened = OpenedFmus::default();
        let fmus = octant_evidence::fmus(&asked.scenario, 1, &opened).map_err(without_fmus)?;
        let begun = asked.begin(&request, fmus)?;
        let path = begun.folder.path().join("recording.mcap");
        let file = StreamKeeping::File(&path);
        let (scenario, seed) = (&asked.scenario, asked.seed);
        let stepped = SteppedRun::new(scenario, Method::Primary, seed, file, parts, &opened)
            .map_err(|error| {
                // Nothing was run: a folder without a run is in nobody's way.
                let _ = std::fs::remove_dir_all(begun.folder.path());
                Failure::from(error).failed()
            })?;
        Ok(Self { request, asked, begun, stepped })
    }

    /// Ends the run, and writes its evidence.
    ///
    /// # Errors
    /// If the bench failed in a way that leaves no result.
    pub fn finish(self) -> Result<Evidence, Failure> {
        let run = self.stepped.finish().map_err(|error| Failure::from(error).failed())?;
        self.asked.conclude(&self.request, self.begun, vec![run], Answers::default())
    }
}
