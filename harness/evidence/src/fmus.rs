//! Facts for the manifest about the FMUs of a run.

use super::manifest::FmuFacts;
use octant_base::hash::sha256;
use octant_fmu_host::description::Description;
use octant_mapping::open::path;
use octant_mapping::stepper::UseError;
use octant_scenario::{Fmu, Process, Scenario};

/// Collects the facts about the FMUs of a scenario.
///
/// # Errors
/// If one can't be read.
pub fn fmus(scenario: &Scenario) -> Result<Vec<FmuFacts>, UseError> {
    [("source", scenario.source.fmu()), ("endpoint", scenario.endpoint.fmu())]
        .into_iter()
        .filter_map(|(role, fmu)| Some(facts(scenario, role, fmu?)))
        .collect()
}

fn facts(scenario: &Scenario, role: &str, fmu: &Fmu) -> Result<FmuFacts, UseError> {
    let path = path(scenario, fmu)?;
    let open = |reason: String| UseError::Open { uri: format!("fmu:{}", path.display()), reason };
    let description: Description =
        octant_mapping::open::describe(&path).map_err(|error| open(error.to_string()))?;
    let interfaces = [&description.co_simulation, &description.model_exchange];
    let only_once =
        interfaces.into_iter().flatten().any(|interface| interface.only_once_per_process);
    Ok(FmuFacts {
        only_once,
        role: role.to_owned(),
        file: path.display().to_string(),
        sha256: if path.is_dir() {
            None
        } else {
            Some(sha256(&path).map_err(|error| open(error.to_string()))?)
        },
        model: description.model_name,
        token: description.token,
        fmi: description.fmi_version,
        generation_tool: description.generation_tool,
        process: match fmu.process {
            Process::Own => "own",
            Process::Shared => "shared",
        }
        .to_owned(),
    })
}
