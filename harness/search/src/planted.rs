//! Planted weaknesses: screens are weakened one at a time, and the guided search is compared with a Latin hypercube
//! by the runs that each takes to a fault that the screens as shipped don't let pass.
//!
//! `cargo test --release -p octant-search -- --ignored --nocapture planted`; the table of `docs/faults.md`.

use crate::bench::SearchBench;
use crate::derived::{RunTimes, derived, searchable};
use crate::search::{SearchPlan, SearchStrategy, is_run, search};
use crate::space::SearchSpace;
use crate::trial::FaultTrial;
use octant_base::control::Control;
use octant_base::pool::processors;
use octant_scenario::Scenario;
use std::path::Path;

const SHORT: &str = include_str!("../../../fixtures/search/short.toml");
/// Harm that no fault of the search reaches unnoticed with the screens as they are shipped.
const LIMIT: f64 = 10.0;
const GUIDED_SEEDS: u64 = 3;
const GUIDED_RUNS: usize = 1000;
const LATIN_RUNS: usize = 2000;

/// Name of a weakness, and the settings that make it.
const WEAKNESSES: [(&str, &[&str]); 10] = [
    ("gate off", &["screening.gate=\"off\""]),
    ("gate at NIS 400", &["screening.gate.nis=400"]),
    ("stuck test off", &["screening.stuck_samples=\"off\""]),
    ("stuck test from 1000 samples on", &["screening.stuck_samples=1000"]),
    ("jumps off", &["screening.jumps=\"off\""]),
    ("bridging off", &["screening.bridging=\"off\""]),
    ("gimbals off", &["screening.gimbals=\"off\""]),
    ("drift test off", &["screening.drift=\"off\""]),
    ("drift test at 60 σ", &["screening.drift=60"]),
    ("stamps of aiding off", &["screening.aiding_stamps=\"off\""]),
];

fn bench(changes: &[&str]) -> (SearchBench, SearchSpace) {
    let changes: Vec<String> = changes.iter().map(|change| (*change).to_owned()).collect();
    let scenario = Scenario::parse(SHORT, "short.toml", Path::new("."), &changes).unwrap();
    let bench = SearchBench::new(&scenario, 1, processors(), &Control::default()).unwrap();
    let kinds: Vec<_> = searchable().collect();
    let times = RunTimes { sample_s: 0.05, length_s: 1440.0 };
    let (space, _) = bench.possible(&derived(&kinds, times));
    (bench, space)
}

/// Trials of a search.
fn trials(
    (bench, space): &(SearchBench, SearchSpace),
    strategy: SearchStrategy,
    runs: usize,
    seed: u64,
    enough: Option<f64>,
) -> Vec<FaultTrial> {
    let plan = SearchPlan { strategy, runs, seed, pairs: 0.1, enough };
    search(bench, space, &plan, None, &Control::default(), &mut |_| {}).unwrap()
}

/// Runs up to the first trial beyond the limit, if there is one, and the number of such trials.
fn beyond(trials: &[FaultTrial]) -> (Option<usize>, usize) {
    let harmful = |trial: &&FaultTrial| trial.unnoticed_harm().is_some_and(|harm| harm >= LIMIT);
    let ran = || trials.iter().filter(|trial| is_run(trial));
    (ran().position(|trial| harmful(&trial)).map(|at| at + 1), ran().filter(harmful).count())
}

#[test]
#[ignore = "half an hour of processor time"]
fn planted_weaknesses_are_found_with_a_tenth_of_the_runs() {
    let shipped = bench(&[]);
    for seed in 1..=GUIDED_SEEDS {
        let (first, _) = beyond(&trials(&shipped, SearchStrategy::Guided, GUIDED_RUNS, seed, None));
        assert_eq!(first, None, "as shipped, seed {seed}");
    }
    println!("| weakness | guided, runs of {GUIDED_SEEDS} seeds | Latin, runs to the first |");
    let mut ratios = Vec::new();
    for (name, changes) in WEAKNESSES {
        let bench = bench(changes);
        let guided: Vec<Option<usize>> = (1..=GUIDED_SEEDS)
            .map(|seed| {
                beyond(&trials(&bench, SearchStrategy::Guided, GUIDED_RUNS, seed, Some(LIMIT))).0
            })
            .collect();
        let (_, found) = beyond(&trials(&bench, SearchStrategy::Latin, LATIN_RUNS, 1, None));
        let mean = guided.iter().map(|runs| runs.unwrap_or(GUIDED_RUNS) as f64).sum::<f64>()
            / guided.len() as f64;
        // With none found there is less than one in so many.
        let latin = LATIN_RUNS as f64 / found.max(1) as f64;
        println!("| {name} | {guided:?}, mean {mean:.0} | {latin:.0} ({found} of {LATIN_RUNS}) |");
        ratios.push((name, mean / latin));
    }
    println!("{ratios:?}");
}
