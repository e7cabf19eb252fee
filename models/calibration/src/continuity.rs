//! Discontinuities of rates: edges of spikes in the increments of a tenth of a second.
//!
//! Turntable and base turn smoothly: over two seconds the rate of a body is a polynomial of low
//! degree, except where a drive changes its acceleration, which the encoders show. A spike has
//! edges. So the increments of blocks of 0.1 s go through a step filter: twenty weights of norm
//! one that are orthogonal to every polynomial up to a degree and otherwise as near to a step as
//! possible. Its output is white noise with the σ of a block, or a spike:
//!
//! | duration of the spike | rotation that gives 6.5 σ, Table 1 |
//! |---|---|
//! | up to 0.1 s | 0.14″ |
//! | 0.5 s | 0.9″ |
//! | 2 s | 3.0″ |
//! | 10 s | 15″ |
//!
//! While the gimbals rest on a base at rest, the rate itself is known, and a cumulative sum of the
//! rate beyond it (Page, 1954) finds 1″ of any duration.
//!
//! The gyros are examined in the case, with the encoders' turn subtracted, so that neither a move
//! nor a ship's sway through turning axes shows. An edge counts only if it is in the gyros
//! themselves, not in the encoders alone, and if it is larger than axes and encoders can cause in a
//! turn that both measure, as at every start of a move. The white noise of the encoders is measured
//! while the gimbals rest: what it makes of an edge is allowed. Velocity is examined in n, where a
//! turn doesn't show.

mod way;

pub(crate) use way::{c_cb, gimbal_turn, share_of_turn};

use crate::config::{Base, Kalman, Noise, Screening, TurntableRates};
use nalgebra::{Matrix3, Vector3};
use octant_sample::GimbalAngles;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::ParameterGroup;
use way::Way;

/// Length of a block, s.
const BLOCK_S: f64 = 0.1;
/// Channels that are always examined: turn of the case in c, and change of velocity in n.
const CHANNELS: usize = 6;
/// Channels examined when the turn of the case seems to have an edge: turn of the body in b,
/// azimuth and roll.
const OTHERS: usize = 5;
/// Smallest turn of an encoder in a block that counts as a turn, rad: 20″.
pub(crate) const TURNS_RAD: f64 = 1e-4;
/// Standard deviations that noise is allowed. A normal variable exceeds them with 8e-11: 7e-5 in
/// four hours of six channels.
const NOISE_SIGMAS: f64 = 6.5;
/// Standard deviations that axes and encoders are allowed.
const AXES_SIGMAS: f64 = 6.0;
/// Root mean square of the slope of an encoder's error: that of harmonics one to four of equal
/// size.
const SLOPE: f64 = 2.74;
/// Smallest white noise of a sample for which the test is meaningful, counts; below it noise
/// doesn't limit a real sensor.
const TESTABLE_COUNTS: f64 = 20.0;
/// Rate beyond the known one that the cumulative sum attributes to noise, in units of the angle
/// random walk per √s, and the probability (as a natural logarithm) of reaching its limit by noise:
/// a Brownian motion with drift −k reaches h with exp(−2kh/σ²).
const SUM_RATE: f64 = 2.5;
const SUM_LOG: f64 = 40.0;
/// Largest edge at the start or end of a turn, as a share of the turn, that slipped encoders can
/// cause, by 3°; and the number of such edges after which they are distrusted.
const ENCODERS_SHARE: f64 = 0.05;
const ENCODERS_EDGES: u32 = 2;
/// Correction of the attitude after which velocity in n has an edge from the correction, rad, whatever the noise: 50″ of
/// gravity are half of what the noise of Table 1 is allowed.
const CORRECTION_RAD: f64 = 2.4e-4;
/// Standard gravity, for a bound.
const GRAVITY_MPS2: f64 = 9.81;
/// Number of alarms in a stretch of 60 s that is a property of the stream; fewer may come from
/// spikes.
const ALARMS_MAX: u32 = 6;
const STRETCH_BLOCKS: u32 = 600;

/// One block of increments.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Turn by the gyros in b, rad: measured, as the sensors scale it.
    pub turn: Vector3<f64>,
    /// Change of velocity by specific force in n, m/s.
    pub velocity: Vector3<f64>,
    /// Encoder angles at the end of the block.
    pub gimbal: GimbalAngles,
    /// True if the gimbals rest and have settled.
    pub rests: bool,
    /// Turn by the gyros beyond the Earth's, rad, if the gimbals rest and the Earth's is known.
    pub beyond: Option<Vector3<f64>>,
}

/// Rate with a discontinuity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// The turn by the gyros.
    Turn,
    /// The velocity by the accelerometers, but not the turn.
    Velocity,
}

/// Detector of discontinuities of rates.
#[derive(Clone, Debug)]
pub struct Continuity {
    weights: [f64; POINTS],
    /// Largest outputs that noise and the base cause in gyros (rad) and velocity (m/s).
    limits: [f64; 2],
    /// Share of a turn by which axes and encoders may differ from the gyros.
    axes: f64,
    /// Apparent error of the encoders at the samples' times where a drive changes its acceleration,
    /// rad; and the turn of the base in a block, rad: their product is the apparent edge.
    corner: f64,
    sway: f64,
    /// Change of the specific force whose edge is half of the velocity's limit, m/s².
    correction_mps2: f64,
    /// Standard deviation of an edge by the white noise of readings, in that of the difference of two.
    of_readings: f64,
    /// Parameters of the cumulative sums: turn of a block attributed to noise, and limit, rad.
    sum: (f64, f64),

    ring: [[f64; CHANNELS]; POINTS],
    others: [[f64; OTHERS]; POINTS],
    next: usize,
    /// Number of valid blocks, of gyros and of velocity.
    filled: [usize; 2],
    /// Path of the encoders since the last block.
    way: Way,
    /// `c_cb` of gimbals that have rested for a block, and their angles.
    middle: (GimbalAngles, Matrix3<f64>),
    sums: [[f64; 2]; 3],
    widened: [f64; 2],
    alarms: [u32; 2],
    /// Number of edges that slipped encoders would show as well.
    encoder_edges: u32,
    /// Blocks until the stretch ends.
    stretch: u32,
    /// Sums of |difference| of two readings at rest, azimuth and roll, rad, and their number.
    flicker: ([f64; 2], u32),
}

#[cfg(feature = "state")]
octant_state::state! {
    Continuity {
        values: ring, others, next, filled, way, middle, sums, widened, alarms, encoder_edges, stretch, flicker;
        parts: ;
        kept: weights, limits, axes, corner, sway, correction_mps2, of_readings, sum;
        check: Self::check_places
    }
}

#[cfg(feature = "state")]
impl Continuity {
    fn check_places(&self) -> Result<(), octant_state::StateError> {
        octant_state::check_below("next", self.next as u64, POINTS as u64 - 1)?;
        for filled in self.filled {
            octant_state::check_below("filled", filled as u64, POINTS as u64)?;
        }
        for alarms in self.alarms {
            octant_state::check_below("alarms", alarms.into(), ALARMS_MAX.into())?;
        }
        Ok(())
    }
}

/// Number of samples in a block.
#[must_use]
pub fn block_ticks(sample_s: f64) -> u64 {
    ((BLOCK_S / sample_s + 1e-9) as u64).max(1)
}

impl Continuity {
    /// Makes a detector for samples of this period; `None` if the noise is too small against the
    /// counts.
    #[must_use]
    pub fn new(
        screening: &Screening,
        kalman: &Kalman,
        noise: &Noise,
        turntable: &TurntableRates,
        sample_s: f64,
    ) -> Option<Self> {
        let sqrt_s = libm::sqrt(sample_s);
        let testable = |walk: f64, lsb: f64| walk * sqrt_s / lsb >= TESTABLE_COUNTS;
        if !testable(noise.angle_random_walk, DELTA_THETA_LSB_RAD)
            || !testable(noise.velocity_random_walk, DELTA_VELOCITY_LSB_MPS)
        {
            return None;
        }
        let block_s = block_ticks(sample_s) as f64 * sample_s;
        let window_s = block_s * POINTS as f64;
        let base = match screening.base {
            Base::Still => (0.0, 0.0),
            // Remainder of a sine of angular frequency ω after its best polynomial of degree d over
            // a window T: (ωT/2)^(d+1) / (2^d (d+1)!) of its amplitude (Chebyshev). Frequencies
            // from the bounds of rate and acceleration, of force and jerk.
            Base::Moving(motion) => {
                let left = |omega: f64| {
                    (0..=DEGREE).fold(2.0, |left, power| {
                        left * omega * 0.25 * window_s / (power + 1) as f64
                    })
                };
                let frequency = |of: f64, by: f64| if by > 0.0 { of / by } else { 0.0 };
                let turning = frequency(motion.acceleration_radps2, motion.rate_radps);
                let pushing = frequency(motion.jerk_mps3, motion.force_mps2);
                (motion.rate_radps * left(turning), motion.force_mps2 * left(pushing))
            }
        };
        let sqrt_block = libm::sqrt(block_s);
        let norm = libm::sqrt(POINTS as f64);
        let limit = |walk: f64, base: f64, resolution: f64, vibration: f64| {
            NOISE_SIGMAS * walk * sqrt_block + norm * (base * block_s + resolution + vibration)
        };
        let prior = |group| kalman.prior.of(group);
        let encoder = SLOPE * screening.encoder_sigma_rad;
        let (scale, across) =
            (prior(ParameterGroup::GyroScale), prior(ParameterGroup::GyroMisalignment));
        let walk = noise.angle_random_walk;
        // Biases and Earth rate through the error of the initial attitude, rad/s.
        let known = AXES_SIGMAS
            * (prior(ParameterGroup::GyroBias)
                + 10.0 * prior(ParameterGroup::GDependent)
                + 7.3e-5 * kalman.prior.attitude_rad[2].min(0.05));
        let weights = step_weights();
        // While the acceleration lasts, the mean of two encoder angles is wrong by a twelfth of the
        // turn that the acceleration causes from one sample to the next.
        let step = 0.5 * weights.iter().map(|one| one.abs()).sum::<f64>();
        let corner = step * turntable.acceleration_radps2 * sample_s * sample_s / 12.0;
        let limits = [
            limit(walk, base.0, screening.resolution.0, screening.vibration.0),
            limit(
                noise.velocity_random_walk,
                base.1,
                screening.resolution.1,
                screening.vibration.1,
            ),
        ];
        Some(Self {
            weights,
            limits,
            correction_mps2: 0.5 * limits[1] / (step * block_s),
            axes: AXES_SIGMAS * libm::sqrt(scale * scale + across * across + encoder * encoder),
            corner,
            sway: match screening.base {
                Base::Still => 0.0,
                Base::Moving(motion) => motion.rate_radps * block_s,
            },
            of_readings: norm_of_differences(&weights),
            sum: (
                (SUM_RATE * walk + known) * block_s,
                0.5 * SUM_LOG * walk / SUM_RATE
                    + 2.0 * (screening.resolution.0 + screening.vibration.0),
            ),
            ring: [[0.0; CHANNELS]; POINTS],
            others: [[0.0; OTHERS]; POINTS],
            way: Way::default(),
            middle: (GimbalAngles::default(), Matrix3::identity()),
            next: 0,
            filled: [0; 2],
            sums: [[0.0; 2]; 3],
            widened: [1.0; 2],
            alarms: [0; 2],
            encoder_edges: 0,
            stretch: 0,
            flicker: ([0.0; 2], 0),
        })
    }

    /// Discards the earlier blocks: the stream was interrupted, or repaired.
    pub fn restart(&mut self, gimbal: GimbalAngles) {
        self.filled = [0; 2];
        self.sums = [[0.0; 2]; 3];
        self.way = Way::from(gimbal);
    }

    /// Takes the encoders of a sample.
    #[inline]
    pub fn follow(&mut self, gimbal: GimbalAngles) {
        self.way.follow(gimbal);
    }

    /// Takes a correction that turned the attitude, rad, and changed the compensated specific force, m/s². Discards the
    /// earlier velocity if that in n has an edge from it. The gyros in the case don't.
    pub fn corrected(&mut self, turned_rad: f64, force_mps2: f64) {
        if turned_rad > CORRECTION_RAD
            || turned_rad * GRAVITY_MPS2 + force_mps2 > self.correction_mps2
        {
            self.filled[1] = 0;
            self.sums = [[0.0; 2]; 3];
        }
    }

    /// Encoder angles at the end of the last block.
    #[must_use]
    pub fn gimbal(&self) -> GimbalAngles {
        self.way.start()
    }

    /// Returns whether edges at starts and ends of turns point to wrong encoders.
    #[must_use]
    pub fn distrusts_encoders(&self) -> bool {
        self.encoder_edges >= ENCODERS_EDGES
    }

    /// Takes a block; returns `Some` if a rate has an edge.
    pub fn add(&mut self, block: &Block) -> Option<Edge> {
        let before = self.way.start();
        let azimuth = block.gimbal.azimuth_rad() - before.azimuth_rad();
        let roll = block.gimbal.roll_rad() - before.roll_rad();
        let (turn, velocity) = (&block.turn, &block.velocity);
        if block.rests {
            self.read_at_rest([azimuth, roll]);
        }
        // Sines and cosines of gimbals at rest are known from the block before.
        let case = if block.gimbal == before && self.middle.0 == before {
            self.middle.1 * turn
        } else {
            let swept = self.way.until(block.gimbal);
            // The angles before a turn: no match for the next block.
            self.middle = (before, swept.c_cb);
            swept.c_cb * (turn - swept.turn)
        };
        self.way = Way::from(block.gimbal);
        self.ring[self.next] = [case.x, case.y, case.z, velocity.x, velocity.y, velocity.z];
        self.others[self.next] = [turn.x, turn.y, turn.z, azimuth, roll];
        self.next = (self.next + 1) % POINTS;
        self.filled = self.filled.map(|filled| (filled + 1).min(POINTS));
        self.stretch = self.stretch.saturating_sub(1);
        if self.stretch == 0 {
            self.alarms = [0; 2];
        }
        let mut found = self.sums_reach(block).then_some(0);
        if found.is_none() && self.filled[0] == POINTS {
            let [x, y, z, n, e, d] = self.filtered(&self.ring);
            let largest = |a: f64, b: f64, c: f64| a.abs().max(b.abs()).max(c.abs());
            if largest(x, y, z) > self.limit(0) && self.breaks(largest(x, y, z)) {
                found = Some(0);
            } else if self.filled[1] == POINTS && largest(n, e, d) > self.limit(1) {
                found = Some(1);
            }
        }
        let triad = found?;
        self.alarm(triad, block.gimbal);
        Some(if triad == 0 { Edge::Turn } else { Edge::Velocity })
    }

    fn alarm(&mut self, triad: usize, gimbal: GimbalAngles) {
        self.restart(gimbal);
        self.stretch = STRETCH_BLOCKS;
        self.alarms[triad] += 1;
        if self.alarms[triad] >= ALARMS_MAX {
            self.alarms[triad] = 0;
            self.widened[triad] *= 2.0;
        }
    }

    fn limit(&self, triad: usize) -> f64 {
        self.limits[triad] * self.widened[triad]
    }

    /// Outputs of the step filter, channel by channel.
    #[inline]
    fn filtered<const N: usize>(&self, ring: &[[f64; N]; POINTS]) -> [f64; N] {
        let mut sums = [0.0; N];
        let (newer, older) = ring.split_at(self.next);
        for (row, weight) in older.iter().chain(newer).zip(&self.weights) {
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += weight * value;
            }
        }
        sums
    }

    /// Returns whether the turn of the case has an edge of this size that the encoders don't cause.
    #[cold]
    fn breaks(&mut self, case: f64) -> bool {
        let [x, y, z, azimuth, roll] = self.filtered(&self.others);
        let (limit, body) = (self.limit(0), x.abs().max(y.abs()).max(z.abs()));
        let turns = self.fastest().iter().sum::<f64>() > TURNS_RAD;
        let corners = self.corners();
        let found = body > limit
            && case
                > limit
                    + corners
                    + self.of_readings * self.readings()
                    + self.axes * (body + azimuth.abs() + roll.abs());
        if found && turns && case < ENCODERS_SHARE * body {
            self.encoder_edges = self.encoder_edges.saturating_add(1);
        }
        found
    }

    /// Apparent edge by changes of the drives' acceleration, rad.
    fn corners(&self) -> f64 {
        let [azimuth, roll] = self.fastest();
        let mut turned = if azimuth + roll > TURNS_RAD { self.sway } else { 0.0 };
        if azimuth.min(roll) > TURNS_RAD {
            turned += azimuth + roll;
        }
        self.corner * turned
    }

    /// Takes the differences of two readings of gimbals at rest, azimuth and roll, rad.
    fn read_at_rest(&mut self, differences: [f64; 2]) {
        let (sums, count) = &mut self.flicker;
        for (sum, difference) in sums.iter_mut().zip(differences) {
            *sum += difference.abs();
        }
        *count = count.saturating_add(1);
    }

    /// Difference of two readings that the white noise of the encoders allows, rad, as it was at rest so far. Sums of
    /// magnitudes: a single wrong reading tells little.
    fn readings(&self) -> f64 {
        // Mean magnitude of a normal variable per standard deviation: √(2/π).
        const MEAN: f64 = 0.797_884_560_802_865_4;
        let ([azimuth, roll], count) = self.flicker;
        NOISE_SIGMAS * libm::hypot(azimuth, roll) / (MEAN * f64::from(count.max(1)))
    }

    /// Largest turns of azimuth and roll in a block, rad.
    fn fastest(&self) -> [f64; 2] {
        self.others.iter().fold([0.0f64; 2], |[azimuth, roll], [.., one, other]| {
            [azimuth.max(one.abs()), roll.max(other.abs())]
        })
    }

    /// Updates the cumulative sums, to both sides, of the turn beyond the Earth's; returns whether
    /// one reached its limit.
    fn sums_reach(&mut self, block: &Block) -> bool {
        let Some(beyond) = block.beyond else {
            self.sums = [[0.0; 2]; 3];
            return false;
        };
        let (allowed, limit) = (self.sum.0, self.sum.1 * self.widened[0] + self.readings());
        let mut reached = false;
        for (sums, beyond) in self.sums.iter_mut().zip(beyond.iter()) {
            sums[0] = (sums[0] + beyond - allowed).max(0.0);
            sums[1] = (sums[1] - beyond - allowed).max(0.0);
            reached |= sums[0].max(sums[1]) > limit;
        }
        reached
    }
}

/// Blocks of the filter.
pub(crate) const POINTS: usize = 20;

/// Degree up to which polynomials are suppressed: a ship's sway of 6 s leaves 1e-6 of its rate.
const DEGREE: usize = 7;

/// Standard deviation of the output for increments that are differences of readings, in that of one difference of two.
fn norm_of_differences(weights: &[f64; POINTS]) -> f64 {
    let inner: f64 = weights.windows(2).map(|two| (two[0] - two[1]) * (two[0] - two[1])).sum();
    let (first, last) = (weights[0], weights[POINTS - 1]);
    libm::sqrt(0.5 * (inner + first * first + last * last))
}

/// Weights of a step from which the polynomials up to the degree are removed, of norm one.
fn step_weights() -> [f64; POINTS] {
    let at = |i: usize| (2.0 * i as f64 + 1.0) / POINTS as f64 - 1.0;
    let dot =
        |a: &[f64; POINTS], b: &[f64; POINTS]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut bases = [[0.0; POINTS]; DEGREE + 1];
    let mut step: [f64; POINTS] = core::array::from_fn(|i| if 2 * i < POINTS { -1.0 } else { 1.0 });
    for power in 0..=DEGREE {
        // Made from the last basis vector, not from the power, and orthogonalised twice, which is
        // enough (Giraud and others, 2005).
        let mut basis: [f64; POINTS] = match power {
            0 => [1.0; POINTS],
            _ => core::array::from_fn(|i| bases[power - 1][i] * at(i)),
        };
        for _ in 0..2 {
            for other in &bases[..power] {
                let share = dot(&basis, other);
                basis.iter_mut().zip(other).for_each(|(value, other)| *value -= share * other);
            }
        }
        let norm = libm::sqrt(dot(&basis, &basis));
        bases[power] = basis.map(|value| value / norm);
        let share = dot(&step, &bases[power]);
        step.iter_mut().zip(&bases[power]).for_each(|(value, basis)| *value -= share * basis);
    }
    let norm = libm::sqrt(dot(&step, &step));
    step.map(|value| value / norm)
}

#[cfg(test)]
mod tests;
