//! Opening of the endpoint that a scenario names.

use super::EndpointOpenError;
use super::any::AnyEndpoint;
use super::fmu::FmuEndpoint;
use super::live::LiveEndpoint;
use super::solution::SolutionEndpoint;
use octant_calibration::CoreConfig;
use octant_fmu_bind::OpenedFmus;
use octant_scenario::{EndpointSpec, Scenario, SourceSpec};

/// Checks an endpoint without opening it, where it is a device: its port is opened only once, when the run begins,
/// since some devices restart when it is opened. Returns whether it is one; any other is checked by [`open_with`].
///
/// # Errors
/// As [`open`].
pub fn check_live(scenario: &Scenario) -> Result<bool, EndpointOpenError> {
    match scenario.endpoint.device() {
        Some(live) => LiveEndpoint::check(scenario, live).map(|()| true),
        None => Ok(false),
    }
}

/// Opens the endpoint of a scenario with the core of `config`; `None` where it is the core in this
/// process, which is called directly: see [`InProcess`](super::InProcess).
///
/// # Errors
/// If it can't be opened, or doesn't fit.
pub fn open(
    scenario: &Scenario,
    config: &CoreConfig,
) -> Result<Option<AnyEndpoint>, EndpointOpenError> {
    open_with(scenario, config, &OpenedFmus::default())
}

/// Opens as [`open`], with FMUs that are opened or get opened.
///
/// # Errors
/// As [`open`].
pub fn open_with(
    scenario: &Scenario,
    config: &CoreConfig,
    fmus: &OpenedFmus,
) -> Result<Option<AnyEndpoint>, EndpointOpenError> {
    if let SourceSpec::Solution(spec) = &scenario.source {
        let endpoint = SolutionEndpoint::open(scenario, spec).map_err(Box::new)?;
        return Ok(Some(endpoint.into()));
    }
    match &scenario.endpoint {
        EndpointSpec::InProcess => Ok(None),
        EndpointSpec::Fmu(fmu) => Ok(Some(FmuEndpoint::open(scenario, fmu, config, fmus)?.into())),
        EndpointSpec::Live(live) => Ok(Some(LiveEndpoint::open(scenario, live, config)?.into())),
    }
}
