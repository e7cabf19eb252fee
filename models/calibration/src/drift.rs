//! Drift test: are the parameters constant while they are estimated?
//!
//! The parameters are constants. Then the correction that a Kalman filter makes to one of them
//! between two instants, p(t₂) − p(t₁), is a sum of weighted innovations, independent of p(t₁),
//! with the variance P(t₁) − P(t₂) by which its uncertainty shrank (the estimate is a martingale;
//! Bar-Shalom, Li and Kirubarajan, 2001, 5.4, state the whiteness of innovations from which this
//! follows). Divided by the root of that variance, the correction is normal with variance one. A
//! sensor whose error changes in between makes it many times larger, while every single innovation
//! remains consistent: the mean square of innovations (NIS) doesn't show the change.
//!
//! The test covers all pairs of up to sixteen marks over the calibration. If less than 1 % of a
//! variance was gained, the parameter could have moved undetected by no more than 0.6 of its σ, and
//! isn't tested. Nor is a parameter tested while it is known hardly better than its prior: a prior
//! that is too narrow is no drift.
//! narrow is no drift.

use crate::covariance::{Covariance, PARAMETERS};
use octant_sample::Parameters;
use octant_sample::parameters::PARAMETER_COUNT;

/// Corrections above this many standard deviations are a drift. A normal variable exceeds them with
/// 2e-9; with thirty parameters and some hundreds of pairs of marks 2e-5 in a calibration. The
/// largest of twenty clean calibrations of 4 h is 4.6.
pub const LIMIT_SIGMAS: f64 = 6.0;
/// The same on a ship, whose sway the filter assumes to be white noise, which it isn't: tails are
/// longer. The largest of twenty clean calibrations of 4 h is 5.0.
pub const LIMIT_MOVING_SIGMAS: f64 = 8.0;

/// Number of marks kept; when they are full, every other one is dropped.
const MARKS: usize = 16;
/// Initial time between marks, s; doubled whenever they are thinned out. Short calibrations have
/// dwells of about a minute, and a drift shows over some of them.
const SPACING_S: f64 = 300.0;
/// Smallest share of the variance to be gained between two marks.
const GAIN_MIN: f64 = 0.01;
/// Share of the prior variance below which a parameter is tested.
const KNOWN: f64 = 0.25;

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
struct Mark {
    time_s: f64,
    parameters: [f64; PARAMETER_COUNT],
    variances: [f64; PARAMETER_COUNT],
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
    prior: [f64; PARAMETER_COUNT],
    marks: [Mark; MARKS],
    len: usize,
    spacing_s: f64,
    next_s: f64,
    largest: Largest,
}

#[cfg(feature = "state")]
impl octant_state::State for DriftTest {
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { limit_sigmas: _, prior: _, marks, len, spacing_s, next_s, largest } = self;
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

fn variances(covariance: &Covariance) -> [f64; PARAMETER_COUNT] {
    core::array::from_fn(|i| covariance.at(PARAMETERS + i, PARAMETERS + i))
}

impl DriftTest {
    /// Makes a test that starts with the prior.
    #[must_use]
    pub fn new(limit_sigmas: f64, prior: &Covariance) -> Self {
        let none = [0.0; PARAMETER_COUNT];
        Self {
            limit_sigmas,
            prior: variances(prior),
            marks: [Mark { time_s: 0.0, parameters: none, variances: none }; MARKS],
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
    fn mark(&mut self, time_s: f64, parameters: &Parameters, covariance: &Covariance) {
        let (parameters, variances) = (parameters.to_array(), variances(covariance));
        for mark in &self.marks[..self.len] {
            for i in 0..PARAMETER_COUNT {
                let gained = mark.variances[i] - variances[i];
                let known = mark.variances[i] <= KNOWN * self.prior[i];
                if !known || gained < GAIN_MIN * variances[i] || gained <= 0.0 {
                    continue;
                }
                let sigmas = (parameters[i] - mark.parameters[i]).abs() / libm::sqrt(gained);
                if sigmas > self.largest.sigmas {
                    let between_s = (mark.time_s, time_s);
                    self.largest = Largest { sigmas, parameter: i, between_s };
                }
            }
        }
        if self.len == MARKS {
            for i in 0..MARKS / 2 {
                self.marks[i] = self.marks[2 * i + 1];
            }
            self.len = MARKS / 2;
            self.spacing_s *= 2.0;
        }
        self.marks[self.len] = Mark { time_s, parameters, variances };
        self.len += 1;
        self.next_s = time_s + self.spacing_s;
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
        self.mark(time_s, parameters, covariance);
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
    use crate::covariance::STATE_COUNT;

    /// Estimates a scalar parameter from white measurements of σ 1 every 10 s, alone in the filter.
    /// `z` are the measurement errors; the parameter steps by `step` at the middle.
    fn estimate(z: impl Fn(u64) -> f64, step: f64) -> DriftTest {
        let mut sigmas = [1e-3; STATE_COUNT];
        sigmas[PARAMETERS + 4] = 10.0;
        let mut covariance = Covariance::from_sigmas(&sigmas);
        let mut drift = DriftTest::new(LIMIT_SIGMAS, &covariance);
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

    #[test]
    fn what_was_undone_is_not_held_against_what_follows() {
        let mut drift = estimate(normal(1), 0.0);
        let before = drift.len;
        drift.go_back(0.5 * 14_400.0);
        assert!(drift.len > 0 && drift.len < before);
        assert!(drift.marks[drift.len - 1].time_s <= 7200.0);
    }
}
