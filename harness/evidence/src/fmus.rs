//! Facts for the manifest about the FMUs of a run.

use super::manifest::FmuFacts;
use octant_mapping::OpenedFmus;
use octant_mapping::stepper::UseError;
use octant_scenario::{Fmu, Process, Scenario};

/// Collects the facts about the FMUs of a scenario, which run from the same openings.
///
/// # Errors
/// If one can't be read.
pub fn fmus(scenario: &Scenario, fmus: &OpenedFmus) -> Result<Vec<FmuFacts>, UseError> {
    [("source", scenario.source.fmu()), ("endpoint", scenario.endpoint.fmu())]
        .into_iter()
        .filter_map(|(role, fmu)| Some(facts(scenario, role, fmu?, fmus)))
        .collect()
}

fn facts(
    scenario: &Scenario,
    role: &str,
    fmu: &Fmu,
    fmus: &OpenedFmus,
) -> Result<FmuFacts, UseError> {
    let (opened, path) = fmus.of(scenario, fmu)?;
    let description = opened.description();
    Ok(FmuFacts {
        only_once: opened.only_once_per_process(),
        role: role.to_owned(),
        file: path.display().to_string(),
        sha256: opened.sha256().map(str::to_owned),
        model: description.model_name.clone(),
        token: description.token.clone(),
        fmi: description.fmi_version.clone(),
        generation_tool: description.generation_tool.clone(),
        process: match fmu.process {
            Process::Own => "own",
            Process::Shared => "shared",
        }
        .to_owned(),
    })
}
