//! Continuous rotation: gimbals that turn back and forth within their ranges without a rest.
//!
//! It isn't searched for. A few schemes at a few rates are evaluated, to hold dwells against: the bound
//! holds for both, and a design with dwells comes as close to it. All but the lead-in is motion, so the
//! evaluation is that of a move, with measurements at the ends of its parts.

use crate::evaluate::{Conditions, Evaluator};
use crate::judge::{Judge, MeasureWeights};
use crate::platform::{NAVIGATING_S, Platform};
use crate::search::SearchProblem;
use crate::setup::{DesignError, Setup};
use octant_calibration::config::{NavigationPlan, TurntableRates};
use octant_calibration::covariance::Covariance;
use octant_calibration::schedule::move_between_s;
use octant_calibration::sequence::{Sequence, Stop};
use octant_earth::units::DEG;
use serde::Serialize;

/// Rates of the schemes, as parts of the turntable's.
const RATE_PARTS: [f64; 3] = [1.0, 0.1, 0.03];
/// Shortest move, s.
const TIME_MIN_S: f64 = 1e-6;
/// Rest at each end of a swing in navigation, s.
const REST_S: f64 = 1.0;
/// Steps of the roll gimbal between two swings of azimuth, deg.
const ROLL_STEPS_DEG: [i32; 2] = [45, 90];

/// Continuous rotation under the conditions of a design.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ContinuousRotation {
    /// Calibrations that turn continuously after the level alignment, with the design's rotation in
    /// navigation, the best first.
    pub calibration: Vec<ContinuousScore>,
    /// Rotations in navigation that turn continuously, after the designed calibration, the best first; empty
    /// for a measure that isn't of navigation, and for largest errors.
    pub navigation: Vec<ContinuousScore>,
}

/// A continuous scheme and its measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ContinuousScore {
    /// The scheme, in words.
    pub scheme: String,
    /// Rate of the gimbals, deg/s.
    pub rate_deg_per_s: f64,
    /// Measure.
    pub score: f64,
}

/// A path of the gimbals: the angles between which they turn.
struct Scheme {
    words: String,
    points: Vec<Stop>,
}

impl SearchProblem {
    /// Evaluates continuous rotation, in calibrations and in navigation after a calibration by `sequence`.
    ///
    /// # Errors
    /// If the sequence doesn't fit.
    pub fn continuous(&self, sequence: &Sequence) -> Result<ContinuousRotation, DesignError> {
        let schemes = self.schemes();
        let rates = self.setup.conditions.platform.rates;
        let (mut calibration, mut navigation) = (Vec::new(), Vec::new());
        let of_navigation = self.measure.is_quadratic_of_navigation();
        for part in RATE_PARTS {
            let rates = TurntableRates { rate_radps: part * rates.rate_radps, ..rates };
            let platform = Platform {
                rates,
                turning_s: NAVIGATING_S,
                ..self.setup.conditions.platform.clone()
            };
            let score = |scheme: &Scheme, score: f64| ContinuousScore {
                scheme: scheme.words.clone(),
                rate_deg_per_s: rates.rate_radps / DEG,
                score,
            };
            for scheme in &schemes {
                if let Some(found) = self.calibrated(&platform, scheme) {
                    calibration.push(score(scheme, found));
                }
                if of_navigation {
                    let found = self.navigated(&platform, scheme, sequence)?;
                    navigation.push(score(scheme, found));
                }
            }
        }
        for all in [&mut calibration, &mut navigation] {
            all.sort_by(|a: &ContinuousScore, b| a.score.total_cmp(&b.score));
        }
        Ok(ContinuousRotation { calibration, navigation })
    }

    /// Makes the paths that the gimbals can turn on.
    fn schemes(&self) -> Vec<Scheme> {
        let [azimuth, roll] = self.limits.free();
        let point = |azimuth_deg: i32, roll_deg: i32| Stop {
            azimuth_rad: f64::from(azimuth_deg) * DEG,
            roll_rad: f64::from(roll_deg) * DEG,
            weight: 1.0,
        };
        let scheme = |words: String, points| Scheme { words, points };
        let turns = |(low, high): (i32, i32)| low < high;
        let mut all = Vec::new();
        if turns(azimuth) {
            let points = vec![point(azimuth.1, 0), point(azimuth.0, 0)];
            all.push(scheme("azimuth".to_owned(), points));
        }
        if turns(roll) {
            let points = vec![point(0, roll.1), point(0, roll.0)];
            all.push(scheme("roll".to_owned(), points));
        }
        if turns(azimuth) && turns(roll) {
            let points = vec![point(azimuth.1, roll.1), point(azimuth.0, roll.0)];
            all.push(scheme("both gimbals at once".to_owned(), points));
            for step in ROLL_STEPS_DEG {
                let up: Vec<i32> = (0..=roll.1 / step).map(|k| k * step).collect();
                let down = up.iter().rev().skip(1);
                let ends = [azimuth.1, azimuth.0].into_iter().cycle();
                let points = ends.zip(up.iter().chain(down)).map(|(a, r)| point(a, *r)).collect();
                all.push(scheme(format!("azimuth, roll by {step} deg after each swing"), points));
            }
        }
        all
    }

    /// Returns the measure of a calibration that turns; `None` if no swing fits.
    fn calibrated(&self, platform: &Platform, scheme: &Scheme) -> Option<f64> {
        let conditions = Conditions { platform: platform.clone(), ..self.setup.conditions.clone() };
        let mut evaluator = Evaluator::new(conditions);
        let swings = Swings { lead_in_s: self.limits.lead_in_s, points: &scheme.points };
        let (covariance, at) = swings.calibrate(&mut evaluator, self.duration_s)?;
        // Navigation begins at the turntable's own rate.
        Some(self.judge().score_of(covariance, &at))
    }

    /// Returns the measure of a navigation that turns.
    fn navigated(
        &self,
        platform: &Platform,
        scheme: &Scheme,
        sequence: &Sequence,
    ) -> Result<f64, DesignError> {
        let covariance = self.judge().evaluator.calibrate(sequence, self.duration_s)?;
        let rotation = Sequence::new(&scheme.points, 1)
            .map_err(|error| DesignError::Limits(error.to_string()))?;
        let conditions = Conditions { platform: platform.clone(), ..self.setup.conditions.clone() };
        let navigation =
            NavigationPlan { rotation, dwell_s: REST_S, ..self.setup.navigation.clone() };
        let setup = Setup { conditions, navigation, ..self.setup.clone() };
        let weights = MeasureWeights::new(&setup, self.measure)?;
        let stops = sequence.stops();
        Ok(Judge::new(&setup, &weights).score_of(covariance, &stops[stops.len() - 1]))
    }
}

/// Swings after a rest.
struct Swings<'a> {
    lead_in_s: f64,
    points: &'a [Stop],
}

impl Swings<'_> {
    /// Returns the covariance at the end, and where the gimbals are; `None` if no swing fits.
    fn calibrate(&self, evaluator: &mut Evaluator, duration_s: f64) -> Option<(Covariance, Stop)> {
        let rates = evaluator.conditions().platform.rates;
        let mut covariance = evaluator.conditions().initial.clone();
        let mut at = Stop::default();
        let start_s = evaluator.conditions().start_s;
        let lead_in_s = self.lead_in_s.max(start_s);
        evaluator.stand(&mut covariance, &at, lead_in_s - start_s);
        let (mut t, mut swings) = (lead_in_s, 0);
        for to in self.points.iter().cycle() {
            let length_s = move_between_s(&at, to, &rates);
            if t + length_s > duration_s {
                break;
            }
            // The way back ends where the next one starts.
            if length_s < TIME_MIN_S {
                continue;
            }
            evaluator.turn(&mut covariance, &at, to);
            (t, at, swings) = (t + length_s, *to, swings + 1);
        }
        evaluator.stand(&mut covariance, &at, duration_s - t);
        (swings > 0).then_some((covariance, at))
    }
}
