//! Steps any FMU with inputs from a file, and writes its outputs row by row: `octant fmu run`.
//!
//! Row 0 is the state after initialization. A row follows each communication step, with the inputs
//! of the step's start, as FMPy records. By [`scheduled`] execution a row follows each tick.

pub mod input;
pub mod output;
pub mod scheduled;

use input::Inputs;
use octant_base::control::Control;
use octant_base::failing::{Failing, FailureKind};
use octant_fmu_bind::settings::Starts;
use octant_fmu_host::instance::{Instance, InstanceError, StepOutcome, Stepped};
use output::{Outputs, Sink};

/// Duration and step of a run.
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
    /// True if the FMU makes steps of any length.
    pub splits: bool,
}

/// Maximum number of steps in a run: with more, the step is surely too short.
const STEPS_MAX: f64 = 1e12;

/// Reason why a run has no steps.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpanError {
    /// The run stops before it starts.
    #[error(
        "found the start {start_s} s and the stop {stop_s} s, expected a stop at or after the start"
    )]
    Stop {
        /// Start found, s.
        start_s: f64,
        /// Stop found, s.
        stop_s: f64,
    },
    /// The step is no length of time.
    #[error("found the step {step_s} s, expected a time above 0")]
    Step {
        /// Step found, s.
        step_s: f64,
    },
    /// Too many steps.
    #[error(
        "found the step {step_s} s, which makes {steps:e} steps, expected {STEPS_MAX:e} at most"
    )]
    TooMany {
        /// Step found, s.
        step_s: f64,
        /// Number of steps.
        steps: f64,
    },
}

impl Span {
    /// Number of steps.
    ///
    /// # Errors
    /// If start, stop and step contradict each other.
    pub fn steps(&self) -> Result<u64, SpanError> {
        let Self { start_s, stop_s, step_s, .. } = *self;
        if !(start_s.is_finite() && stop_s.is_finite() && stop_s >= start_s) {
            return Err(SpanError::Stop { start_s, stop_s });
        }
        if !(step_s.is_finite() && step_s > 0.0) {
            return Err(SpanError::Step { step_s });
        }
        let steps = (stop_s - start_s) / step_s;
        if steps > STEPS_MAX {
            return Err(SpanError::TooMany { step_s, steps });
        }
        // A remainder within rounding isn't a step of its own.
        let whole = steps.round();
        Ok(if (steps - whole).abs() <= 1e-9 * steps.max(1.0) { whole } else { steps.ceil() } as u64)
    }
}

/// Results of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// Steps done.
    pub steps: u64,
    /// Time reached, s.
    pub time_s: f64,
    /// True if the FMU requested the end.
    pub terminated: bool,
    /// True if the run was interrupted on request.
    pub cancelled: bool,
    /// Differences between the times that were asked for and those of the run, in words.
    pub notes: Vec<String>,
}

impl Finished {
    fn at(time_s: f64) -> Self {
        Self { steps: 0, time_s, terminated: false, cancelled: false, notes: Vec::new() }
    }
}

/// Reasons why a run was aborted.
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
        /// Message that the FMU logged, after a colon; else empty.
        said: String,
    },
    /// A clock has no time at which it could tick.
    #[error("the clock {clock} of {fmu} can't tick after {time_s} s: {reason}")]
    Clock {
        /// Name of the clock.
        clock: String,
        /// Name of the FMU.
        fmu: String,
        /// Time of the last tick, or of the start, s.
        time_s: f64,
        /// Found and expected.
        reason: String,
    },
    /// The FMU has nothing to be activated.
    #[error("{fmu} has no input clock, expected one for each model partition")]
    NoPartition {
        /// Name of the FMU.
        fmu: String,
    },
    /// The outputs can't be written.
    #[error("write the outputs: {0}")]
    Write(#[from] std::io::Error),
}

impl Failing for SimulateError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Instance(error) => error.kind_of_running(),
            Self::Refused { .. }
            | Self::Clock { .. }
            | Self::NoPartition { .. }
            | Self::Write(_) => FailureKind::Bench,
        }
    }
}

/// Steps an FMU from its start values to the end.
///
/// # Errors
/// If the FMU fails or refuses a step, or the outputs can't be written; earlier rows are kept.
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
    if let Some(inputs) = &mut inputs {
        inputs.take_as_close(1e-9 * span.step_s);
    }
    let (mut numbers, mut texts) = (vec![0.0; outputs.plan.elements], Vec::new());
    let mut rest = numbers.as_mut_slice();
    for group in &outputs.plan.groups {
        let (these, others) = rest.split_at_mut(group.elements);
        instance.get(group, these)?;
        rest = others;
    }
    outputs.read_texts(instance, &mut texts)?;
    sink.row(span.start_s, outputs, &numbers, &texts)?;
    let steps = span.steps().unwrap_or(0);
    let mut finished = Finished::at(span.start_s);
    let mut late = LateRows::default();
    // A product doesn't accumulate errors.
    let time = |step: u64| (span.start_s + step as f64 * span.step_s).min(span.stop_s);
    for step in 0..steps {
        if control.look(step) {
            finished.cancelled = true;
            break;
        }
        let (now_s, end_s) =
            (time(step), if step + 1 == steps { span.stop_s } else { time(step + 1) });
        let whole = (end_s - now_s - span.step_s).abs() <= 1e-9 * span.step_s;
        if !whole && !span.splits {
            finished.notes.push(format!(
                "the last step, from {now_s} s to {end_s} s, wasn't made: {CAN_NOT_SPLIT}, and makes steps of {} s",
                span.step_s
            ));
            break;
        }
        let ended =
            part(instance, inputs.as_deref_mut(), outputs, span, (now_s, end_s), &mut numbers)?;
        if let Some(inputs) = inputs.as_deref().filter(|_| !span.splits) {
            late.look(inputs, now_s, end_s);
        }
        finished.steps += 1;
        finished.time_s = ended.time_s;
        outputs.read_texts(instance, &mut texts)?;
        sink.row(finished.time_s, outputs, &numbers, &texts)?;
        if ended.terminate {
            finished.terminated = true;
            break;
        }
    }
    finished.notes.extend(late.told());
    instance.terminate()?;
    Ok(finished)
}

/// Reason why a step isn't split.
const CAN_NOT_SPLIT: &str = "the FMU can't vary its step (canHandleVariableCommunicationStepSize)";

/// Steps from one communication point to the next: in parts, where inputs jump between them and the
/// FMU makes steps of any length.
fn part(
    instance: &mut dyn Instance,
    mut inputs: Option<&mut Inputs>,
    outputs: &Outputs,
    span: &Span,
    (start_s, end_s): (f64, f64),
    numbers: &mut [f64],
) -> Result<Stepped, SimulateError> {
    let mut now_s = start_s;
    loop {
        let mut until_s = end_s;
        let (set, given): (&[_], &[f64]) = match &mut inputs {
            Some(inputs) => {
                inputs.at(now_s);
                if let Some(clocks) = inputs.ticks() {
                    instance.set(&clocks, &vec![1.0; clocks.elements])?;
                }
                let jump_s = inputs.jumps_between(now_s, end_s).next();
                until_s = jump_s.filter(|_| span.splits).unwrap_or(end_s);
                (&inputs.plan.groups, &inputs.numbers)
            }
            None => (&[], &[]),
        };
        let whole = (until_s - now_s - span.step_s).abs() <= 1e-9 * span.step_s;
        let step_s = if whole { span.step_s } else { until_s - now_s };
        let mut stepped =
            instance.exchange(set, given, now_s, step_s, &outputs.plan.groups, numbers)?;
        if stepped.outcome == StepOutcome::Discarded && !stepped.terminate {
            return Err(SimulateError::Refused {
                fmu: instance.name().to_owned(),
                time_s: now_s,
                step_s,
                said: octant_fmu_host::instance::said(instance),
            });
        }
        if stepped.outcome == StepOutcome::Done {
            stepped.time_s = until_s;
        }
        if stepped.terminate || until_s == end_s {
            return Ok(stepped);
        }
        now_s = until_s;
    }
}

/// Rows of inputs that an FMU gets after their time.
#[derive(Debug, Default)]
struct LateRows {
    rows: u64,
    /// Rows that another one follows before the next communication point.
    lost: u64,
    /// Time of the first one, and the point at which it arrives, s.
    first_s: Option<(f64, f64)>,
    largest_shift_s: f64,
}

impl LateRows {
    /// Looks for rows between two communication points.
    fn look(&mut self, inputs: &Inputs, now_s: f64, end_s: f64) {
        let mut rows = 0;
        for time_s in inputs.jumps_between(now_s, end_s) {
            rows += 1;
            self.first_s.get_or_insert((time_s, end_s));
            self.largest_shift_s = self.largest_shift_s.max(end_s - time_s);
        }
        self.rows += rows;
        self.lost += rows.saturating_sub(1);
    }

    fn told(&self) -> Option<String> {
        let (row_s, point_s) = self.first_s?;
        let lost = match self.lost {
            0 => String::new(),
            lost => {
                format!("; {lost} of them never, because a later one follows before that point")
            }
        };
        Some(format!(
            "{} of inputs between communication points reached the FMU at the next one, the first of {row_s} s at \
             {point_s} s, the largest shift {:.6} s: {CAN_NOT_SPLIT}{lost}",
            octant_base::number::counted(self.rows, "row", "rows"),
            self.largest_shift_s
        ))
    }
}
