//! `octant faults search`: the fault that does most harm unnoticed.

use super::case_progress::CaseBar;
use super::progress::interruptible;
use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::terminal::{note, print, print_json, write};
use clap::{Args, ValueEnum};
use octant_base::control::Control;
use octant_base::failing::Failing;
use octant_base::names::suggestion;
use octant_base::pool::processors;
use octant_evidence::manifest::shell_path;
use octant_faults::catalogue::FaultKind;
use octant_scenario::Scenario;
use octant_search::bench::SearchBench;
use octant_search::derived::{RunTimes, derived, searchable};
use octant_search::earlier::{EarlierFound, EarlierSearch};
use octant_search::error::SearchError;
use octant_search::found::{FoundFault, SearchFound, worst};
use octant_search::minimal::minimal;
use octant_search::page::render;
use octant_search::search::{SearchPlan, Strategy, search};
use octant_search::space::Space;
use octant_search::space_file;
use octant_search::trial::{Trial, TrialEffect, TrialResult};
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Kinds to search among, separated by commas; by default all that act on samples or on what makes them.
    #[arg(long, value_name = "KINDS", value_delimiter = ',', conflicts_with = "space")]
    kinds: Vec<String>,
    /// File with the faults to search among, and the values of their keys.
    #[arg(long, value_name = "FILE")]
    space: Option<PathBuf>,
    /// Print the space that would be searched as such a file, and run nothing but the scenario without faults.
    #[arg(long)]
    print_space: bool,
    /// Seed of all runs, instead of the scenario's.
    #[arg(long, value_name = "N", value_parser = crate::arguments::seed, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Number of parallel runs; by default the number of processors.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    #[command(flatten)]
    searching: SearchingArguments,
}

/// The search itself, of which there is none where the space alone is printed.
#[derive(Debug, Args)]
struct SearchingArguments {
    /// Runs with faults, at least.
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..))]
    runs: u32,
    /// Share of candidates with two faults at once, from 0 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 0.2, value_parser = share)]
    pairs: f64,
    /// End when a fault with this harm went unnoticed; 1 is a shift of 3 σ.
    #[arg(long, value_name = "HARM", value_parser = positive)]
    enough: Option<f64>,
    /// How candidates are chosen.
    #[arg(long, value_enum, default_value = "guided")]
    strategy: StrategyName,
    /// Seed of the candidates.
    #[arg(long, value_name = "N", default_value = "1", value_parser = crate::arguments::seed, allow_negative_numbers = true)]
    search_seed: u64,
    /// Folder of an earlier search of another core in the same space: first what noticed faults there is asked again, then the
    /// search goes on where it answers otherwise.
    #[arg(long, value_name = "DIR")]
    after: Option<PathBuf>,
    /// Folder for worst.toml, search.json, search.html and the journal with which an interrupted search goes on;
    /// by default nothing is written.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print search.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum StrategyName {
    /// By the results before.
    Guided,
    /// A Latin hypercube: all at once, for comparison.
    Latin,
}

fn share(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|share| (0.0..=1.0).contains(share));
    number.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}

pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    if arguments.print_space {
        given.refuse::<SearchingArguments>(
            "found with --print-space, expected one without the other: nothing is searched then",
        )?;
    }
    let scenario = load(&arguments.scenario, &[])?;
    let seed = arguments.seed.unwrap_or(scenario.seed);
    interruptible(|control| searched(arguments, &scenario, seed, control))
}

fn searched(
    arguments: &Arguments,
    scenario: &Scenario,
    seed: u64,
    control: &Control,
) -> Result<Verdict, Failure> {
    let Arguments {
        scenario: ScenarioArguments { scenario: file, set: _ },
        kinds,
        space,
        print_space,
        // The caller has chosen it.
        seed: _,
        jobs,
        searching,
    } = arguments;
    let SearchingArguments { runs, pairs, enough, strategy, search_seed, after, out, json } =
        searching;
    // Files are read before anything is run.
    let asked = asked((file, kinds, space.as_deref()), scenario)?;
    let jobs = jobs.map_or_else(processors, usize::from);
    let bench = SearchBench::new(scenario, seed, jobs, control).map_err(failure)?;
    let (space, left_out) = possible(&bench, asked, space.as_deref())?;
    if *print_space {
        print(&space_file::to_toml(&space))?;
        return Ok(Verdict::Pass);
    }
    let after = earlier(after.as_deref(), *strategy, &space)?;
    if let Some(folder) = out {
        std::fs::create_dir_all(folder).map_err(|error| {
            Failure::bench(format!("failed to create {}: {error}", folder.display()))
        })?;
    }
    let strategy = match strategy {
        StrategyName::Guided => Strategy::Guided,
        StrategyName::Latin => Strategy::Latin,
    };
    let plan = SearchPlan {
        strategy,
        runs: *runs as usize,
        seed: *search_seed,
        pairs: *pairs,
        enough: *enough,
        after,
    };
    let journal = out.as_ref().map(|folder| folder.join("search.jsonl"));
    let bar = CaseBar::new("search", plan.runs, jobs, plan.enough.is_some());
    let mut told = 0;
    let mut tell = |trials: &[Trial]| {
        trials[told..].iter().filter(|trial| trial.is_run()).for_each(|_| bar.ended(None, false));
        told = trials.len();
    };
    let name = |_: usize| String::new();
    let work = || search(&bench, &space, &plan, journal.as_deref(), control, &mut tell);
    let trials = bar.during(&name, work).map_err(failure)?;
    let found = SearchFound {
        scenario: scenario.title.clone(),
        seed,
        search_seed: plan.seed,
        strategy: strategy.name().to_owned(),
        pairs: plan.pairs,
        earlier: plan.after.as_ref().map(|earlier| EarlierFound::of(earlier, &trials)),
        left_out,
        ..SearchFound::of(&trials, &space)
    };
    let target = SearchTarget { rerun: rerun(arguments, seed), out: out.as_deref(), json: *json };
    conclude(&target, &bench, &space, &trials, found, control)
}

/// The space that was asked for.
fn asked(
    (of_scenario, kinds, space): (&Path, &[String], Option<&Path>),
    scenario: &Scenario,
) -> Result<Space, Failure> {
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let Some(samples) = scenario.samples() else {
        return Err(Failure::input(format!(
            "failed to search {}: found a run whose length isn't known before, expected one that is",
            of_scenario.display()
        )));
    };
    let times = RunTimes { sample_s, length_s: samples as f64 * sample_s };
    if let Some(file) = space {
        return space_file::read(file, times)
            .map_err(|error| Failure::input(format!("failed to read {error}")));
    }
    let kinds = match kinds {
        [] => searchable().collect(),
        names => names.iter().map(|name| the_kind(name)).collect::<Result<Vec<_>, _>>()?,
    };
    Ok(derived(&kinds, times))
}

/// The earlier search, read before anything is written.
fn earlier(
    folder: Option<&Path>,
    strategy: StrategyName,
    space: &Space,
) -> Result<Option<EarlierSearch>, Failure> {
    let Some(folder) = folder else { return Ok(None) };
    if let StrategyName::Latin = strategy {
        return Err(Failure::input(
            "--after: a Latin hypercube is drawn all at once and takes no earlier search; leave out one of --after and \
             --strategy latin",
        ));
    }
    let earlier = EarlierSearch::read(&folder.join("search.jsonl"), space);
    earlier.map(Some).map_err(|error| Failure::input(format!("failed to search: --after: {error}")))
}

fn the_kind(name: &str) -> Result<&'static FaultKind, Failure> {
    let known: Vec<&str> = searchable().map(|kind| kind.name).collect();
    searchable().find(|kind| kind.name == name).ok_or_else(|| {
        let known = suggestion(name, known.iter().copied(), "kinds");
        Failure::input(format!(
            "--kinds: found {name:?}, which is no kind that a search takes, {known}"
        ))
    })
}

/// The part of a space that the scenario can have. A file has to be possible as a whole.
fn possible(
    bench: &SearchBench,
    asked: Space,
    file: Option<&Path>,
) -> Result<(Space, Vec<(String, String)>), Failure> {
    if let Some(file) = file {
        return match bench.impossible(&asked) {
            None => Ok((asked, Vec::new())),
            Some((form, reason)) => Err(Failure::input(format!(
                "failed to read {}: faults[{}]: {reason}",
                file.display(),
                form + 1
            ))),
        };
    }
    let (space, left_out) = bench.possible(&asked);
    match left_out.first() {
        Some((_, reason)) if space.forms.is_empty() => {
            Err(failure(SearchError::EmptySpace(reason.clone())))
        }
        _ => Ok((space, left_out)),
    }
}

/// Where the results of a search go, and the command line that makes them again.
struct SearchTarget<'a> {
    rerun: String,
    out: Option<&'a Path>,
    json: bool,
}

/// Makes the worst fault smaller, runs it undivided, writes and prints the result.
fn conclude(
    target: &SearchTarget<'_>,
    bench: &SearchBench,
    space: &Space,
    trials: &[Trial],
    mut found: SearchFound,
    control: &Control,
) -> Result<Verdict, Failure> {
    let missed =
        worst(trials).filter(|trial| trial.unnoticed_harm().is_some_and(|harm| harm >= 1.0));
    let mut scenario = None;
    if let Some(trial) = missed {
        let smaller = minimal(bench, space, trial, control).map_err(failure)?;
        let about = [
            "The worst fault that went unnoticed, found by octant faults search.".to_owned(),
            target.rerun.clone(),
        ];
        let text = bench.text_of(&smaller.space, &smaller.trial.candidate, &about);
        let again = bench.again(&text, control).map_err(failure)?;
        if again != smaller.trial.result {
            let words = smaller.trial.candidate.words(&smaller.space);
            return Err(failure(SearchError::Differs(format!(
                "{words}: undivided it had another effect"
            ))));
        }
        found.minimal = FoundFault::of(&smaller.trial, &smaller.space);
        found.minimal_runs = smaller.runs;
        scenario = Some(text);
    }
    if let Some(folder) = target.out {
        let json = serde_json::to_string_pretty(&found)
            .map_err(|error| Failure::bench(format!("failed to write search.json: {error}")))?;
        write(&folder.join("search.json"), json + "\n")?;
        write(&folder.join("search.html"), render(&found, trials, space, &target.rerun))?;
        if let Some(text) = &scenario {
            write(&folder.join("worst.toml"), text.clone())?;
        }
    }
    if target.json {
        print_json(&found)?;
    } else {
        print(&found.text())?;
        if let (Some(folder), Some(_)) = (target.out, &scenario) {
            print(&format!(
                "octant run {} --seed {}\n",
                shell_path(&folder.join("worst.toml")),
                bench.seed()
            ))?;
        }
    }
    Ok(verdict(&found, trials))
}

/// A fail where something harmful went unnoticed; a pass needs runs whose faults acted.
fn verdict(found: &SearchFound, trials: &[Trial]) -> Verdict {
    let acted = trials.iter().filter_map(Trial::effect).any(TrialEffect::is_judged);
    let broken = trials.iter().any(|trial| matches!(trial.result, TrialResult::Broken(_)));
    match found.missed {
        0 if !acted => {
            note!(
                "octant: no fault altered anything whose harm could be judged: the search shows nothing"
            );
            Verdict::Inconclusive
        }
        0 if broken => Verdict::Inconclusive,
        0 if found.earlier.as_ref().is_some_and(EarlierFound::is_too_short) => {
            note!(
                "octant: not all faults that were harmful and unnoticed in the earlier search were run again: expected more --runs"
            );
            Verdict::Inconclusive
        }
        0 => Verdict::Pass,
        _ => Verdict::Fail,
    }
}

fn failure(error: SearchError) -> Failure {
    if let SearchError::Method(error) = error {
        return Failure::from(error).failed();
    }
    Failure::of_kind(error.kind(), format!("failed to search: {error}"))
}

/// Returns the command line that makes the search again.
fn rerun(arguments: &Arguments, used_seed: u64) -> String {
    // Where the results go makes no other search, nor do the parallel runs.
    let Arguments { scenario, kinds, space, print_space: _, seed: _, jobs: _, searching } =
        arguments;
    let ScenarioArguments { scenario, set } = scenario;
    let SearchingArguments { runs, pairs, enough, strategy, search_seed, after, out: _, json: _ } =
        searching;
    let mut line = format!("octant faults search {}", shell_path(scenario));
    for set in set {
        line += &format!(" --set '{set}'");
    }
    if !kinds.is_empty() {
        line += &format!(" --kinds {}", kinds.join(","));
    }
    if let Some(space) = space {
        line += &format!(" --space {}", shell_path(space));
    }
    if let StrategyName::Latin = strategy {
        line += " --strategy latin";
    }
    if let Some(folder) = after {
        line += &format!(" --after {}", shell_path(folder));
    }
    if let Some(enough) = enough {
        line += &format!(" --enough {enough}");
    }
    line + &format!(" --runs {runs} --pairs {pairs} --seed {used_seed} --search-seed {search_seed}")
}
