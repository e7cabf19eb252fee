//! Covariance of a calibration, stop by stop: a candidate is judged in about a millisecond.
//!
//! Each dwell is one exact step (`dwell`). A move is carried in parts of a few seconds with
//! its own attitudes, so that scale factors and misalignments act as they do in a run. What is simplified
//! is the time of the measurements: they count from the arrival at a stop, not from the start, and those in
//! a part of a move stand at its end, with the variance of their mean.

use super::dwell::Dwells;
use super::platform::{CALIBRATING_S, InputRows, KNOWN_AT_START, Platform, hold_vertical};
use octant_calibration::config::ErrorModel;
use octant_calibration::covariance::{Covariance, STATE_COUNT, Transition};
use octant_calibration::schedule::{DoesNotFit, dwell_s, move_between_s};
use octant_calibration::sequence::{Sequence, Stop};
use std::collections::HashMap;
use std::sync::Arc;

/// Longest part of a move between two measurements in a search, s. Of the misalignments, which show while
/// turning, some σ are up to 6 % too large by it; measures of navigation change by less than a part in
/// thousand.
pub const PART_S: f64 = 5.0;
/// Moves that are kept, some 10 kB each.
const MOVES_MAX: usize = 8000;
/// Steps in which the angles of a move are counted, rad: the same move elsewhere has the same number.
const ANGLE_STEP_RAD: f64 = 1e-9;
/// Shortest time that counts, s.
const TIME_MIN_S: f64 = 1e-6;

/// Measurement of the filter, on three axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AidingReference {
    /// First of the three states that are measured: those of the velocity or of the position.
    pub first: usize,
    /// Standard deviation on each axis, m/s or m.
    pub sigma: f64,
}

/// Conditions of a calibration, the same for all candidates.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Base, gimbals and noise.
    pub platform: Platform,
    /// Covariance of all errors at the start of the filter.
    pub initial: Covariance,
    /// Start of the filter, s: the time of the alignment before it, at the first stop.
    pub start_s: f64,
    /// Measurement.
    pub reference: AidingReference,
    /// Time between two measurements, s.
    pub period_s: f64,
    /// Longest part of a move between two measurements, s: [`PART_S`], or a period to be exact.
    pub part_s: f64,
}

/// A move: the angles at its start, within a turn, and the angles that it turns by, in steps.
type MoveKey = [i64; 4];
/// Transitions over the parts of a move, and the length of a part, s.
type Move = Arc<(Vec<Transition>, f64)>;

/// Judge of candidates: conditions, and all that was computed once.
#[derive(Debug)]
pub struct Evaluator {
    conditions: Conditions,
    dwells: Dwells,
    inputs: HashMap<[u64; 2], Arc<InputRows>>,
    moves: HashMap<MoveKey, Move>,
    /// Moves into navigation, with the vertical channel held.
    last_moves: HashMap<MoveKey, Move>,
}

impl Evaluator {
    /// Creates a judge under these conditions.
    #[must_use]
    pub fn new(conditions: Conditions) -> Self {
        let AidingReference { first, sigma } = conditions.reference;
        let dwells = Dwells::new(&conditions.platform, conditions.period_s, (first, sigma * sigma));
        let (inputs, moves, last_moves) = Default::default();
        Self { conditions, dwells, inputs, moves, last_moves }
    }

    /// The conditions.
    #[must_use]
    pub fn conditions(&self) -> &Conditions {
        &self.conditions
    }

    /// Returns the covariance of all errors at the end of a calibration of `duration_s`.
    ///
    /// # Errors
    /// If the moves leave no time for the dwells.
    pub fn calibrate(
        &mut self,
        sequence: &Sequence,
        duration_s: f64,
    ) -> Result<Covariance, DoesNotFit> {
        self.calibrate_with(sequence, duration_s, |_, _, _| {})
    }

    /// The same, calling `after` with each stop's number, the time, and the covariance at the end of its
    /// dwell.
    ///
    /// # Errors
    /// If the moves leave no time for the dwells.
    pub fn calibrate_with(
        &mut self,
        sequence: &Sequence,
        duration_s: f64,
        mut after: impl FnMut(usize, f64, &Covariance),
    ) -> Result<Covariance, DoesNotFit> {
        let rates = self.conditions.platform.rates;
        let unit_s = dwell_s(sequence, duration_s, &rates)?;
        let mut covariance = self.conditions.initial.clone();
        let mut at = Stop::default();
        // Time that the alignment has used already.
        let mut used_s = self.conditions.start_s;
        let mut t = 0.0;
        let stops = sequence.stops();
        for number in 0..stops.len() * sequence.passes() as usize {
            let to = stops[number % stops.len()];
            if move_between_s(&at, &to, &rates) > TIME_MIN_S {
                self.turn(&mut covariance, &at, &to);
                t += move_between_s(&at, &to, &rates);
            }
            at = to;
            let length_s = unit_s * to.weight;
            self.stand(&mut covariance, &to, (length_s - used_s).max(0.0));
            used_s = (used_s - length_s).max(0.0);
            t += length_s;
            after(number, t, &covariance);
        }
        Ok(covariance)
    }

    /// Starts navigation: the position is known, the vertical channel held, and the gimbals turn from
    /// `from` to the first stop of the rotation.
    pub fn start_navigation(&mut self, covariance: &mut Covariance, from: &Stop, to: &Stop) {
        KNOWN_AT_START.iter().for_each(|state| covariance.reopen(*state, 0.0));
        if move_between_s(from, to, &self.conditions.platform.rates) < TIME_MIN_S {
            return;
        }
        let platform = &self.conditions.platform;
        let made = kept(&mut self.last_moves, from, to, |from, to| {
            let (mut parts, h) = platform.moving(from, to, self.conditions.part_s, ErrorModel::Phi);
            parts.iter_mut().for_each(hold_vertical);
            (parts, h)
        });
        for part in &made.0 {
            platform.carry(covariance, part, made.1);
            hold_in(covariance);
        }
    }

    /// Carries the covariance through a move.
    pub(crate) fn turn(&mut self, covariance: &mut Covariance, from: &Stop, to: &Stop) {
        let platform = &self.conditions.platform;
        let made = kept(&mut self.moves, from, to, |from, to| {
            platform.moving(from, to, self.conditions.part_s, platform.error_model)
        });
        for part in &made.0 {
            platform.carry(covariance, part, made.1);
            self.measure(covariance, made.1);
        }
    }

    /// Carries the covariance through a dwell.
    pub(crate) fn stand(&mut self, covariance: &mut Covariance, at: &Stop, length_s: f64) {
        let period_s = self.conditions.period_s;
        let periods = libm::floor(length_s / period_s + TIME_MIN_S);
        if periods >= 1.0 {
            let inputs = self.inputs_at(at);
            self.dwells.of(periods as u32).apply(covariance, &inputs);
        }
        let rest_s = length_s - periods * period_s;
        if rest_s > TIME_MIN_S {
            let platform = &self.conditions.platform;
            let over = platform.standing(at, rest_s, CALIBRATING_S, platform.error_model);
            platform.carry(covariance, &over, rest_s);
            self.measure(covariance, rest_s);
        }
    }

    /// Takes in the measurements of a part: one with the variance of their mean.
    fn measure(&self, covariance: &mut Covariance, length_s: f64) {
        let AidingReference { first, sigma } = self.conditions.reference;
        let variance = sigma * sigma * self.conditions.period_s / length_s;
        for axis in 0..3 {
            covariance.update(first + axis, variance, 0.0, &mut [0.0; STATE_COUNT]);
        }
    }

    fn inputs_at(&mut self, at: &Stop) -> Arc<InputRows> {
        let key = [at.azimuth_rad.to_bits(), at.roll_rad.to_bits()];
        let platform = &self.conditions.platform;
        Arc::clone(self.inputs.entry(key).or_insert_with(|| Arc::new(platform.inputs(at))))
    }
}

/// Forgets the errors of height and vertical velocity.
fn hold_in(covariance: &mut Covariance) {
    KNOWN_AT_START[2..].iter().for_each(|state| covariance.reopen(*state, 0.0));
}

/// Finds a move, or makes it.
///
/// Whole turns before a move make no difference, so it is made from angles within one. They follow from its
/// number alone: a move is the same, bit for bit, whichever stops ask for it first.
fn kept(
    moves: &mut HashMap<MoveKey, Move>,
    from: &Stop,
    to: &Stop,
    make: impl FnOnce(&Stop, &Stop) -> (Vec<Transition>, f64),
) -> Move {
    let steps = |angle_rad: f64| libm::round(angle_rad / ANGLE_STEP_RAD) as i64;
    let turn = 2.0 * core::f64::consts::PI;
    let within = |angle_rad: f64| steps(angle_rad - turn * libm::floor(angle_rad / turn));
    let key = [
        within(from.azimuth_rad),
        within(from.roll_rad),
        steps(to.azimuth_rad - from.azimuth_rad),
        steps(to.roll_rad - from.roll_rad),
    ];
    if let Some(made) = moves.get(&key) {
        return Arc::clone(made);
    }
    if moves.len() >= MOVES_MAX {
        moves.clear();
    }
    let [azimuth_rad, roll_rad, by_azimuth_rad, by_roll_rad] =
        key.map(|steps| steps as f64 * ANGLE_STEP_RAD);
    let from = Stop { azimuth_rad, roll_rad, weight: 1.0 };
    let to = Stop {
        azimuth_rad: azimuth_rad + by_azimuth_rad,
        roll_rad: roll_rad + by_roll_rad,
        weight: 1.0,
    };
    let made = Arc::new(make(&from, &to));
    moves.insert(key, Arc::clone(&made));
    made
}
