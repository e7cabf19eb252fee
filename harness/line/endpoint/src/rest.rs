//! Core beside one that uses the rest of its case, and doesn't: it takes over where the case turned.
//!
//! What was learned from a rest that wasn't one can't be told apart afterwards. A second core takes the same samples without
//! it, for as long as the calibration lasts. At its end the first one gives way if its own tests found a turn, if it
//! refuses its calibration and the second one doesn't, or if the two differ by more than the information of a rest explains: the errors of an efficient estimate and its difference from
//! another one are uncorrelated, so that the variance of the difference is that of the variances (J. A. Hausman,
//! "Specification tests in econometrics", Econometrica 46, 1978).

use octant_calibration::config::{Estimator, Further};
use octant_calibration::state_machine::{CalibrationRefusal, CoreConfigError};
use octant_calibration::{Core, CoreConfig};
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use octant_sample::{Epoch, Mode, Output};

/// Difference of a parameter with and without rest that contradicts a rest, in its standard deviations: of thirty
/// normal ones 2e-5 of calibrations.
const DIFFERENCE_SIGMAS: f64 = 5.0;
/// Smallest standard deviation of a difference, in those of the parameter without rest: below it rounding and the
/// order of corrections are seen.
const SMALLEST_PART: f64 = 0.1;

/// Use of a case that is said to rest, at the end of a calibration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestUse {
    /// Contradiction for which the calibration without it was taken; `None`: it was used.
    pub contradicted: Option<String>,
    /// Largest difference of a parameter with and without it, in standard deviations of that difference, and its name;
    /// `None` where one of the two calibrations was refused.
    pub largest_difference: Option<(f64, &'static str)>,
}

/// The core without the rest of its case.
#[derive(Clone, Debug)]
pub(super) struct WithoutRest {
    core: Core,
    output: Output,
}

impl WithoutRest {
    /// Makes it; `None` where no case is said to rest.
    pub(super) fn new(config: &CoreConfig) -> Result<Option<Box<Self>>, CoreConfigError> {
        let mut config = config.clone();
        let Some(calibration) = &mut config.calibration else { return Ok(None) };
        let Estimator::Kalman(kalman) = &mut calibration.estimator else { return Ok(None) };
        if kalman.further.rest.is_none() {
            return Ok(None);
        }
        kalman.further = Further { rest: None, ..kalman.further };
        Ok(Some(Box::new(Self { core: Core::new(&config)?, output: Output::default() })))
    }

    /// Core that goes on without rest.
    pub(super) fn core_mut(&mut self) -> &mut Core {
        &mut self.core
    }

    pub(super) fn step(&mut self, epoch: &Epoch) {
        self.core.step_into(&epoch.sample, epoch.aiding.as_ref(), &mut self.output);
    }

    /// Ends the stream of the core without rest, and returns its use.
    pub(super) fn end_of_stream(&mut self) {
        self.output = self.core.end_of_stream();
    }

    /// Compares the two at the end of the calibration, and exchanges them where the rest is contradicted. The second
    /// value is what has then to be added to the revisions of the parameters, which only grow.
    pub(super) fn conclude(
        mut self: Box<Self>,
        core: &mut Core,
        output: &mut Output,
    ) -> (RestUse, u32) {
        let mut rest = RestUse::default();
        match core.refusal() {
            Some(CalibrationRefusal::CaseTurned(turn)) => {
                rest.contradicted = Some(turn.to_string())
            }
            // With the same samples and tests the one difference is the rest.
            Some(refusal) if self.core.refusal().is_none() => {
                rest.contradicted = Some(refusal.to_string());
            }
            Some(_) => return (rest, 0),
            None if self.core.refusal().is_some() => return (rest, 0),
            None => {
                let (sigmas, parameter) = largest_difference(core, &self.core);
                rest.largest_difference = Some((sigmas, NAMES[parameter]));
                if sigmas > DIFFERENCE_SIGMAS {
                    rest.contradicted = Some(format!(
                        "{} differs by {sigmas:.1} standard deviations from the calibration without it",
                        NAMES[parameter]
                    ));
                }
            }
        }
        if rest.contradicted.is_none() {
            return (rest, 0);
        }
        core::mem::swap(core, &mut self.core);
        let before = output.parameters_revision;
        *output = self.output;
        (rest, before.saturating_add(1).saturating_sub(output.parameters_revision).max(1))
    }
}

/// Returns the largest difference of a parameter, in its standard deviations, with the index of the parameter.
fn largest_difference(with: &Core, without: &Core) -> (f64, usize) {
    let [a, b] = [with, without].map(|core| core.parameters().to_array());
    let (narrow, wide) = (with.sigma(), without.sigma());
    let of = |i: usize| {
        let least = SMALLEST_PART * wide[i];
        let variance = (wide[i] * wide[i] - narrow[i] * narrow[i]).max(least * least);
        if variance > 0.0 { (a[i] - b[i]).abs() / variance.sqrt() } else { 0.0 }
    };
    (0..PARAMETER_COUNT)
        .map(|i| (of(i), i))
        .fold((0.0, 0), |most, at| if at.0 > most.0 { at } else { most })
}

/// Returns whether a calibration goes on in this mode.
pub(super) fn goes_on(mode: Mode) -> bool {
    matches!(mode, Mode::Aligning | Mode::Calibrating)
}
