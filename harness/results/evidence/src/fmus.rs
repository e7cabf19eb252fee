//! Facts for the manifest about the FMUs of a run.

use super::manifest::FmuFacts;
use octant_fmu_bind::OpenedFmus;
use octant_fmu_bind::stepper::UseError;
use octant_scenario::{Fmu, Process, Scenario};

/// Reasons why a run can't have its FMUs.
#[derive(Debug, thiserror::Error)]
pub enum FmuFactsError {
    /// One can't be opened.
    #[error(transparent)]
    Use(#[from] UseError),
    /// One can't have as many instances as the run needs.
    #[error(
        "run {tasks} instances of {file}: a process can hold only one, expected process = \"own\" in {role}.fmu"
    )]
    Once {
        /// Number of instances.
        tasks: usize,
        /// The file.
        file: String,
        /// Its table in the scenario.
        role: String,
    },
}

/// Collects the facts about the FMUs of a scenario, which run from the same openings, each in this number of tasks at
/// a time.
///
/// # Errors
/// If one can't be read, or can't have so many instances.
pub fn fmus(
    scenario: &Scenario,
    tasks: usize,
    fmus: &OpenedFmus,
) -> Result<Vec<FmuFacts>, FmuFactsError> {
    let of = |(role, fmu): (_, Option<_>)| Some(facts(scenario, role, fmu?, fmus));
    let roles = [("source", scenario.source.fmu()), ("endpoint", scenario.endpoint.fmu())];
    let found: Vec<FmuFacts> = roles.into_iter().filter_map(of).collect::<Result<_, _>>()?;
    match found.iter().find(|fmu| fmu.only_once && fmu.process == "shared") {
        Some(FmuFacts { file, role, .. }) if tasks > 1 => {
            Err(FmuFactsError::Once { tasks, file: file.clone(), role: role.clone() })
        }
        _ => Ok(found),
    }
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
