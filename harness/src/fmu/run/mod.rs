//! Any FMU stepped with inputs from a file, its outputs row by row: `octant fmu run`.
//!
//! Row 0 is the state after initialization. A row follows each communication step, with the
//! inputs of the step's start: as FMPy records.

pub mod input;
pub mod output;

use super::mapping::settings::Starts;
use crate::run::Control;
use input::Inputs;
use octant_fmu_host::instance::{Instance, InstanceError, Outcome};
use output::{Outputs, Sink};

/// How long, and in what steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Start, s.
    pub start_s: f64,
    /// End, s.
    pub stop_s: f64,
    /// Communication step, s; the last one may be shorter.
    pub step_s: f64,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
}

/// Steps in a run, at most: beyond, a step is surely too short.
const STEPS_MAX: f64 = 1e12;

impl Span {
    /// Number of steps.
    ///
    /// # Errors
    /// If start, stop and step contradict each other.
    pub fn steps(&self) -> Result<u64, String> {
        let Self { start_s, stop_s, step_s, .. } = *self;
        if !(start_s.is_finite() && stop_s.is_finite() && stop_s >= start_s) {
            return Err(format!(
                "found the start {start_s} s and the stop {stop_s} s, expected a stop at or after the start"
            ));
        }
        if !(step_s.is_finite() && step_s > 0.0) {
            return Err(format!("found the step {step_s} s, expected a time above 0"));
        }
        let steps = (stop_s - start_s) / step_s;
        if steps > STEPS_MAX {
            return Err(format!(
                "found the step {step_s} s, which makes {steps:e} steps, expected {STEPS_MAX:e} at most"
            ));
        }
        // A rest that is rounding is no step.
        let whole = steps.round();
        Ok(if (steps - whole).abs() <= 1e-9 * steps.max(1.0) { whole } else { steps.ceil() } as u64)
    }
}

/// What a run left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finished {
    /// Steps done.
    pub steps: u64,
    /// Time reached, s.
    pub time_s: f64,
    /// The FMU wanted it to end.
    pub terminated: bool,
    /// Somebody else did.
    pub cancelled: bool,
}

/// Why a run broke off.
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// The FMU failed.
    #[error(transparent)]
    Instance(#[from] InstanceError),
    /// The FMU refused a step.
    #[error("{fmu} refused the step from {time_s} s by {step_s} s{said}")]
    Refused {
        /// Name of the FMU.
        fmu: String,
        /// Start of the step, s.
        time_s: f64,
        /// The step, s.
        step_s: f64,
        /// What it logged, after a colon; else empty.
        said: String,
    },
    /// The outputs can't be written.
    #[error("write the outputs: {0}")]
    Write(#[from] std::io::Error),
}

/// Steps an FMU from its start values to the end.
///
/// # Errors
/// If the FMU fails or refuses a step, or the outputs can't be written; rows before are kept.
pub fn simulate(
    instance: &mut dyn Instance,
    starts: &Starts,
    mut inputs: Option<&mut Inputs>,
    outputs: &Outputs,
    span: &Span,
    sink: &mut Sink,
    control: &Control,
) -> Result<Finished, SimulateError> {
    starts.apply(instance)?;
    instance.enter_initialization(span.start_s, Some(span.stop_s), span.tolerance)?;
    if let Some(inputs) = &mut inputs {
        inputs.at(span.start_s);
        let mut rest = inputs.numbers.as_slice();
        for group in &inputs.plan.groups {
            let (these, others) = rest.split_at(group.elements);
            instance.set(group, these)?;
            rest = others;
        }
    }
    instance.exit_initialization()?;
    let mut numbers = vec![0.0; outputs.plan.elements];
    let mut rest = numbers.as_mut_slice();
    for group in &outputs.plan.groups {
        let (these, others) = rest.split_at_mut(group.elements);
        instance.get(group, these)?;
        rest = others;
    }
    sink.row(span.start_s, outputs, &numbers)?;
    let steps = span.steps().unwrap_or(0);
    let mut finished =
        Finished { steps: 0, time_s: span.start_s, terminated: false, cancelled: false };
    // A product has no error that grows.
    let time = |step: u64| (span.start_s + step as f64 * span.step_s).min(span.stop_s);
    for step in 0..steps {
        if control.look(step) {
            finished.cancelled = true;
            break;
        }
        let (now_s, end_s) =
            (time(step), if step + 1 == steps { span.stop_s } else { time(step + 1) });
        let (set, given): (&[_], &[f64]) = match &mut inputs {
            Some(inputs) => {
                inputs.at(now_s);
                (&inputs.plan.groups, &inputs.numbers)
            }
            None => (&[], &[]),
        };
        let whole = (end_s - now_s - span.step_s).abs() <= 1e-9 * span.step_s;
        let step_s = if whole { span.step_s } else { end_s - now_s };
        let stepped =
            instance.exchange(set, given, now_s, step_s, &outputs.plan.groups, &mut numbers)?;
        if stepped.outcome == Outcome::Discarded && !stepped.terminate {
            return Err(SimulateError::Refused {
                fmu: instance.name().to_owned(),
                time_s: now_s,
                step_s,
                said: said(instance),
            });
        }
        finished.steps += 1;
        finished.time_s = if stepped.outcome == Outcome::Done { end_s } else { stepped.time_s };
        sink.row(finished.time_s, outputs, &numbers)?;
        if stepped.terminate {
            finished.terminated = true;
            break;
        }
    }
    instance.terminate()?;
    Ok(finished)
}

/// The last thing that an FMU said, after a colon.
pub(crate) fn said(instance: &mut dyn Instance) -> String {
    let messages = instance.messages();
    messages.last().map_or(String::new(), |message| format!(": {}", message.text.trim()))
}

#[cfg(test)]
mod tests;
