//! Result of a search.

use crate::earlier::EarlierFound;
use crate::space::Space;
use crate::trial::{Trial, TrialEffect, TrialResult};
use octant_base::number::{counted, significant};
use octant_score::counterfactual::HARMFUL_SHIFT_SIGMA;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of `search.json`.
pub const SEARCH_SCHEMA: u32 = 1;

/// Result of a search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SearchFound {
    /// [`SEARCH_SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub octant: String,
    /// Title of the scenario.
    pub scenario: String,
    /// Seed of the runs.
    pub seed: u64,
    /// Seed of the candidates.
    pub search_seed: u64,
    /// Strategy.
    pub strategy: String,
    /// Share of candidates with two faults.
    pub pairs: f64,
    /// Screens of the earlier search with which this one began.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub earlier: Option<EarlierFound>,
    /// Shift of a parameter, in σ, from which a fault counts as harmful.
    pub harmful_shift_sigma: f64,
    /// Runs with faults.
    pub runs: usize,
    /// Candidates that the scenario can't have.
    pub refused: usize,
    /// Runs in which a fault altered nothing.
    pub not_fired: usize,
    /// Runs whose fault changed the instrument for good unnoticed, without a navigation that would show the harm.
    pub not_judged: usize,
    /// Runs in which it was noticed.
    pub noticed: usize,
    /// Runs that were harmful and unnoticed.
    pub missed: usize,
    /// Number of the first such run, from 1.
    pub first_missed: Option<usize>,
    /// Worst fault that went unnoticed, as it was found.
    pub worst: Option<FoundFault>,
    /// The same, made smaller.
    pub minimal: Option<FoundFault>,
    /// Runs that making it smaller took.
    pub minimal_runs: usize,
    /// Result for each kind, and for each pair of kinds that was tried.
    pub kinds: Vec<KindFound>,
    /// Largest shift of each parameter that went unnoticed with a published calibration, in posterior σ.
    pub largest_unnoticed: BTreeMap<String, UnnoticedShift>,
    /// Kinds that the scenario can't have, with the reason.
    pub left_out: Vec<(String, String)>,
    /// Runs that ended without a result, with the reason.
    pub broken: Vec<(String, String)>,
}

/// A fault that was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoundFault {
    /// Kinds and values on one line.
    pub words: String,
    /// As entries of a scenario.
    pub toml: String,
    /// Harm, as a multiple of that from which a fault is harmful.
    pub harm: f64,
    /// Its effect.
    pub effect: TrialEffect,
}

impl FoundFault {
    /// A fault that went unnoticed.
    #[must_use]
    pub fn of(trial: &Trial, space: &Space) -> Option<Self> {
        let effect = trial.effect()?.clone();
        let (words, toml) = (trial.candidate.words(space), trial.candidate.to_toml(space));
        Some(Self { words, toml, harm: effect.harm(), effect })
    }
}

/// Result for a kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KindFound {
    /// Kind, or two kinds.
    pub kinds: String,
    /// Runs.
    pub runs: usize,
    /// Runs in which a fault was noticed.
    pub noticed: usize,
    /// Largest harm of those that went unnoticed.
    pub worst_harm: Option<f64>,
    /// The fault that did it.
    pub worst: Option<String>,
}

/// A shift that went unnoticed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnnoticedShift {
    /// Shift in posterior σ of the run without faults.
    pub sigma: f64,
    /// The fault that did it.
    pub fault: String,
}

impl SearchFound {
    /// Gathers the trials of a search; `minimal` isn't set.
    #[must_use]
    pub fn of(trials: &[Trial], space: &Space) -> Self {
        let mut found = Self {
            schema: SEARCH_SCHEMA,
            octant: env!("CARGO_PKG_VERSION").to_owned(),
            scenario: String::new(),
            seed: 0,
            search_seed: 0,
            strategy: String::new(),
            pairs: 0.0,
            earlier: None,
            harmful_shift_sigma: HARMFUL_SHIFT_SIGMA,
            runs: 0,
            refused: 0,
            not_fired: 0,
            not_judged: 0,
            noticed: 0,
            missed: 0,
            first_missed: None,
            worst: None,
            minimal: None,
            minimal_runs: 0,
            kinds: Vec::new(),
            largest_unnoticed: BTreeMap::new(),
            left_out: Vec::new(),
            broken: Vec::new(),
        };
        let mut kinds: BTreeMap<String, KindFound> = BTreeMap::new();
        for trial in trials {
            found.count(trial, space, &mut kinds);
        }
        found.kinds = kinds.into_values().collect();
        found
            .kinds
            .sort_by(|a, b| b.worst_harm.unwrap_or(-1.0).total_cmp(&a.worst_harm.unwrap_or(-1.0)));
        found.worst = worst(trials).and_then(|trial| FoundFault::of(trial, space));
        found
    }

    fn count(&mut self, trial: &Trial, space: &Space, kinds: &mut BTreeMap<String, KindFound>) {
        let words = || trial.candidate.words(space);
        let effect = match &trial.result {
            TrialResult::Refused(_) => {
                self.refused += 1;
                return;
            }
            TrialResult::Broken(reason) => {
                self.runs += 1;
                self.broken.push((words(), reason.clone()));
                return;
            }
            TrialResult::Ran(effect) => effect,
        };
        self.runs += 1;
        let names: Vec<&str> =
            trial.candidate.faults.iter().map(|fault| space.forms[fault.form].kind.name).collect();
        let name = names.join(" + ");
        let kind = kinds
            .entry(name.clone())
            .or_insert_with(|| KindFound { kinds: name, ..KindFound::default() });
        kind.runs += 1;
        if !effect.fired {
            self.not_fired += 1;
            return;
        }
        if effect.noticed_by.is_some() {
            self.noticed += 1;
            kind.noticed += 1;
            return;
        }
        if !effect.is_judged() {
            self.not_judged += 1;
            return;
        }
        let harm = effect.harm();
        if harm >= 1.0 {
            self.missed += 1;
            self.first_missed = self.first_missed.or(Some(self.runs));
        }
        if kind.worst_harm.is_none_or(|worst| harm > worst) {
            (kind.worst_harm, kind.worst) = (Some(harm), Some(words()));
        }
        for (parameter, sigma) in &effect.shifts_sigma {
            let known = self.largest_unnoticed.get(parameter);
            if known.is_none_or(|known| sigma.abs() > known.sigma.abs()) {
                let shift = UnnoticedShift { sigma: *sigma, fault: words() };
                self.largest_unnoticed.insert(parameter.clone(), shift);
            }
        }
    }

    /// Describes the result for a terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = format!(
            "{}: {} search, {}, seed {}\n  {} noticed, {} without effect on a sample, {} harmful and unnoticed\n",
            self.scenario,
            self.strategy,
            counted(self.runs, "run", "runs"),
            self.seed,
            self.noticed,
            self.not_fired,
            self.missed
        );
        if let Some(earlier) = &self.earlier {
            earlier.words().iter().for_each(|line| out += &format!("  {line}\n"));
        }
        if self.not_judged > 0 {
            out += &format!(
                "  {} unnoticed and not judged: the instrument changed for good, and there is no navigation\n",
                self.not_judged
            );
        }
        for kind in self.kinds.iter().filter(|kind| kind.worst_harm.is_some_and(|harm| harm >= 1.0))
        {
            let harm = kind.worst_harm.map_or_else(String::new, |harm| significant(harm, 3));
            out += &format!(
                "  {harm:>8} × harmful  {}\n",
                kind.worst.as_deref().unwrap_or(&kind.kinds)
            );
        }
        match (&self.minimal, &self.worst) {
            (Some(minimal), _) => {
                out += &format!(
                    "the worst, made smaller in {}:\n",
                    counted(self.minimal_runs, "run", "runs")
                );
                out += &format!("  {}\n  {}\n", minimal.words, effect_words(&minimal.effect));
            }
            (None, Some(worst)) => {
                out += &format!(
                    "nothing harmful went unnoticed; nearest to it, {} of harmful: {}\n",
                    significant(worst.harm, 2),
                    worst.words
                );
            }
            (None, None) => out += "nothing went unnoticed\n",
        }
        for (words, reason) in &self.broken {
            out += &format!("  no result: {words}: {reason}\n");
        }
        out
    }
}

/// Describes an effect on one line.
#[must_use]
pub fn effect_words(effect: &TrialEffect) -> String {
    let mut parts = Vec::new();
    if let Some((parameter, sigma)) = &effect.worst {
        parts.push(format!("{parameter} moves by {} σ", significant(*sigma, 3)));
    }
    if let Some([radial, of_twin]) = effect.radial_nmi {
        parts.push(format!(
            "the position by {} nmi, where the run without the fault has an error of {} nmi",
            significant(radial, 3),
            significant(of_twin, 3)
        ));
    }
    parts.push(
        effect
            .noticed_by
            .clone()
            .map_or_else(|| "unnoticed".to_owned(), |by| format!("noticed as {by}")),
    );
    parts.join(", ")
}

/// The worst trial that went unnoticed; of two alike the first.
#[must_use]
pub fn worst(trials: &[Trial]) -> Option<&Trial> {
    let mut worst: Option<(&Trial, f64)> = None;
    for trial in trials {
        if let Some(harm) = trial.unnoticed_harm()
            && worst.is_none_or(|(_, known)| harm > known)
        {
            worst = Some((trial, harm));
        }
    }
    worst.map(|(trial, _)| trial)
}
