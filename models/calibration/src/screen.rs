//! Rejection of impossible samples: increments that jump further than any motion allows, and
//! channels that are stuck.
//!
//! Two neighbouring increments of one channel differ by their noise and by the change of the rate
//! (or of the specific force) in one period. The table's and the base's largest accelerations bound
//! that change, and a difference beyond the bound is rejected. A clean stream costs one comparison
//! a channel: everything else is computed only if one of these fails.
//!
//! Limits, for a period h and noise σ of an increment:
//! - noise: 8 √2 σ. The difference of two samples has √2 σ, and eight of these are exceeded with
//!   1.2e-15: in 28 h at 200 Hz, 2e7 samples of six channels, with 2e-7.
//! - gyros: α h², where α is the acceleration that the base can have and, while the gimbals move,
//!   twice that of the turntable on both gimbals with the square of the rates (two gimbals turning
//!   at once carry each other's axes around). Twice, because a servo doesn't follow its set point
//!   exactly.
//! - accelerometers: gravity turning through the axes, (g + a) ω h², and the base's own jerk.
//!
//! The hold is bounded: after it the stream is accepted again. If a stream keeps jumping, the limit
//! must be wrong, and is doubled.

use crate::config::{Base, Noise, Screening, TurntableRates};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};

/// Counts of gyros x y z and accelerometers x y z.
pub type SensorCounts = [i32; 6];

/// Channels of the gyros as bits.
pub const GYROS: u8 = 0b00_0111;
/// Channels of the accelerometers as bits.
pub const ACCELEROMETERS: u8 = 0b11_1000;

/// Standard deviations of the difference of two samples that the noise is allowed.
const NOISE_SIGMAS: f64 = 8.0;
/// Smallest white noise for which the limit is meaningful, counts; below it noise doesn't limit a
/// real sensor.
const TESTABLE_COUNTS: f64 = 20.0;
/// Margin for the deviation of the turntable's servo from its acceleration and rate.
const SERVO_MARGIN: f64 = 2.0;
/// Limit of a channel without a test: no difference is as large, and a difference below the floor
/// wraps to more.
const NO_LIMIT: u32 = u32::MAX - 1;
/// Standard gravity, for a bound.
const GRAVITY_MPS2: f64 = 9.81;
/// Longest hold if the motion is known (a base at rest), s, and if the last increments are held, s:
/// a ship's 5 °/s² make 90″ in 0.1 s.
const HOLD_KNOWN_S: f64 = 2.0;
const HOLD_LAST_S: f64 = 0.1;
/// Largest number of jumps in a stretch of ten seconds that a fault can cause; more jumps are a
/// property of the stream. One hold that reaches its end counts as ten.
const JUMPS_MAX: u32 = 50;
const JUMPS_STRETCH_S: f64 = 10.0;
const EXPIRED_JUMPS: u32 = 10;

/// Result for a sample that didn't pass at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Examined {
    /// Channels that jumped and are rejected.
    pub jumped: u8,
    /// Channels that have repeated the same count for too long.
    pub stuck: u8,
    /// Stuck channels that were found with this sample.
    pub found_stuck: u8,
    /// Channels that have jumped for too long: accepted again from this sample on.
    pub expired: u8,
}

/// Screen of one stream.
#[derive(Clone, Debug)]
pub struct Screen {
    /// Last counts that were accepted.
    last: SensorCounts,
    /// Limits while the gimbals rest and while they move; `floor` is 1 where identical counts are a
    /// fault.
    limits: [[u32; 6]; 2],
    floor: [u32; 6],
    /// True if no channel is held and no repeats are counted.
    calm: bool,
    started: bool,
    stuck_limit: u32,
    hold: [u32; 2],
    stretch: u64,

    seen: SensorCounts,
    runs: [u32; 6],
    held: [u32; 6],
    jumps: [u32; 2],
    stretch_until: u64,
}

#[cfg(feature = "state")]
octant_state::state! {
    Screen {
        values: last, limits, calm, started, seen, runs, held, jumps, stretch_until;
        parts: ;
        kept: floor, stuck_limit, hold, stretch;
        check: Self::check_counts
    }
}

#[cfg(feature = "state")]
impl Screen {
    fn check_counts(&self) -> Result<(), octant_state::StateError> {
        let longest = self.hold[0].max(self.hold[1]);
        for held in self.held {
            octant_state::check_below("held", held.into(), longest.into())?;
        }
        for jumps in self.jumps {
            octant_state::check_below("jumps", jumps.into(), JUMPS_MAX.into())?;
        }
        Ok(())
    }
}

impl Screen {
    /// Makes a screen for samples of this period (s).
    #[must_use]
    pub fn new(
        screening: &Screening,
        noise: &Noise,
        turntable: &TurntableRates,
        sample_s: f64,
    ) -> Self {
        let sqrt_s = libm::sqrt(sample_s);
        let (base_rate, base_acceleration, force, jerk) = match screening.base {
            Base::Still => (0.0, 0.0, 0.0, 0.0),
            Base::Moving(motion) => {
                (motion.rate_radps, motion.acceleration_radps2, motion.force_mps2, motion.jerk_mps3)
            }
        };
        let table_rate = SERVO_MARGIN * core::f64::consts::SQRT_2 * turntable.rate_radps;
        let table_acceleration =
            SERVO_MARGIN * core::f64::consts::SQRT_2 * turntable.acceleration_radps2;
        // Index 0: gimbals at rest; index 1: gimbals moving.
        let angular = [
            base_acceleration,
            base_acceleration
                + table_acceleration
                + (table_rate + base_rate) * (table_rate + base_rate),
        ];
        let turning = |rate: f64| (GRAVITY_MPS2 + force) * rate + jerk;
        let linear = [turning(base_rate), turning(base_rate + table_rate)];
        let square = sample_s * sample_s;
        let (gyro_step, accel_step) = screening.resolution;
        let triads = [
            (noise.angle_random_walk, gyro_step, screening.vibration.0, angular),
            (noise.velocity_random_walk, accel_step, screening.vibration.1, linear),
        ];
        let mut limits = [[NO_LIMIT; 6]; 2];
        let mut floor = [0; 6];
        for (triad, (random_walk, step, vibration, motion)) in triads.into_iter().enumerate() {
            let lsb = [DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS][triad];
            let sigma = random_walk * sqrt_s;
            let sigma_counts = sigma / lsb;
            let testable = sigma_counts >= TESTABLE_COUNTS;
            for channel in 3 * triad..3 * triad + 3 {
                for (limit, motion) in limits.iter_mut().zip(motion) {
                    let noise_counts = NOISE_SIGMAS * core::f64::consts::SQRT_2 * sigma_counts;
                    let known = 2.0 * step + vibration + motion * square;
                    let counts = noise_counts + known / lsb + 2.0;
                    limit[channel] = if testable && screening.jumps && counts < 1e9 {
                        counts as u32
                    } else {
                        NO_LIMIT
                    };
                }
                let coarse = step > sigma;
                floor[channel] =
                    u32::from(testable && !coarse && screening.stuck_samples.is_some());
            }
        }
        let samples = |time_s: f64| (time_s / sample_s + 0.5).max(1.0) as u32;
        Self {
            last: [0; 6],
            limits,
            floor,
            calm: true,
            started: false,
            stuck_limit: screening.stuck_samples.unwrap_or(u32::MAX),
            hold: [samples(HOLD_LAST_S), samples(HOLD_KNOWN_S)],
            stretch: u64::from(samples(JUMPS_STRETCH_S)),
            seen: [0; 6],
            runs: [0; 6],
            held: [0; 6],
            jumps: [0; 2],
            stretch_until: 0,
        }
    }

    /// Returns whether the sample passes, and takes it in that case; otherwise call
    /// [`Self::examine`]. The counts are separate arguments for the reason given at the caller.
    #[must_use]
    #[inline]
    #[allow(clippy::too_many_arguments, reason = "in registers")]
    pub fn passes(&mut self, moving: bool, x: i32, y: i32, z: i32, u: i32, v: i32, w: i32) -> bool {
        let limits = &self.limits[usize::from(moving)];
        let counts = [x, y, z, u, v, w];
        let mut bad = false;
        for i in 0..6 {
            // From the floor up to the limit; a difference below the floor wraps around.
            let difference = counts[i].wrapping_sub(self.last[i]).unsigned_abs();
            bad |= difference.wrapping_sub(self.floor[i]) > limits[i];
        }
        let good = self.calm & !bad;
        if good {
            self.last = counts;
        }
        good
    }

    /// Examines a sample that didn't pass. `expected`: counts of the known motion, if it is known;
    /// `tick`: number of the sample.
    pub fn examine(
        &mut self,
        counts: &SensorCounts,
        moving: bool,
        expected: Option<&[f64; 6]>,
        tick: u64,
    ) -> Examined {
        let mut found = Examined::default();
        if !self.started {
            self.started = true;
            (self.last, self.seen) = (*counts, *counts);
            return found;
        }
        if self.calm {
            self.seen = self.last;
        }
        if tick >= self.stretch_until {
            self.stretch_until = tick.saturating_add(self.stretch);
            self.jumps = [0; 2];
        }
        let hold = self.hold[usize::from(expected.is_some())];
        let mut calm = true;
        for i in 0..6 {
            let bit = 1u8 << i;
            let repeats = self.floor[i] != 0 && counts[i] == self.seen[i];
            let was_stuck = self.runs[i].saturating_add(1) >= self.stuck_limit;
            self.runs[i] = if repeats { self.runs[i].saturating_add(1) } else { 0 };
            let stuck = self.runs[i].saturating_add(1) >= self.stuck_limit;
            calm &= self.runs[i] == 0;
            if stuck {
                found.stuck |= bit;
                if !was_stuck {
                    found.found_stuck |= bit;
                }
                // The counts of a stuck channel are neither a jump nor a reference for one.
                self.held[i] = 0;
                continue;
            }
            let limit = self.limits[usize::from(moving)][i];
            let near =
                |reference: f64, allowed: f64| (f64::from(counts[i]) - reference).abs() <= allowed;
            // A motion continues while it is rejected; the limit is twice the motion.
            let moves = moving || expected.is_none();
            let since = if moves { 1.0 + 0.5 * f64::from(self.held[i]) } else { 1.0 };
            let believed = limit == NO_LIMIT
                || near(f64::from(self.last[i]), since * f64::from(limit))
                || expected.is_some_and(|expected| near(expected[i], f64::from(limit)))
                // The motion while the channel was stuck is unknown.
                || (was_stuck && expected.is_none());
            if believed {
                self.last[i] = counts[i];
                self.held[i] = 0;
                continue;
            }
            let triad = i / 3;
            if self.held[i] == 0 {
                self.jumps[triad] += 1;
            }
            self.held[i] += 1;
            if self.held[i] > hold {
                found.expired |= bit;
                self.jumps[triad] += EXPIRED_JUMPS;
                self.last[i] = counts[i];
                self.held[i] = 0;
            } else {
                found.jumped |= bit;
                calm = false;
            }
        }
        for triad in 0..2 {
            if self.jumps[triad] > JUMPS_MAX {
                self.jumps[triad] = 0;
                self.widen(triad);
            }
        }
        self.seen = *counts;
        self.calm = calm;
        found
    }

    /// Doubles the limit of a triad whose stream jumps again and again: the limit must be wrong.
    fn widen(&mut self, triad: usize) {
        for limits in &mut self.limits {
            for limit in &mut limits[3 * triad..3 * triad + 3] {
                *limit = limit.saturating_mul(2);
            }
        }
    }

    /// Number of repeats of the last count in a row.
    #[must_use]
    pub fn run(&self, channel: usize) -> u32 {
        self.runs[channel]
    }

    /// Last counts that were accepted.
    #[must_use]
    pub fn last(&self) -> &SensorCounts {
        &self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Recovery;

    const SAMPLE_S: f64 = 0.005;

    fn noise() -> Noise {
        // Table 1: 0.0007 °/√h and 50 µg/√Hz.
        Noise { angle_random_walk: 2.036e-7, velocity_random_walk: 4.903e-4 }
    }

    fn screen(screening: &Screening) -> Screen {
        let table = TurntableRates { rate_radps: 0.174_533, acceleration_radps2: 0.174_533 };
        let mut screen = Screen::new(screening, &noise(), &table, SAMPLE_S);
        assert_eq!(screen.examine(&still(0), false, None, 0), Examined::default());
        screen
    }

    /// Counts that change from sample to sample by less than the noise.
    fn still(k: i32) -> SensorCounts {
        [100 + k % 2, 200 + k % 2, 300 + k % 2, k % 2, 1 + k % 2, -52_000_000 + k % 2]
    }

    fn passes(screen: &mut Screen, [x, y, z, u, v, w]: SensorCounts, moving: bool) -> bool {
        screen.passes(moving, x, y, z, u, v, w)
    }

    #[test]
    fn limits_follow_from_noise_and_motion() {
        let screen = screen(&Screening::hardened(Base::Still));
        // 8 √2 × 2.036e-7 √0.005 × 2³⁶ = 11 195; 8 √2 × 4.903e-4 √0.005 × 2³⁰ = 421 200.
        assert!((11_150..11_250).contains(&screen.limits[0][0]), "{:?}", screen.limits);
        assert!((419_000..423_000).contains(&screen.limits[0][3]), "{:?}", screen.limits);
        // Twice √2 of 10 °/s² over 5 ms, and the square of the rate, 0.244: 0.737 × 2.5e-5 × 2³⁶.
        let motion = screen.limits[1][0] - screen.limits[0][0];
        assert!((1_250_000..1_280_000).contains(&motion), "{motion}");
    }

    #[test]
    fn a_jump_is_held_for_no_longer_than_its_bound() {
        let mut screen = screen(&Screening::hardened(Base::Still));
        for k in 1..10 {
            assert!(passes(&mut screen, still(k), false));
        }
        let jumped = |k: i32| {
            let mut counts = still(k);
            counts[1] += 1_000_000;
            counts
        };
        let mut held = 0;
        for k in 10.. {
            assert!(!passes(&mut screen, jumped(k), false));
            let found = screen.examine(&jumped(k), false, None, k as u64);
            if found.expired != 0 {
                assert_eq!(found.expired, 0b10);
                break;
            }
            assert_eq!(found.jumped, 0b10);
            held += 1;
        }
        // 0.1 s if the motion isn't known.
        assert_eq!(held, 20);
        assert!(passes(&mut screen, jumped(1), false), "believed");
    }

    #[test]
    fn a_stream_that_keeps_jumping_is_believed_in_the_end() {
        let mut screen = screen(&Screening::hardened(Base::Still));
        let mut disbelieved = 0;
        for k in 1..20_000 {
            let mut counts = still(k);
            counts[0] += if k % 4 == 0 { 60_000 } else { 0 };
            if !passes(&mut screen, counts, false) {
                let found = screen.examine(&counts, false, None, k as u64);
                disbelieved += i32::from(found.jumped != 0);
            }
        }
        // Three doublings of 11 200 reach 60 000 after 51 jumps each.
        assert_eq!(disbelieved, 3 * 51);
    }

    #[test]
    fn identical_counts_are_stuck_and_a_bare_screen_passes_everything_else() {
        for screening in [
            Screening::hardened(Base::Still),
            Screening::gated(Recovery::Widening),
            Screening::none(),
        ] {
            let mut screen = screen(&screening);
            let mut stuck = 0;
            for k in 1..20 {
                let mut counts = still(k);
                counts[4] = 7;
                if !passes(&mut screen, counts, false) {
                    let found = screen.examine(&counts, false, None, k as u64);
                    assert_eq!(found.jumped | found.expired, 0);
                    stuck += u32::from(found.stuck == 0b1_0000);
                    assert_eq!(found.found_stuck != 0, found.stuck != 0 && stuck == 1);
                }
            }
            // The eighth of nineteen equal counts is the first that is found stuck.
            assert_eq!(stuck, if screening.stuck_samples.is_some() { 12 } else { 0 });
            let wild = [i32::MIN, i32::MAX, 0, i32::MAX, i32::MIN, 5];
            let good = passes(&mut screen, wild, true);
            let jumped = !good && screen.examine(&wild, true, None, 20).jumped != 0;
            assert_eq!(jumped, screening.jumps);
        }
    }
}
