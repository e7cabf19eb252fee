//! Checks every number of an answer of the unit under test, once, at the input.
//!
//! The rules are those of `harness/devices/wire/README.md`, for every endpoint. Numbers are finite, except
//! the NIS of an answer without a measurement; an answer carries number and stamp of its sample;
//! modes only advance until the unit is restarted.

use octant_sample::parameters::ParameterEstimate;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterGroup};
use octant_sample::{Mode, Output, Sample};
use std::f64::consts::FRAC_PI_2;

/// Largest magnitude of a longitude, rad: it isn't wrapped, and no vehicle circles the Earth more
/// often.
const LONGITUDE_MAX_RAD: f64 = 1000.0;
/// Largest magnitude of a height, m: normal gravity isn't valid beyond.
const HEIGHT_MAX_M: f64 = 1e7;
/// Largest magnitude of a velocity over ground, m/s: about twice orbital velocity.
const VELOCITY_MAX_MPS: f64 = 2e4;
/// Largest deviation of an attitude's squared norm from 1: single precision keeps 1e-6.
const NORM_SLACK: f64 = 1e-3;
/// Largest magnitude of a parameter, SI: a scale factor or misalignment of 1 inverts the sensor,
/// and the other parameters are far smaller in SI units.
const PARAMETER_MAX: f64 = 1e3;

/// First violation of the answer rules by a unit; nothing after it is judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Misbehaviour {
    /// Number of the sample that was answered.
    pub sample: u64,
    /// The field, as in `navigation.latitude_rad`.
    pub field: String,
    /// Value found.
    pub found: String,
    /// Values allowed.
    pub expected: String,
}

impl std::fmt::Display for Misbehaviour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { sample, field, found, expected } = self;
        write!(f, "the answer to sample {sample}: {field} is {found}, expected {expected}")
    }
}

impl std::error::Error for Misbehaviour {}

/// Checks the answers of a unit, one after the other.
#[derive(Clone, Debug)]
pub struct AnswerCheck {
    last_mode: Option<Mode>,
    revision: Option<u32>,
}

impl Default for AnswerCheck {
    fn default() -> Self {
        Self::new()
    }
}

impl AnswerCheck {
    /// Creates a check at the state before the first answer.
    #[must_use]
    pub fn new() -> Self {
        Self { last_mode: None, revision: None }
    }

    /// Resets the check after a restart of the unit: modes and revisions begin anew.
    pub fn restarted(&mut self) {
        *self = Self::new();
    }

    /// Checks the answer to a sample.
    ///
    /// # Errors
    /// The first violation in it.
    #[inline]
    pub fn answer(&mut self, sent: &Sample, output: &Output) -> Result<(), Misbehaviour> {
        let navigation = &output.navigation;
        let [w, x, y, z] = navigation.q_nb;
        let [north, east, down] = navigation.velocity_mps;
        let norm = w * w + x * x + y * y + z * z;
        // Sums and comparisons that fail on NaN, without a branch that is taken in a good run.
        let good = output.sequence == sent.sequence
            && output.device_time == sent.device_time
            && navigation.latitude_rad.abs() <= FRAC_PI_2
            && navigation.longitude_rad.abs() <= LONGITUDE_MAX_RAD
            && navigation.height_m.abs() <= HEIGHT_MAX_M
            && north.abs() <= VELOCITY_MAX_MPS
            && east.abs() <= VELOCITY_MAX_MPS
            && down.abs() <= VELOCITY_MAX_MPS
            && (norm - 1.0).abs() <= NORM_SLACK
            && (output.nis.is_nan() || (output.nis >= 0.0 && output.nis < f64::INFINITY))
            && self.last_mode == Some(output.mode)
            && self.revision.is_some_and(|before| output.parameters_revision >= before);
        if good { Ok(()) } else { self.look(sent, output) }
    }

    /// Finds the violation in an answer, or takes over a new mode or revision.
    #[cold]
    fn look(&mut self, sent: &Sample, output: &Output) -> Result<(), Misbehaviour> {
        let wrong = |field: &str, found: String, expected: String| {
            Err(Misbehaviour { sample: sent.sequence, field: field.to_owned(), found, expected })
        };
        if output.sequence != sent.sequence {
            return wrong("sequence", output.sequence.to_string(), sent.sequence.to_string());
        }
        if output.device_time != sent.device_time {
            let (found, expected) = (output.device_time.ns, sent.device_time.ns);
            return wrong("device_time", format!("{found} ns"), format!("{expected} ns"));
        }
        let navigation = &output.navigation;
        let [north, east, down] = navigation.velocity_mps;
        let numbers = [
            ("navigation.latitude_rad", navigation.latitude_rad, FRAC_PI_2),
            ("navigation.longitude_rad", navigation.longitude_rad, LONGITUDE_MAX_RAD),
            ("navigation.height_m", navigation.height_m, HEIGHT_MAX_M),
            ("navigation.velocity_mps, north", north, VELOCITY_MAX_MPS),
            ("navigation.velocity_mps, east", east, VELOCITY_MAX_MPS),
            ("navigation.velocity_mps, down", down, VELOCITY_MAX_MPS),
        ];
        for (field, value, most) in numbers {
            if !(value.abs() <= most) {
                return wrong(field, value.to_string(), format!("a number from -{most} to {most}"));
            }
        }
        let norm: f64 = navigation.q_nb.iter().map(|q| q * q).sum();
        if !((norm - 1.0).abs() <= NORM_SLACK) {
            let found = format!("{:?}", navigation.q_nb);
            return wrong("navigation.q_nb", found, "a quaternion of norm 1".to_owned());
        }
        if !(output.nis.is_nan() || (output.nis >= 0.0 && output.nis < f64::INFINITY)) {
            let expected = "a number of 0 or more, or NaN where nothing was measured".to_owned();
            return wrong("nis", output.nis.to_string(), expected);
        }
        if let Some(before) = self.revision
            && output.parameters_revision < before
        {
            let found = output.parameters_revision.to_string();
            return wrong("parameters_revision", found, format!("at least {before}, as before"));
        }
        if let Some(before) = self.last_mode
            && !follows(before, output.mode)
        {
            let (found, before) = (output.mode.name().to_owned(), before.name());
            return wrong("mode", found, format!("{before}, or a later one"));
        }
        self.last_mode = Some(output.mode);
        self.revision = Some(output.parameters_revision);
        Ok(())
    }

    /// Checks parameters that came with the answer to a sample. σ is NaN or zero where a parameter
    /// isn't estimated.
    ///
    /// # Errors
    /// The first violation among them.
    pub fn parameters(
        &mut self,
        sample: u64,
        estimate: &ParameterEstimate,
    ) -> Result<(), Misbehaviour> {
        let values = estimate.parameters.to_array();
        for i in 0..PARAMETER_COUNT {
            let (value, sigma) = (values[i], estimate.sigma[i]);
            let wrong = |field: String, found: f64, expected: String| {
                let unit = ParameterGroup::of(i);
                let found = format!("{} {}", found / unit.si_per_unit(), unit.unit());
                Err(Misbehaviour { sample, field, found, expected })
            };
            let name = NAMES[i];
            if !(value.abs() <= PARAMETER_MAX) {
                return wrong(format!("parameters.{name}"), value, "a finite number".to_owned());
            }
            if !(sigma.is_nan() || (0.0..=PARAMETER_MAX).contains(&sigma)) {
                let expected = "a number of 0 or more, or NaN where it isn't estimated".to_owned();
                return wrong(format!("sigma.{name}"), sigma, expected);
            }
        }
        self.revision = Some(estimate.revision.max(self.revision.unwrap_or(0)));
        Ok(())
    }
}

/// Returns whether one mode may follow another without a restart.
fn follows(before: Mode, after: Mode) -> bool {
    let rank = |mode: Mode| match mode {
        Mode::Aligning => 0,
        Mode::Calibrating => 1,
        Mode::Navigating => 2,
        Mode::Done | Mode::Refused => 3,
    };
    before == after || rank(after) > rank(before)
}
