//! The part of the rates that the temperature explains, to be taken off.

use super::blocks::{StretchBlocks, TemperatureBlocks};
use crate::deviations::RateChannels;

/// Part of the rates that is linear in a smooth temperature.
///
/// The temperature is the parabola with the means of a block and its neighbours: the noise and the steps of a
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
        // In blocks from the beginning; the rest behind the last block is extrapolated by half a block at most.
        let place = ((sample as f64 + 0.5) / self.samples as f64).min(means.len() as f64 + 0.5);
        let first = (place as usize).saturating_sub(1).min(means.len().saturating_sub(3));
        let u = place - first as f64;
        let [a, b] = [means[first], means[first + 1]];
        let curved = means.get(first + 2).map_or(0.0, |c| c - 2.0 * b + a);
        // Derivative of the cubic through the sums of the means at the four edges, in Newton's form.
        a + (b - a) * (u - 0.5) + curved * (0.5 * u * u - u + 1.0 / 3.0) - self.reference_c
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
