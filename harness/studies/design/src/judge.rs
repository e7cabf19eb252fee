//! Judge of candidates: the covariance of a calibration, and a measure of navigation.

use crate::evaluate::{Conditions, Evaluator};
use crate::largest::{LargestDraws, LargestErrors, Sampled};
use crate::measure::{DesignMeasure, Part};
use crate::navigation::Quadratic;
use crate::setup::{Setup, level};
use octant_calibration::covariance::{Covariance, PARAMETERS, STATE_COUNT};
use octant_calibration::schedule::DoesNotFit;
use octant_calibration::sequence::{Sequence, Stop};
use octant_earth::units::NAUTICAL_MILE_M;
use octant_observe::covariance::arcmin_m;
use std::sync::Arc;

/// A measure of navigation, made once for a scenario and a rotation.
#[derive(Clone, Debug)]
pub struct MeasureWeights {
    /// Form whose root is the measure, or stands for it in a search.
    pub form: Quadratic,
    /// First stop of the rotation, where the weights start.
    pub first: Stop,
    /// Draws of a largest error.
    largest: Option<(Part, Arc<LargestDraws>)>,
}

impl MeasureWeights {
    /// Prepares a measure.
    ///
    /// The form that stands for a largest error is its mean square at the times at which it is the largest
    /// where the bound is reached.
    ///
    /// # Errors
    /// If the calibration is shorter than a dwell can be.
    pub fn new(setup: &Setup, measure: DesignMeasure) -> Result<Self, DoesNotFit> {
        let drift = setup.drift();
        let earth = &setup.conditions.platform.earth;
        let Some(part) = measure.largest() else {
            let form = measure.form(&drift, earth);
            return Ok(Self { form, first: drift.first, largest: None });
        };
        let draws = setup.largest();
        let initial = known_but_isotropic(&setup.conditions.initial);
        let mut knowing = Evaluator::new(Conditions { initial, ..setup.conditions.clone() });
        let mut left = knowing.calibrate(&level(), setup.duration_s)?;
        knowing.start_navigation(&mut left, &Stop::default(), &drift.first);
        let [latitude, longitude, radial] = draws.forms(&left);
        let [latitude_m, longitude_m] = arcmin_m(earth);
        let (form, unit_m) = match part {
            Part::Latitude => (latitude, latitude_m),
            Part::Longitude => (longitude, longitude_m),
            Part::Radial => (radial, NAUTICAL_MILE_M),
        };
        let form = form.times(1.0 / (unit_m * unit_m));
        Ok(Self { form, first: drift.first, largest: Some((part, Arc::new(draws))) })
    }
}

impl Setup {
    /// Makes the draws from which largest errors are predicted.
    #[must_use]
    pub fn largest(&self) -> LargestDraws {
        LargestDraws::new(&self.conditions.platform, &self.navigation, self.navigation_s)
    }

    /// Predicts the largest errors after a calibration by this sequence.
    ///
    /// # Errors
    /// If the sequence doesn't fit.
    pub fn largest_after(
        &self,
        sequence: &Sequence,
        duration_s: f64,
    ) -> Result<Vec<LargestErrors>, DoesNotFit> {
        let mut evaluator = Evaluator::new(self.conditions.clone());
        let mut covariance = evaluator.calibrate(sequence, duration_s)?;
        let (from, to) = (last(sequence), self.navigation.rotation.stops()[0]);
        evaluator.start_navigation(&mut covariance, &from, &to);
        Ok(self.largest().of(&covariance))
    }
}

/// What a candidate is judged by: the covariance of its calibration, and a measure of navigation.
#[derive(Debug)]
pub struct Judge {
    /// The covariance recursion.
    pub evaluator: Evaluator,
    weights: MeasureWeights,
}

impl Judge {
    /// Creates the judge of a measure.
    #[must_use]
    pub fn new(setup: &Setup, weights: &MeasureWeights) -> Self {
        Self { evaluator: Evaluator::new(setup.conditions.clone()), weights: weights.clone() }
    }

    /// Creates a judge of the same measure from another covariance at the start of the filter.
    #[must_use]
    pub fn from_initial(&self, initial: Covariance) -> Self {
        let conditions = Conditions { initial, ..self.evaluator.conditions().clone() };
        Self { evaluator: Evaluator::new(conditions), weights: self.weights.clone() }
    }

    /// The form of the measure.
    #[must_use]
    pub fn form(&self) -> &Quadratic {
        &self.weights.form
    }

    /// Returns the measure after a calibration by this sequence.
    ///
    /// # Errors
    /// If the sequence doesn't fit.
    pub fn score(&mut self, sequence: &Sequence, duration_s: f64) -> Result<f64, DoesNotFit> {
        let covariance = self.at_start(sequence, duration_s)?;
        Ok(self.measured(&covariance))
    }

    /// Returns the measure for a covariance at the end of a calibration, with the gimbals at `from`.
    pub fn score_of(&mut self, covariance: Covariance, from: &Stop) -> f64 {
        let covariance = self.started(covariance, from);
        self.measured(&covariance)
    }

    /// Returns what a search minimises: the measure, or for a largest error the form that stands for it.
    ///
    /// # Errors
    /// If the sequence doesn't fit.
    pub(crate) fn fast(&mut self, sequence: &Sequence, duration_s: f64) -> Result<f64, DoesNotFit> {
        let covariance = self.at_start(sequence, duration_s)?;
        Ok(self.root(&covariance))
    }

    /// Returns whether a search minimises something else than the measure.
    pub(crate) fn has_draws(&self) -> bool {
        self.weights.largest.is_some()
    }

    /// Returns a largest error for a covariance at the start of navigation; `None` for other measures.
    pub(crate) fn drawn(&self, covariance: &Covariance) -> Option<Sampled> {
        let (part, draws) = self.weights.largest.as_ref()?;
        let all = draws.of(covariance);
        let LargestErrors { latitude_arcmin, longitude_arcmin, radial_nmi, .. } = all.last()?;
        Some(match part {
            Part::Latitude => *latitude_arcmin,
            Part::Longitude => *longitude_arcmin,
            Part::Radial => *radial_nmi,
        })
    }

    /// Returns the covariance at the start of navigation after a calibration by this sequence.
    ///
    /// # Errors
    /// If the sequence doesn't fit.
    pub fn at_start(
        &mut self,
        sequence: &Sequence,
        duration_s: f64,
    ) -> Result<Covariance, DoesNotFit> {
        let covariance = self.evaluator.calibrate(sequence, duration_s)?;
        Ok(self.started(covariance, &last(sequence)))
    }

    fn started(&mut self, mut covariance: Covariance, from: &Stop) -> Covariance {
        self.evaluator.start_navigation(&mut covariance, from, &self.weights.first);
        covariance
    }

    fn measured(&self, covariance: &Covariance) -> f64 {
        self.drawn(covariance).map_or_else(|| self.root(covariance), |drawn| drawn.value)
    }

    fn root(&self, covariance: &Covariance) -> f64 {
        libm::sqrt(self.weights.form.of(covariance).max(0.0))
    }
}

fn last(sequence: &Sequence) -> Stop {
    let stops = sequence.stops();
    stops[stops.len() - 1]
}

/// First state of G, by rows.
pub(crate) const G: usize = PARAMETERS + 12;
/// Diagonal of G.
pub(crate) const DIAGONAL: [usize; 3] = [G, G + 4, G + 8];

/// Makes the covariance of the same errors with all parameters known but the isotropic part of G.
#[must_use]
pub fn known_but_isotropic(initial: &Covariance) -> Covariance {
    let mut covariance = initial.clone();
    for state in (PARAMETERS..STATE_COUNT).filter(|state| !DIAGONAL.contains(state)) {
        learn(&mut covariance, &[(state, 1.0)]);
    }
    for pair in DIAGONAL.windows(2) {
        learn(&mut covariance, &[(pair[0], 1.0), (pair[1], -1.0)]);
    }
    covariance
}

/// Makes a combination of errors exactly known.
fn learn(covariance: &mut Covariance, combination: &[(usize, f64)]) {
    let row: [f64; STATE_COUNT] = core::array::from_fn(|j| {
        combination.iter().map(|(state, factor)| factor * covariance.at(*state, j)).sum()
    });
    let variance: f64 = combination.iter().map(|(state, factor)| factor * row[*state]).sum();
    if variance > 0.0 {
        for i in 0..STATE_COUNT {
            for j in i..STATE_COUNT {
                covariance.add(i, j, -row[i] * row[j] / variance);
            }
        }
    }
    // Remainder of the rounding.
    if let [(state, _)] = combination {
        covariance.reopen(*state, 0.0);
    }
}
