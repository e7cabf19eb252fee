//! Files of a design: stored searches, and the scenario with the designed sequence.

use super::outcome::{Outcome, name_of};
use crate::failure::Failure;
use crate::terminal::write;
use octant_base::not_finite;
use octant_design::Rotation;
use octant_design::candidate::GridStop;
use octant_design::measure::DesignMeasure;
use octant_design::report::SequenceDesign;
use octant_design::search::{SearchProblem, SearchState};
use octant_run::paired::SideResult;
use octant_scenario::Scenario;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// What a file of --state holds.
#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    /// Searches, by rotation and lead-in.
    searches: BTreeMap<String, SearchState>,
    /// Runs that confirm a design, by the hash of all that they depend on.
    runs: BTreeMap<String, Vec<[SideResult; 2]>>,
}

/// Stored states of searches and confirmations.
pub(super) struct States<'a> {
    file: Option<&'a Path>,
    all: Stored,
}

impl<'a> States<'a> {
    pub(super) fn read(file: Option<&'a Path>, resume: bool) -> Result<Self, Failure> {
        let Some(path) = file.filter(|_| resume) else {
            return Ok(Self { file, all: Stored::default() });
        };
        let bytes = std::fs::read(path).map_err(|error| {
            Failure::input(format!("failed to read {}: {error}", path.display()))
        })?;
        let all = not_finite::from_slice(&bytes).map_err(|error| {
            Failure::input(format!(
                "failed to read {}: {error}, expected the state of a search",
                path.display()
            ))
        })?;
        Ok(Self { file, all })
    }

    pub(super) fn stored(
        &self,
        rotation: Rotation,
        problem: &SearchProblem,
    ) -> Option<SearchState> {
        self.all.searches.get(&key_of(rotation, problem)).cloned()
    }

    pub(super) fn keep(
        &mut self,
        rotation: Rotation,
        problem: &SearchProblem,
        state: &SearchState,
    ) -> Result<(), Failure> {
        self.all.searches.insert(key_of(rotation, problem), state.clone());
        self.write()
    }

    /// Runs that were done before.
    pub(super) fn runs(&self, key: &str) -> Vec<[SideResult; 2]> {
        self.all.runs.get(key).cloned().unwrap_or_default()
    }

    pub(super) fn keep_runs(&mut self, key: &str, runs: &[[SideResult; 2]]) -> Result<(), Failure> {
        self.all.runs.insert(key.to_owned(), runs.to_vec());
        self.write()
    }

    fn write(&self) -> Result<(), Failure> {
        let Some(path) = self.file else { return Ok(()) };
        write(path, serde_json::to_vec(&self.all).map_err(Failure::bench)?)
    }
}

/// Name of a search: its rotation, and the quick round of its lead-in where it has one.
fn key_of(rotation: Rotation, problem: &SearchProblem) -> String {
    match problem.limits.round_s {
        0.0 => name_of(rotation).to_owned(),
        round_s => format!("{}, round of {round_s} s", name_of(rotation)),
    }
}

/// Changes of a scenario for a sequence of a duration.
pub(super) fn changes(
    (name, stops): (&str, &[GridStop]),
    duration_s: f64,
    rotation: Rotation,
) -> Vec<String> {
    let stop = |stop: &GridStop| {
        let GridStop { azimuth_deg, roll_deg, share } = stop;
        format!(
            "{{ azimuth = \"{azimuth_deg} deg\", roll = \"{roll_deg} deg\", weight = {share} }}"
        )
    };
    let stops: Vec<String> = stops.iter().map(stop).collect();
    let mut changes = vec![
        format!("procedure.calibration.stops=[{}]", stops.join(", ")),
        format!("procedure.calibration.name={name}"),
        "procedure.calibration.passes=1".to_owned(),
        format!("procedure.calibration.duration={duration_s} s"),
    ];
    if let Some(name) = rotation.name() {
        changes.push(format!("procedure.navigation.rotation={name}"));
    }
    changes
}

/// Writes a scenario with changes, and reads it again.
pub(super) fn changed(
    scenario: &Scenario,
    changes: &[String],
    about: &[String],
    path: &Path,
) -> Result<(String, Scenario), Failure> {
    let written =
        scenario.to_toml_with(changes, about).map_err(|problem| Failure::bench(problem.message))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let read = Scenario::parse(&written, &path.display().to_string(), folder, &[])
        .map_err(Failure::input)?;
    Ok((written, read))
}

/// Writes the scenario with a designed sequence, after it was read again; `said` is what simulation says.
pub(super) fn write_scenario(
    scenario: &Scenario,
    outcome: &Outcome,
    measure: DesignMeasure,
    seed: u64,
    (out, said): (&Path, Option<String>),
) -> Result<(), Failure> {
    let SequenceDesign { score, bound, duration_h, .. } = &outcome.design;
    let name = format!("designed, seed {seed}");
    let changes = changes((&name, &outcome.found.stops), duration_h * 3600.0, outcome.rotation);
    let mut about = vec![
        "Designed by octant design, with every default of its scenario.".to_owned(),
        format!(
            "Predicted: {score:.4} {}, {}; no sequence is below {:.4}.",
            measure.unit(),
            measure.words(),
            bound.value
        ),
    ];
    about.extend(said.map(|said| format!("It was {said}.")));
    let (written, _) = changed(scenario, &changes, &about, out)?;
    write(out, written)
}
