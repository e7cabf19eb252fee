//! Means of temperature and rates over equal blocks within stretches at rest.

use crate::deviations::{CHANNELS, RateChannels};

/// Blocks of a recording that is one stretch.
const BLOCKS: u64 = 64;
/// Blocks of the stretch that half of the time at rest isn't shorter than.
const IN_STRETCH: u64 = 4;

/// Blocks of a stretch.
#[derive(Clone, Debug, Default)]
pub struct StretchBlocks {
    /// Mean temperature of the whole stretch, °C; NaN if there is none.
    pub mean_c: f64,
    /// Mean temperatures, °C; NaN where there is none.
    pub temperature_c: Vec<f64>,
    /// Mean rates.
    pub rates: Vec<RateChannels>,
}

/// Sum of the temperatures that are there.
#[derive(Clone, Copy, Debug, Default)]
struct TemperatureSum {
    sum: f64,
    count: u64,
}

impl TemperatureSum {
    fn add(&mut self, temperature_c: Option<f64>) {
        self.sum += temperature_c.unwrap_or(0.0);
        self.count += u64::from(temperature_c.is_some());
    }

    /// Mean; NaN of none.
    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }
}

/// Takes samples at rest and makes the means.
#[derive(Clone, Debug)]
pub struct TemperatureBlocks {
    samples: u64,
    stretches: Vec<StretchBlocks>,
    rates: RateChannels,
    count: u64,
    in_block: TemperatureSum,
    in_stretch: TemperatureSum,
    in_all: TemperatureSum,
    present: StretchBlocks,
}

impl TemperatureBlocks {
    /// Prepares for stretches of these lengths, in samples.
    ///
    /// A long stretch has 64 blocks. Where there are many short ones, half of the time at rest is in stretches of
    /// four blocks and more: a stretch of one block tells nothing, as its offset is free.
    #[must_use]
    pub fn new(lengths: &[u64]) -> Self {
        let total: u64 = lengths.iter().sum();
        let mut sorted = lengths.to_vec();
        sorted.sort_unstable_by(|a, b| b.cmp(a));
        let mut sum = 0;
        let half = sorted.into_iter().find(|length| {
            sum += length;
            2 * sum >= total
        });
        let samples = (total / BLOCKS).min(half.unwrap_or(0) / IN_STRETCH).max(1);
        Self {
            samples,
            stretches: Vec::new(),
            rates: [0.0; CHANNELS],
            count: 0,
            in_block: TemperatureSum::default(),
            in_stretch: TemperatureSum::default(),
            in_all: TemperatureSum::default(),
            present: StretchBlocks::default(),
        }
    }

    /// Takes the next sample of a stretch.
    pub fn push(&mut self, rates: &RateChannels, temperature_c: Option<f64>) {
        for (sum, rate) in self.rates.iter_mut().zip(rates) {
            *sum += rate;
        }
        for sum in [&mut self.in_block, &mut self.in_stretch, &mut self.in_all] {
            sum.add(temperature_c);
        }
        self.count += 1;
        if self.count == self.samples {
            self.present.temperature_c.push(self.in_block.mean());
            self.present.rates.push(self.rates.map(|sum| sum / self.samples as f64));
            self.begin_block();
        }
    }

    /// Ends a stretch.
    pub fn end_stretch(&mut self) {
        self.begin_block();
        self.present.mean_c = self.in_stretch.mean();
        self.in_stretch = TemperatureSum::default();
        self.stretches.push(core::mem::take(&mut self.present));
    }

    fn begin_block(&mut self) {
        (self.rates, self.count) = ([0.0; CHANNELS], 0);
        self.in_block = TemperatureSum::default();
    }

    /// Length of a block, samples.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Stretches, in order.
    #[must_use]
    pub fn stretches(&self) -> &[StretchBlocks] {
        &self.stretches
    }

    /// Mean temperature of all samples, °C; NaN of none.
    #[must_use]
    pub fn mean_c(&self) -> f64 {
        self.in_all.mean()
    }
}

impl StretchBlocks {
    /// True if every block has a temperature, and there are two at least.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        self.temperature_c.len() >= 2 && self.temperature_c.iter().all(|t| t.is_finite())
    }
}
