//! Search for the best sequence: simulated annealing of several chains, in rounds.
//!
//! A chain's round depends on its state before it, the seed and the numbers of chain and step alone, and
//! chains meet between rounds only. So the result doesn't depend on the number of threads, and a search
//! that goes on from a stored state gives the same sequence as one that was never interrupted.

use crate::candidate::{GridStop, Limits, sequence_of};
use crate::judge::{Judge, MeasureWeights};
use crate::measure::DesignMeasure;
use crate::mutate::{changed, random};
use crate::ranked::rank;
use crate::setup::{DesignError, Setup};
use octant_base::failing::{Failing, FailureKind};
use octant_base::pool;
use octant_calibration::positions::SEQUENCES;
use octant_random::draws::Draws;
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, PoisonError};

pub use crate::ranked::Found;

/// Version of the form of a stored search.
pub const STATE_VERSION: u32 = 1;
/// Relative increases of the measure that are accepted once in e times, at the start and at the end of the
/// annealing.
const TEMPERATURES: (f64, f64) = (0.05, 0.0005);
/// Share of the rounds that anneal; in the others only improvements are accepted.
const ANNEALED: f64 = 0.8;
/// Trials for a random start that fits its duration.
const STARTS_MAX: u64 = 200;

/// Subject of a search.
#[derive(Clone, Debug)]
pub struct SearchProblem {
    /// The scenario.
    pub setup: Setup,
    /// Measure to minimise.
    pub measure: DesignMeasure,
    /// The same, prepared.
    pub weights: MeasureWeights,
    /// Limits of gimbals and sequence.
    pub limits: Limits,
    /// Duration of the calibration, s.
    pub duration_s: f64,
    /// Seed of the search.
    pub seed: u64,
}

/// Work that a search does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SearchEffort {
    /// Number of chains.
    pub chains: usize,
    /// Number of rounds.
    pub rounds: usize,
    /// Steps of a chain in a round.
    pub steps: usize,
}

impl SearchEffort {
    /// Number of candidates that are judged, at most.
    #[must_use]
    pub fn candidates(&self) -> usize {
        self.chains * self.rounds * self.steps
    }
}

/// One chain of the search.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Chain {
    /// Present candidate.
    pub at: Vec<GridStop>,
    /// Best candidate so far.
    pub best: Vec<GridStop>,
}

/// A search between two rounds, as it is stored.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchState {
    /// [`STATE_VERSION`].
    pub version: u32,
    /// Hash of what is searched for, and how.
    pub problem: String,
    /// Rounds that are done.
    pub round: usize,
    /// Chains.
    pub chains: Vec<Chain>,
}

/// Reasons why a search gave no sequence.
#[derive(Debug, thiserror::Error)]
pub enum SearchError {
    /// Nothing fits.
    #[error(
        "search for a sequence: no candidate keeps the limits in {duration_s} s, expected a longer \
         calibration, a shorter lead-in or wider ranges"
    )]
    NothingFits {
        /// Duration of the calibration, s.
        duration_s: f64,
    },
    /// A stored search is of something else.
    #[error(
        "resume the search: found the state of another search (scenario, options, seed or version \
         differ), expected that of this one"
    )]
    OtherSearch,
    /// The search was interrupted between two rounds.
    #[error("search for a sequence: interrupted after {done} of {rounds} rounds")]
    Interrupted {
        /// Rounds that are done.
        done: usize,
        /// All rounds.
        rounds: usize,
    },
    /// The scenario can't be designed for.
    #[error(transparent)]
    Design(#[from] DesignError),
}

impl Failing for SearchError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::NothingFits { .. } | Self::OtherSearch | Self::Design(_) => FailureKind::Input,
            Self::Interrupted { .. } => FailureKind::Inconclusive,
        }
    }
}

impl SearchProblem {
    /// Creates a problem; the duration is the scenario's.
    ///
    /// # Errors
    /// If the limits leave nothing to choose from.
    pub fn new(
        setup: Setup,
        measure: DesignMeasure,
        limits: Limits,
        seed: u64,
    ) -> Result<Self, DesignError> {
        limits.check()?;
        limits.check_lead_in(&setup.conditions.platform.rates)?;
        let weights = MeasureWeights::new(&setup, measure)?;
        let duration_s = setup.duration_s;
        Ok(Self { setup, measure, weights, limits, duration_s, seed })
    }

    /// Creates a judge of candidates.
    #[must_use]
    pub fn judge(&self) -> Judge {
        Judge::new(&self.setup, &self.weights)
    }

    /// Returns the hash of everything that the result depends on.
    #[must_use]
    pub fn hash(&self, effort: SearchEffort) -> String {
        let mut hasher = blake3::Hasher::new();
        let Self { setup, measure, weights, limits, duration_s, seed } = self;
        let conditions = &setup.conditions;
        let mut number = |value: f64| {
            hasher.update(&value.to_le_bytes());
        };
        conditions.initial.rows().iter().flatten().for_each(|value| number(*value));
        let form = &weights.form;
        (0..39).for_each(|i| (0..39).for_each(|j| number(form.at(i, j))));
        let platform = &conditions.platform;
        platform.c_nc.iter().for_each(|value| number(*value));
        [
            form.constant,
            platform.earth.sin_latitude,
            platform.earth.gravity_mps2,
            platform.rates.rate_radps,
            platform.rates.acceleration_radps2,
            platform.non_orthogonality_rad,
            platform.noise.0,
            platform.noise.1,
            conditions.start_s,
            conditions.reference.first as f64,
            conditions.reference.sigma,
            conditions.period_s,
            *duration_s,
        ]
        .into_iter()
        .for_each(number);
        let rest = format!(
            "{STATE_VERSION} {} {:?} {limits:?} {seed} {effort:?} {:?}",
            measure.name(),
            platform.error_model,
            weights.first
        );
        hasher.update(rest.as_bytes());
        hasher.finalize().to_hex().to_string()
    }

    fn score(&self, judge: &mut Judge, stops: &mut [GridStop]) -> f64 {
        let rates = self.setup.conditions.platform.rates;
        let led_in = self.limits.led_in(stops, self.duration_s, &rates);
        let sequence = led_in.and_then(|all| sequence_of(&all));
        let score = sequence.and_then(|sequence| judge.fast(&sequence, self.duration_s).ok());
        score.filter(|score| score.is_finite()).unwrap_or(f64::INFINITY)
    }

    /// Makes the start of each chain: the published sequences, then random ones.
    fn starts(&self, judge: &mut Judge, chains: usize) -> Vec<Chain> {
        let published =
            SEQUENCES.iter().filter_map(|(_, stops, _)| self.limits.of_published(stops));
        let mut all: Vec<Vec<GridStop>> = published.take(chains).collect();
        for chain in all.len()..chains {
            let stream = format!("design.start.{chain}");
            let drawn = (0..STARTS_MAX)
                .map(|trial| random(&self.limits, &mut Draws::of(self.seed, &stream, trial)));
            let mut last = Vec::new();
            for mut stops in drawn {
                let fits = self.score(judge, &mut stops).is_finite();
                last = stops;
                if fits {
                    break;
                }
            }
            all.push(last);
        }
        all.into_iter().map(|stops| Chain { at: stops.clone(), best: stops }).collect()
    }

    /// Does one round of a chain.
    fn round(
        &self,
        judge: &mut Judge,
        effort: SearchEffort,
        round: usize,
        number: usize,
        chain: &mut Chain,
    ) {
        let done = round as f64 / effort.rounds as f64;
        let temperature = match done < ANNEALED {
            true => TEMPERATURES.0 * libm::pow(TEMPERATURES.1 / TEMPERATURES.0, done / ANNEALED),
            false => 0.0,
        };
        if temperature == 0.0 {
            chain.at.clone_from(&chain.best);
        }
        let mut score = self.score(judge, &mut chain.at);
        let mut best = self.score(judge, &mut chain.best);
        let stream = format!("design.chain.{number}");
        for step in 0..effort.steps {
            let step = (round * effort.steps + step) as u64;
            let mut draws = Draws::of(self.seed, &stream, step);
            let Some(mut next) = changed(&self.limits, &chain.at, &mut draws) else { continue };
            let found = self.score(judge, &mut next);
            let worse = libm::log(found / score);
            if found.is_finite()
                && (worse <= 0.0
                    || !score.is_finite()
                    || draws.unit() < libm::exp(-worse / temperature))
            {
                (chain.at, score) = (next, found);
                if score < best {
                    chain.best.clone_from(&chain.at);
                    best = score;
                }
            }
        }
    }

    /// Searches for the best sequence, on `jobs` threads, from a stored state on where there is one.
    ///
    /// `after_round` is called with the state after each round, all rounds and the best measure so far;
    /// `false` ends the search.
    ///
    /// # Errors
    /// If nothing fits, the state is of another search, or the search was ended.
    pub fn search(
        &self,
        effort: SearchEffort,
        jobs: usize,
        stored: Option<SearchState>,
        after_round: &mut dyn FnMut(&SearchState, usize, f64) -> bool,
    ) -> Result<Found, SearchError> {
        let hash = self.hash(effort);
        let mut judge = self.judge();
        let mut state = match stored {
            Some(state) if !self.is_mine(&state, &hash, effort) => {
                return Err(SearchError::OtherSearch);
            }
            Some(state) => state,
            None => {
                let chains = self.starts(&mut judge, effort.chains);
                SearchState { version: STATE_VERSION, problem: hash, round: 0, chains }
            }
        };
        let judges = Mutex::new(vec![judge]);
        while state.round < effort.rounds {
            state.chains = self.all_chains(effort, jobs, &state, &judges);
            state.round += 1;
            let scores = self.meet(&mut state, &judges);
            let best = scores.into_iter().fold(f64::INFINITY, f64::min);
            let goes_on = after_round(&state, effort.rounds, best);
            if !goes_on && state.round < effort.rounds {
                return Err(SearchError::Interrupted { done: state.round, rounds: effort.rounds });
            }
        }
        self.best(&state, &judges)
    }

    fn is_mine(&self, state: &SearchState, hash: &str, effort: SearchEffort) -> bool {
        state.version == STATE_VERSION
            && state.problem == hash
            && state.chains.len() == effort.chains
            && state.round <= effort.rounds
            && state
                .chains
                .iter()
                .all(|chain| self.limits.keep(&chain.at) && self.limits.keep(&chain.best))
    }

    fn all_chains(
        &self,
        effort: SearchEffort,
        jobs: usize,
        state: &SearchState,
        judges: &Mutex<Vec<Judge>>,
    ) -> Vec<Chain> {
        let work = |number: usize| {
            let mut judge = take(judges).unwrap_or_else(|| self.judge());
            let mut chain = state.chains[number].clone();
            self.round(&mut judge, effort, state.round, number, &mut chain);
            judges.lock().unwrap_or_else(PoisonError::into_inner).push(judge);
            Ok::<_, std::convert::Infallible>(Some(chain))
        };
        let Ok(chains) = pool::in_order(jobs, state.chains.len(), || false, work);
        let all = chains.into_iter().zip(&state.chains);
        all.map(|(now, before)| now.unwrap_or_else(|| before.clone())).collect()
    }

    /// Lets the last quarter of the chains go on from the best candidates of the first; returns the
    /// measures of all best candidates.
    fn meet(&self, state: &mut SearchState, judges: &Mutex<Vec<Judge>>) -> Vec<f64> {
        let mut judge = take(judges).unwrap_or_else(|| self.judge());
        let scores: Vec<f64> =
            state.chains.iter_mut().map(|chain| self.score(&mut judge, &mut chain.best)).collect();
        let mut order: Vec<usize> = (0..scores.len()).collect();
        order.sort_by(|a, b| scores[*a].total_cmp(&scores[*b]));
        let quarter = order.len() / 4;
        // Chains find their own way first.
        if state.round.is_multiple_of(MEET_EVERY) {
            for (good, bad) in order.iter().zip(order.iter().rev()).take(quarter) {
                let from = state.chains[*good].best.clone();
                state.chains[*bad] = Chain { at: from.clone(), best: from };
            }
        }
        judges.lock().unwrap_or_else(PoisonError::into_inner).push(judge);
        scores
    }

    fn best(&self, state: &SearchState, judges: &Mutex<Vec<Judge>>) -> Result<Found, SearchError> {
        let mut judge = take(judges).unwrap_or_else(|| self.judge());
        let mut all: Vec<(Vec<GridStop>, f64)> = Vec::new();
        for chain in &state.chains {
            let mut stops = chain.best.clone();
            let score = self.score(&mut judge, &mut stops);
            all.push((stops, score));
        }
        let rates = self.setup.conditions.platform.rates;
        let ranked = rank(all, &mut judge, &self.limits, (self.duration_s, &rates));
        let nothing = SearchError::NothingFits { duration_s: self.duration_s };
        ranked.map_err(DesignError::from)?.ok_or(nothing)
    }
}

/// Rounds between two meetings of the chains.
const MEET_EVERY: usize = 4;

fn take(judges: &Mutex<Vec<Judge>>) -> Option<Judge> {
    judges.lock().unwrap_or_else(PoisonError::into_inner).pop()
}
