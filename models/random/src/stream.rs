//! Named random streams. The key of a stream depends only on the seed, its name and the phase, and
//! its counter is the sample number in the phase: adding a stream, or lengthening the calibration,
//! changes no number of any other.

use crate::normal::Ziggurat;
use crate::philox::StreamKey;

/// Part of a run in which a stream counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Phase {
    /// Drawn once, before the run: true parameters, phases, initial states.
    Draw = 0,
    /// Calibration, counted from its first sample.
    Calibration = 1,
    /// Navigation, counted from its first sample.
    Navigation = 2,
}

/// Key of a stream: the first 16 bytes, as two little-endian words, of the BLAKE3 hash of
/// `"octant stream 1\0"`, the seed (u64, little-endian), the phase (u8) and the name (UTF-8).
#[must_use]
pub fn key(seed: u64, name: &str, phase: Phase) -> StreamKey {
    let mut hasher = blake3::Hasher::new();
    hasher.update(b"octant stream 1\0");
    hasher.update(&seed.to_le_bytes());
    hasher.update(&[phase as u8]);
    hasher.update(name.as_bytes());
    let hash = hasher.finalize();
    let word = |at: usize| {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&hash.as_bytes()[at..at + 8]);
        u64::from_le_bytes(bytes)
    };
    [word(0), word(8)]
}

/// Three standard normals per sample: one triad's noise.
#[derive(Clone, Debug)]
pub struct Triad {
    current: StreamKey,
    navigation: StreamKey,
    initial: StreamKey,
    ziggurat: &'static Ziggurat,
}

impl Triad {
    /// The stream of a seed and a name.
    #[must_use]
    pub fn new(seed: u64, name: &str) -> Self {
        Self {
            current: key(seed, name, Phase::Calibration),
            navigation: key(seed, name, Phase::Navigation),
            initial: key(seed, name, Phase::Draw),
            ziggurat: Ziggurat::shared(),
        }
    }

    /// Switches to the numbers of the navigation phase.
    pub fn navigate(&mut self) {
        self.current = self.navigation;
    }

    /// Numbers of a sample of the present phase.
    #[inline(always)]
    pub fn at(&self, sample: u64) -> [f64; 3] {
        self.ziggurat.three(self.current, sample)
    }

    /// Numbers drawn once, for an initial state.
    pub fn initial(&self) -> [f64; 3] {
        self.ziggurat.three(self.initial, 0)
    }
}

/// Number of samples whose numbers are made at once.
const AHEAD: usize = 64;
/// Sample number that no sample has.
const NO_SAMPLE: u64 = 1 << 63;

/// A [`Triad`] whose numbers are made ahead, many samples at a time: their long chains of
/// multiplications then overlap with one another and don't delay the use of a sample.
#[derive(Clone, Debug)]
pub struct Ahead {
    triad: Triad,
    /// Sample of the first numbers.
    first: u64,
    numbers: [[f64; 3]; AHEAD],
}

impl Ahead {
    /// Makes no numbers yet: the first call of [`Self::at`] does.
    #[must_use]
    pub fn new(triad: Triad) -> Self {
        Self { triad, first: NO_SAMPLE, numbers: [[0.0; 3]; AHEAD] }
    }

    /// Switches to the numbers of the navigation phase.
    pub fn navigate(&mut self) {
        self.triad.navigate();
        self.first = NO_SAMPLE;
    }

    /// Numbers of a sample of the present phase.
    #[inline(always)]
    pub fn at(&mut self, sample: u64) -> [f64; 3] {
        if sample.wrapping_sub(self.first) >= AHEAD as u64 {
            self.fill(sample);
        }
        self.numbers[sample.wrapping_sub(self.first) as usize % AHEAD]
    }

    #[inline(never)]
    fn fill(&mut self, first: u64) {
        self.first = first;
        self.triad.ziggurat.threes(self.triad.current, first, &mut self.numbers);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_made_ahead_are_the_same() {
        let mut triad = Triad::new(3, "gyro.noise");
        let mut ahead = Ahead::new(triad.clone());
        let samples = (0..200).chain([1000, 7, 8]);
        for sample in samples.clone() {
            assert_eq!(ahead.at(sample), triad.at(sample));
        }
        triad.navigate();
        ahead.navigate();
        for sample in samples {
            assert_eq!(ahead.at(sample), triad.at(sample));
        }
    }

    #[test]
    fn keys_differ_in_seed_name_and_phase() {
        let keys = [
            key(1, "gyro.noise", Phase::Calibration),
            key(2, "gyro.noise", Phase::Calibration),
            key(1, "gyro.noise", Phase::Navigation),
            key(1, "accelerometer.noise", Phase::Calibration),
        ];
        for i in 0..keys.len() {
            for j in 0..i {
                assert_ne!(keys[i], keys[j]);
            }
        }
    }
}
