//! A recorded run with faults and the run without them, which share the beginning.
//!
//! The recorded run is the trunk here, with its station at its side. Before the first fault sets in the twin
//! branches off, on a thread of its own.

use super::beginning::{Beginning, BranchPlan, Parts, beginning, until_due};
use super::branch::Branch;
use super::drive::{Books, Ended, Steps};
use super::host::RunHost;
use super::in_time::{CONTROL_EPOCHS, InTime};
use super::method::{self, MethodError, MethodRun, SetupError, StreamKeeping};
use super::recording::recorder_options;
use super::watch::Watcher;
use octant_base::pool::spawn;
use octant_endpoint::{InProcess, Tells};
use octant_recorder::{RecorderError, RecorderOptions, RecorderTrouble};
use octant_scenario::resolve::DrawnValues;
use octant_score::trace::RunTrace;
use octant_source::{PlantSource, Source};
use std::sync::Arc;

/// Runs a scenario with faults and its twin: both plans are of one method and seed, the second without the faults.
/// A failure in the middle ends the first as [`method::run_as_far_as_it_goes`] says.
///
/// `None` if the two can't share their beginning, and have to run one by one.
///
/// # Errors
/// If a run can't be set up, or a recorder fails.
pub(super) fn run_with_twin(
    faulted: BranchPlan<'_>,
    twin: BranchPlan<'_>,
    recording: StreamKeeping<'_>,
) -> Option<Result<MethodRun, MethodError>> {
    let (begun, draws) = beginning(&faulted)?;
    if beginning(&twin)?.0 != begun {
        return None;
    }
    Some(both((faulted, twin), recording, (begun, draws)))
}

// Apart from its caller, whose frame would have room for two runs in any case.
#[inline(never)]
fn both(
    (plan, twin): (BranchPlan<'_>, BranchPlan<'_>),
    recording: StreamKeeping<'_>,
    (begun, draws): (Beginning, DrawnValues),
) -> Result<MethodRun, MethodError> {
    let BranchPlan { scenario, method, seed, control } = plan;
    let trouble = RecorderTrouble::default();
    let Some(mut faulted) = method::faulted(scenario, seed)? else {
        return method::run_as_far_as_it_goes(scenario, method, seed, recording, control);
    };
    faulted.host = RunHost::new(scenario, &recording, &trouble)?;
    let mut source = PlantSource::new(&begun.plant, begun.samples).map_err(SetupError::Plant)?;
    let mut endpoint = InProcess::new(&begun.core).map_err(SetupError::Core)?;
    let told = (true, Tells::ALL);
    let options =
        RecorderOptions { trouble, ..recorder_options(scenario, seed, &draws, method, told) };
    let mut recorder = recording.start(&options).map_err(SetupError::Recorder)?;
    let mut watcher = Watcher::new(begun.work);
    watcher.trace = Some(RunTrace::new());
    method::charts(&mut watcher, scenario, method, recording);
    let books = Books::new(&mut recorder, &mut watcher, Some(&faulted));
    let mut keeper =
        InTime { books, control, look_every: CONTROL_EPOCHS, revision: 0, attended: None };
    let mut steps = Steps::new(source.samples_total());
    let begun = until_due(
        (&mut source, &mut endpoint, &mut keeper, &mut steps),
        &mut faulted,
        twin.control,
    );
    // A recorder that fails here fails in the run too, which says so.
    let branch = match &begun {
        Ok(ended) => branch((&source, &endpoint, &mut keeper, &steps), &draws, *ended).ok(),
        Err(_) => None,
    };
    let (driven, twin) = std::thread::scope(|scope| {
        let other = spawn(scope, || match branch {
            Some(branch) => branch.finish(&twin),
            None => {
                let BranchPlan { scenario, method, seed, control } = twin;
                let keeping = StreamKeeping::Hash;
                method::run_as_far_as_it_goes(scenario, method, seed, keeping, control)
            }
        });
        let driven = match begun {
            Ok(None) => steps.go_on(&mut source, &mut faulted, &mut endpoint, &mut keeper),
            Ok(Some(ended)) => Ok(ended),
            Err(error) => Err(error),
        };
        (driven, other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    });
    let words = faulted.last_words();
    words.into_iter().for_each(|event| keeper.books.recorder.event(event));
    let books = (&mut recorder, &mut watcher);
    let closed = method::close((driven, None), &mut source, &mut endpoint, books, control)?;
    let truth = Some(&draws);
    let run = method::finish(scenario, method, closed, recorder, watcher, truth)?;
    let receipts = faulted.station.receipts();
    Ok(MethodRun { receipts, twin: Some(Arc::new(twin?)), ..run })
}

/// Makes the twin from the run, which no fault has touched yet.
fn branch(
    (source, endpoint, keeper, steps): (&PlantSource, &InProcess, &mut InTime<'_>, &Steps),
    draws: &DrawnValues,
    ended: Option<Ended>,
) -> Result<Branch, RecorderError> {
    let recorder = keeper.books.recorder.branch()?;
    let mut watcher = keeper.books.watcher.clone();
    // What only the report of a recorded run shows.
    (watcher.at_rest, watcher.filtered) = (None, None);
    let (source, endpoint, steps) = (source.clone(), endpoint.clone(), steps.clone());
    let parts = Parts { source, endpoint, steps, watcher, revision: keeper.revision, ended };
    Ok(Branch { index: 0, faulted: None, parts, recorder, draws: draws.clone() })
}
