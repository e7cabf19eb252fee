//! Files of a design: stored searches, and the scenario with the designed sequence.

use super::outcome::{Outcome, name_of};
use crate::failure::Failure;
use crate::terminal::write;
use octant_design::Rotation;
use octant_design::candidate::GridStop;
use octant_design::measure::DesignMeasure;
use octant_design::report::SequenceDesign;
use octant_design::search::SearchState;
use octant_scenario::Scenario;
use std::collections::BTreeMap;
use std::path::Path;

/// Stored states of the searches, by rotation.
pub(super) struct States<'a> {
    file: Option<&'a Path>,
    all: BTreeMap<String, SearchState>,
}

impl<'a> States<'a> {
    pub(super) fn read(file: Option<&'a Path>, resume: bool) -> Result<Self, Failure> {
        let Some(path) = file.filter(|_| resume) else {
            return Ok(Self { file, all: BTreeMap::new() });
        };
        let bytes = std::fs::read(path).map_err(|error| {
            Failure::input(format!("failed to read {}: {error}", path.display()))
        })?;
        let all = serde_json::from_slice(&bytes).map_err(|error| {
            Failure::input(format!(
                "failed to read {}: {error}, expected the state of a search",
                path.display()
            ))
        })?;
        Ok(Self { file, all })
    }

    pub(super) fn stored(&self, rotation: Rotation) -> Option<SearchState> {
        self.all.get(name_of(rotation)).cloned()
    }

    pub(super) fn keep(&mut self, rotation: Rotation, state: &SearchState) -> Result<(), Failure> {
        let Some(path) = self.file else { return Ok(()) };
        self.all.insert(name_of(rotation).to_owned(), state.clone());
        let bytes = serde_json::to_vec(&self.all).map_err(Failure::bench)?;
        write(path, bytes)
    }
}

/// Writes the scenario with a designed sequence, after it was read again.
pub(super) fn write_scenario(
    scenario: &Scenario,
    outcome: &Outcome,
    measure: DesignMeasure,
    seed: u64,
    out: &Path,
) -> Result<(), Failure> {
    let SequenceDesign { score, bound, duration_h, .. } = &outcome.design;
    let stop = |stop: &GridStop| {
        let GridStop { azimuth_deg, roll_deg, share } = stop;
        format!(
            "{{ azimuth = \"{azimuth_deg} deg\", roll = \"{roll_deg} deg\", weight = {share} }}"
        )
    };
    let stops: Vec<String> = outcome.stops.iter().map(stop).collect();
    let mut changes = vec![
        format!("procedure.calibration.stops=[{}]", stops.join(", ")),
        format!("procedure.calibration.name=designed, seed {seed}"),
        "procedure.calibration.passes=1".to_owned(),
        format!("procedure.calibration.duration={} s", duration_h * 3600.0),
    ];
    if let Some(name) = outcome.rotation.name() {
        changes.push(format!("procedure.navigation.rotation={name}"));
    }
    let about = [
        "Designed by octant design, with every default of its scenario.".to_owned(),
        format!(
            "Predicted: {score:.4} {}, {}; no sequence is below {:.4}.",
            measure.unit(),
            measure.words(),
            bound.value
        ),
    ];
    let written = scenario
        .to_toml_with(&changes, &about)
        .map_err(|problem| Failure::bench(problem.message))?;
    let folder = out.parent().unwrap_or(Path::new(""));
    Scenario::parse(&written, &out.display().to_string(), folder, &[]).map_err(Failure::input)?;
    write(out, written)
}
