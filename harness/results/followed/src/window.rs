//! Sums of the error dynamics over windows of a length, and the regressions of their residuals.

use crate::interval::{ACCEL_PARAMETERS, Effects, Errors, GYRO_PARAMETERS, Interval, Noise};
use crate::regression::{BLOCK, Block, Normal, Slope};

/// Lags of the answers behind the samples that are tried, s; none is longer than the window.
pub const LAGS_S: [usize; 8] = [0, 1, 2, 5, 10, 20, 30, 60];
/// Number of intervals that are remembered: the longest window with the longest lag before it, and a margin.
pub const REMEMBERED: usize = 256;

/// Number of windows from which on sparse ones leave out three of four blocks.
const SPARSE_FROM: u64 = 900;

const PARAMETERS: usize = GYRO_PARAMETERS + ACCEL_PARAMETERS;
const OF_ATTITUDE: usize = GYRO_PARAMETERS + LAGS_S.len() + 1;
/// Two responses: with the tilt that the unit tells, and without.
const OF_VELOCITY: usize = PARAMETERS + LAGS_S.len() + 2;

/// The last intervals without a break, oldest overwritten.
#[derive(Clone, Debug)]
pub struct Past {
    noise: [(Noise, f64); REMEMBERED],
    /// Number of intervals since the break.
    count: usize,
}

impl Default for Past {
    fn default() -> Self {
        Self { noise: [(Noise::default(), 0.0); REMEMBERED], count: 0 }
    }
}

impl Past {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Takes an interval: its noise, and what a tilt pushes in it.
    pub fn push(&mut self, interval: &Interval) {
        let [_, per_north] = interval.pushed([1.0, 0.0]);
        self.noise[self.count % REMEMBERED] = (interval.noise, per_north);
        self.count += 1;
    }

    /// Sums the effect of the noise over `length` intervals that ended `lag` intervals ago: φ north and east, velocity
    /// north and east; `None` where not all of them are remembered.
    fn effect(&self, length: usize, lag: usize) -> Option<[f64; 4]> {
        if length + lag > self.count.min(REMEMBERED) {
            return None;
        }
        let mut sum = [0.0; 4];
        for back in (lag..lag + length).rev() {
            let (noise, per_tilt) = self.noise[(self.count - 1 - back) % REMEMBERED];
            // The tilt in the middle of the interval pushes.
            let [north, east] = [0, 1].map(|axis| sum[axis] + 0.5 * noise.phi_rad[axis]);
            sum[2] += noise.velocity_mps[0] - per_tilt * east;
            sum[3] += noise.velocity_mps[1] + per_tilt * north;
            sum[0] += noise.phi_rad[0];
            sum[1] += noise.phi_rad[1];
        }
        Some(sum)
    }
}

/// Windows of one length, one after the other, with their regressions.
///
/// Each quantity is regressed over the windows without a turn, and over those with one: errors of encoders at a turn spoil
/// the second alone. The velocity is regressed with the tilt that the unit tells, which turns the force of a moving ship,
/// and with none, which a coarse or false attitude can't spoil.
#[derive(Clone, Debug)]
pub struct Windows {
    length_s: usize,
    /// True if one of four blocks is enough, once there are some.
    is_sparse: bool,
    open: Option<Open>,
    attitude: [Quantity<OF_ATTITUDE>; 2],
    velocity: [Quantity<OF_VELOCITY>; 2],
    windows: u64,
}

/// Regression of one quantity, whose rows north and east are in blocks of their own.
#[derive(Clone, Debug)]
struct Quantity<const N: usize> {
    normal: Normal<N>,
    blocks: [Block<N>; 2],
}

impl<const N: usize> Quantity<N> {
    fn of(rows: usize) -> Self {
        Self { normal: Normal::default(), blocks: [Block::of(rows), Block::of(rows)] }
    }

    fn push(&mut self, axis: usize, row: &[f64; N]) {
        self.blocks[axis].push(row, &mut self.normal);
    }

    fn end(&mut self) {
        self.blocks.iter_mut().for_each(|block| block.end(&mut self.normal));
    }
}

/// A window that has begun.
#[derive(Clone, Copy, Debug)]
struct Open {
    /// Errors at its beginning, carried to now.
    carried: Errors,
    /// Attitude at its beginning, carried to now by itself.
    phi_rad: [f64; 3],
    /// Velocity at its beginning: without a tilt it stays.
    velocity_mps: [f64; 2],
    intervals: usize,
    elapsed_s: f64,
    is_quiet: bool,
    /// Effects of the gyros' parameters on φ and on the velocity, north and east, and of the accelerometers' ones.
    phi: [[f64; GYRO_PARAMETERS]; 2],
    by_tilt: [[f64; GYRO_PARAMETERS]; 2],
    by_force: [[f64; ACCEL_PARAMETERS]; 2],
}

impl Open {
    fn at(errors: &Errors) -> Self {
        Self {
            carried: *errors,
            phi_rad: errors.phi_rad,
            velocity_mps: errors.velocity_mps,
            intervals: 0,
            elapsed_s: 0.0,
            is_quiet: true,
            phi: [[0.0; GYRO_PARAMETERS]; 2],
            by_tilt: [[0.0; GYRO_PARAMETERS]; 2],
            by_force: [[0.0; ACCEL_PARAMETERS]; 2],
        }
    }

    fn carry(&mut self, interval: &Interval, effects: &Effects) {
        interval.carry(&mut self.carried);
        interval.carry_attitude(&mut self.phi_rad);
        self.intervals += 1;
        self.elapsed_s += interval.dt_s;
        self.is_quiet &= interval.is_quiet;
        for parameter in 0..GYRO_PARAMETERS {
            let added = effects.gyro.map(|effects| effects[parameter]);
            let [north, east] = [0, 1].map(|axis| self.phi[axis][parameter] + 0.5 * added[axis]);
            let pushed = interval.pushed([north, east]);
            for axis in 0..2 {
                self.by_tilt[axis][parameter] += pushed[axis];
                self.phi[axis][parameter] += added[axis];
            }
        }
        for (axis, by_force) in self.by_force.iter_mut().enumerate() {
            let effects = &effects.accelerometer[axis];
            by_force.iter_mut().zip(effects).for_each(|(sum, effect)| *sum += effect);
        }
    }
}

impl Windows {
    /// Makes windows of at least this length, s, which is longer where the answers change more seldom. Lines are taken
    /// from blocks of two minutes, of at least four windows and at most twelve.
    #[must_use]
    pub fn of(length_s: usize, is_sparse: bool) -> Self {
        let rows = 120 / length_s;
        Self {
            length_s,
            is_sparse,
            open: None,
            attitude: [0; 2].map(|_| Quantity::of(rows)),
            velocity: [0; 2].map(|_| Quantity::of(rows)),
            windows: 0,
        }
    }

    /// Ends the window that is open without a result.
    pub fn interrupt(&mut self) {
        self.open = None;
        self.attitude.iter_mut().for_each(Quantity::end);
        self.velocity.iter_mut().for_each(Quantity::end);
    }

    /// Carries the open window over an interval.
    pub fn carry(&mut self, interval: &Interval, effects: &Effects) {
        if let Some(open) = &mut self.open {
            open.carry(interval, effects);
        }
    }

    /// Takes a new answer's errors at the end of the last interval, which end one window and begin the next.
    pub fn answer(&mut self, errors: &Errors, past: &Past) {
        let block = BLOCK * self.length_s;
        if self.is_sparse && self.windows > SPARSE_FROM && !(past.count / block).is_multiple_of(4) {
            return self.interrupt();
        }
        if let Some(open) = &self.open {
            if open.elapsed_s < self.length_s as f64 - 0.5 {
                return;
            }
            let open = *open;
            // Longer ones are those of answers that stood still.
            if open.elapsed_s < 2.0 * self.length_s as f64 + 60.0 {
                self.end(&open, errors, past);
            }
        }
        self.open = Some(Open::at(errors));
    }

    fn end(&mut self, open: &Open, errors: &Errors, past: &Past) {
        let mut effects = [[0.0; 4]; LAGS_S.len()];
        for (effect, lag) in effects.iter_mut().zip(&LAGS_S[..self.lags()]) {
            let Some(sum) = past.effect(open.intervals, *lag) else { return };
            *effect = sum;
        }
        self.windows += 1;
        for axis in 0..2 {
            let mut row = [0.0; OF_ATTITUDE];
            row[..GYRO_PARAMETERS].copy_from_slice(&open.phi[axis]);
            for (lag, effect) in effects.iter().enumerate() {
                row[GYRO_PARAMETERS + lag] = effect[axis];
            }
            row[OF_ATTITUDE - 1] = errors.phi_rad[axis] - open.phi_rad[axis];
            let turns = usize::from(!open.is_quiet);
            self.attitude[turns].push(axis, &row);
            let mut row = [0.0; OF_VELOCITY];
            row[..GYRO_PARAMETERS].copy_from_slice(&open.by_tilt[axis]);
            row[GYRO_PARAMETERS..PARAMETERS].copy_from_slice(&open.by_force[axis]);
            for (lag, effect) in effects.iter().enumerate() {
                row[PARAMETERS + lag] = effect[2 + axis];
            }
            for (response, carried) in
                [open.carried.velocity_mps, open.velocity_mps].into_iter().enumerate()
            {
                row[OF_VELOCITY - 2 + response] = errors.velocity_mps[axis] - carried[axis];
            }
            self.velocity[turns].push(axis, &row);
        }
    }

    /// Number of the lags that aren't longer than the window.
    fn lags(&self) -> usize {
        LAGS_S.iter().filter(|lag| **lag <= self.length_s).count()
    }

    /// Length, s.
    #[must_use]
    pub fn length_s(&self) -> usize {
        self.length_s
    }

    /// Number of windows.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.windows
    }

    /// Regressions of the attitude for each lag, s.
    pub fn attitude(&self) -> impl Iterator<Item = (usize, Slope)> {
        let of = |of| self.slopes(GYRO_PARAMETERS, of, OF_ATTITUDE - 1);
        self.attitude.iter().flat_map(move |quantity| of(&quantity.normal))
    }

    /// Regressions of the velocity for each lag, s.
    pub fn velocity(&self) -> impl Iterator<Item = (usize, Slope)> {
        let responses = [OF_VELOCITY - 2, OF_VELOCITY - 1];
        self.velocity.iter().flat_map(move |quantity| {
            let of = move |response| self.slopes(PARAMETERS, &quantity.normal, response);
            responses.into_iter().flat_map(of)
        })
    }

    fn slopes<'a, const N: usize>(
        &self,
        nuisance: usize,
        of: &'a Normal<N>,
        response: usize,
    ) -> impl Iterator<Item = (usize, Slope)> + use<'a, N> {
        let lags = 0..self.lags();
        lags.filter_map(move |lag| {
            Some((LAGS_S[lag], of.slope(nuisance, nuisance + lag, response)?))
        })
    }
}
