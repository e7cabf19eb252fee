//! The simulated truth as a source.

use super::{Epoch, Source, SourceError};
use octant_plant::{Plant, Truth};
use octant_sample::GimbalCommand;

/// A plant that delivers a number of samples.
#[derive(Clone, Debug)]
pub struct PlantSource {
    plant: Plant,
    delivered: u64,
    samples: u64,
}

impl PlantSource {
    /// A source of so many samples.
    #[must_use]
    pub fn new(plant: Plant, samples: u64) -> Self {
        Self { plant, delivered: 0, samples }
    }
}

impl Source for PlantSource {
    #[inline]
    fn next(&mut self, command: &GimbalCommand) -> Result<Option<Epoch>, SourceError> {
        if self.delivered == self.samples {
            return Ok(None);
        }
        self.delivered += 1;
        let step = self.plant.step(command);
        Ok(Some(Epoch { sample: step.sample, aiding: step.aiding }))
    }

    fn truth(&self) -> Option<Truth> {
        Some(self.plant.truth())
    }

    fn samples_total(&self) -> Option<u64> {
        Some(self.samples)
    }
}
