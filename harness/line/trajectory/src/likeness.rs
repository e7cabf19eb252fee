//! How like a solution is to its reference: sums from which it can be told that one was made of the other.
//!
//! The errors of a solution that is independent of its reference contain the reference's own errors. Where the differences are far
//! below them, the solution isn't independent: it is the reference itself, rounded, or late, or was aided by it. Sums are
//! taken of the differences as they are, and of what is left of them after the best fit of a delay τ: a solution that is τ late
//! is off by -τ v + τ²/2 a, with velocity v and acceleration a of the reference.

/// Largest scatter of differences that is too small, in σ of the reference.
const SCATTER: f64 = 0.5;
/// Largest mean that is too small, in σ, of one axis and of two: sqrt(0.75 q), with the quantile q of 1 % of χ² with as many
/// degrees of freedom, 1.5709e-4 and 0.020101.
const MEANS: [f64; 2] = [0.010_854, 0.122_78];
/// Shortest time between two points that are taken, ns: the digits of a reference would spoil its velocity.
const STEP_NS: u64 = 500_000_000;
/// Longest one over which a velocity is taken, ns.
const STEP_MAX_NS: u64 = 5_000_000_000;

/// Sums of the differences of a quantity with one or two axes.
#[derive(Clone, Debug, Default)]
pub struct Likeness {
    axes: usize,
    points: u64,
    sum: [f64; 2],
    square: f64,
    /// Points with a velocity and an acceleration; then sums of differences, velocities and accelerations.
    moving: u64,
    sums: [[f64; 2]; 3],
    /// Products of differences, velocities and accelerations, summed over axes and points.
    products: [[f64; 3]; 3],
    first: Option<[[f64; 2]; 2]>,
    varies: [bool; 2],
    last: Option<(u64, [f64; 2], Option<[f64; 2]>)>,
}

/// Differences of a quantity over all points, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differences {
    /// Standard deviation about their mean, of each axis.
    pub scatter: f64,
    /// Length of the mean of all axes.
    pub mean: f64,
    /// Delay of the solution, s, whose effect was taken out first; `None`: none was.
    pub delay_s: Option<f64>,
}

impl Differences {
    /// Returns whether differences on so many axes, one or two, are too small for a reference of this standard deviation.
    ///
    /// The differences of a solution that is independent of its reference contain the errors of the reference, of σ on each axis.
    /// However these are spread between a constant and a part that changes, both parts can't be small: σ² is their sum. A
    /// scatter below 0.5 σ leaves three quarters of it or more for the constant, and the mean of so many axes is then
    /// below its limit with a probability of 1 %. Errors of a few independent draws lie between, and are less probable still.
    #[must_use]
    pub fn is_too_small(&self, axes: usize, sigma: f64) -> bool {
        let mean = MEANS[axes.clamp(1, MEANS.len()) - 1];
        self.scatter < SCATTER * sigma && self.mean < mean * sigma
    }
}

impl Likeness {
    /// Sums of a quantity of so many axes, one or two.
    pub(crate) fn of_axes(axes: usize) -> Self {
        Self { axes, ..Self::default() }
    }

    /// Takes solution and reference at a time; of one axis the other is zero.
    pub(crate) fn push(&mut self, time_ns: u64, solution: [f64; 2], reference: [f64; 2]) {
        let first = *self.first.get_or_insert([solution, reference]);
        self.varies[0] |= first[0] != solution;
        self.varies[1] |= first[1] != reference;
        let Some((last_ns, before, velocity_before)) = self.last else {
            self.take(solution, reference);
            self.last = Some((time_ns, reference, None));
            return;
        };
        let elapsed_ns = time_ns.saturating_sub(last_ns);
        if elapsed_ns < STEP_NS {
            return;
        }
        self.take(solution, reference);
        let elapsed_s = elapsed_ns as f64 * 1e-9;
        let per_s = |now: [f64; 2], before: [f64; 2]| {
            [0, 1].map(|axis| (now[axis] - before[axis]) / elapsed_s)
        };
        let velocity = (elapsed_ns <= STEP_MAX_NS).then(|| per_s(reference, before));
        self.last = Some((time_ns, reference, velocity));
        let (Some(velocity), Some(velocity_before)) = (velocity, velocity_before) else { return };
        let difference = [0, 1].map(|axis| solution[axis] - reference[axis]);
        let vectors = [difference, velocity, per_s(velocity, velocity_before)];
        self.moving += 1;
        for (sum, vector) in self.sums.iter_mut().zip(vectors) {
            (0..2).for_each(|axis| sum[axis] += vector[axis]);
        }
        for (row, a) in vectors.iter().enumerate() {
            for (column, b) in vectors.iter().enumerate() {
                self.products[row][column] += a[0] * b[0] + a[1] * b[1];
            }
        }
    }

    fn take(&mut self, solution: [f64; 2], reference: [f64; 2]) {
        self.points += 1;
        for axis in 0..2 {
            let difference = solution[axis] - reference[axis];
            self.sum[axis] += difference;
            self.square += difference * difference;
        }
    }

    /// Number of axes.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.axes
    }

    /// Number of points whose differences were taken.
    #[must_use]
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Returns whether both solution and reference change; constants that agree show nothing.
    #[must_use]
    pub fn varies(&self) -> bool {
        self.varies == [true; 2]
    }

    /// Returns whether the solution changes.
    #[must_use]
    pub fn solution_varies(&self) -> bool {
        self.varies[0]
    }

    /// The differences as they are.
    #[must_use]
    pub fn differences(&self) -> Option<Differences> {
        self.left(self.points, self.sum, self.square, None)
    }

    /// What is left of the differences after the best delay.
    #[must_use]
    pub fn after_delay(&self) -> Option<Differences> {
        let [[dd, dv, da], [_, vv, va], [_, _, aa]] = self.products;
        let determinant = vv * aa - va * va;
        // Of a motion without acceleration the velocity alone is fitted.
        let (by_velocity, by_acceleration) = if determinant > 1e-9 * vv * aa {
            ((dv * aa - da * va) / determinant, (da * vv - dv * va) / determinant)
        } else if vv > 0.0 {
            (dv / vv, 0.0)
        } else {
            return None;
        };
        let [d, v, a] = self.sums;
        let sum = [0, 1].map(|axis| d[axis] - by_velocity * v[axis] - by_acceleration * a[axis]);
        let square = dd - by_velocity * dv - by_acceleration * da;
        self.left(self.moving, sum, square.max(0.0), Some(-by_velocity))
    }

    fn left(
        &self,
        points: u64,
        sum: [f64; 2],
        square: f64,
        delay_s: Option<f64>,
    ) -> Option<Differences> {
        if points < 2 || self.axes == 0 {
            return None;
        }
        let n = points as f64;
        let mean = sum.map(|sum| sum / n);
        let mean_square = mean[0] * mean[0] + mean[1] * mean[1];
        let scatter = libm::sqrt((square / n - mean_square).max(0.0) / self.axes as f64);
        Some(Differences { scatter, mean: libm::sqrt(mean_square), delay_s })
    }
}
