//! Builds the archive with both FMUs and the parameters of a scenario.

use super::archive::{File, archive};
use super::error::BuildError;
use super::parameters;
use super::reference::Reference;
use super::ssp::{self, ParameterValues};
use octant_fmu::table::Model;
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use std::path::Path;

/// Ten minutes that show calibration and navigation: the scenario of the archive if none is named.
const BUILT_IN: &str = include_str!("../../../../fixtures/scenarios/lockstep.toml");

/// Parameter values of both models for a scenario.
pub(super) struct Configured {
    /// Name of the scenario's file, without extension.
    name: String,
    plant: ParameterValues,
    calibrator: ParameterValues,
    /// End of the scenario, s.
    stop_s: f64,
    /// Sample period, s.
    step_s: f64,
}

impl Configured {
    /// Computes the values from a scenario.
    pub(super) fn new(scenario: &Scenario, name: &str) -> Result<Self, BuildError> {
        let failed = |reason: String| BuildError::Scenario { name: name.to_owned(), reason };
        if !scenario.source.is_plant_alone() {
            return Err(failed("its samples don't come from the plant".to_owned()));
        }
        let (plant, core, _) = configurations(scenario, Method::Primary, scenario.seed)
            .map_err(|error| failed(error.to_string()))?;
        // The parameters of the Calibrator have no place for them. The baseline isn't in the archive.
        if scenario.has_further_states(Method::Primary) {
            return Err(failed(
                "procedure.calibration.further is given, and the FMU has no parameters for these states"
                    .to_owned(),
            ));
        }
        let faults: Vec<_> = scenario.faults.iter().map(|fault| fault.spec.clone()).collect();
        let period_s = scenario.sample_period_ns as f64 * 1e-9;
        // One step more than samples: there is no sample before the first step.
        let steps = scenario.samples().unwrap_or(0).saturating_add(1);
        Ok(Self {
            name: name.to_owned(),
            plant: octant_fmu::plant::start_values(&plant, &faults)
                .map_err(|error| failed(error.to_string()))?,
            calibrator: octant_fmu::calibrator::start_values(&core),
            stop_s: steps as f64 * period_s,
            step_s: period_s,
        })
    }

    /// Computes the values from the built-in scenario.
    pub(super) fn built_in() -> Result<Self, BuildError> {
        let scenario =
            Scenario::parse(BUILT_IN, "lockstep.toml", Path::new(""), &[]).map_err(|error| {
                BuildError::Scenario { name: "lockstep".into(), reason: error.to_string() }
            })?;
        Self::new(&scenario, "lockstep")
    }

    fn of(&self, model: &Model) -> &ParameterValues {
        if model.stem == "plant" { &self.plant } else { &self.calibrator }
    }

    /// Builds `plant_NAME.ssv`, `plant_NAME.csv` and those of the calibrator, for tools that don't
    /// read the archive.
    pub(super) fn files(
        &self,
        models: impl Iterator<Item = &'static Model>,
    ) -> std::io::Result<Vec<(String, Vec<u8>)>> {
        let mut files = Vec::new();
        for model in models {
            let stem = format!("{}_{}", model.stem, self.name);
            let ssv = ssp::parameter_set(model, &self.name, self.of(model)).document()?;
            files.push((format!("{stem}.ssv"), ssv));
            files
                .push((format!("{stem}.csv"), parameters::csv(model, self.of(model)).into_bytes()));
        }
        Ok(files)
    }
}

/// Builds `octant.ssp`: both FMUs, with the same bytes as the separate files.
pub(super) fn archive_of(
    own: &[Own; 2],
    fmus: &[Vec<u8>],
    configured: &Configured,
) -> std::io::Result<Vec<u8>> {
    let components = own.each_ref().map(|own| ssp::Component {
        model: own.model,
        source: format!("resources/{}_fmi2.fmu", own.model.stem),
        parameters: format!("resources/{}.ssv", own.model.stem),
    });
    let structure = ssp::structure(&components, configured.stop_s, configured.step_s);
    let mut files = vec![File::new("SystemStructure.ssd", structure.document()?)];
    for (component, bytes) in components.iter().zip(fmus) {
        let mut values = configured.of(component.model).clone();
        // The plant is wired to the calibrator, and provides number and stamp of each sample.
        for (name, value) in &mut values {
            if *name == "imu.external_stamps" {
                *value = vec![1.0];
            }
        }
        let set = ssp::parameter_set(component.model, &configured.name, &values).document()?;
        files.push(File::new(component.source.clone(), bytes.as_slice()));
        files.push(File::new(component.parameters.clone(), set));
    }
    Ok(archive(&files)?)
}

/// One of our models, with the data for its FMUs.
pub(super) struct Own {
    pub(super) model: &'static Model,
    /// Inputs and results with which users check their tools. A model on a bus has none: tables of
    /// values have no columns for clocked variables.
    pub(super) reference: Option<Reference>,
}
