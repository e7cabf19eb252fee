//! Searches of `octant design`: one for each rotation.

use super::files::States;
use super::outcome::{Outcome, ShortestReport, name_of};
use crate::failure::Failure;
use crate::progress_bar::ProgressBar;
use octant_base::interrupt;
use octant_calibration::positions::{from_degrees, named};
use octant_design::report::SequenceDesign;
use octant_design::search::{SearchEffort, SearchError, SearchProblem, SearchState};
use octant_design::{DesignError, Judge, MeasureWeights, Rotation, Setup};

/// Duration of the eight positions whose drift `--shortest` keeps, s.
const EIGHT_S: f64 = 4.0 * 3600.0;

/// Failure by a scenario that can't be designed for.
pub(super) fn failed(error: DesignError) -> Failure {
    Failure::input(format!("failed to {error}"))
}

/// Failure of a search.
pub(super) fn search_failed(error: SearchError) -> Failure {
    Failure::of(&error).failed()
}

/// Work of a search, and what of it is wanted.
#[derive(Clone, Copy, Debug)]
pub(super) struct DesignWork {
    /// Number of threads.
    pub(super) jobs: usize,
    pub(super) effort: SearchEffort,
    /// The shortest calibration is searched for.
    pub(super) shortest: bool,
    /// Continuous rotation is evaluated too.
    pub(super) continuous: bool,
}

/// Designs for one rotation.
pub(super) fn design(
    work: DesignWork,
    setup: &Setup,
    problem: &SearchProblem,
    rotation: Rotation,
    states: &mut States<'_>,
) -> Result<Outcome, Failure> {
    let DesignWork { jobs, effort, shortest, continuous } = work;
    let bar = ProgressBar::new(None, |progress| progress.message.clone());
    let show = |duration_s: f64, state: &SearchState, rounds: usize, best: f64| {
        bar.update(|progress| {
            (progress.done, progress.total) = (state.round as u64, Some(rounds as u64));
            progress.message = format!(
                "{}, {:.2} h: round {} of {rounds}, best {best:.4} {}",
                name_of(rotation),
                duration_s / 3600.0,
                state.round,
                problem.measure.unit()
            );
        });
    };
    let mut kept = Ok(());
    let (problem, found, shortest) = if shortest {
        let target = eight(setup, problem)?;
        let mut told = |duration_s: f64, state: &SearchState, rounds: usize, best: f64| {
            show(duration_s, state, rounds, best);
            !interrupt::seen()
        };
        let shortest = problem.shortest(target, effort, jobs, &mut told).map_err(search_failed)?;
        let Some(shortest) = shortest else { return Err(not_kept(problem, target)) };
        let duration_s = shortest.duration_s;
        let report = ShortestReport {
            target,
            duration_h: duration_s / 3600.0,
            bound_h: shortest.bound_s / 3600.0,
        };
        (SearchProblem { duration_s, ..problem.clone() }, shortest.found, Some(report))
    } else {
        let stored = states.stored(rotation, problem);
        let mut told = |state: &SearchState, rounds: usize, best: f64| {
            show(problem.duration_s, state, rounds, best);
            kept = states.keep(rotation, problem, state);
            kept.is_ok() && !interrupt::seen()
        };
        let found = problem.search(effort, jobs, stored, &mut told);
        (problem.clone(), found.map_err(search_failed).or_else(|e| kept.and(Err(e)))?, None)
    };
    bar.finish();
    let mut design =
        SequenceDesign::of(&problem, name_of(rotation), &found).map_err(search_failed)?;
    if continuous {
        design.continuous = Some(problem.continuous(&found.sequence).map_err(failed)?);
    }
    Ok(Outcome { rotation, problem, found, design, shortest })
}

/// Returns the measure of eight positions in 4 h with the scenario's own rotation.
fn eight(setup: &Setup, problem: &SearchProblem) -> Result<f64, Failure> {
    let weights =
        MeasureWeights::new(setup, problem.measure).map_err(|error| failed(error.into()))?;
    let mut judge = Judge::new(setup, &weights);
    let stops = named("eight").unwrap_or_default();
    let sequence = from_degrees(stops, 1).map_err(Failure::bench)?;
    judge.score(&sequence, EIGHT_S).map_err(|error| failed(error.into()))
}

fn not_kept(problem: &SearchProblem, target: f64) -> Failure {
    Failure::input(format!(
        "failed to find a shorter calibration: none of {} h that was found keeps {target:.4} {}, the {} of eight \
         positions in 4 h; expected a longer --duration or a larger --effort",
        problem.duration_s / 3600.0,
        problem.measure.unit(),
        problem.measure.words()
    ))
}
