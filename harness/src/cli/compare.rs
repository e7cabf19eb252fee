//! `octant compare`: two methods over many seeds, on the same instruments with the same noise.

use super::progress::with_progress;
use super::{Failure, ScenarioArguments, load, print, print_json, write};
use crate::run::method::{MethodError, label};
use crate::run::{Control, Recording, run_method};
use crate::scenario::{Method, Scenario};
use crate::score::compare::{Comparison, Maxima, PairedRun, compare};
use crate::score::floor::Floor;
use crate::score::verdict::Verdict;
use clap::Args;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Members of the ensemble that the floor of the random walk is taken from.
const FLOOR_MEMBERS: u32 = 400;
/// Hours of the marks that methods are compared at.
const MARKS_H: [f64; 2] = [24.0, 72.0];

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// The scenario to be improved on. Without it: the scenario's own [baseline]; where there is
    /// none, the scenario as it stands against the scenario with --set.
    #[arg(long, value_name = "SCENARIO")]
    against: Option<PathBuf>,
    /// Number of seeds, from the scenario's own on.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: u64,
    /// Folder for compare.json and compare.html; by default nothing is written.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print compare.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
}

/// A method of a scenario.
struct Side {
    scenario: Scenario,
    method: Method,
}

/// Both sides: what is to be improved on, and what is to improve on it.
fn sides(arguments: &Arguments) -> Result<(Side, Side), Failure> {
    let side = |scenario, method| Side { scenario, method };
    let second = load(&arguments.scenario, &[])?;
    if let Some(against) = &arguments.against {
        let first = Scenario::load(against, &[]).map_err(Failure::input)?;
        return Ok((side(first, Method::Primary), side(second, Method::Primary)));
    }
    if second.baseline.is_some() {
        return Ok((side(second.clone(), Method::Baseline), side(second, Method::Primary)));
    }
    if arguments.scenario.set.is_empty() {
        return Err(Failure::input(format!(
            "failed to compare {}: it has no [baseline]; give --against SCENARIO, or --set \
             KEY=VALUE for what the second method has",
            arguments.scenario.scenario.display()
        )));
    }
    let first = Scenario::load(&arguments.scenario.scenario, &[]).map_err(Failure::input)?;
    Ok((side(first, Method::Primary), side(second, Method::Primary)))
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let (first, second) = sides(arguments)?;
    let scenario = &second.scenario;
    if scenario.source != crate::scenario::Source::Plant {
        return Err(Failure::input("failed to compare: seeds need source.uri = \"plant\""));
    }
    let seeds: Vec<u64> = (0..arguments.seeds).map(|n| scenario.seed.wrapping_add(n)).collect();
    let maxima = ensemble(&[&first, &second], &seeds)?;
    let runs: Vec<PairedRun> = seeds
        .iter()
        .zip(&maxima)
        .map(|(seed, pair)| PairedRun { seed: *seed, first: pair[0], second: pair[1] })
        .collect();
    let floor = Floor::new(
        scenario.site.latitude_rad,
        scenario.site.height_m,
        scenario.imu.angle_random_walk,
        scenario.imu.velocity_random_walk,
    )
    .maxima(&MARKS_H, FLOOR_MEMBERS, scenario.seed);
    let names = [&first, &second].map(|side| label(&side.scenario, side.method));
    let names = if names[0] == names[1] {
        [format!("{} (first)", names[0]), format!("{} (second)", names[1])]
    } else {
        names
    };
    let comparison = compare(&scenario.title, &names[0], &names[1], &runs, &floor);
    if comparison.cells.is_empty() {
        return Err(Failure::input(
            "failed to compare: the navigation is shorter than the first mark, 24 h",
        ));
    }
    write_results(arguments, &comparison)?;
    Ok(Verdict::Pass)
}

/// Runs every seed with every side, on all processors, in an order that the result doesn't show.
fn ensemble(sides: &[&Side; 2], seeds: &[u64]) -> Result<Vec<[Maxima; 2]>, Failure> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let controls: Vec<Control> = (0..2 * seeds.len()).map(|_| Control::default()).collect();
    let samples =
        sides.iter().map(|side| side.scenario.samples()).sum::<Option<u64>>().unwrap_or_default();
    let sample_s = sides[0].scenario.sample_period_ns as f64 * 1e-9;
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<Result<Maxima, Failure>>>> =
        Mutex::new((0..2 * seeds.len()).map(|_| None).collect());
    with_progress(&controls, Some(samples * seeds.len() as u64), sample_s, || {
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    loop {
                        let task = next.fetch_add(1, Ordering::Relaxed);
                        let Some(control) = controls.get(task) else { break };
                        let result = one(sides[task % 2], seeds[task / 2], control);
                        results.lock().unwrap_or_else(PoisonError::into_inner)[task] = Some(result);
                    }
                });
            }
        });
    });
    let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    let maxima = results
        .into_iter()
        .map(|result| result.unwrap_or_else(|| Err(Failure::bench("failed to run a seed"))))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(maxima.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
}

fn one(side: &Side, seed: u64, control: &Control) -> Result<Maxima, Failure> {
    let run = run_method(&side.scenario, side.method, seed, Recording::None, control)
        .map_err(|error: MethodError| Failure::from(error))?;
    let samples = side.scenario.samples().unwrap_or_default();
    control.epochs.store(samples, Ordering::Relaxed);
    if run.ended == crate::run::Ended::Cancelled {
        return Err(Failure {
            status: Verdict::Inconclusive.exit_code(),
            message: "interrupted".to_owned(),
        });
    }
    match (&run.navigation, run.calibration.and_then(|c| c.refused)) {
        (Some(navigation), _) => Ok(Maxima::of(navigation)),
        (None, Some(reason)) => Err(Failure {
            status: Verdict::Fail.exit_code(),
            message: format!("seed {seed}, {}: calibration refused: {reason}", run.label),
        }),
        (None, None) => Err(Failure::input(
            "failed to compare: the scenario has no [procedure.navigation] to be scored",
        )),
    }
}

fn write_results(arguments: &Arguments, comparison: &Comparison) -> Result<(), Failure> {
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder).map_err(|error| {
            Failure::bench(format!("failed to create {}: {error}", folder.display()))
        })?;
        let json = serde_json::to_string_pretty(comparison)
            .map_err(|error| Failure::bench(format!("failed to write compare.json: {error}")))?;
        write(&folder.join("compare.json"), json + "\n")?;
        let mut line = vec![
            "octant".to_owned(),
            "compare".to_owned(),
            arguments.scenario.scenario.display().to_string(),
        ];
        for set in &arguments.scenario.set {
            line.extend(["--set".to_owned(), format!("'{set}'")]);
        }
        if let Some(against) = &arguments.against {
            line.extend(["--against".to_owned(), against.display().to_string()]);
        }
        line.extend(["--seeds".to_owned(), arguments.seeds.to_string()]);
        let provenance = [("rerun".to_owned(), line.join(" "))];
        let html = crate::report::compare::render(comparison, &provenance);
        write(&folder.join("compare.html"), html)?;
    }
    if arguments.json {
        print_json(comparison)
    } else {
        print(&crate::report::compare::table(comparison))
    }
}
