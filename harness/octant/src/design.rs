//! `octant design`: the sequence and the rotation with the least drift, and the bound of all of them.

mod files;
mod outcome;
mod text;

use crate::arguments::{ScenarioArguments, load, seconds, seed};
use crate::failure::Failure;
use crate::progress::watch_interrupts;
use crate::progress_bar::ProgressBar;
use crate::terminal::{print, print_json};
use clap::{Args, ValueEnum};
use files::{States, write_scenario};
use octant_base::names::suggestion;
use octant_base::{interrupt, pool};
use octant_calibration::positions::{from_degrees, named};
use octant_design::candidate::{Gimbals, Limits};
use octant_design::measure::DesignMeasure;
use octant_design::report::{SCHEMA, SequenceDesign};
use octant_design::search::{SearchEffort, SearchError, SearchProblem, SearchState};
use octant_design::{DesignError, DesignSetup, Rotation};
use octant_requirements::Verdict;
use outcome::{Outcome, Report, ShortestReport, name_of};
use std::path::PathBuf;

/// Duration of the eight positions whose drift `--shortest` keeps, s.
const EIGHT_S: f64 = 4.0 * 3600.0;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Measure to minimise: longitude, latitude or radial, the rms in the last 3 h of navigation; with
    /// .time-rms over all of it, with .final at its end; or the σ of a parameter, such as sigma.g_zz.
    #[arg(long, value_name = "MEASURE", default_value = "longitude")]
    minimise: String,
    /// Duration of the calibration, in place of the scenario's; with --shortest the longest.
    #[arg(long, value_name = "TIME")]
    duration: Option<String>,
    /// Rotation in navigation that the sequence is designed for.
    #[arg(long, value_enum, default_value_t = RotationChoice::Scenario)]
    rotation: RotationChoice,
    /// Gimbals that may turn in one move.
    #[arg(long, value_enum, default_value_t = GimbalChoice::Both)]
    gimbals: GimbalChoice,
    /// Range of the azimuth gimbal, cumulative, deg.
    #[arg(long, value_name = "LOW..HIGH", default_value = "-360..360", value_parser = range, allow_hyphen_values = true)]
    azimuth_range: Range,
    /// Range of the roll gimbal, cumulative, deg.
    #[arg(long, value_name = "LOW..HIGH", default_value = "-360..360", value_parser = range, allow_hyphen_values = true)]
    roll_range: Range,
    /// Grid of the angles, deg.
    #[arg(long, value_name = "DEG", default_value_t = 45)]
    grid: i32,
    /// Largest number of stops.
    #[arg(long, value_name = "N", default_value_t = 40)]
    stops: usize,
    /// Time at rest at zero with which the sequence starts: the level alignment.
    #[arg(long, value_name = "TIME", default_value = "300 s")]
    lead_in: String,
    /// Shortest dwell.
    #[arg(long, value_name = "TIME", default_value = "30 s")]
    dwell_min: String,
    /// Seed of the search.
    #[arg(long, value_name = "N", default_value = "1", value_parser = seed)]
    seed: u64,
    /// Work of the search.
    #[arg(long, value_enum, default_value_t = EffortChoice::Normal)]
    effort: EffortChoice,
    /// Number of threads; by default the number of processors. The result doesn't depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Find the shortest calibration that keeps the drift of eight positions in 4 h.
    #[arg(long, conflicts_with_all = ["state", "resume"])]
    shortest: bool,
    /// Write the scenario with the designed sequence and its rotation to this file.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Keep the state of the search in this file, after every round.
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Go on from the state in --state.
    #[arg(long, requires = "state")]
    resume: bool,
    /// Replace the files of --out and --state.
    #[arg(long)]
    force: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RotationChoice {
    /// That of the scenario
    Scenario,
    /// Sixteen moves of 180 deg
    Sixteen,
    /// Twelve attitudes, out and back
    Tetrahedral,
    /// A sequence for each of the two shipped schemes, and the better pair of them
    Both,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum GimbalChoice {
    /// Both at once
    Both,
    /// One a move
    One,
    /// The azimuth gimbal alone
    Azimuth,
    /// The roll gimbal alone
    Roll,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum EffortChoice {
    /// Some seconds, for a first look
    Quick,
    /// Below five minutes on two processors
    Normal,
    /// Four times that
    Thorough,
}

impl EffortChoice {
    fn work(self) -> SearchEffort {
        match self {
            Self::Quick => SearchEffort { chains: 8, rounds: 10, steps: 40 },
            Self::Normal => SearchEffort { chains: 16, rounds: 30, steps: 80 },
            Self::Thorough => SearchEffort { chains: 32, rounds: 60, steps: 80 },
        }
    }
}

/// Range of a gimbal, deg.
#[derive(Clone, Copy, Debug)]
struct Range(i32, i32);

/// Parses a range on the command line.
fn range(text: &str) -> Result<Range, String> {
    let expected = || "expected whole degrees such as -90..270".to_owned();
    let (low, high) = text.split_once("..").ok_or_else(expected)?;
    let number = |text: &str| text.trim().parse::<i32>().map_err(|_| expected());
    Ok(Range(number(low)?, number(high)?))
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    refuse_to_replace(arguments)?;
    let duration = arguments.duration.as_ref();
    let more: Vec<String> =
        duration.map(|time| format!("procedure.calibration.duration={time}")).into_iter().collect();
    let scenario = load(&arguments.scenario, &more)?;
    let setup = DesignSetup::of(&scenario).map_err(failed)?;
    let measure = measure(&arguments.minimise)?;
    let limits = limits(arguments)?;
    let mut outcomes = Vec::new();
    let mut states = States::read(arguments.state.as_deref(), arguments.resume)?;
    watch_interrupts();
    for rotation in rotations(arguments.rotation) {
        let problem =
            SearchProblem::new(setup.with_rotation(*rotation), measure, limits, arguments.seed)
                .map_err(failed)?;
        outcomes.push(design(arguments, &setup, &problem, *rotation, &mut states)?);
    }
    outcomes.sort_by(|a, b| {
        let of = |outcome: &Outcome| (outcome.design.duration_h, outcome.design.score);
        of(a).0.total_cmp(&of(b).0).then(of(a).1.total_cmp(&of(b).1))
    });
    if let (Some(out), Some(best)) = (&arguments.out, outcomes.first()) {
        write_scenario(&scenario, best, measure, arguments.seed, out)?;
    }
    let shortest = outcomes.first_mut().and_then(|best| best.shortest.take());
    let report = Report {
        schema: SCHEMA,
        octant: env!("CARGO_PKG_VERSION"),
        scenario: scenario.title.clone(),
        measure: measure.name(),
        unit: measure.unit(),
        seed: arguments.seed,
        limits,
        candidates: arguments.effort.work().candidates(),
        designs: outcomes.into_iter().map(|outcome| outcome.design).collect(),
        shortest,
    };
    if arguments.json {
        print_json(&report)?;
    } else {
        print(&text::of(&report, measure))?;
    }
    Ok(Verdict::Pass)
}

/// Checks, before the search, that no file is lost to its result.
fn refuse_to_replace(arguments: &Arguments) -> Result<(), Failure> {
    let state = arguments.state.as_ref().filter(|_| !arguments.resume);
    for (option, file) in [("--out", arguments.out.as_ref()), ("--state", state)] {
        if let Some(file) = file.filter(|file| !arguments.force && file.exists()) {
            return Err(Failure::input(format!(
                "{option}: {} exists already, expected another name, or --force",
                file.display()
            )));
        }
    }
    Ok(())
}

fn failed(error: DesignError) -> Failure {
    Failure::input(format!("failed to {error}"))
}

fn search_failed(error: SearchError) -> Failure {
    let message = format!("failed to {error}");
    match error {
        SearchError::Interrupted { .. } => {
            Failure { status: Verdict::Inconclusive.exit_code(), message }
        }
        _ => Failure::input(message),
    }
}

fn measure(name: &str) -> Result<DesignMeasure, Failure> {
    DesignMeasure::named(name).ok_or_else(|| {
        let all: Vec<String> = DesignMeasure::all().map(|measure| measure.name()).collect();
        let known = suggestion(name, all.iter().map(String::as_str), "measures");
        Failure::input(format!("--minimise: unknown measure {name:?}, {known}"))
    })
}

fn rotations(choice: RotationChoice) -> &'static [Rotation] {
    match choice {
        RotationChoice::Scenario => &[Rotation::Given],
        RotationChoice::Sixteen => &[Rotation::Sixteen],
        RotationChoice::Tetrahedral => &[Rotation::Tetrahedral],
        RotationChoice::Both => &[Rotation::Sixteen, Rotation::Tetrahedral],
    }
}

fn limits(arguments: &Arguments) -> Result<Limits, Failure> {
    let positive = |name: &str, text: &str| {
        let time_s = seconds(name, text)?;
        if time_s >= 0.0 {
            return Ok(time_s);
        }
        Err(Failure::input(format!("{name}: found {text:?}, expected a time of 0 or more")))
    };
    Ok(Limits {
        gimbals: match arguments.gimbals {
            GimbalChoice::Both => Gimbals::Both,
            GimbalChoice::One => Gimbals::One,
            GimbalChoice::Azimuth => Gimbals::Azimuth,
            GimbalChoice::Roll => Gimbals::Roll,
        },
        azimuth_deg: (arguments.azimuth_range.0, arguments.azimuth_range.1),
        roll_deg: (arguments.roll_range.0, arguments.roll_range.1),
        grid_deg: arguments.grid,
        stops_max: arguments.stops,
        dwell_min_s: positive("--dwell-min", &arguments.dwell_min)?,
        lead_in_s: positive("--lead-in", &arguments.lead_in)?,
    })
}

/// Designs for one rotation.
fn design(
    arguments: &Arguments,
    setup: &DesignSetup,
    problem: &SearchProblem,
    rotation: Rotation,
    states: &mut States<'_>,
) -> Result<Outcome, Failure> {
    let jobs = arguments.jobs.map_or_else(pool::processors, usize::from);
    let effort = arguments.effort.work();
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
    let (problem, found, shortest) = if arguments.shortest {
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
        let stored = states.stored(rotation);
        let mut told = |state: &SearchState, rounds: usize, best: f64| {
            show(problem.duration_s, state, rounds, best);
            kept = states.keep(rotation, state);
            kept.is_ok() && !interrupt::seen()
        };
        let found = problem.search(effort, jobs, stored, &mut told);
        (problem.clone(), found.map_err(search_failed).or_else(|e| kept.and(Err(e)))?, None)
    };
    bar.finish();
    let design = SequenceDesign::of(&problem, name_of(rotation), &found).map_err(search_failed)?;
    Ok(Outcome { rotation, design, stops: found.stops, shortest })
}

/// Returns the measure of eight positions in 4 h with the scenario's own rotation.
fn eight(setup: &DesignSetup, problem: &SearchProblem) -> Result<f64, Failure> {
    let mut judge = octant_design::Judge::new(setup, problem.measure, &setup.drift());
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
