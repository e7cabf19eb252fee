//! Runs candidates, each beside the run without faults.

use crate::candidate::{Candidate, PlacedFault};
use crate::error::SearchError;
use crate::space::{Form, KeyValues, Space};
use crate::trial::{Trial, TrialEffect, TrialResult};
use octant_base::control::Control;
use octant_random::draws::Draws;
use octant_run::Ended;
use octant_run::Plan;
use octant_run::branches::run_branches;
use octant_run::{MethodError, MethodRun, StreamKeeping, run_method};
use octant_scenario::{Method, Scenario};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Random candidates of a form that are tried before it counts as impossible.
const TRIES: usize = 16;

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
    pub fn text_of(&self, space: &Space, candidate: &Candidate, about: &[String]) -> String {
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

    /// The reason why the scenario can't have the faults of a candidate, if there is one.
    fn check(&self, space: &Space, candidate: &Candidate) -> Result<(), String> {
        self.scenario_of(&self.text_of(space, candidate, &[])).map(|_| ())
    }

    /// Runs candidates and compares each with the run without faults. What they have in common at their
    /// beginning runs once.
    ///
    /// # Errors
    /// If the end was asked for.
    pub fn run(
        &self,
        space: &Space,
        candidates: Vec<Candidate>,
        control: &Control,
    ) -> Result<Vec<Trial>, SearchError> {
        let scenarios: Vec<Result<Scenario, String>> = (candidates.iter())
            .map(|candidate| self.scenario_of(&self.text_of(space, candidate, &[])))
            .collect();
        let (places, plans): (Vec<usize>, Vec<Plan<'_>>) = (scenarios.iter().enumerate())
            .filter_map(|(place, scenario)| Some((place, scenario.as_ref().ok()?)))
            .map(|(place, scenario)| {
                let (method, seed, keeping) = (Method::Primary, self.seed, StreamKeeping::None);
                (place, Plan::of(scenario, method, seed, keeping, control))
            })
            .unzip();
        let results: Mutex<BTreeMap<usize, TrialResult>> = Mutex::default();
        let cancelled = Mutex::new(false);
        run_branches(&plans, self.jobs, &|index, run| {
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
        Ok(results.map(|(candidate, result)| Trial { candidate, result }).collect())
    }

    fn judged(&self, scenario: &Scenario, run: Result<MethodRun, MethodError>) -> TrialResult {
        match run {
            Err(error) => TrialResult::Broken(error.to_string()),
            Ok(run) => match TrialEffect::of(scenario, &run, &self.twin) {
                Some(effect) => TrialResult::Ran(effect),
                None => TrialResult::Broken(
                    run.bench
                        .broken
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
    /// for the kinds of which no form is left.
    #[must_use]
    pub fn possible(&self, space: &Space) -> (Space, Vec<(String, String)>) {
        let mut left_out: Vec<(String, String)> = Vec::new();
        let mut forms: Vec<Form> = Vec::new();
        for (index, form) in space.forms.iter().enumerate() {
            match self.possible_form(space, index) {
                Ok(kept) => forms.push(kept),
                Err(reason) => left_out.push((form.kind.name.to_owned(), reason)),
            }
        }
        left_out.retain(|(name, _)| !forms.iter().any(|form| form.kind.name == name));
        left_out.dedup_by(|a, b| a.0 == b.0);
        (Space { forms }, left_out)
    }

    /// A form with the choices that the scenario can have.
    fn possible_form(&self, space: &Space, form: usize) -> Result<Form, String> {
        self.tried(space, form, None)?;
        let mut kept = space.forms[form].clone();
        for (key, of) in kept.keys.iter_mut().enumerate() {
            if let KeyValues::OneOf(texts) = &mut of.values {
                let count = texts.len() as f64;
                let mut place = 0.5 / count;
                texts.retain(|_| {
                    let is_possible = self.tried(space, form, Some((key, place))).is_ok();
                    place += 1.0 / count;
                    is_possible
                });
            }
        }
        Ok(kept)
    }

    /// Tries random candidates of a form, with one key at a place, until the scenario can have one.
    fn tried(&self, space: &Space, form: usize, other: Option<(usize, f64)>) -> Result<(), String> {
        let mut draws = Draws::of(0, "faults search possible", form as u64);
        let mut last = Ok(());
        for _ in 0..TRIES {
            let mut fault = PlacedFault::random(space, form, &mut draws);
            if let Some((key, place)) = other {
                fault.places[key] = place;
            }
            last = self.check(space, &Candidate { faults: vec![fault] });
            if last.is_ok() {
                break;
            }
        }
        last
    }

    /// The first form of a space of which the scenario can't have every choice, with the reason.
    #[must_use]
    pub fn impossible(&self, space: &Space) -> Option<(usize, String)> {
        (0..space.forms.len()).find_map(|form| {
            let keys = space.forms[form].keys.iter().enumerate();
            let choices = keys.flat_map(|(key, of)| {
                let count = of.choices();
                (0..count).map(move |choice| (key, (choice as f64 + 0.5) / count as f64, count))
            });
            let fixed =
                choices.filter(|(.., count)| *count > 1).map(|(key, at, _)| Some((key, at)));
            let mut tried = std::iter::once(None).chain(fixed);
            tried.find_map(|other| Some((form, self.tried(space, form, other).err()?)))
        })
    }
}
