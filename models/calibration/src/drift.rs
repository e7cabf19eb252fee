//! Drift test: are the parameters constant while they are estimated?
//!
//! Between two instants m and n the filter corrects the parameters by d = p(n) − p(m), a sum of weighted innovations.
//! If the parameters are constants, d is independent of p(m) and has the covariance P(m) − P(n) by which their
//! uncertainty shrank (the estimate is a martingale; Bar-Shalom, Li and Kirubarajan, 2001, 5.4, state the whiteness of
//! innovations from which this follows). So for any weights w the quotient
//!
//! ```text
//! z = wᵀ d / √(wᵀ (P(m) − P(n)) w)
//! ```
//!
//! is normal with variance one. A parameter that jumps at m makes it large, while every single innovation remains
//! consistent: the mean square of innovations (NIS) doesn't show the jump.
//!
//! The weights decide how large. Let parameter i jump by a at m, and let the measurements that follow be those of the
//! parameters alone. Then the error of the estimate is c(n) = P(n) P(m)⁻¹ e a, with e the unit vector of i: the filter
//! believes the new value as far as it has forgotten the old one. d has the mean (P(m) − P(n)) P(m)⁻¹ e a, and
//! the weights with the largest mean of z are those of the likelihood ratio, w = P(m)⁻¹ e. What else d tells of the
//! other parameters is used with it: a jump of a bias shows in all that was told apart from it before. (Attitude,
//! velocity and position go on through m too, and are left out. That costs little: where the innovations of all the
//! calibration have a signal-to-noise ratio of 8.1 for a jump that is known, z has a mean of 7.9; where they have 6.3,
//! 6.2 to 6.3. `drift_power` in the tests of the closed loop.)
//!
//! The test covers all pairs of up to 24 marks over the calibration. If less than 1 % of a variance was gained,
//! the parameter could have moved undetected by no more than 0.6 of its σ, and isn't tested. Nor is a parameter tested
//! while it is known hardly better than its prior: a prior that is too narrow is no drift.

use crate::covariance::{Covariance, PARAMETERS};
use nalgebra::SMatrix;
use octant_sample::Parameters;
use octant_sample::parameters::PARAMETER_COUNT;

/// Corrections above this many standard deviations are a drift. Of 3000 clean calibrations of 4 h one is above it, of 1000 of
/// half an hour one.
pub const LIMIT_SIGMAS: f64 = 5.0;
/// The same on a ship, with [`DriftWeights::Own`]: its sway isn't the white noise that the filter assumes. The largest of a
/// hundred clean calibrations of 4 h is 4.3.
pub const LIMIT_MOVING_SIGMAS: f64 = 6.0;

/// Number of marks kept; when they are full, every other one is dropped.
const MARKS: usize = 24;
/// Initial time between marks, s; doubled whenever they are thinned out. Short calibrations have
/// dwells of about a minute, and a drift shows over some of them.
const SPACING_S: f64 = 150.0;
/// Smallest share of the variance to be gained between two marks.
const GAIN_MIN: f64 = 0.01;
/// Share of the prior variance below which a parameter is tested.
const KNOWN: f64 = 0.25;

/// Weights of the test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriftWeights {
    /// Those of the likelihood ratio: the covariance is that of the errors.
    Likelihood,
    /// The parameter's own correction alone. On a ship the filter takes the sway for white noise, and what it knows best it
    /// knows worse than it believes; weights by P⁻¹ rest on just that.
    Own,
}

/// A value for each parameter.
type All = [f64; PARAMETER_COUNT];
/// A square matrix over the parameters.
type Square = SMatrix<f64, PARAMETER_COUNT, PARAMETER_COUNT>;
/// Half of a symmetric matrix over the parameters, row by row: 30 · 31/2 numbers, in rows that serde knows.
type Half = [[f32; PARAMETER_COUNT + 1]; PARAMETER_COUNT / 2];

/// Estimate at one time. Weights are rounded to save memory: z is normal whatever they are, as long as the variance is
/// that of the weights as they are kept.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
struct Mark {
    time_s: f64,
    parameters: All,
    variances: All,
    /// P⁻¹ in units of the prior; zero if there is none.
    weights: Half,
    /// wᵀ P w for the weights w of each parameter.
    spread: All,
}

/// Largest correction found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Largest {
    /// Size in the standard deviations that the correction should have.
    pub sigmas: f64,
    /// Index of the parameter.
    pub parameter: usize,
    /// Start and end, s of filter time.
    pub between_s: (f64, f64),
}

/// Drift test of one calibration.
#[derive(Clone, Debug)]
pub struct DriftTest {
    limit_sigmas: f64,
    weights: DriftWeights,
    /// Standard deviations of the prior.
    prior: All,
    marks: [Mark; MARKS],
    len: usize,
    spacing_s: f64,
    next_s: f64,
    largest: Largest,
}

#[cfg(feature = "state")]
impl octant_state::State for DriftTest {
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { limit_sigmas: _, weights: _, prior: _, marks, len, spacing_s, next_s, largest } =
            self;
        to.value("spacing_s", spacing_s);
        to.value("next_s", next_s);
        to.value("largest", largest);
        to.value("len", len);
        for mark in &marks[..*len] {
            to.value("mark", mark);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        self.spacing_s = from.value("spacing_s")?;
        self.next_s = from.value("next_s")?;
        self.largest = from.value("largest")?;
        let last = PARAMETER_COUNT as u64 - 1;
        octant_state::check_below("largest.parameter", self.largest.parameter as u64, last)?;
        self.len = from.value("len")?;
        octant_state::check_below("len", self.len as u64, MARKS as u64)?;
        for mark in &mut self.marks[..self.len] {
            *mark = from.value("mark")?;
        }
        Ok(())
    }
}

/// Returns whether a parameter is tested between two times at which it has these variances, in units of its prior.
#[must_use]
pub fn is_tested(before: f64, after: f64) -> bool {
    before <= KNOWN && before - after >= GAIN_MIN * after && before > after
}

/// Covariance of the parameters in units of their prior. A parameter without a prior is known: it has no errors.
fn in_units(covariance: &Covariance, prior: &All) -> Square {
    Square::from_fn(|i, j| {
        let unit = prior[i] * prior[j];
        if unit > 0.0 { covariance.at(PARAMETERS + i, PARAMETERS + j) / unit } else { 0.0 }
    })
}

/// P⁻¹, rounded. Zero if P is singular beyond rounding: nothing is tested from there on.
fn weights(covariance: &Square) -> Half {
    let mut weights = Half::default();
    let mut regular = *covariance;
    for i in 0..PARAMETER_COUNT {
        if regular[(i, i)] == 0.0 {
            regular[(i, i)] = 1.0;
        }
    }
    if let Some(found) = regular.cholesky() {
        let inverse = found.inverse();
        let half = (0..PARAMETER_COUNT).flat_map(|i| (0..=i).map(move |j| (i, j)));
        for (weight, at) in weights.as_flattened_mut().iter_mut().zip(half) {
            *weight = inverse[at] as f32;
        }
    }
    weights
}

/// A row of a symmetric matrix.
fn row(half: &Half, i: usize) -> All {
    let at = |i: usize, j: usize| half.as_flattened()[i * (i + 1) / 2 + j];
    core::array::from_fn(|j| f64::from(at(i.max(j), i.min(j))))
}

/// wᵀ P w.
fn square(covariance: &Square, w: &All) -> f64 {
    let columns = covariance.column_iter().zip(w);
    columns.map(|(column, own)| own * dot(column.as_slice(), w)).sum()
}

/// Scalar product in two partial sums: a fixed order that the compiler can vectorize.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 2];
    for (a, b) in a.chunks_exact(2).zip(b.chunks_exact(2)) {
        for lane in 0..2 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums[0] + sums[1]
}

impl Mark {
    const NONE: Self = Self {
        time_s: 0.0,
        parameters: [0.0; PARAMETER_COUNT],
        variances: [0.0; PARAMETER_COUNT],
        weights: [[0.0; PARAMETER_COUNT + 1]; PARAMETER_COUNT / 2],
        spread: [0.0; PARAMETER_COUNT],
    };
}

impl DriftTest {
    /// Makes a test that starts with the prior.
    #[must_use]
    pub fn new(limit_sigmas: f64, weights: DriftWeights, prior: &Covariance) -> Self {
        Self {
            limit_sigmas,
            weights,
            prior: core::array::from_fn(|i| prior.sigma(PARAMETERS + i)),
            marks: [Mark::NONE; MARKS],
            len: 0,
            spacing_s: SPACING_S,
            next_s: SPACING_S,
            largest: Largest::default(),
        }
    }

    /// Takes the estimate after a measurement; acts only when a mark is due.
    #[inline]
    pub fn watch(&mut self, time_s: f64, parameters: &Parameters, covariance: &Covariance) {
        if time_s >= self.next_s {
            self.mark(time_s, parameters, covariance);
        }
    }

    #[cold]
    #[inline(never)]
    fn mark(&mut self, time_s: f64, parameters: &Parameters, covariance: &Covariance) {
        let parameters = parameters.to_array();
        let now = in_units(covariance, &self.prior);
        self.compare(time_s, &parameters, &now);
        if self.len == MARKS {
            for i in 0..MARKS / 2 {
                self.marks[i] = self.marks[2 * i + 1];
            }
            self.len = MARKS / 2;
            self.spacing_s *= 2.0;
        }
        let mark = &mut self.marks[self.len];
        (mark.time_s, mark.parameters) = (time_s, parameters);
        mark.variances = core::array::from_fn(|i| now[(i, i)]);
        if self.weights == DriftWeights::Likelihood {
            mark.weights = weights(&now);
            mark.spread = core::array::from_fn(|i| square(&now, &row(&mark.weights, i)));
        }
        self.len += 1;
        self.next_s = time_s + self.spacing_s;
    }

    /// Tests the corrections since each mark.
    fn compare(&mut self, time_s: f64, parameters: &All, now: &Square) {
        for mark in &self.marks[..self.len] {
            let corrections: All = core::array::from_fn(|i| {
                let correction = parameters[i] - mark.parameters[i];
                if self.prior[i] > 0.0 { correction / self.prior[i] } else { 0.0 }
            });
            for i in 0..PARAMETER_COUNT {
                let variance = now[(i, i)];
                if !is_tested(mark.variances[i], variance) {
                    continue;
                }
                let (correction, expected) = match self.weights {
                    DriftWeights::Own => (corrections[i], mark.variances[i] - variance),
                    DriftWeights::Likelihood => {
                        let w = row(&mark.weights, i);
                        (dot(&w, &corrections), mark.spread[i] - square(now, &w))
                    }
                };
                let sigmas = correction.abs() / libm::sqrt(expected);
                // Rounding can make the expectation of a small one negative, and NaN is no drift.
                if sigmas > self.largest.sigmas && expected > 0.0 {
                    let between_s = (mark.time_s, time_s);
                    self.largest = Largest { sigmas, parameter: i, between_s };
                }
            }
        }
    }

    /// Drops the marks after a time to which the estimate was set back: later corrections are
    /// undone, and the estimate has to be compared with older marks.
    pub fn go_back(&mut self, time_s: f64) {
        while self.len > 0 && self.marks[self.len - 1].time_s > time_s {
            self.len -= 1;
        }
    }

    /// Compares the estimate at the end of the calibration.
    pub fn finish(&mut self, time_s: f64, parameters: &Parameters, covariance: &Covariance) {
        self.compare(time_s, &parameters.to_array(), &in_units(covariance, &self.prior));
    }

    /// The weights.
    #[must_use]
    pub fn weights(&self) -> DriftWeights {
        self.weights
    }

    /// Times of the marks that are kept, s of filter time.
    pub fn marks_s(&self) -> impl Iterator<Item = f64> + '_ {
        self.marks[..self.len].iter().map(|mark| mark.time_s)
    }

    /// Changes the limit. The corrections so far are held against it too.
    pub(crate) fn tune(&mut self, limit_sigmas: f64) {
        self.limit_sigmas = limit_sigmas;
    }

    /// The largest correction so far.
    #[must_use]
    pub fn largest(&self) -> &Largest {
        &self.largest
    }

    /// Returns whether the largest correction is above the limit.
    #[must_use]
    #[inline]
    pub fn is_found(&self) -> bool {
        self.largest.sigmas > self.limit_sigmas
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::covariance::{STATE_COUNT, Transition};

    /// Estimates a scalar parameter from white measurements of σ 1 every 10 s, alone in the filter.
    /// `z` are the measurement errors; the parameter steps by `step` at the middle.
    fn estimate(z: impl Fn(u64) -> f64, step: f64) -> DriftTest {
        let mut sigmas = [1e-3; STATE_COUNT];
        sigmas[PARAMETERS + 4] = 10.0;
        let mut covariance = Covariance::from_sigmas(&sigmas);
        let mut drift = DriftTest::new(LIMIT_SIGMAS, DriftWeights::Likelihood, &covariance);
        let mut all = [0.0; PARAMETER_COUNT];
        for k in 1..=1440u64 {
            let truth = if k > 720 { 2.0 + step } else { 2.0 };
            let mut x = [0.0; STATE_COUNT];
            let innovation = truth + z(k) - all[4];
            covariance.update(PARAMETERS + 4, 1.0, innovation, &mut x);
            all[4] += x[PARAMETERS + 4];
            drift.watch(10.0 * k as f64, &Parameters::from_array(&all), &covariance);
        }
        drift
    }

    /// Normal variables from integer mixing, without Philox: sums of twelve uniform ones.
    fn normal(seed: u64) -> impl Fn(u64) -> f64 {
        move |k| {
            let mut state = (seed << 32) ^ (k << 4) ^ 0x9E37_79B9_7F4A_7C15;
            (0..12)
                .map(|_| {
                    state ^= state >> 30;
                    state = state.wrapping_mul(0xBF58_476D_1CE4_E5B9);
                    state ^= state >> 27;
                    state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
                    (state >> 11) as f64 / (1u64 << 53) as f64
                })
                .sum::<f64>()
                - 6.0
        }
    }

    #[test]
    fn white_measurements_show_no_drift_and_a_step_does() {
        let mut largest: f64 = 0.0;
        for seed in 0..50 {
            let drift = estimate(normal(seed), 0.0);
            assert!(!drift.is_found(), "seed {seed}: {:?}", drift.largest());
            largest = largest.max(drift.largest().sigmas);
            // A step by a measurement's σ is 38 σ of the 720 measurements before it.
            let drift = estimate(normal(seed), 1.0);
            assert!(drift.is_found());
            assert_eq!(drift.largest().parameter, 4);
        }
        // Some hundred dependent pairs in fifty runs: the largest can't be small either.
        assert!((2.5..5.5).contains(&largest), "{largest}");
    }

    /// Sum and difference of two parameters are measured, each before and after the mark. If one parameter jumps there,
    /// both change alike, and the best test adds their changes by the inverse of their variances.
    #[test]
    fn a_jump_is_tested_with_all_that_it_shows_in() {
        const NUMBERS: [(u32, f64); 4] = [(400, 1.0), (20, -1.0), (100, 1.0), (50, -1.0)];
        let (first, second) = (PARAMETERS + 4, PARAMETERS + 5);
        let mut sigmas = [1e-3; STATE_COUNT];
        (sigmas[first], sigmas[second]) = (1e4, 1e4);
        let mut covariance = Covariance::from_sigmas(&sigmas);
        let mut drift = DriftTest::new(LIMIT_SIGMAS, DriftWeights::Likelihood, &covariance);
        let mut all = [0.0; PARAMETER_COUNT];
        let mut means = [0.0; 4];
        let noise = normal(7);
        let mut k = 0;
        for (part, (number, sign)) in NUMBERS.iter().enumerate() {
            let mut transition = Transition::identity();
            transition.rows[0][0] = 0.0;
            (transition.rows[0][first], transition.rows[0][second]) = (1.0, *sign);
            for _ in 0..*number {
                k += 1;
                let measured = 2.0 + sign * 3.0 + noise(k) + if part < 2 { 0.0 } else { 1.5 };
                means[part] += measured / f64::from(*number);
                covariance.propagate(&transition);
                let mut x = [0.0; STATE_COUNT];
                let innovation = measured - (all[4] + sign * all[5]);
                covariance.update(0, 1.0, innovation, &mut x);
                (all[4], all[5]) = (all[4] + x[first], all[5] + x[second]);
            }
            if part == 1 {
                drift.watch(SPACING_S, &Parameters::from_array(&all), &covariance);
            }
        }
        drift.finish(2.0 * SPACING_S, &Parameters::from_array(&all), &covariance);
        let change = |before: usize, after: usize| {
            let variance = 1.0 / f64::from(NUMBERS[before].0) + 1.0 / f64::from(NUMBERS[after].0);
            (means[after] - means[before], variance)
        };
        let ((sum, of_sum), (difference, of_difference)) = (change(0, 2), change(1, 3));
        let best = (sum / of_sum + difference / of_difference)
            / (1.0 / of_sum + 1.0 / of_difference).sqrt();
        let found = drift.largest();
        assert!((found.sigmas / best - 1.0).abs() < 1e-5, "{found:?}, expected {best}");
        assert_eq!((found.parameter, found.between_s), (4, (SPACING_S, 2.0 * SPACING_S)));
        // The first parameter's own correction and its σ know it by the twenty differences alone.
        let own = 0.5 * (sum * 100.0 / 500.0 + difference * 50.0 / 70.0);
        let spread = |before: f64, after: f64| 0.25 * (1.0 / before - 1.0 / (before + after));
        let alone = own / (spread(400.0, 100.0) + spread(20.0, 50.0)).sqrt();
        assert!(found.sigmas > 1.5 * alone, "{found:?}, alone {alone}");
    }

    #[test]
    fn what_was_undone_is_not_held_against_what_follows() {
        let mut drift = estimate(normal(1), 0.0);
        let before = drift.len;
        drift.go_back(0.5 * 14_400.0);
        assert!(drift.len > 0 && drift.len < before);
        assert!(drift.marks[drift.len - 1].time_s <= 7200.0);
    }
}
