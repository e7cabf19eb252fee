//! Reasons why the tests of a smoothed calibration say nothing, or not enough.

use super::smoothed::RepeatedCalibration;
use octant_calibration::CoreConfig;
use octant_calibration::config::{Base, Kalman};
use octant_sample::Mode;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use octant_smoother::backward::SmoothedCalibration;

/// Mean NIS between which the tests are normal, within a tenth of their σ.
const NIS: std::ops::RangeInclusive<f64> = 2.5..=3.5;
/// Largest share of a calibration that may be left out before the first smoothed measurement.
const LEFT_OUT: f64 = 0.1;

/// Reasons against a verdict.
#[derive(Debug, Default)]
pub struct SmoothingDoubts {
    /// The tests aren't normal here: neither their silence nor what they find counts.
    pub invalid: Vec<String>,
    /// The tests hold, but not for all of the calibration: their silence doesn't count.
    pub incomplete: Vec<String>,
}

impl SmoothingDoubts {
    /// Reasons against the tests of a calibration that was made again; `tested` are the parameters that were tested.
    #[must_use]
    pub fn of(
        config: &CoreConfig,
        kalman: &Kalman,
        repeated: &RepeatedCalibration,
        smoothed: &SmoothedCalibration,
        tested: &[usize],
    ) -> Self {
        let mut doubts = Self::default();
        if !NIS.contains(&smoothed.mean_nis) {
            doubts.invalid.push(format!(
                "the mean NIS is {:.2}, expected {} to {}: the noise isn't that of the filter, and σ neither",
                smoothed.mean_nis,
                NIS.start(),
                NIS.end()
            ));
        }
        if matches!(config.screening.base, Base::Moving(_)) {
            doubts.invalid.push(
                "the base moves, and the filter takes its sway for white noise, which it isn't"
                    .to_owned(),
            );
        }
        if kalman.estimated != [true; 7] {
            doubts.invalid.push(
                "the filter leaves out a group of parameters, which then shows in the others"
                    .to_owned(),
            );
        }
        match repeated.mode {
            Mode::Aligning | Mode::Calibrating => {
                doubts.incomplete.push("the recording ends before the calibration".to_owned());
            }
            Mode::Refused => {
                let why = repeated.refusal.as_deref().unwrap_or("no reason is known");
                doubts.incomplete.push(format!("the core refused the calibration: {why}"));
            }
            Mode::Navigating | Mode::Done => {}
        }
        let history = &repeated.history;
        if history.begins_s() > LEFT_OUT * history.ends_s() {
            doubts.incomplete.push(format!(
                "the filter recovered: the {:.0} s before are left out",
                history.begins_s()
            ));
        }
        // A parameter known no better than by its prior is published with the prior's σ, so nothing is claimed of it. The
        // biases, though, are what every calibration is for.
        let untested = |i: &usize| !tested.contains(i) && NAMES[*i].contains("_bias_");
        let untested: Vec<&str> = (0..PARAMETER_COUNT).filter(untested).map(|i| NAMES[i]).collect();
        if !untested.is_empty() {
            doubts.incomplete.push(format!("{} known too little to be tested", are(&untested)));
        }
        doubts
    }
}

/// Names with their verb.
fn are(names: &[&str]) -> String {
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", names.join(", "))
}
