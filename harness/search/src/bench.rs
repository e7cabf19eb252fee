//! Runs candidates, each beside the run without faults.

use crate::candidate::FaultCandidate;
use crate::error::SearchError;
use crate::space::{FormKey, KeyValues, NumberRange, SearchSpace};
use crate::trial::{FaultTrial, TrialEffect, TrialResult};
use octant_base::control::Control;
use octant_run::branches::{BranchPlan, run_branches};
use octant_run::drive::Ended;
use octant_run::method::{MethodError, MethodRun, StreamKeeping, run_method};
use octant_scenario::{Method, Scenario};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// A scenario without faults, its run, and what it takes to run it with some.
#[derive(Debug)]
pub struct SearchBench {
    base: String,
    folder: PathBuf,
    seed: u64,
    twin: MethodRun,
    jobs: usize,
}

impl SearchBench {
    /// Runs the scenario without faults. `jobs` runs go at a time later.
    ///
    /// # Errors
    /// If the scenario has faults, can't run, or refuses its calibration.
    pub fn new(
        scenario: &Scenario,
        seed: u64,
        jobs: usize,
        control: &Control,
    ) -> Result<Self, SearchError> {
        if !scenario.faults.is_empty() {
            return Err(SearchError::HasFaults(scenario.faults.len()));
        }
        let base = scenario.to_toml_with(&[], &[]).map_err(SearchError::Unwritable)?;
        let twin = run_method(scenario, Method::Primary, seed, StreamKeeping::Hash, control)?;
        if twin.ended == Ended::Cancelled {
            return Err(SearchError::Cancelled);
        }
        match twin.calibration.as_ref() {
            None => return Err(SearchError::NoCalibration),
            Some(score) => {
                if let Some(reason) = &score.refused {
                    return Err(SearchError::TwinRefused(reason.clone()));
                }
            }
        }
        Ok(Self { base, folder: scenario.folder.clone(), seed, twin, jobs })
    }

    /// The scenario without faults as TOML, with every default.
    #[must_use]
    pub fn base(&self) -> &str {
        &self.base
    }

    /// Seed of all runs.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The scenario with the faults of a candidate as TOML. `about` are the lines of a comment at its top.
    #[must_use]
    pub fn text_of(
        &self,
        space: &SearchSpace,
        candidate: &FaultCandidate,
        about: &[String],
    ) -> String {
        let about: String = about.iter().map(|line| format!("# {line}\n")).collect();
        format!("{about}{}\n{}", self.base, candidate.to_toml(space))
    }

    fn scenario_of(&self, text: &str) -> Result<Scenario, String> {
        let parsed = Scenario::parse(text, "candidate", &self.folder, &[]);
        parsed.map_err(|error| {
            let problems: Vec<String> =
                error.problems.iter().map(|problem| problem.message.clone()).collect();
            problems.join("; ")
        })
    }

    /// Reason why the scenario can't have the faults of a candidate.
    ///
    /// # Errors
    /// With that reason.
    pub fn check(&self, space: &SearchSpace, candidate: &FaultCandidate) -> Result<(), String> {
        self.scenario_of(&self.text_of(space, candidate, &[])).map(|_| ())
    }

    /// Runs candidates and compares each with the run without faults. What they have in common at their
    /// beginning runs once.
    ///
    /// # Errors
    /// If the end was asked for.
    pub fn run(
        &self,
        space: &SearchSpace,
        candidates: Vec<FaultCandidate>,
        control: &Control,
    ) -> Result<Vec<FaultTrial>, SearchError> {
        let scenarios: Vec<Result<Scenario, String>> = (candidates.iter())
            .map(|candidate| self.scenario_of(&self.text_of(space, candidate, &[])))
            .collect();
        let (places, plans): (Vec<usize>, Vec<BranchPlan<'_>>) = (scenarios.iter().enumerate())
            .filter_map(|(place, scenario)| Some((place, scenario.as_ref().ok()?)))
            .map(|(place, scenario)| {
                let (method, seed) = (Method::Primary, self.seed);
                (place, BranchPlan { scenario, method, seed, control })
            })
            .unzip();
        let results: Mutex<BTreeMap<usize, TrialResult>> = Mutex::default();
        let cancelled = Mutex::new(false);
        run_branches(&plans, StreamKeeping::None, self.jobs, &|index, run| {
            if matches!(&run, Ok(run) if run.ended == Ended::Cancelled) {
                *cancelled.lock().unwrap_or_else(PoisonError::into_inner) = true;
                return;
            }
            let result = self.judged(plans[index].scenario, run);
            results.lock().unwrap_or_else(PoisonError::into_inner).insert(places[index], result);
        });
        let is_cancelled = cancelled.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
        if is_cancelled || results.len() != plans.len() {
            return Err(SearchError::Cancelled);
        }
        for (place, scenario) in scenarios.into_iter().enumerate() {
            if let Err(reason) = scenario {
                results.insert(place, TrialResult::Refused(reason));
            }
        }
        let results = candidates.into_iter().zip(results.into_values());
        Ok(results.map(|(candidate, result)| FaultTrial { candidate, result }).collect())
    }

    fn judged(&self, scenario: &Scenario, run: Result<MethodRun, MethodError>) -> TrialResult {
        match run {
            Err(error) => TrialResult::Broken(error.to_string()),
            Ok(run) => match TrialEffect::of(scenario, &run, &self.twin) {
                Some(effect) => TrialResult::Ran(effect),
                None => TrialResult::Broken(
                    run.broken
                        .as_ref()
                        .map_or_else(|| "it has no end".to_owned(), ToString::to_string),
                ),
            },
        }
    }

    /// Runs a scenario that was written, undivided, and compares it with the run without faults.
    ///
    /// # Errors
    /// If it can't be read or run.
    pub fn again(&self, text: &str, control: &Control) -> Result<TrialResult, SearchError> {
        let scenario = self.scenario_of(text).map_err(SearchError::Unreadable)?;
        let run = run_method(&scenario, Method::Primary, self.seed, StreamKeeping::Hash, control)?;
        if run.ended == Ended::Cancelled {
            return Err(SearchError::Cancelled);
        }
        Ok(self.judged(&scenario, Ok(run)))
    }

    /// Leaves out of a space the forms, and the choices of keys, that the scenario can't have; with the reasons
    /// for the forms.
    #[must_use]
    pub fn possible(&self, space: &SearchSpace) -> (SearchSpace, Vec<(String, String)>) {
        let mut left_out = Vec::new();
        let mut forms = Vec::new();
        for (index, form) in space.forms.iter().enumerate() {
            let mut kept = form.clone();
            for (place, key) in form.keys.iter().enumerate() {
                if let Some(texts) = self.accepted(space, index, place, key) {
                    kept.keys[place].values = KeyValues::OneOf(texts);
                } else if let Some(range) = kept.keys[place].values.range_mut() {
                    let is_possible = |at: f64| {
                        self.check(space, &middle(space, index, Some((place, at)))).is_ok()
                    };
                    *range = within(range, &is_possible);
                }
            }
            let none =
                |key: &FormKey| matches!(&key.values, KeyValues::OneOf(all) if all.is_empty());
            match self.check(space, &middle(space, index, None)) {
                _ if !kept.keys.iter().any(none) => forms.push(kept),
                Err(reason) => left_out.push((form.kind.name.to_owned(), reason)),
                Ok(()) => {
                    left_out.push((form.kind.name.to_owned(), "no choice is possible".to_owned()))
                }
            }
        }
        (SearchSpace { forms }, left_out)
    }

    /// The first form of a space that the scenario can't have with every choice and the middle of every range, with
    /// the reason.
    #[must_use]
    pub fn impossible(&self, space: &SearchSpace) -> Option<(usize, String)> {
        let places = |key: &FormKey| match &key.values {
            KeyValues::Fixed(_) => vec![0.5],
            KeyValues::OneOf(all) => {
                (0..all.len()).map(|index| (index as f64 + 0.5) / all.len() as f64).collect()
            }
            // An end may be impossible beside the middle of another key; such candidates cost no run.
            KeyValues::Between(_) | KeyValues::Multiple(_) => vec![0.5],
        };
        (0..space.forms.len()).find_map(|form| {
            let keys = space.forms[form].keys.iter().enumerate();
            let mut tried =
                keys.flat_map(|(key, of)| places(of).into_iter().map(move |at| (key, at)));
            tried.find_map(|other| {
                Some((form, self.check(space, &middle(space, form, Some(other))).err()?))
            })
        })
    }

    /// Choices of a key that the scenario can have; `None` for a key without choices that is possible.
    fn accepted(
        &self,
        space: &SearchSpace,
        form: usize,
        place: usize,
        key: &FormKey,
    ) -> Option<Vec<String>> {
        let is_possible =
            |at: f64| self.check(space, &middle(space, form, Some((place, at)))).is_ok();
        match &key.values {
            KeyValues::OneOf(texts) => {
                let count = texts.len() as f64;
                let at = |index: usize| (index as f64 + 0.5) / count;
                let kept = texts.iter().enumerate().filter(|(index, _)| is_possible(at(*index)));
                Some(kept.map(|(_, text)| text.clone()).collect())
            }
            // With the other keys in the middle it's this one only if all of its values are wrong.
            _ => None,
        }
    }
}

/// The part of a range whose ends are possible, if its middle is.
fn within(range: &NumberRange, is_possible: &dyn Fn(f64) -> bool) -> NumberRange {
    const HALVINGS: u32 = 8;
    let end = |end: f64| {
        if is_possible(end) || !is_possible(0.5) {
            return range.at(end);
        }
        let (mut good, mut bad) = (0.5, end);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (good + bad);
            if is_possible(middle) { good = middle } else { bad = middle }
        }
        range.at(good)
    };
    NumberRange { from: end(0.0), to: end(1.0), ..range.clone() }.rounded_inward()
}

/// A candidate of a form with every value in its middle, but for one key at another place.
fn middle(space: &SearchSpace, form: usize, other: Option<(usize, f64)>) -> FaultCandidate {
    let mut places = vec![0.5; space.forms[form].keys.len()];
    if let Some((key, place)) = other {
        places[key] = place;
    }
    FaultCandidate { faults: vec![crate::candidate::PlacedFault { form, places }] }
}
