//! A keyed dither: a small known perturbation of the gyro samples of one session.

use octant_random::philox::{StreamKey, block};
use octant_random::stream::{Phase, key};
use octant_sample::Sample;
use octant_sample::counts::DELTA_THETA_LSB_RAD;

/// Share of an interval's random walk that a dither has: what it moves is far below what the noise moves.
const OF_NOISE: f64 = 1.0 / 30.0;

/// One count more or less, times an amplitude, for each gyro in each sample. The signs depend on the key and the number of
/// the sample alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SessionDither {
    key: StreamKey,
    amplitude_counts: i32,
}

impl SessionDither {
    /// Creates the dither of a stream, of gyros with this random walk, rad/√s; at least one count.
    #[must_use]
    pub fn below(angle_random_walk: f64, sample_s: f64, seed: u64, stream: &str) -> Self {
        let noise_counts = angle_random_walk * sample_s.sqrt() / DELTA_THETA_LSB_RAD;
        // A conversion saturates; such a noise fills the range of a sample.
        let amplitude_counts = ((OF_NOISE * noise_counts).round() as i32).max(1);
        Self { key: key(seed, stream, Phase::Draw), amplitude_counts }
    }

    /// Amplitude, counts.
    #[must_use]
    pub fn amplitude_counts(&self) -> i32 {
        self.amplitude_counts
    }

    /// Counts that it adds to the gyros of the sample of this number.
    #[must_use]
    pub fn at(&self, sequence: u64) -> [i32; 3] {
        let [word, ..] = block(self.key, [sequence, 0, 0, 0]);
        let sign = |axis: u64| if word >> axis & 1 == 0 { 1 } else { -1 };
        [0, 1, 2].map(|axis| sign(axis) * self.amplitude_counts)
    }

    /// Adds it to a sample.
    pub(crate) fn add(&self, sample: &mut Sample) {
        for (counts, more) in sample.delta_theta.iter_mut().zip(self.at(sample.sequence)) {
            *counts = counts.saturating_add(more);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_below_the_noise_and_depends_on_its_key() {
        // 0.0007 °/√h at 200 Hz: 990 counts a sample.
        let walk = 0.0007f64.to_radians() / 60.0;
        let of = |stream| SessionDither::below(walk, 0.005, 7, stream);
        let dither = of("a");
        assert_eq!(dither.amplitude_counts(), 33);
        let all: Vec<[i32; 3]> = (1..=1000).map(|number| dither.at(number)).collect();
        for axis in 0..3 {
            let sum: i32 = all.iter().map(|counts| counts[axis]).sum();
            assert!(sum.abs() < 33 * 120, "as many of both signs: {sum}");
        }
        assert!(all.iter().flatten().all(|counts| counts.abs() == 33));
        assert_ne!(all, (1..=1000).map(|number| of("b").at(number)).collect::<Vec<_>>());
        assert_eq!(SessionDither::below(0.0, 0.005, 7, "a").amplitude_counts(), 1);
        let mut sample = Sample { sequence: 5, ..Sample::default() };
        sample.delta_theta = [i32::MAX, 0, i32::MIN];
        dither.add(&mut sample);
        assert_eq!(sample.delta_theta[1], dither.at(5)[1]);
    }
}
