//! `octant design`: the sequence and the rotation with the least drift, and the bound of all of them.

mod confirm;
mod confirm_text;
mod files;
mod options;
mod outcome;
mod searched;
mod text;

pub(super) use options::Arguments;

use crate::arguments::load;
use crate::failure::Failure;
use crate::progress::watch_interrupts;
use crate::terminal::{print, print_json};
use confirm::{Confirmed, Runs, confirm};
use files::{States, write_scenario};
use octant_design::Setup;
use octant_design::report::SCHEMA;
use octant_design::search::SearchProblem;
use octant_verdict::Verdict;
use options::{limits, measure, refuse_to_replace, rotations, threads};
use outcome::{Outcome, Report};
use searched::{DesignWork, design, failed};

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments {
        scenario: of_scenario,
        minimise,
        duration,
        rotation: choice,
        limits: of_limits,
        seed,
        effort,
        jobs,
        shortest,
        continuous,
        confirm: seeds,
        confirm_rate,
        confirm_attempts,
        out,
        state,
        resume,
        force,
        json,
    } = arguments;
    if !force {
        // The state that a search goes on from is replaced by its own.
        refuse_to_replace(out.as_deref(), state.as_deref().filter(|_| !resume))?;
    }
    let duration = duration.as_ref();
    let more: Vec<String> =
        duration.map(|time| format!("procedure.calibration.duration={time}")).into_iter().collect();
    let scenario = load(of_scenario, &more)?;
    let setup = Setup::of(&scenario).map_err(failed)?;
    let measure = measure(minimise)?;
    let work = DesignWork {
        jobs: threads(*jobs),
        effort: effort.work(),
        shortest: *shortest,
        continuous: *continuous,
    };
    let runs = seeds.map(|seeds| Runs {
        scenario: &scenario,
        setup: &setup,
        seeds,
        rate: confirm_rate,
        attempts_max: *confirm_attempts,
        file: &of_scenario.scenario,
        work,
    });
    if let Some(runs) = &runs {
        runs.check()?;
    }
    let limits = limits(of_limits)?;
    let mut outcomes = Vec::new();
    let mut states = States::read(state.as_deref(), *resume)?;
    watch_interrupts();
    for rotation in rotations(*choice) {
        let problem = SearchProblem::new(setup.with_rotation(*rotation), measure, limits, *seed)
            .map_err(failed)?;
        outcomes.push(design(work, &setup, &problem, *rotation, &mut states)?);
    }
    outcomes.sort_by(|a, b| {
        let of = |outcome: &Outcome| (outcome.design.duration_h, outcome.design.score);
        of(a).0.total_cmp(&of(b).0).then(of(a).1.total_cmp(&of(b).1))
    });
    let confirmation = match &runs {
        Some(runs) => Some(confirm(runs, &outcomes, &mut states)?),
        None => None,
    };
    let written = confirmation.as_ref().and_then(Confirmed::design).or(outcomes.first());
    if let (Some(out), Some(best)) = (out, written) {
        let said = confirmation.as_ref().map(|confirmation| confirmation.report.words());
        write_scenario(&scenario, best, measure, *seed, (out, said))?;
    }
    let confirmation = confirmation.map(|confirmation| confirmation.report);
    let verdict = match &confirmation {
        Some(report) if report.confirmed.is_none() => Verdict::Inconclusive,
        _ => Verdict::Pass,
    };
    let shortest = outcomes.first_mut().and_then(|best| best.shortest.take());
    let report = Report {
        schema: SCHEMA,
        octant: env!("CARGO_PKG_VERSION"),
        scenario: scenario.title.clone(),
        measure: measure.name(),
        unit: measure.unit(),
        seed: *seed,
        limits,
        candidates: work.effort.candidates(),
        designs: outcomes.into_iter().map(|outcome| outcome.design).collect(),
        shortest,
        confirmation,
    };
    if *json {
        print_json(&report)?;
    } else {
        print(&text::of(&report, measure))?;
    }
    Ok(verdict)
}
