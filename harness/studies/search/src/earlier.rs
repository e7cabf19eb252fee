//! Search of a changed core, begun with the results of an earlier search.
//!
//! Faults that were harmful and unnoticed are run again, worst first, until one is so again: a pass needs all of them
//! noticed. A weakened screen shows at once: its faults raise another report now, or none. So a few faults of each screen
//! are run again, and the search goes on with those of the screens whose report changed.

use crate::candidate::Candidate;
use crate::error::SearchError;
use crate::journal;
use crate::space::Space;
use crate::trial::Trial;
use octant_base::number::counted;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::path::Path;

/// Faults of a screen that are run while it answers as before.
const ASKED: usize = 4;

/// Trials of an earlier search, on whatever core.
#[derive(Clone, Debug)]
pub struct EarlierSearch {
    /// The trials.
    pub trials: Vec<Trial>,
    /// BLAKE3 of its journal.
    pub journal_blake3: String,
}

impl EarlierSearch {
    /// Reads the journal of a search in the same space. Scenario, seeds, program and strategy may be others.
    ///
    /// # Errors
    /// If there is none, it is damaged, of a newer version, of another space, or has no trial.
    pub fn read(path: &Path, space: &Space) -> Result<Self, SearchError> {
        let (trials, journal_blake3) = journal::read(path, space)?;
        Ok(Self { trials, journal_blake3 })
    }
}

/// A fault that is run again, and the screen whose it is.
#[derive(Clone, Debug)]
pub(crate) struct AskedFault {
    pub(crate) candidate: Candidate,
    pub(crate) screen: usize,
}

/// Screens of an earlier search, with the reports that their faults raise now.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarlierFound {
    /// BLAKE3 of the journal of the earlier search.
    pub journal_blake3: String,
    /// Its runs.
    pub runs: usize,
    /// Reports that its faults raised, the one with the most faults first.
    pub screens: Vec<ScreenFound>,
    /// Its faults that were harmful and unnoticed.
    pub missed: usize,
    /// Those of them that were run again.
    pub missed_again: usize,
    /// Those of them that are harmful and unnoticed now too.
    pub still_missed: usize,
}

/// A report of the earlier core.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScreenFound {
    /// The report, without numbers and names of parameters.
    pub report: String,
    /// Faults that were noticed by it.
    pub faults: usize,
    /// Those that were run again.
    pub again: usize,
    /// Those that are noticed otherwise now, or not at all.
    pub otherwise: usize,
}

impl EarlierFound {
    /// Compares the trials of a search with those of the earlier one.
    #[must_use]
    pub fn of(earlier: &EarlierSearch, trials: &[Trial]) -> Self {
        let now = |before: &Trial| trials.iter().find(|trial| trial.candidate == before.candidate);
        let missed: Vec<&Trial> = earlier.trials.iter().filter(|trial| is_missed(trial)).collect();
        let again: Vec<&Trial> = missed.iter().filter_map(|before| now(before)).collect();
        let mut screens: BTreeMap<String, ScreenFound> = BTreeMap::new();
        for before in earlier.trials.iter().filter(|trial| trial.candidate.faults.len() == 1) {
            let Some(report) = report_of(before) else { continue };
            let none = ScreenFound { report: report.clone(), faults: 0, again: 0, otherwise: 0 };
            let screen = screens.entry(report).or_insert(none);
            screen.faults += 1;
            if let Some(now) = now(before) {
                screen.again += 1;
                screen.otherwise += usize::from(report_of(now).as_ref() != Some(&screen.report));
            }
        }
        let mut screens: Vec<ScreenFound> = screens.into_values().collect();
        screens.sort_by_key(|screen| Reverse(screen.faults));
        let runs = earlier.trials.iter().filter(|trial| trial.is_run()).count();
        Self {
            journal_blake3: earlier.journal_blake3.clone(),
            runs,
            screens,
            missed: missed.len(),
            missed_again: again.len(),
            still_missed: again.into_iter().filter(|trial| is_missed(trial)).count(),
        }
    }

    /// True if a missed fault wasn't run again and none is missed still: the search is too short to say that they are noticed.
    #[must_use]
    pub fn is_too_short(&self) -> bool {
        self.still_missed == 0 && self.missed_again < self.missed
    }

    /// Says what changed, a line each.
    #[must_use]
    pub fn words(&self) -> Vec<String> {
        let again: usize = self.screens.iter().map(|screen| screen.again).sum();
        let changed = self.screens.iter().filter(|screen| screen.otherwise > 0);
        let changed: Vec<String> = changed
            .map(|screen| format!("{} of {} ({})", screen.otherwise, screen.again, screen.report))
            .collect();
        let changed = if changed.is_empty() { "none".to_owned() } else { changed.join(", ") };
        let mut lines = vec![
            format!("after a search of {}:", counted(self.runs, "run", "runs")),
            format!(
                "  noticed there, {again} run again; noticed otherwise now, or not at all: {changed}"
            ),
        ];
        if self.missed > 0 {
            lines.push(format!(
                "  harmful and unnoticed there, {} of {} run again; still so: {}",
                self.missed_again, self.missed, self.still_missed
            ));
        }
        lines
    }
}

/// A screen, known by its report, with the faults of the earlier search that raised it.
#[derive(Clone, Debug)]
struct Screen {
    /// Its report, without numbers and names; `None` for what was harmful and unnoticed.
    report: Option<String>,
    /// Faults that it noticed, the next one last.
    faults: Vec<Candidate>,
    asked: usize,
    /// Faults that answered otherwise, or as before.
    changed: usize,
    same: usize,
}

impl Screen {
    fn new(report: Option<String>, faults: Vec<Candidate>) -> Self {
        Self { report, faults, asked: 0, changed: 0, same: 0 }
    }

    fn is_asked(&self) -> bool {
        let goes_on = match &self.report {
            Some(_) => self.changed > 0 || self.asked < ASKED,
            // One alone, until it is known whether it is still missed.
            None => self.same == 0 && (self.asked == 0 || self.changed > 0),
        };
        goes_on && !self.faults.is_empty()
    }
}

/// A fault that the earlier core noticed.
struct Known<'a> {
    is_harmless: bool,
    size: f64,
    candidate: &'a Candidate,
}

/// The screens of an earlier search, and how they answer now.
#[derive(Clone, Debug, Default)]
pub(crate) struct EarlierScreens(Vec<Screen>);

impl EarlierScreens {
    /// Sorts the single faults of a search by what noticed them.
    pub(crate) fn of(trials: &[Trial], space: &Space) -> Self {
        let mut reports: BTreeMap<String, BTreeMap<usize, Vec<Known<'_>>>> = BTreeMap::new();
        let mut noticed: BTreeMap<usize, usize> = BTreeMap::new();
        for trial in trials {
            let [fault] = trial.candidate.faults.as_slice() else { continue };
            let Some(report) = report_of(trial) else { continue };
            let size = space.forms.get(fault.form).and_then(|form| form.size());
            let size = size.and_then(|key| fault.places.get(key)).copied().unwrap_or(0.0);
            let is_harmless = trial.effect().is_none_or(|effect| effect.harm() < 1.0);
            *noticed.entry(fault.form).or_default() += 1;
            let forms = reports.entry(report).or_default();
            let known = Known { is_harmless, size, candidate: &trial.candidate };
            forms.entry(fault.form).or_default().push(known);
        }
        let screen = |(report, forms): (String, BTreeMap<usize, Vec<Known<'_>>>)| {
            // Each form in turn, the smallest first: what a screen just notices, it misses first. Forms that no other screen
            // notices go first, and what did harm although it was noticed goes before what was undone.
            let mut ranked = Vec::new();
            for (form, mut known) in forms {
                let share = known.len() as f64 / noticed[&form] as f64;
                known.sort_by(|a, b| {
                    a.is_harmless.cmp(&b.is_harmless).then(a.size.total_cmp(&b.size))
                });
                ranked.extend(
                    known.into_iter().enumerate().map(|(rank, known)| (rank, share, known)),
                );
            }
            ranked.sort_by(|a, b| {
                a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)).then(a.2.is_harmless.cmp(&b.2.is_harmless))
            });
            let faults = ranked.into_iter().rev().map(|(_, _, known)| known.candidate.clone());
            Screen::new(Some(report), faults.collect())
        };
        let mut screens: Vec<Screen> = reports.into_iter().map(screen).collect();
        screens.sort_by_key(|screen| Reverse(screen.faults.len()));
        screens.insert(0, Screen::new(None, missed(trials)));
        Self(screens)
    }

    /// The next fault to run: one that was missed, or of the screens that answered otherwise, or else of those that were
    /// asked least.
    pub(crate) fn next(&mut self) -> Option<AskedFault> {
        let places = (0..self.0.len()).filter(|place| self.0[*place].is_asked());
        let screen = places.min_by_key(|place| {
            let screen = &self.0[*place];
            (screen.report.is_some(), screen.changed == 0, screen.asked)
        })?;
        let of = &mut self.0[screen];
        of.asked += 1;
        Some(AskedFault { candidate: of.faults.pop()?, screen })
    }

    /// True while there is a fault to run.
    pub(crate) fn are_asked(&self) -> bool {
        self.0.iter().any(Screen::is_asked)
    }

    /// Takes the result of a fault that was asked for; returns whether its screen answered otherwise.
    pub(crate) fn learn(&mut self, screen: usize, trial: &Trial) -> bool {
        let Some(screen) = self.0.get_mut(screen) else { return false };
        if screen.report.is_none() {
            *(if is_missed(trial) { &mut screen.same } else { &mut screen.changed }) += 1;
            return false;
        }
        let changed = report_of(trial) != screen.report;
        *(if changed { &mut screen.changed } else { &mut screen.same }) += 1;
        changed
    }
}

/// True for what was harmful and unnoticed.
fn is_missed(trial: &Trial) -> bool {
    trial.unnoticed_harm().is_some_and(|harm| harm >= 1.0)
}

/// Faults that were harmful and unnoticed, the worst last.
fn missed(trials: &[Trial]) -> Vec<Candidate> {
    let mut all: Vec<&Trial> = trials.iter().filter(|trial| is_missed(trial)).collect();
    let harm = |trial: &Trial| trial.unnoticed_harm().unwrap_or(0.0);
    all.sort_by(|a, b| harm(a).total_cmp(&harm(b)));
    all.into_iter().map(|trial| trial.candidate.clone()).collect()
}

/// Report that a fault raised, without numbers and names of parameters, which differ from fault to fault; of a refusal,
/// its reason without the details.
fn report_of(trial: &Trial) -> Option<String> {
    let by = trial.effect().filter(|effect| effect.fired)?.noticed_by.as_ref()?;
    let differs = |word: &&str| !word.contains(|c: char| c == '_' || c.is_ascii_digit());
    let of = |part: &str| part.split_whitespace().filter(differs).collect::<Vec<_>>().join(" ");
    Some(by.split(':').take(2).map(of).collect::<Vec<_>>().join(": "))
}
