//! Largest errors over every answer of a navigation, between two answers that are scored in full.
//!
//! Regressions and integrals are of one answer a second; a maximum is over all of them. An answer
//! costs some comparisons here: errors are compared in the units of the answer, and are turned into
//! those of a score once, at the end. Angles close to one that was computed in full are linear in the
//! quaternion; the largest of them is computed in full when it is needed.
//!
//! A truth that moves costs more than a sample. There an answer is compared if it strays
//! from the one before, and so is every answer after it until the second scored one.

use super::attitude::CaseReference;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};

/// Solution of an answer, as far as it is scored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnsweredSolution {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Longitude, rad.
    pub longitude_rad: f64,
    /// Velocity over ground, north and east, m/s; NaN where the unit doesn't tell it.
    pub velocity_mps: [f64; 2],
    /// Attitude `q_nb` (w, x, y, z); NaN where the unit doesn't tell it.
    pub q_nb: [f64; 4],
}

/// Truth with which answers are compared, for as long as it stands.
#[derive(Clone, Copy, Debug)]
pub struct StandingTruth {
    latitude_rad: f64,
    longitude_rad: f64,
    velocity_mps: [f64; 2],
    /// Metres north per radian of latitude, and east per radian of longitude in two factors.
    per_latitude_m: f64,
    transverse_m: f64,
    cos_latitude: f64,
    case: CaseReference,
}

impl StandingTruth {
    /// Makes the truth at a time: the solution that is right, the height (m), and the true gimbal
    /// angles (azimuth, roll), rad. NaN: not known.
    #[must_use]
    pub fn new(right: &AnsweredSolution, height_m: f64, gimbal_rad: [f64; 2]) -> Self {
        let earth = Ellipsoid::at(right.latitude_rad, height_m);
        Self {
            latitude_rad: right.latitude_rad,
            longitude_rad: right.longitude_rad,
            velocity_mps: right.velocity_mps,
            per_latitude_m: earth.meridian_radius_m,
            transverse_m: earth.transverse_radius_m,
            cos_latitude: earth.cos_latitude,
            case: CaseReference::new(right.q_nb, gimbal_rad),
        }
    }
}

impl StandingTruth {
    /// Returns whether another truth is the same, NaN included.
    fn is(&self, other: &Self) -> bool {
        let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
        same(self.latitude_rad, other.latitude_rad)
            && same(self.longitude_rad, other.longitude_rad)
            && self.velocity_mps.iter().zip(&other.velocity_mps).all(|(a, b)| same(*a, *b))
            && same(self.per_latitude_m, other.per_latitude_m)
            && self.case.is(&other.case)
    }
}

/// Largest magnitudes in the units of the scores.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LargestErrors {
    /// Latitude, longitude, heading, pitch, roll: arcmin; north, east: m/s.
    pub(super) each: [f64; 7],
    pub(super) radial_nmi: f64,
}

/// Largest errors so far of the answers between those that are scored in full.
#[derive(Clone, Debug, Default)]
pub(super) struct EveryAnswer {
    truth: Option<StandingTruth>,
    /// Latitude, longitude, rad; north, east, m/s.
    far: [f64; 4],
    radial_m2: f64,
    attitude: LargestAttitude,
    /// Last answer at a truth that moves.
    before: Option<AnsweredSolution>,
    /// Number of scored answers until those between that don't stray aren't compared.
    stray: u8,
}

/// Largest attitude errors.
#[derive(Clone, Debug)]
struct LargestAttitude {
    /// Attitude that was last compared in full, and the square of the distance from it up to which
    /// no error can become the largest.
    near: [f64; 4],
    slack: f64,
    /// Errors in heading, pitch and roll there, rad, and their slopes along the quaternion.
    errors_rad: [f64; 3],
    slopes: [[f64; 4]; 3],
    /// Largest magnitudes, rad.
    largest_rad: [f64; 3],
    /// Attitudes whose errors are the largest by their slopes, and aren't computed in full yet.
    pending: [Option<[f64; 4]>; 3],
}

impl Default for LargestAttitude {
    fn default() -> Self {
        Self {
            near: [0.0; 4],
            slack: -1.0,
            errors_rad: [0.0; 3],
            slopes: [[0.0; 4]; 3],
            largest_rad: [0.0; 3],
            pending: [None; 3],
        }
    }
}

/// Changes from one answer to the next that need no look at a truth that moves: rad, m/s, and the
/// square of a turn by 2 mrad on the quaternion.
const NEAR_RAD: f64 = 1e-7;
const NEAR_MPS: f64 = 0.05;
const NEAR_TURN: f64 = 1e-6;

impl EveryAnswer {
    /// Takes another truth; `None`: it isn't known.
    pub(super) fn stand(&mut self, truth: Option<StandingTruth>) {
        let same = match (&self.truth, &truth) {
            (Some(own), Some(other)) => own.is(other),
            (None, None) => true,
            _ => false,
        };
        if !same {
            self.settle();
            self.truth = truth;
            self.attitude.slack = -1.0;
        }
    }

    /// Returns whether answers are compared with this truth. Numbers that aren't known are equal.
    pub(super) fn stands_at(&self, truth: &StandingTruth) -> bool {
        self.truth.as_ref().is_some_and(|own| own.is(truth))
    }

    /// Takes note of an answer that is scored in full.
    pub(super) fn scored(&mut self) {
        self.stray = self.stray.saturating_sub(1);
    }

    /// Returns whether an answer at a truth that moves is to be compared with it.
    #[inline(always)]
    pub(super) fn strays(&mut self, answer: &AnsweredSolution) -> bool {
        let near = self.before.is_some_and(|before| {
            let square = |i: usize| {
                let step = answer.q_nb[i] - before.q_nb[i];
                step * step
            };
            (answer.latitude_rad - before.latitude_rad).abs() < NEAR_RAD
                && (answer.longitude_rad - before.longitude_rad).abs() < NEAR_RAD
                && (answer.velocity_mps[0] - before.velocity_mps[0]).abs() < NEAR_MPS
                && (answer.velocity_mps[1] - before.velocity_mps[1]).abs() < NEAR_MPS
                && (square(0) + square(1)) + (square(2) + square(3)) < NEAR_TURN
        });
        self.before = Some(*answer);
        if !near {
            self.stray = 2;
        }
        self.stray > 0
    }

    /// Computes the largest attitude errors that are pending in full.
    fn settle(&mut self) {
        if let Some(truth) = &self.truth {
            self.attitude.settle(&truth.case);
        }
    }

    /// True if there is a truth with which answers can be compared.
    #[inline(always)]
    pub(super) fn has_truth(&self) -> bool {
        self.truth.is_some()
    }

    /// Takes an answer at the standing truth.
    #[inline(always)]
    pub(super) fn take(&mut self, answer: &AnsweredSolution) {
        let Some(truth) = &self.truth else { return };
        let latitude = answer.latitude_rad - truth.latitude_rad;
        let longitude = answer.longitude_rad - truth.longitude_rad;
        let errors = [
            latitude,
            longitude,
            answer.velocity_mps[0] - truth.velocity_mps[0],
            answer.velocity_mps[1] - truth.velocity_mps[1],
        ];
        for (far, error) in self.far.iter_mut().zip(errors) {
            // A comparison with NaN is false: it isn't known.
            *far = if error.abs() > *far { error.abs() } else { *far };
        }
        let north_m = latitude * truth.per_latitude_m;
        let east_m = longitude * truth.transverse_m * truth.cos_latitude;
        let radial_m2 = north_m * north_m + east_m * east_m;
        self.radial_m2 = if radial_m2 > self.radial_m2 { radial_m2 } else { self.radial_m2 };
        let near = &self.attitude.near;
        let square = |i: usize| (answer.q_nb[i] - near[i]) * (answer.q_nb[i] - near[i]);
        if (square(0) + square(1)) + (square(2) + square(3)) > self.attitude.slack {
            self.attitude.compare(&truth.case, answer.q_nb);
        }
    }

    /// Largest errors so far.
    pub(super) fn largest(&self) -> LargestErrors {
        let [latitude, longitude, north, east] = self.far;
        let mut attitude = self.attitude.clone();
        if let Some(truth) = &self.truth {
            attitude.settle(&truth.case);
        }
        let [heading, pitch, roll] = attitude.largest_rad.map(|error| error / ARCMIN);
        let each = [latitude / ARCMIN, longitude / ARCMIN, heading, pitch, roll, north, east];
        LargestErrors { each, radial_nmi: libm::sqrt(self.radial_m2) / NAUTICAL_MILE_M }
    }
}

/// Distance from an attitude that was computed in full, squared, up to which its slopes hold.
const LINEAR: f64 = 1e-10;
/// Step of the quaternion for a slope.
const STEP: f64 = 1e-5;

impl LargestAttitude {
    /// Compares an attitude: by the slopes close to one that was computed in full, else in full.
    #[inline(never)]
    fn compare(&mut self, truth: &CaseReference, q_nb: [f64; 4]) {
        let apart: [f64; 4] = core::array::from_fn(|i| q_nb[i] - self.near[i]);
        let square = (apart[0] * apart[0] + apart[1] * apart[1])
            + (apart[2] * apart[2] + apart[3] * apart[3]);
        if self.slack < 0.0 || !(square < LINEAR) {
            self.settle(truth);
            self.compute(truth, q_nb);
            return;
        }
        let mut larger = false;
        for (angle, slope) in self.slopes.iter().enumerate() {
            let along = (slope[0] * apart[0] + slope[1] * apart[1])
                + (slope[2] * apart[2] + slope[3] * apart[3]);
            let error = (self.errors_rad[angle] + along).abs();
            if error > self.largest_rad[angle] {
                self.largest_rad[angle] = error;
                self.pending[angle] = Some(q_nb);
                larger = true;
            }
        }
        if larger {
            self.widen();
        }
    }

    /// Computes the errors of an attitude in full, and their slopes.
    #[inline(never)]
    fn compute(&mut self, truth: &CaseReference, q_nb: [f64; 4]) {
        self.errors_rad = truth.errors(q_nb);
        for (largest, error) in self.largest_rad.iter_mut().zip(self.errors_rad) {
            *largest = if error.abs() > *largest { error.abs() } else { *largest };
        }
        for i in 0..4 {
            let beside = |step: f64| {
                let mut q = q_nb;
                q[i] += step;
                truth.errors(q)
            };
            let (low, high) = (beside(-STEP), beside(STEP));
            for angle in 0..3 {
                self.slopes[angle][i] = (high[angle] - low[angle]) / (2.0 * STEP);
            }
        }
        self.near = q_nb;
        self.widen();
    }

    /// Sets the distance up to which no error can become the largest.
    fn widen(&mut self) {
        let mut distance = f64::INFINITY;
        for angle in 0..3 {
            let [a, b, c, d] = self.slopes[angle];
            let steepest = libm::sqrt((a * a + b * b) + (c * c + d * d));
            let margin_rad = self.largest_rad[angle] - self.errors_rad[angle].abs();
            distance = distance.min(margin_rad / steepest);
        }
        // Attitudes that aren't known have no distance.
        let unknown = self.errors_rad.iter().any(|error| error.is_nan());
        self.slack = if unknown { f64::INFINITY } else { (distance * distance).min(LINEAR) };
    }

    /// Computes the pending largest errors in full.
    fn settle(&mut self, truth: &CaseReference) {
        for angle in 0..3 {
            if let Some(q_nb) = self.pending[angle].take() {
                self.largest_rad[angle] = truth.errors(q_nb)[angle].abs();
            }
        }
    }
}
