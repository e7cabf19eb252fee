//! Allan, modified Allan and Hadamard variances while samples go by, in bounded memory.
//!
//! With the phase x, the integral of the rate, and an averaging time τ = m τ₀:
//!
//! ```text
//! AVAR(τ) = ⟨(x(t+2τ) − 2x(t+τ) + x(t))²⟩ / 2τ²
//! HVAR(τ) = ⟨(x(t+3τ) − 3x(t+2τ) + 3x(t+τ) − x(t))²⟩ / 6τ²
//! MVAR(τ) = AVAR of x̄, the mean of m neighbouring values of x
//! ```
//!
//! (NIST Special Publication 1065, 5.2 to 5.6). Differences begin at every sample up to m = 64. Beyond, level
//! by level, they begin at every second, fourth, … sample: 48 or 64 starts in τ, which lose below 0.1 % of the
//! degrees of freedom of full overlap. Nothing is approximated: a level holds the phase at the samples where its
//! differences begin, and the sums of the phases in between, so that MVAR has the mean of all m.
//!
//! A sample costs the 12 averaging times of the lowest level and twice the 2 of an upper one on average,
//! whatever the length of the record; a level has 25 kB.

pub use octant_scenario::file_names::CHANNELS;

/// One value of each channel.
pub type RateChannels = [f64; CHANNELS];

/// Averaging times of the lowest level, in samples.
const LOWEST: [usize; 12] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64];
/// Those of the others, in strides.
const UPPER: [usize; 2] = [48, 64];
/// Points that a level holds: three averaging times and one.
const RING: usize = 256;
/// Levels of the longest record: 2³³ samples, 497 days at 200 Hz.
const LEVELS_MAX: usize = 28;

/// Differences of one averaging time.
#[derive(Clone, Debug, Default)]
struct Squares {
    /// Averaging time in strides.
    strides: usize,
    allan: RateChannels,
    hadamard: RateChannels,
    modified: RateChannels,
    counts: [u64; 3],
    /// Second difference of the sums of phases.
    window: RateChannels,
}

/// One level: every 2ˡth sample.
#[derive(Clone, Debug)]
struct Level {
    phases: Vec<RateChannels>,
    sums: Vec<RateChannels>,
    /// Points in this stretch: of phases, of sums.
    points: usize,
    blocks: usize,
    squares: Vec<Squares>,
}

impl Level {
    fn new(lengths: &[usize]) -> Self {
        let of = |strides: &usize| Squares { strides: *strides, ..Squares::default() };
        Self {
            phases: vec![[0.0; CHANNELS]; RING],
            sums: vec![[0.0; CHANNELS]; RING],
            points: 0,
            blocks: 0,
            squares: lengths.iter().map(of).collect(),
        }
    }

    fn restart(&mut self) {
        (self.points, self.blocks) = (0, 0);
        for squares in &mut self.squares {
            squares.window = [0.0; CHANNELS];
        }
    }

    /// Takes the phase at the next start.
    #[inline]
    fn phase(&mut self, phase: &RateChannels) {
        let at = self.points;
        self.phases[at % RING] = *phase;
        self.points = at + 1;
        let Self { phases, squares, .. } = self;
        for squares in squares {
            let n = squares.strides;
            if at < 2 * n {
                break;
            }
            let back = |k: usize| &phases[(at - k * n) % RING];
            let (one, two) = (back(1), back(2));
            squares.counts[0] += 1;
            for c in 0..CHANNELS {
                let difference = phase[c] - 2.0 * one[c] + two[c];
                squares.allan[c] += difference * difference;
            }
            if at < 3 * n {
                continue;
            }
            let three = back(3);
            squares.counts[1] += 1;
            for c in 0..CHANNELS {
                let difference = phase[c] - 3.0 * (one[c] - two[c]) - three[c];
                squares.hadamard[c] += difference * difference;
            }
        }
    }

    /// Takes the sum of the phases from the last start to the next.
    #[inline]
    fn sum(&mut self, sum: &RateChannels) {
        let at = self.blocks;
        self.sums[at % RING] = *sum;
        self.blocks = at + 1;
        let Self { sums, squares, .. } = self;
        for squares in squares {
            let n = squares.strides;
            let weights = [(n, -3.0), (2 * n, 3.0), (3 * n, -1.0)];
            for c in 0..CHANNELS {
                squares.window[c] += sum[c];
            }
            for (back, weight) in weights {
                if at >= back {
                    let old = &sums[(at - back) % RING];
                    for c in 0..CHANNELS {
                        squares.window[c] += weight * old[c];
                    }
                }
            }
            if at + 1 >= 3 * n {
                squares.counts[2] += 1;
                for c in 0..CHANNELS {
                    squares.modified[c] += squares.window[c] * squares.window[c];
                }
            }
        }
    }
}

/// Variances of one averaging time, of all channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Variances {
    /// Averaging time in samples.
    pub samples: u64,
    /// Samples from one start to the next.
    pub stride: u64,
    /// Allan variances, in the square of the rate's unit.
    pub allan: RateChannels,
    /// Modified Allan variances; `None` where the record is too short for one.
    pub modified: Option<RateChannels>,
    /// Hadamard variances; `None` where the record is too short for one.
    pub hadamard: Option<RateChannels>,
}

/// Estimates the three variances.
#[derive(Clone, Debug)]
pub struct Deviations {
    period_s: f64,
    levels: Vec<Level>,
    phase: RateChannels,
    offset: RateChannels,
    begun: bool,
    samples: u64,
    stretches: Vec<u64>,
}

impl Deviations {
    /// Creates the estimator of samples of this period.
    #[must_use]
    pub fn new(period_s: f64) -> Self {
        Self {
            period_s,
            levels: (0..LEVELS_MAX)
                .map(|level| Level::new(if level == 0 { &LOWEST[..] } else { &UPPER }))
                .collect(),
            phase: [0.0; CHANNELS],
            offset: [0.0; CHANNELS],
            begun: false,
            samples: 0,
            stretches: Vec::new(),
        }
    }

    /// Takes the next sample of the stretch: a rate of each channel. The first one is taken off all of them, so that
    /// the integral stays small; it cancels in every difference.
    #[inline]
    pub fn push(&mut self, rate: &RateChannels) {
        if !self.begun {
            self.begun = true;
            self.offset = *rate;
            self.phase = [0.0; CHANNELS];
            self.point();
        }
        for c in 0..CHANNELS {
            self.phase[c] += (rate[c] - self.offset[c]) * self.period_s;
        }
        self.samples += 1;
        self.point();
    }

    /// Hands the phase to the levels.
    #[inline]
    fn point(&mut self) {
        let phase = self.phase;
        let mut sum = phase;
        // A level gets every second phase of the one below, and the sums of two of its sums.
        let (mut takes_phase, mut takes_sum) = (true, true);
        for level in &mut self.levels {
            if takes_phase {
                level.phase(&phase);
                takes_phase = level.points % 2 == 1;
            }
            if takes_sum {
                level.sum(&sum);
                takes_sum = level.blocks % 2 == 0;
                if takes_sum {
                    let before = &level.sums[(level.blocks - 2) % RING];
                    for c in 0..CHANNELS {
                        sum[c] += before[c];
                    }
                }
            }
            if !takes_phase && !takes_sum {
                return;
            }
        }
    }

    /// Ends the stretch: no difference reaches over its end.
    pub fn end_stretch(&mut self) {
        if self.begun {
            self.stretches.push(self.samples);
        }
        self.begun = false;
        self.samples = 0;
        self.levels.iter_mut().for_each(Level::restart);
    }

    /// Lengths of the stretches that have ended, in samples.
    #[must_use]
    pub fn stretches(&self) -> &[u64] {
        &self.stretches
    }

    /// Averaging times that have a difference, the shortest first.
    #[must_use]
    pub fn variances(&self) -> Vec<Variances> {
        let mut all = Vec::new();
        for (level, stride) in self.levels.iter().zip((0..).map(|index| 1u64 << index)) {
            for squares in &level.squares {
                if squares.counts[0] == 0 {
                    continue;
                }
                let samples = squares.strides as u64 * stride;
                let tau_s = samples as f64 * self.period_s;
                let mean = |sums: &RateChannels, count: u64, divisor: f64| {
                    (count > 0).then(|| sums.map(|sum| sum / (count as f64 * divisor)))
                };
                let [allan, hadamard, modified] = squares.counts;
                let m2 = (samples as f64) * (samples as f64);
                all.push(Variances {
                    samples,
                    stride,
                    allan: mean(&squares.allan, allan, 2.0 * tau_s * tau_s)
                        .unwrap_or([f64::NAN; CHANNELS]),
                    modified: mean(&squares.modified, modified, 2.0 * tau_s * tau_s * m2),
                    hadamard: mean(&squares.hadamard, hadamard, 6.0 * tau_s * tau_s),
                });
            }
        }
        all
    }
}
