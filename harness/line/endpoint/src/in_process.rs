//! The core in this process.

use super::rest::{RestUse, WithoutRest, goes_on};
use super::{Conclusion, Endpoint, EndpointError};
use octant_calibration::config::{Estimator, Further, FurtherUse, NavigationPlan};
use octant_calibration::state_machine::CoreConfigError;
use octant_calibration::{Core, CoreConfig};
use octant_sample::further::FurtherGroup;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Epoch, Innovation, NavigationCovariance};
use octant_sample::{Output, Parameters};

/// The calibration core, called directly.
#[derive(Clone, Debug)]
pub struct InProcess {
    core: Core,
    revision: u32,
    /// True where errors follow the temperature.
    feels: bool,
    /// Configuration with which the core starts after each restart.
    config: Box<CoreConfig>,
    /// The core without the rest of its case, until the end of the calibration.
    without_rest: Option<Box<WithoutRest>>,
    rest: Option<RestUse>,
    /// Revisions of the core that gave way, which those of the other one go on from.
    revisions: u32,
}

impl InProcess {
    /// Creates a core that waits for its first sample.
    ///
    /// # Errors
    /// If the configuration contradicts itself.
    pub fn new(config: &CoreConfig) -> Result<Self, CoreConfigError> {
        Ok(Self {
            core: Core::new(config)?,
            revision: 0,
            feels: further_of(config).is_some_and(Further::follows_temperature),
            config: Box::new(config.clone()),
            without_rest: WithoutRest::new(config)?,
            rest: None,
            revisions: 0,
        })
    }

    /// Returns the core behind the endpoint, for data that no wire carries: diagnostics and table.
    #[must_use]
    pub fn core(&self) -> &Core {
        &self.core
    }

    /// Plans another navigation after the calibration that runs: see [`Core::plan_navigation`].
    ///
    /// # Errors
    /// As there.
    pub fn plan_navigation(
        &mut self,
        navigation: Option<NavigationPlan>,
    ) -> Result<(), CoreConfigError> {
        self.core.plan_navigation(navigation.clone())?;
        if let Some(other) = &mut self.without_rest {
            other.core_mut().plan_navigation(navigation.clone())?;
        }
        self.config.navigation = navigation;
        Ok(())
    }

    /// Lets the core without rest follow, and compares the two where the calibration has ended.
    #[inline(never)]
    fn follow(&mut self, epoch: Option<&Epoch>, output: &mut Output) {
        let Some(mut other) = self.without_rest.take() else { return };
        match epoch {
            Some(epoch) => other.step(epoch),
            None => other.end_of_stream(),
        }
        if goes_on(output.mode) {
            self.without_rest = Some(other);
        } else {
            let (rest, revisions) = other.conclude(&mut self.core, output);
            (self.rest, self.revisions) = (Some(rest), revisions);
        }
    }

    /// Returns whether the core estimates further states.
    fn has_further_estimates(&self) -> bool {
        let Some(further) = further_of(&self.config) else { return false };
        let of_sensors = FurtherGroup::ALL.into_iter().filter(|group| !group.is_of_gimbals());
        of_sensors
            .into_iter()
            .any(|group| matches!(further.of(group), FurtherUse::Estimated { .. }))
    }

    /// Returns the core itself, after its last step.
    #[must_use]
    pub fn into_core(self) -> Core {
        self.core
    }
}

/// Further states of a configuration.
fn further_of(config: &CoreConfig) -> Option<&Further> {
    match &config.calibration.as_ref()?.estimator {
        Estimator::Kalman(kalman) => Some(&kalman.further),
        _ => None,
    }
}

impl Endpoint for InProcess {
    #[inline]
    fn feels(&self) -> bool {
        self.feels
    }

    fn feel(&mut self, temperature_c: f64) {
        self.core.feel(temperature_c);
        if let Some(other) = &mut self.without_rest {
            other.core_mut().feel(temperature_c);
        }
    }

    #[inline]
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        self.core.step_into(&epoch.sample, epoch.aiding.as_ref(), output);
        if self.without_rest.is_some() {
            self.follow(Some(epoch), output);
        }
        output.parameters_revision = output.parameters_revision.wrapping_add(self.revisions);
        self.revision = output.parameters_revision;
        Ok(())
    }

    fn uri(&self) -> String {
        "in-process".to_owned()
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        let mut config = CoreConfig::clone(&self.config);
        if let Some(offset) = offset {
            config.initial_parameters = super::sum(&config.initial_parameters, offset);
        }
        let refused = |error: CoreConfigError| EndpointError::Restart {
            uri: "in-process".to_owned(),
            reason: error.to_string(),
        };
        self.core = Core::new(&config).map_err(refused)?;
        self.without_rest = WithoutRest::new(&config).map_err(refused)?;
        self.rest = None;
        (self.revision, self.revisions) = (0, 0);
        Ok(())
    }

    fn parameters(&self) -> ParameterEstimate {
        ParameterEstimate {
            revision: self.revision,
            parameters: *self.core.parameters(),
            sigma: *self.core.sigma(),
        }
    }

    fn innovation(&self) -> Option<Innovation> {
        Some(*self.core.innovation())
    }

    fn navigation_covariance(&self) -> Option<NavigationCovariance> {
        self.core.navigation_covariance()
    }

    /// Ends the stream: see [`Core::end_of_stream`].
    fn end_of_stream(&mut self) -> Result<Option<Output>, EndpointError> {
        let mut output = self.core.end_of_stream();
        self.follow(None, &mut output);
        output.parameters_revision = output.parameters_revision.wrapping_add(self.revisions);
        self.revision = output.parameters_revision;
        Ok(Some(output))
    }

    fn conclusion(&mut self) -> Conclusion {
        let quality = self.core.diagnostics().quality;
        Conclusion {
            refused: self.core.refusal().map(ToString::to_string),
            nis_mean: Some(quality.nis_mean),
            nis_expected: self.core.expected_nis().map(|expected| [expected.low, expected.high]),
            measurements: Some(quality.used + quality.rejected),
            // A table has the parameters alone: without the further states that were estimated beside them it would
            // be another compensation.
            table: self.core.table().filter(|_| !self.has_further_estimates()).cloned(),
            solution: self.core.concluded().copied(),
            further: self.core.further().copied(),
            rest: self.rest.clone(),
            events: Vec::new(),
        }
    }
}
