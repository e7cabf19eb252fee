//! Random numbers one after the other, for searches and other decisions that take as many as they need.

use crate::normal::{uniform, words};
use crate::philox::StreamKey;
use crate::stream::{Phase, key};

/// Blocks of four words that a step can use before it takes those of the next one.
const BLOCKS: u64 = 256;

/// Random numbers of one step of a procedure.
#[derive(Clone, Debug)]
pub struct Draws {
    key: StreamKey,
    counter: u64,
    words: [u64; 4],
    used: usize,
}

impl Draws {
    /// Numbers of a step: they depend on the seed, the name of the stream and the step alone.
    #[must_use]
    pub fn of(seed: u64, stream: &str, step: u64) -> Self {
        let key = key(seed, stream, Phase::Draw);
        Self { key, counter: step * BLOCKS, words: [0; 4], used: 4 }
    }

    fn word(&mut self) -> u64 {
        if self.used == self.words.len() {
            self.words = words(self.key, self.counter);
            self.counter += 1;
            self.used = 0;
        }
        self.used += 1;
        self.words[self.used - 1]
    }

    /// A whole number below `count`, which must not be 0.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.word()) * count as u128) >> 64) as usize
    }

    /// A number in (0, 1).
    pub fn unit(&mut self) -> f64 {
        uniform(self.word())
    }

    /// A standard normal number (Box and Muller, 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = libm::sqrt(-2.0 * libm::log(self.unit()));
        radius * libm::cos(2.0 * core::f64::consts::PI * self.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_and_normals_have_their_distributions() {
        let mut draws = Draws::of(1, "test", 0);
        let mut counts = [0u32; 7];
        (0..70_000).for_each(|_| counts[draws.below(7)] += 1);
        // Chi-square of 6 degrees of freedom, 0.1 %: 22.5.
        let chi: f64 = counts.iter().map(|n| (f64::from(*n) - 1e4).powi(2) / 1e4).sum();
        assert!(chi < 22.5, "{chi}: {counts:?}");
        let normals: [f64; 20_000] = core::array::from_fn(|_| draws.normal());
        let moment = |k| normals.iter().map(|x| x.powi(k)).sum::<f64>() / 2e4;
        // Five standard errors of each moment.
        assert!(
            moment(1).abs() < 0.036 && (moment(2) - 1.0).abs() < 0.05,
            "{} {}",
            moment(1),
            moment(2)
        );
        assert!((moment(4) - 3.0).abs() < 0.35, "{}", moment(4));
    }
}
