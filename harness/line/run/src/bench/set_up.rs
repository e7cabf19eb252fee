//! A method that is set up: its configurations, and the source and endpoint that were opened for it.

use super::error::SetupError;
use octant_calibration::config::CoreConfig;
use octant_endpoint::{AnyEndpoint, InProcess};
use octant_fmu_bind::OpenedFmus;
use octant_plant::config::PlantConfig;
use octant_sample::Parameters;
use octant_scenario::resolve::DrawnValues;
use octant_scenario::{Method, Scenario};
use octant_source::configure::{Configured, configured};
use octant_source::{AnySource, PlantSource, Source};
use std::fmt;

/// A method of a scenario with a seed, set up. What was checked is what runs: source and endpoint are opened once.
pub(crate) struct SetUp {
    pub(crate) plant: PlantConfig,
    pub(crate) core: CoreConfig,
    pub(crate) draws: DrawnValues,
    /// FMUs of the run.
    fmus: OpenedFmus,
    source: Option<AnySource>,
    endpoint: Option<AnyEndpoint>,
}

/// Source and endpoint of a run, at their start.
pub(crate) struct Line<S, E> {
    pub(crate) source: S,
    pub(crate) endpoint: E,
    /// Number of samples that were planned, where a source that isn't the plant alone knows it.
    pub(crate) recorded: Option<u64>,
}

impl fmt::Debug for SetUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SetUp").finish_non_exhaustive()
    }
}

impl SetUp {
    /// Configures a method. An FMU that moves the case is opened, since it knows the attitude at the start.
    ///
    /// # Errors
    /// If the configurations contradict themselves, or that FMU can't be opened.
    pub(crate) fn of(
        scenario: &Scenario,
        method: Method,
        seed: u64,
        fmus: &OpenedFmus,
    ) -> Result<Self, SetupError> {
        let Configured { plant, core, draws, source } = configured(scenario, method, seed, fmus)?;
        Ok(Self { plant, core, draws, fmus: fmus.clone(), source, endpoint: None })
    }

    /// Opens everything that can be opened before a run begins.
    ///
    /// # Errors
    /// If the core can't be set up, or source or endpoint can't be opened.
    pub(crate) fn check(&mut self, scenario: &Scenario) -> Result<(), SetupError> {
        octant_calibration::Core::new(&self.core)?;
        if !octant_source::check_live(scenario)? {
            self.source = self.source(scenario)?;
        }
        if !octant_endpoint::check_live(scenario)? {
            self.endpoint = self.endpoint(scenario)?;
        }
        Ok(())
    }

    /// Sets the initial parameters to those on which earlier passes settled. An endpoint that was opened with others
    /// is opened again.
    pub(crate) fn settle(&mut self, parameters: Option<Parameters>) {
        if let Some(parameters) = parameters {
            self.core.initial_parameters = parameters;
            self.endpoint = None;
        }
    }

    /// Takes the source at its start, and opens it if it isn't; `None` where it is the plant alone.
    ///
    /// # Errors
    /// As [`octant_source::open`].
    pub(crate) fn source(&mut self, scenario: &Scenario) -> Result<Option<AnySource>, SetupError> {
        match self.source.take() {
            Some(source) => Ok(Some(source)),
            None => Ok(octant_source::open_with(scenario, &self.plant, &self.fmus)?),
        }
    }

    /// Takes the endpoint at its start, and opens it if it isn't; `None` where it is the core in this process.
    ///
    /// # Errors
    /// As [`octant_endpoint::open`].
    pub(crate) fn endpoint(
        &mut self,
        scenario: &Scenario,
    ) -> Result<Option<AnyEndpoint>, SetupError> {
        match self.endpoint.take() {
            Some(endpoint) => Ok(Some(endpoint)),
            None => Ok(octant_endpoint::open_with(scenario, &self.core, &self.fmus)?),
        }
    }

    /// Puts configurations together that were made for several runs.
    pub(crate) fn configured(plant: PlantConfig, core: CoreConfig, draws: DrawnValues) -> Self {
        Self { plant, core, draws, fmus: OpenedFmus::default(), source: None, endpoint: None }
    }

    /// The plant as the source of a scenario's samples.
    pub(crate) fn plant_source(&self, scenario: &Scenario) -> Result<PlantSource, SetupError> {
        let samples = scenario.samples().unwrap_or(u64::MAX);
        PlantSource::new(&self.plant, samples).map_err(SetupError::Plant)
    }

    /// The core in this process.
    pub(crate) fn in_process(&self) -> Result<InProcess, SetupError> {
        InProcess::new(&self.core).map_err(SetupError::Core)
    }

    /// Plant and core of this process: statically dispatched, this loop processes ten million samples a second.
    pub(crate) fn simulated(
        &mut self,
        scenario: &Scenario,
    ) -> Result<Line<PlantSource, InProcess>, SetupError> {
        let (source, endpoint) = (self.plant_source(scenario)?, self.in_process()?);
        Ok(Line { source, endpoint, recorded: None })
    }

    /// Source and endpoint of any kind, opened if they aren't.
    pub(crate) fn opened(
        &mut self,
        scenario: &Scenario,
    ) -> Result<Line<AnySource, AnyEndpoint>, SetupError> {
        let source = self.source(scenario)?;
        let endpoint = self.endpoint(scenario)?;
        let recorded = source.as_ref().and_then(|source| source.samples_planned());
        let source = match source {
            Some(source) => source,
            None => self.plant_source(scenario)?.into(),
        };
        let endpoint = match endpoint {
            Some(endpoint) => endpoint,
            None => self.in_process()?.into(),
        };
        Ok(Line { source, endpoint, recorded })
    }
}
