//! The part of the rates that the temperature explains, to be taken off.

use super::blocks::{StretchBlocks, TemperatureBlocks};
use crate::deviations::RateChannels;

/// Part of the rates that is linear in a smooth temperature.
///
/// The temperature goes straight from the middle of a block to that of the next: the noise and the steps of a
/// thermometer would come into the rates with the temperature of each sample.
#[derive(Clone, Debug)]
pub struct TemperatureCorrection {
    /// Rates per kelvin; 0 where nothing is taken off.
    per_k: RateChannels,
    /// Temperature at which nothing is taken off, °C.
    reference_c: f64,
    /// Length of a block, samples.
    samples: u64,
    stretches: Vec<StretchBlocks>,
}

impl TemperatureCorrection {
    /// Prepares the correction; the reference is the mean temperature.
    #[must_use]
    pub fn new(per_k: RateChannels, blocks: &TemperatureBlocks) -> Self {
        Self {
            per_k,
            reference_c: blocks.mean_c(),
            samples: blocks.samples(),
            stretches: blocks.stretches().to_vec(),
        }
    }

    /// Temperature at a sample of a stretch against the reference, K; 0 where it isn't known.
    #[must_use]
    pub fn warmer_k(&self, stretch: usize, sample: u64) -> f64 {
        let Some(blocks) = self.stretches.get(stretch) else { return 0.0 };
        let means = &blocks.temperature_c;
        if !blocks.is_usable() {
            return self.mean_warmer_k(stretch);
        }
        let place = (sample as f64 + 0.5) / self.samples as f64 - 0.5;
        let before = (place.max(0.0) as usize).min(means.len() - 2);
        let slope = means[before + 1] - means[before];
        means[before] + (place - before as f64) * slope - self.reference_c
    }

    /// Mean temperature of a stretch against the reference, K; 0 where it isn't known.
    #[must_use]
    pub fn mean_warmer_k(&self, stretch: usize) -> f64 {
        let mean_c = self.stretches.get(stretch).map_or(f64::NAN, |blocks| blocks.mean_c);
        if mean_c.is_finite() { mean_c - self.reference_c } else { 0.0 }
    }

    /// Takes the part off that the temperature explains.
    #[must_use]
    pub fn taken_off(&self, rates: &RateChannels, warmer_k: f64) -> RateChannels {
        core::array::from_fn(|c| rates[c] - self.per_k[c] * warmer_k)
    }
}
