//! The plant as a source.

use super::{Epoch, Source, SourceError};
use octant_plant::config::PlantConfig;
use octant_plant::{ComparedPlant, Plant, PlantConfigError, Truth};
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, NoiseIntegral};

/// The simulated instrument, for a fixed number of samples.
#[derive(Clone, Debug)]
pub struct PlantSource {
    plant: ComparedPlant,
    total: u64,
    left: u64,
}

impl PlantSource {
    /// Creates a plant at time 0 that delivers `samples` samples.
    ///
    /// # Errors
    /// If a field of the configuration is out of its range.
    pub fn new(config: &PlantConfig, samples: u64) -> Result<Self, PlantConfigError> {
        Ok(Self { plant: ComparedPlant::new(config)?, total: samples, left: samples })
    }

    /// Sets the number of samples in all; those that it has delivered count.
    #[must_use]
    pub fn lasting(self, samples: u64) -> Self {
        let delivered = self.total - self.left;
        Self { total: samples, left: samples.saturating_sub(delivered), ..self }
    }

    /// Returns the plant.
    #[must_use]
    pub fn plant(&self) -> &Plant {
        self.plant.plant()
    }
}

impl Source for PlantSource {
    #[inline]
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        if self.left == 0 {
            return Ok(false);
        }
        self.left -= 1;
        self.plant.step_into(command, &mut epoch.sample, &mut epoch.aiding);
        Ok(true)
    }

    /// Returns truth at the stamp of the last epoch; before the first epoch, at time 0.
    fn truth(&self) -> Option<Truth> {
        Some(self.plant().truth())
    }

    #[inline]
    fn truth_stands(&self) -> Option<bool> {
        Some(self.plant().stands())
    }

    fn known_noise(&self) -> Option<NoiseIntegral> {
        Some(self.plant().white_noise())
    }

    fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        Ok(Some(self.plant().temperature_c()))
    }

    fn samples_total(&self) -> Option<u64> {
        Some(self.total)
    }

    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        Some(&mut self.plant)
    }

    fn ahead(&self) -> Option<Box<dyn Source + Send>> {
        Some(Box::new(self.clone()))
    }

    fn has_true_parameters(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_scenario::Scenario;
    use octant_scenario::resolve::{DrawnValues, Seeded};

    #[test]
    fn it_is_the_plant_and_it_ends() {
        let text = "schema = 1\n[procedure.calibration]\n";
        let scenario = Scenario::parse(text, "f", std::path::Path::new(""), &[]).unwrap();
        let config = scenario.plant(3, &DrawnValues::of(&scenario, &Seeded(3)));
        let mut source = PlantSource::new(&config, 450).unwrap();
        let mut plant = Plant::new(&config).unwrap();
        assert_eq!(source.samples_total(), Some(450));
        let command = GimbalCommand::default();
        let mut epoch = Epoch::default();
        for _ in 0..450 {
            let step = plant.step(&command);
            assert!(source.next(&command, &mut epoch).unwrap());
            assert_eq!(epoch, Epoch { sample: step.sample, aiding: step.aiding });
        }
        assert_eq!(source.truth(), Some(plant.truth()));
        let last = epoch;
        assert!(!source.next(&command, &mut epoch).unwrap());
        assert_eq!(epoch, last);
        assert_eq!(source.truth(), Some(plant.truth()));
    }
}
