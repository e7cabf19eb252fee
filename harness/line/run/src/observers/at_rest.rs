//! Stretches of a run in which the instrument is at rest, and the Allan variance of its samples there.
//!
//! The samples are those of the source, before faults. They are taken in blocks of about 0.1 s. A block
//! is at rest if no sample of it is missing, flagged or saturated, and nothing turns the instrument.
//!
//! - Where the source tells gimbal angles, these decide: they are where they were when the stretch began.
//!   They are compared with a tolerance, because encoders flicker by seconds of arc. A unit's word that
//!   the gimbals move is its plan, not a measurement, and not every unit gives it.
//! - Where the angles aren't valid (no encoders, an instrument turned by hand), the unit's word decides,
//!   and on a base that doesn't move the sensors: mean rate and specific force are those with which the
//!   stretch began.
//!
//! A move is noticed only after it began, and gimbals settle after they arrive. So a second of samples
//! is held back before it counts, and a second is left out at the start of a stretch.
//!
//! Averages of less than a block are taken from every eighth block: there are so many of them that no
//! more certainty is needed, and a sample costs a few additions.

use octant_earth::units::{DEG, STANDARD_GRAVITY_MPS2};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, GIMBAL_LSB_RAD};
use octant_sample::{GimbalAngles, Sample, Status};
use octant_scenario::{MotionSpec, Scenario};
use octant_score::allan::{InstrumentNoise, RestOctave, RestRecord};
use octant_statistics::allan::AllanCascade;

/// Shortest duration of a block, s; a block has a power of two of samples.
const BLOCK_S: f64 = 0.05;
/// Time that is left out at both ends of a stretch, s.
const GUARD_S: f64 = 1.0;
/// Every block of this number has its single samples compared.
const FINE_EVERY: u64 = 8;
/// Largest departure of a gimbal at rest, counts: 0.05°, ten times the scatter of an encoder of 18″.
const STANDS_COUNTS: u64 = (0.05 * DEG / GIMBAL_LSB_RAD) as u64;
/// Largest change of a mean rate at rest, rad/s: 0.5 °/s, more than the noise of any instrument over a
/// block, and less than a turn by hand.
const TURNS_RADPS: f64 = 0.5 * DEG;
/// Largest change of a mean specific force at rest, m/s²: 0.05 g, that of a tilt by 3°.
const TILTS_MPS2: f64 = 0.05 * STANDARD_GRAVITY_MPS2;

/// Returns the noise of a scenario's simulated instrument; `None` where this program's plant doesn't make
/// the samples.
#[must_use]
pub(crate) fn instrument_noise(scenario: &Scenario) -> Option<InstrumentNoise> {
    let (imu, more) = (&scenario.imu, &scenario.imu.extensions);
    // A counter's remainder is spread over its last digit evenly: a standard deviation of q/√12.
    let quantization = |coarser: f64, lsb: f64| coarser.max(lsb) / 12.0f64.sqrt();
    scenario.source.has_plant().then(|| InstrumentNoise {
        gyro: [
            quantization(more.gyro_quantization_rad, DELTA_THETA_LSB_RAD),
            imu.angle_random_walk,
            more.gyro_bias_instability,
            more.gyro_rate_random_walk,
            0.0,
        ],
        accelerometer: [
            quantization(more.accel_quantization_mps, DELTA_VELOCITY_LSB_MPS),
            imu.velocity_random_walk,
            more.accel_bias_instability,
            0.0,
            0.0,
        ],
    })
}

/// Increments of a sample, gyros first.
type Increments = [[i32; 3]; 2];

/// Increments as the channels of an estimate.
#[inline(always)]
fn channels([[x, y, z], [u, v, w]]: &Increments) -> [f64; 6] {
    [*x, *y, *z, *u, *v, *w].map(f64::from)
}

/// Finds the stretches at rest, and keeps their Allan variance.
#[derive(Clone, Debug)]
pub struct AtRest {
    period_ns: u64,
    base_moves: bool,
    /// Blocks that have been completed and not counted yet, and the one that is being filled.
    ring: Ring,
    signs: BlockSigns,
    /// Stamp and number of the last sample of the last block; `None` before it.
    last: Option<(u64, u64)>,
    /// Gimbal angles at the start of the stretch, and the sums of the block that ended there.
    stands: GimbalAngles,
    began: [f64; 6],
    /// Blocks at rest since the last one that wasn't.
    rested: usize,
    /// Blocks that have counted.
    counted: u64,
    /// Averages of single samples up to half a block.
    fine: AllanCascade<6>,
    /// Averages of blocks.
    coarse: AllanCascade<6>,
}

/// Flags of the present block, and the unit's word on moves.
#[derive(Clone, Copy, Debug)]
struct BlockSigns {
    /// Flags of the samples.
    flags: Status,
    /// True if the unit said in this block that the gimbals move; whether it says so now.
    unit_moved: bool,
    unit_moves: bool,
}

/// Blocks of samples, one after the other, around a ring.
#[derive(Clone, Debug)]
struct Ring {
    samples: Vec<Increments>,
    sums: Vec<[f64; 6]>,
    /// Samples in a block, a power of two.
    block: usize,
    /// Place of the next sample, and the end of its block.
    at: usize,
    end: usize,
}

impl Ring {
    /// Creates a ring of blocks.
    fn new(block: usize, blocks: usize) -> Self {
        Self {
            samples: vec![[[0; 3]; 2]; block * blocks],
            sums: vec![[0.0; 6]; blocks],
            block,
            at: 0,
            end: block,
        }
    }

    /// Sums the block that has just been filled, and goes to the next one.
    fn close(&mut self) -> [f64; 6] {
        let number = self.end / self.block - 1;
        let mut sum = [0.0; 6];
        for sample in &self.samples[self.end - self.block..self.end] {
            let sample = channels(sample);
            for channel in 0..6 {
                sum[channel] += sample[channel];
            }
        }
        self.sums[number] = sum;
        if self.end == self.samples.len() {
            self.end = 0;
        }
        self.at = self.end;
        self.end += self.block;
        sum
    }

    /// The oldest block: the next one that is overwritten.
    fn oldest(&self) -> ([f64; 6], &[Increments]) {
        (self.sums[self.at / self.block], &self.samples[self.at..self.end])
    }
}

impl AtRest {
    /// Creates it for samples of a period; `base_moves` tells whether the base may move.
    #[must_use]
    pub fn new(period_ns: u64, base_moves: bool) -> Self {
        let period_s = period_ns as f64 * 1e-9;
        let mut block = 1usize;
        while (block as f64) * period_s < BLOCK_S {
            block *= 2;
        }
        let guard = (GUARD_S / (block as f64 * period_s)).ceil() as usize;
        Self {
            period_ns,
            base_moves,
            ring: Ring::new(block, guard.max(1) + 1),
            signs: BlockSigns { flags: Status::empty(), unit_moved: false, unit_moves: false },
            last: None,
            stands: GimbalAngles::default(),
            began: [0.0; 6],
            rested: 0,
            counted: 0,
            fine: AllanCascade::new(block.trailing_zeros().max(1) as usize),
            coarse: AllanCascade::unlimited(),
        }
    }

    /// Creates it for the samples of a scenario.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let ship = matches!(scenario.motion, MotionSpec::Dockside(_));
        // An FMU moves the case as it likes.
        let moved = scenario.source.motion().is_some();
        Self::new(scenario.sample_period_ns, ship || moved)
    }

    /// Number of samples in a block, which is at rest as a whole or not at all.
    #[must_use]
    pub fn block_samples(&self) -> usize {
        self.ring.block
    }

    /// Takes the unit's word whether the gimbals move, when it changes.
    pub fn unit_moves(&mut self, moves: bool) {
        self.signs.unit_moves = moves;
        self.signs.unit_moved |= moves;
    }

    /// Takes the next sample of the source.
    #[inline]
    pub fn push(&mut self, sample: &Sample) {
        let at = self.ring.at;
        self.ring.samples[at] = [sample.delta_theta, sample.delta_velocity];
        self.ring.at = at + 1;
        self.signs.flags |= sample.status;
        if at + 1 == self.ring.end {
            self.block(sample);
        }
    }

    /// Ends a block with its last sample.
    #[inline(never)]
    fn block(&mut self, sample: &Sample) {
        let sum = self.ring.close();
        let rests = self.rests(sample, &sum);
        self.last = Some((sample.device_time.ns, sample.sequence));
        (self.signs.flags, self.signs.unit_moved) = (Status::empty(), self.signs.unit_moves);
        if !rests {
            self.coarse.end_stretch();
            (self.rested, self.stands, self.began) = (0, sample.gimbal, sum);
            return;
        }
        self.rested += 1;
        // The ring holds the blocks of the guard; those at the start of a stretch never count.
        let guard = self.ring.sums.len() - 1;
        if self.rested > 2 * guard {
            self.count();
        }
    }

    /// Returns whether a block is at rest.
    fn rests(&self, sample: &Sample, sum: &[f64; 6]) -> bool {
        let Some((last_ns, last_sequence)) = self.last else { return false };
        let block = self.ring.block as u64;
        let unusable =
            Status::GYRO_SATURATED | Status::ACCELEROMETER_SATURATED | Status::INERTIAL_INVALID;
        let lasted_ns = sample.device_time.ns.wrapping_sub(last_ns);
        if sample.sequence.wrapping_sub(last_sequence) != block
            || lasted_ns.abs_diff(block * self.period_ns) >= self.period_ns
            || self.signs.flags.intersects(unusable)
        {
            return false;
        }
        if self.signs.flags.contains(Status::GIMBAL_INVALID) {
            return !self.signs.unit_moved && (self.base_moves || self.feels_nothing(sum));
        }
        let off = |a: i32, b: i32| (i64::from(a) - i64::from(b)).unsigned_abs();
        off(sample.gimbal.azimuth, self.stands.azimuth) <= STANDS_COUNTS
            && off(sample.gimbal.roll, self.stands.roll) <= STANDS_COUNTS
    }

    /// Returns whether the means of a block are those with which the stretch began.
    fn feels_nothing(&self, sum: &[f64; 6]) -> bool {
        let block_s = self.ring.block as f64 * self.period_ns as f64 * 1e-9;
        let turn = TURNS_RADPS * block_s / DELTA_THETA_LSB_RAD;
        let push = TILTS_MPS2 * block_s / DELTA_VELOCITY_LSB_MPS;
        (0..6).all(|channel| {
            let change = (sum[channel] - self.began[channel]).abs();
            change <= if channel < 3 { turn } else { push }
        })
    }

    /// Counts the oldest block of the ring.
    fn count(&mut self) {
        let (sum, samples) = self.ring.oldest();
        self.coarse.push(&sum);
        if self.counted.is_multiple_of(FINE_EVERY) && samples.len() > 1 {
            samples.iter().for_each(|sample| self.fine.push(&channels(sample)));
            self.fine.end_stretch();
        }
        self.counted += 1;
    }

    /// Returns what was found so far.
    #[must_use]
    pub fn record(&self) -> RestRecord {
        let period_s = self.period_ns as f64 * 1e-9;
        let block = self.ring.block as u64;
        let block_s = block as f64 * period_s;
        let octaves = |cascade: &AllanCascade<6>, interval_s: f64| {
            let [rate, force] =
                [DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS].map(|lsb| lsb / interval_s);
            let octave = move |tally: octant_statistics::allan::AllanTally<6>| RestOctave {
                tau_s: tally.samples as f64 * interval_s,
                variance: std::array::from_fn(|channel| {
                    let unit = if channel < 3 { rate } else { force };
                    tally.variance[channel] * unit * unit
                }),
                counts: tally.counts,
            };
            cascade.tallies().into_iter().map(octave)
        };
        RestRecord {
            sample_period_s: period_s,
            base_moves: self.base_moves,
            stretches: self.coarse.stretches(),
            at_rest_s: self.counted as f64 * block_s,
            longest_s: self.coarse.longest() as f64 * block_s,
            octaves: octaves(&self.fine, period_s).chain(octaves(&self.coarse, block_s)).collect(),
        }
    }
}
