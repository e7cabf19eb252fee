//! The loop of a search: candidates, their runs, the journal.

use crate::bench::SearchBench;
use crate::candidate::Candidate;
use crate::earlier::{EarlierScreens, EarlierSearch};
use crate::error::SearchError;
use crate::guide::Guide;
use crate::journal::{Identity, JOURNAL_SCHEMA, Journal, hash_of};
use crate::latin::latin;
use crate::space::Space;
use crate::trial::Trial;
use octant_base::control::Control;
use octant_score::numerics;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Candidates that are proposed together: their beginnings are shared, whatever the number of processors.
const PROPOSED: usize = 16;

/// Way in which candidates are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// By the results before.
    Guided,
    /// A Latin hypercube, for comparison.
    Latin,
}

impl Strategy {
    /// Name for the user.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Guided => "guided",
            Self::Latin => "latin",
        }
    }
}

/// Settings of a search.
#[derive(Clone, Debug)]
pub struct SearchPlan {
    /// The strategy.
    pub strategy: Strategy,
    /// Runs with faults, at least: the last candidates that are proposed together are run to their end.
    pub runs: usize,
    /// Seed of the candidates.
    pub seed: u64,
    /// Share of new candidates with two faults, from 0 to 1.
    pub pairs: f64,
    /// Harm at which the search ends, as a multiple of that from which a fault is harmful; `None`: all runs.
    pub enough: Option<f64>,
    /// A search before this one, of a core that was changed since; a Latin hypercube takes none.
    pub after: Option<EarlierSearch>,
}

/// Runs a search, or goes on with that of a journal. `tell` is called with all trials after each proposal.
///
/// # Errors
/// If it can't run, or if the end was asked for; the journal stays.
pub fn search(
    bench: &SearchBench,
    space: &Space,
    plan: &SearchPlan,
    journal: Option<&Path>,
    control: &Control,
    tell: &mut dyn FnMut(&[Trial]),
) -> Result<Vec<Trial>, SearchError> {
    let mut journal =
        journal.map(|path| Journal::open(path, &identity(bench, space, plan))).transpose()?;
    let mut proposer = match plan.strategy {
        Strategy::Guided => {
            let earlier = plan.after.as_ref();
            let screens = earlier.map(|earlier| EarlierScreens::of(&earlier.trials, space));
            let guide = Guide::new(space, plan.seed, plan.pairs);
            Proposer::Guided(guide.after(screens.unwrap_or_default()))
        }
        Strategy::Latin => {
            let mut all = latin(space, plan.seed, plan.pairs, plan.runs);
            all.reverse();
            Proposer::Listed(all)
        }
    };
    let mut trials: Vec<Trial> = Vec::new();
    let (mut runs, mut proposed) = (0, 0);
    // Candidates that the scenario can't have cost no run, and don't go on forever.
    while runs < plan.runs && proposed < 20 * plan.runs.max(PROPOSED) {
        let candidates = proposer.propose(PROPOSED);
        if candidates.is_empty() {
            break;
        }
        if control.cancel.load(Ordering::Relaxed) {
            return Err(SearchError::Cancelled);
        }
        let known = journal.as_mut().map(|journal| journal.take(&candidates)).transpose()?;
        let results = match known.flatten() {
            Some(known) => known,
            None => {
                let results = bench.run(space, candidates, control)?;
                if let Some(journal) = &mut journal {
                    journal.keep(&results)?;
                }
                results
            }
        };
        proposer.learn(&results);
        proposed += results.len();
        runs += results.iter().filter(|trial| trial.is_run()).count();
        trials.extend(results);
        tell(&trials);
        let worst = trials.iter().filter_map(Trial::unnoticed_harm).fold(0.0, f64::max);
        if plan.enough.is_some_and(|enough| worst >= enough) {
            break;
        }
    }
    Ok(trials)
}

enum Proposer<'a> {
    Guided(Guide<'a>),
    /// Candidates, the first last.
    Listed(Vec<Candidate>),
}

impl Proposer<'_> {
    fn propose(&mut self, count: usize) -> Vec<Candidate> {
        match self {
            Self::Guided(guide) => guide.propose(count),
            Self::Listed(all) => {
                all.split_off(all.len().saturating_sub(count)).into_iter().rev().collect()
            }
        }
    }

    fn learn(&mut self, results: &[Trial]) {
        if let Self::Guided(guide) = self {
            guide.learn(results);
        }
    }
}

fn identity(bench: &SearchBench, space: &Space, plan: &SearchPlan) -> Identity {
    let strategy = match plan.strategy {
        Strategy::Guided => {
            let after = plan.after.as_ref();
            let after = after.map(|after| format!(", after {}", after.journal_blake3));
            format!("guided, pairs {}{}", plan.pairs, after.unwrap_or_default())
        }
        Strategy::Latin => format!("latin, pairs {}, runs {}", plan.pairs, plan.runs),
    };
    Identity {
        schema: JOURNAL_SCHEMA,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        numerics: numerics::NUMERICS,
        scenario_blake3: blake3::hash(bench.base().as_bytes()).to_hex().to_string(),
        space_blake3: hash_of(space),
        seed: bench.seed(),
        search_seed: plan.seed,
        strategy,
    }
}
