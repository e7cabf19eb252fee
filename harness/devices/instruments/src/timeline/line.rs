//! Line of the stamps over the count of readings, with a fading memory.

/// Number of readings that the fit remembers.
pub const MEMORY: f64 = 2000.0;
/// Number of readings that are looked at behind a stamp that is off, where they are there.
pub const AHEAD: usize = 16;

/// Information of the nominal period: as much as ten stamps have.
const NOMINAL_VARIANCE: f64 = 12.0 / 1000.0;
/// Variance by which the period may change from one reading to the next, in stamps' variances: the steady state of the filter then
/// remembers [`MEMORY`] readings.
const DRIFT_VARIANCE: f64 = 36.0 / (MEMORY * MEMORY * MEMORY * MEMORY);
/// Memory of the scatter, in readings.
const SCATTER_MEMORY: f64 = 500.0;

/// Standard deviation of the nominal period, as a share: rates that differ by more than 5 % are refused.
const NOMINAL_SIGMA: f64 = 0.02;

/// Number of readings whose mean shows a gap that single stamps don't.
const BLOCK: u32 = 64;

/// Phase and period, with stamps of unit variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// First stamp, ns.
    origin_ns: u64,
    /// Fitted time of the last reading since the first stamp, ns.
    phase_ns: f64,
    period_ns: f64,
    /// Covariance of phase and period.
    variance: [f64; 3],
    /// Mean square of the distances from the fit, ns², and the number of readings behind it.
    square_ns2: f64,
    squares: f64,
    off_max_ns: f64,
    /// Sum of the distances in the present block, ns, and the number of them.
    block: (f64, u32),
    /// Number of missing readings that a block showed and that no reading has skipped yet.
    owed: u64,
}

impl Line {
    pub(super) fn new(origin_ns: u64, nominal_ns: f64) -> Self {
        Self {
            origin_ns,
            phase_ns: 0.0,
            period_ns: nominal_ns,
            variance: [1.0, 0.0, NOMINAL_VARIANCE],
            square_ns2: 0.0,
            squares: 0.0,
            off_max_ns: 0.0,
            block: (0.0, 0),
            owed: 0,
        }
    }

    /// Begins in the middle of stamps that aren't regular: the line through the first ones, and their scatter.
    #[cold]
    pub(super) fn settle(&mut self, followers: impl Iterator<Item = u64>) {
        let mut off = [0.0; AHEAD + 1];
        let mut n = 1;
        for stamp in followers.take(AHEAD) {
            off[n] = self.off_ns(stamp, n as u64);
            n += 1;
        }
        if n <= AHEAD {
            return;
        }
        let off = &off[..n];
        let mean = off.iter().sum::<f64>() / n as f64;
        let square = off.iter().map(|off| (off - mean) * (off - mean)).sum::<f64>() / n as f64;
        // Stamps far from the nominal rate have a gap, or another rate: the line isn't theirs.
        if mean.abs() > AHEAD as f64 * 0.5 * self.period_ns {
            return;
        }
        self.phase_ns = mean;
        (self.square_ns2, self.squares) = (square, n as f64);
        self.variance[0] = 4.0 / n as f64;
        // Stamps in bursts aren't independent: a burst must not be taken for another rate.
        let nominal_ns = NOMINAL_SIGMA * self.period_ns;
        self.variance[2] = self.variance[2].min(nominal_ns * nominal_ns / square.max(1.0));
    }

    /// Returns whether the scatter is known.
    pub(super) fn is_settled(&self) -> bool {
        self.squares >= 8.0
    }

    pub(super) const fn origin_ns(&self) -> u64 {
        self.origin_ns
    }

    pub(super) const fn period_ns(&self) -> f64 {
        self.period_ns
    }

    /// Standard deviation of the stamps about the fit, ns.
    pub(super) fn scatter_ns(&self) -> f64 {
        libm::sqrt(self.square_ns2)
    }

    pub(super) const fn scatter_max_ns(&self) -> f64 {
        self.off_max_ns
    }

    /// Fitted time of the last reading, ns.
    pub(super) fn time_ns(&self) -> u64 {
        let since = libm::round(self.phase_ns) as i64;
        self.origin_ns.saturating_add_signed(since)
    }

    /// Distance of a stamp, so many steps behind the last reading, from the line, ns: positive where it is late.
    #[inline]
    pub(super) fn off_ns(&self, stamp_ns: u64, steps: u64) -> f64 {
        // Stamps since 1970 in ns are no numbers that f64 has: the difference is taken first.
        let since = (i128::from(stamp_ns) - i128::from(self.origin_ns)) as f64;
        since - (self.phase_ns + steps as f64 * self.period_ns)
    }

    /// Moves the line on by so many readings without a stamp.
    pub(super) fn skip(&mut self, steps: u64) {
        let k = steps as f64;
        let [phase, both, period] = self.variance;
        let phase = phase + k * (2.0 * both + k * period);
        self.variance = [phase, both + k * period, period + k * DRIFT_VARIANCE];
        self.phase_ns += k * self.period_ns;
    }

    /// Takes the stamp of a reading so many steps behind the last one; returns its distance from the line before.
    #[inline]
    pub(super) fn take(&mut self, stamp_ns: u64, steps: u64, by_stamps: bool) -> f64 {
        let off_ns = self.off_ns(stamp_ns, steps);
        let k = steps as f64;
        let [phase, both, period] = self.variance;
        let (phase, both) = (phase + k * (2.0 * both + k * period), both + k * period);
        let period = period + k * DRIFT_VARIANCE;
        let gain = 1.0 / (phase + 1.0);
        // A single stamp that is far off is no reason to move the line.
        let limit_ns = (4.0 * self.scatter_ns()).max(0.5 * self.period_ns);
        let taken_ns = off_ns.clamp(-limit_ns, limit_ns);
        self.phase_ns += k * self.period_ns + phase * gain * taken_ns;
        self.period_ns += both * gain * taken_ns;
        self.variance = [phase * gain, both * gain, period - both * both * gain];
        // The first distances are those of a line that isn't settled.
        if phase < 0.5 {
            self.squares = (self.squares + 1.0).min(SCATTER_MEMORY);
            self.square_ns2 += (taken_ns * taken_ns - self.square_ns2) / self.squares;
            self.off_max_ns = self.off_max_ns.max(off_ns.abs());
        }
        if by_stamps {
            self.add_to_block(taken_ns);
        }
        off_ns
    }

    /// Finds a gap that no single stamp shows for all their scatter: the mean of a block is off by whole periods.
    #[inline]
    fn add_to_block(&mut self, off_ns: f64) {
        self.block = (self.block.0 + off_ns, self.block.1 + 1);
        if self.block.1 < BLOCK {
            return;
        }
        let mean_ns = self.block.0 / f64::from(BLOCK);
        self.block = (0.0, 0);
        let error_ns = self.scatter_ns() / libm::sqrt(f64::from(BLOCK));
        if mean_ns > 0.6 * self.period_ns && mean_ns > 4.0 * error_ns {
            self.owed = libm::round(mean_ns / self.period_ns) as u64;
        }
    }

    /// Number of missing readings that the next reading has to skip.
    #[inline]
    pub(super) fn owed(&mut self) -> u64 {
        core::mem::take(&mut self.owed)
    }
}
