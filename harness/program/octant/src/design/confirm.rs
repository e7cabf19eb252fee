//! Confirmation of designs by simulation, one after the other until one keeps its promise.

use super::files::{States, changed, changes};
use super::outcome::{Attempt, ConfirmationReport, Outcome, PairedSeed, name_of};
use super::searched::{DesignWork, design, failed, search_failed};
use crate::failure::Failure;
use crate::progress::with_progress;
use octant_base::control::Control;
use octant_calibration::positions::{EIGHT, from_degrees};
use octant_design::candidate::{GridStop, Limits};
use octant_design::confirm::{Confirmation, PredictedPair, runs_hash};
use octant_design::largest::LargestErrors;
use octant_design::lead_in::quick_round_s;
use octant_design::report::SequenceDesign;
use octant_design::search::{Found, SearchProblem};
use octant_design::{Rotation, Setup};
use octant_run::paired::{MethodSide, SideResult, paired_runs};
use octant_scenario::{Method, Scenario};
use std::collections::VecDeque;
use std::path::Path;

/// Seeds between two writes of the state.
const BATCH: usize = 8;
/// Least navigation that largest errors are compared in, s.
const NAVIGATION_MIN_S: f64 = 24.0 * 3600.0;
/// What a design is compared with.
const REFERENCE: &str = "eight positions, sixteen moves";

/// What is run.
pub(super) struct Runs<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) setup: &'a Setup,
    pub(super) seeds: u64,
    /// Sample rate, as it was given.
    pub(super) rate: &'a str,
    /// Largest number of designs that are tried.
    pub(super) attempts_max: u8,
    /// File of the scenario.
    pub(super) file: &'a Path,
    pub(super) work: DesignWork,
}

/// What came of it.
pub(super) struct Confirmed {
    pub(super) report: ConfirmationReport,
    /// The design that was confirmed.
    kept: Option<Outcome>,
}

impl Confirmed {
    pub(super) fn design(&self) -> Option<&Outcome> {
        self.kept.as_ref()
    }
}

/// A design to try.
struct Candidate {
    about: String,
    rotation: Rotation,
    problem: SearchProblem,
    found: Found,
}

/// Tries the best design; then the best after a quick round of the eight positions, where it had none; then
/// the next best ones.
pub(super) fn confirm(
    runs: &Runs<'_>,
    outcomes: &[Outcome],
    states: &mut States<'_>,
) -> Result<Confirmed, Failure> {
    let most = runs.attempts_max;
    let mut waiting = waiting(outcomes);
    let (mut attempts, mut kept) = (Vec::new(), None);
    let predicted_reference = runs.reference()?;
    while attempts.len() < usize::from(most) && kept.is_none() {
        if attempts.len() == 1
            && let Some(outcome) = outcomes.first()
        {
            for led_in in runs.led_in(outcome, states)?.into_iter().rev() {
                waiting.push_front(led_in);
            }
        }
        let Some(next) = waiting.pop_front() else { break };
        let (attempt, outcome) = runs.attempt(next, &predicted_reference, states)?;
        if attempt.result.confirmed {
            kept = Some(outcome);
        }
        attempts.push(attempt);
    }
    let report = ConfirmationReport {
        seeds: runs.seeds,
        first_seed: runs.scenario.seed,
        rate: runs.rate(),
        reference: REFERENCE,
        attempts_max: most,
        confirmed: kept.as_ref().map(|_| attempts.len()),
        attempts,
    };
    Ok(Confirmed { report, kept })
}

/// Candidates of all searches, the best first.
fn waiting(outcomes: &[Outcome]) -> VecDeque<Candidate> {
    let mut all = Vec::new();
    for (number, outcome) in outcomes.iter().enumerate() {
        let about = if number == 0 { "best design" } else { "best design for another rotation" };
        all.extend(candidates(outcome, about, "next best design"));
    }
    // The sort is stable: the best design stays the first.
    all.sort_by(|a, b| a.found.score.total_cmp(&b.found.score));
    all.into()
}

fn candidates(outcome: &Outcome, best: &str, next: &str) -> Vec<Candidate> {
    let Outcome { rotation, problem, found, .. } = outcome;
    let of = |about: &str, found: &Found| Candidate {
        about: about.to_owned(),
        rotation: *rotation,
        problem: problem.clone(),
        found: found.clone(),
    };
    let others = found.others.iter().map(|other| of(next, other));
    std::iter::once(of(best, found)).chain(others).collect()
}

impl Runs<'_> {
    /// Checks, before the search, that the runs can be made and compared.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let navigation_s = self.setup.navigation_s;
        if navigation_s < NAVIGATION_MIN_S {
            return Err(Failure::input(format!(
                "--confirm: found a navigation of {} h in procedure.navigation.duration, expected at least \
                 24 h, the first time at which largest errors are compared",
                navigation_s / 3600.0
            )));
        }
        self.eight(self.setup.duration_s)?;
        Ok(())
    }

    fn rate(&self) -> String {
        let rate = self.rate.trim();
        match rate.parse::<f64>() {
            Ok(_) => format!("{rate} Hz"),
            Err(_) => rate.to_owned(),
        }
    }

    /// Predicts the largest errors of eight positions with the sixteen moves.
    fn reference(&self) -> Result<Vec<LargestErrors>, Failure> {
        let setup = self.setup.with_rotation(Rotation::Sixteen);
        let eight = from_degrees(EIGHT, 1).map_err(Failure::bench)?;
        let predicted = setup.largest_after(&eight, setup.duration_s);
        predicted.map_err(|error| failed(error.into()))
    }

    /// Searches again with a quick round of the eight positions in the lead-in; nothing where there was one,
    /// or the gimbals can't do it.
    fn led_in(
        &self,
        outcome: &Outcome,
        states: &mut States<'_>,
    ) -> Result<Vec<Candidate>, Failure> {
        let SearchProblem { setup, measure, limits, duration_s, seed, .. } = &outcome.problem;
        let rates = &setup.conditions.platform.rates;
        let Some(round_s) = quick_round_s(limits, *duration_s, rates) else {
            return Ok(Vec::new());
        };
        let stops_max = limits.stops_max.min(Limits::STOPS_AFTER_ROUND_MAX);
        let limits = Limits { round_s, stops_max, ..*limits };
        let Ok(problem) = SearchProblem::new(setup.clone(), *measure, limits, *seed) else {
            return Ok(Vec::new());
        };
        let led_in = design(self.work, self.setup, &problem, outcome.rotation, states)?;
        let best = format!("best design after a quick round of the eight positions in {round_s} s");
        let next =
            format!("next best design after a quick round of the eight positions in {round_s} s");
        Ok(candidates(&led_in, &best, &next))
    }

    fn attempt(
        &self,
        candidate: Candidate,
        reference: &[LargestErrors],
        states: &mut States<'_>,
    ) -> Result<(Attempt, Outcome), Failure> {
        let Candidate { about, rotation, problem, found } = candidate;
        let design =
            SequenceDesign::of(&problem, name_of(rotation), &found).map_err(search_failed)?;
        let designed = problem.setup.largest_after(&found.sequence, problem.duration_s);
        let predicted = PredictedPair {
            reference: reference.to_vec(),
            designed: designed.map_err(|error| failed(error.into()))?,
        };
        let pairs = self.pairs(&problem, rotation, &found, states)?;
        let result = Confirmation::of(&pairs, &predicted, problem.measure);
        let seeds = self.seeds();
        let runs = seeds.into_iter().zip(pairs);
        let attempt = Attempt {
            about,
            round_s: problem.limits.round_s,
            design: design.clone(),
            predicted,
            result,
            runs: runs
                .map(|(seed, [reference, designed])| PairedSeed { seed, reference, designed })
                .collect(),
        };
        Ok((attempt, Outcome { rotation, problem, found, design, shortest: None }))
    }

    fn seeds(&self) -> Vec<u64> {
        (0..self.seeds).map(|n| self.scenario.seed.wrapping_add(n)).collect()
    }

    /// Runs all seeds with both sides, or what of them isn't stored.
    fn pairs(
        &self,
        problem: &SearchProblem,
        rotation: Rotation,
        found: &Found,
        states: &mut States<'_>,
    ) -> Result<Vec<[SideResult; 2]>, Failure> {
        let reference = self.eight(problem.duration_s)?;
        let designed = self.side(("designed", &found.stops), problem.duration_s, rotation)?;
        let key = runs_hash(&reference.0, &designed.0);
        let sides = [&reference.1, &designed.1];
        let seeds = self.seeds();
        let mut done = states.runs(&key);
        done.truncate(seeds.len());
        let controls: Vec<Control> = (0..2 * seeds.len()).map(|_| Control::default()).collect();
        let samples = reference.1.scenario.samples().zip(designed.1.scenario.samples());
        let left = (seeds.len() - done.len()) as u64;
        let epochs = samples.map(|(a, b)| (a + b) * left);
        let sample_s = designed.1.scenario.sample_period_ns as f64 * 1e-9;
        with_progress(&controls, epochs, sample_s, || {
            while done.len() < seeds.len() {
                let from = done.len();
                let to = (from + BATCH).min(seeds.len());
                let jobs = self.work.jobs;
                let controls = &controls[2 * from..2 * to];
                done.extend(paired_runs(sides, &seeds[from..to], jobs, controls)?);
                states.keep_runs(&key, &done)?;
            }
            Ok::<_, Failure>(())
        })?;
        Ok(done)
    }

    /// Makes the side of eight positions with the sixteen moves.
    fn eight(&self, duration_s: f64) -> Result<(String, MethodSide), Failure> {
        let eight: Vec<GridStop> = EIGHT.iter().map(GridStop::of_published).collect();
        self.side(("reference", &eight), duration_s, Rotation::Sixteen)
    }

    /// Makes the scenario of a side, as text and as what is run.
    fn side(
        &self,
        sequence: (&str, &[GridStop]),
        duration_s: f64,
        rotation: Rotation,
    ) -> Result<(String, MethodSide), Failure> {
        let mut changes = changes(sequence, duration_s, rotation);
        changes.push(format!("imu.rate={}", self.rate()));
        // Nothing is recorded, but a rate of the record has to fit that of the samples.
        changes.push("record.rate=0.1 Hz".to_owned());
        let path = self.file.parent().unwrap_or(Path::new(""));
        let path = path.join(format!("{} of --confirm", sequence.0));
        let (text, scenario) = changed(self.scenario, &changes, &[], &path)?;
        Ok((text, MethodSide { scenario, method: Method::Primary }))
    }
}
