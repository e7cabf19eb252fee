//! Checks every number of an answer of the unit under test, once, at the input.
//!
//! The rules are those of `harness/wire/README.md`, for every endpoint. Numbers are finite, except
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

#[cfg(test)]
mod tests {
    use super::*;
    use octant_sample::{DeviceTime, Navigation, Parameters};

    fn sample(number: u64) -> Sample {
        let device_time = DeviceTime::from_ns(number * 5_000_000);
        Sample { sequence: number, device_time, ..Sample::default() }
    }

    fn good(number: u64) -> Output {
        let sent = sample(number);
        Output {
            sequence: sent.sequence,
            device_time: sent.device_time,
            navigation: Navigation { q_nb: [1.0, 0.0, 0.0, 0.0], ..Navigation::default() },
            nis: f64::NAN,
            ..Output::default()
        }
    }

    fn second(change: impl FnOnce(&mut Output)) -> Result<(), Misbehaviour> {
        let mut check = AnswerCheck::new();
        let before = Output { parameters_revision: 7, mode: Mode::Calibrating, ..good(1) };
        check.answer(&sample(1), &before).unwrap();
        let mut output = Output { parameters_revision: 7, mode: Mode::Calibrating, ..good(2) };
        change(&mut output);
        check.answer(&sample(2), &output)
    }

    #[test]
    fn an_answer_that_is_right_passes_with_all_that_the_wire_allows() {
        second(|_| {}).unwrap();
        second(|o| o.nis = 0.0).unwrap();
        second(|o| o.nis = 1e300).unwrap();
        second(|o| o.parameters_revision = u32::MAX).unwrap();
        second(|o| o.navigation.latitude_rad = -FRAC_PI_2).unwrap();
        // Unwrapped, and in single precision.
        second(|o| o.navigation.longitude_rad = 6.9).unwrap();
        second(|o| o.navigation.q_nb = [-0.6, 0.0, f64::from(0.8_f32), -0.0]).unwrap();
        for mode in [Mode::Navigating, Mode::Done, Mode::Refused] {
            second(|o| o.mode = mode).unwrap();
        }
    }

    #[test]
    fn every_number_that_is_wrong_is_found_with_field_and_value() {
        type Change = fn(&mut Output);
        let table: [(&str, &str, Change); 19] = [
            ("sequence", "3", |o| o.sequence = 3),
            ("sequence", "0", |o| o.sequence = 0),
            ("device_time", "1 ns", |o| o.device_time = DeviceTime::from_ns(1)),
            ("navigation.latitude_rad", "NaN", |o| o.navigation.latitude_rad = f64::NAN),
            ("navigation.latitude_rad", "1.6", |o| o.navigation.latitude_rad = 1.6),
            ("navigation.longitude_rad", "inf", |o| o.navigation.longitude_rad = f64::INFINITY),
            ("navigation.longitude_rad", "-inf", |o| {
                o.navigation.longitude_rad = f64::NEG_INFINITY;
            }),
            ("navigation.height_m", "NaN", |o| o.navigation.height_m = f64::NAN),
            ("navigation.velocity_mps, north", "NaN", |o| o.navigation.velocity_mps[0] = f64::NAN),
            ("navigation.velocity_mps, east", "30000", |o| o.navigation.velocity_mps[1] = 3e4),
            ("navigation.velocity_mps, down", "inf", |o| {
                o.navigation.velocity_mps[2] = f64::INFINITY;
            }),
            ("navigation.q_nb", "[0.0, 0.0, 0.0, 0.0]", |o| o.navigation.q_nb = [0.0; 4]),
            ("navigation.q_nb", "[inf, 0.0, 0.0, 0.0]", |o| o.navigation.q_nb[0] = f64::INFINITY),
            ("navigation.q_nb", "[1.0, 0.0, NaN, 0.0]", |o| o.navigation.q_nb[2] = f64::NAN),
            ("nis", "inf", |o| o.nis = f64::INFINITY),
            ("nis", "-1", |o| o.nis = -1.0),
            ("parameters_revision", "6", |o| o.parameters_revision = 6),
            ("mode", "aligning", |o| o.mode = Mode::Aligning),
            ("navigation.height_m", "-100000000", |o| o.navigation.height_m = -1e8),
        ];
        for (field, found, change) in table {
            let wrong = second(change).unwrap_err();
            assert_eq!(
                (wrong.field.as_str(), wrong.found.as_str(), wrong.sample),
                (field, found, 2)
            );
            assert!(wrong.to_string().starts_with("the answer to sample 2: "), "{wrong}");
        }
    }

    #[test]
    fn modes_go_back_after_a_restart_alone() {
        let mut check = AnswerCheck::new();
        let in_mode = |number, mode| Output { mode, ..good(number) };
        check.answer(&sample(1), &in_mode(1, Mode::Navigating)).unwrap();
        let wrong = check.answer(&sample(2), &in_mode(2, Mode::Calibrating)).unwrap_err();
        assert_eq!(wrong.expected, "navigating, or a later one");
        check.restarted();
        check.answer(&sample(2), &in_mode(2, Mode::Aligning)).unwrap();
    }

    #[test]
    fn parameters_are_finite_and_sigmas_not_negative() {
        let estimate = |value: f64, sigma: f64| {
            let mut values = [1e-9; PARAMETER_COUNT];
            let mut sigmas = [1e-10; PARAMETER_COUNT];
            (values[14], sigmas[14]) = (value, sigma);
            let parameters = Parameters::from_array(&values);
            ParameterEstimate { revision: 1, parameters, sigma: sigmas }
        };
        let found = |value, sigma| {
            AnswerCheck::new().parameters(9, &estimate(value, sigma)).map_err(|wrong| wrong.field)
        };
        for sigma in [1e-9, 0.0, f64::NAN] {
            found(1e-8, sigma).unwrap();
        }
        let name = NAMES[14];
        for value in [f64::NAN, f64::INFINITY, 1e9] {
            assert_eq!(found(value, 1.0), Err(format!("parameters.{name}")));
        }
        for sigma in [f64::INFINITY, -1e-9] {
            assert_eq!(found(0.0, sigma), Err(format!("sigma.{name}")));
        }
    }
}
