//! A person who attends to a run: steps that are due are told to the desk, and a run that is held stands still.
//!
//! A run that stands exchanges nothing and computes nothing, so the bits of its samples are those of a run in which nobody
//! was asked. Only host time passes; a device hears that its harness is alive.

use super::ended::RunError;
use super::error::SetupError;
use octant_base::attendance::Attendance;
use octant_base::control::Control;
use octant_endpoint::Endpoint;
use octant_faults::TriggerOnce;
use octant_sample::Output;
use octant_scenario::{Method, Scenario};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Pause between two looks of a run that stands.
const LOOK: Duration = Duration::from_millis(5);

/// Steps of a run that are still to come, and those that hold it.
#[derive(Debug)]
pub(crate) struct Attended<'a> {
    attendance: &'a Attendance,
    control: &'a Control,
    waiting: Vec<WaitingStep>,
    /// Numbers of the steps that hold the run.
    holding: Vec<usize>,
}

#[derive(Debug)]
struct WaitingStep {
    number: usize,
    holds: bool,
    trigger: TriggerOnce,
}

impl<'a> Attended<'a> {
    /// Makes that of a run; `None`: nobody attends to it. Steps belong to the first method.
    pub(crate) fn of(scenario: &Scenario, method: Method, control: &'a Control) -> Option<Self> {
        let attendance = control.attendance.get()?;
        let steps = if method == Method::Primary { &*scenario.operator } else { &[] };
        let waiting: Vec<WaitingStep> = steps
            .iter()
            .enumerate()
            .filter_map(|(number, step)| {
                let trigger = TriggerOnce::new(step.trigger.clone()?);
                Some(WaitingStep { number, holds: step.holds, trigger })
            })
            .collect();
        let holding = Vec::with_capacity(waiting.len());
        Some(Self { attendance, control, waiting, holding })
    }

    /// Tells the desk which steps are due before the next epoch. Takes no lock and allocates nothing.
    pub(crate) fn tell(&mut self, done: u64, output: &Output) {
        let (sample, attendance, holding) = (done + 1, self.attendance, &mut self.holding);
        self.waiting.retain_mut(|step| {
            let is_due = step.trigger.comes_true(sample, output);
            if is_due {
                attendance.ask(step.number, sample);
                if step.holds {
                    holding.push(step.number);
                }
            }
            !is_due
        });
    }

    /// Tells the desk which steps are due before the next epoch, and stands still while the run is held; true if the run
    /// is to end.
    pub(crate) fn stand<E: Endpoint + ?Sized>(
        &mut self,
        done: u64,
        output: &Output,
        endpoint: &mut E,
    ) -> Result<bool, RunError> {
        self.tell(done, output);
        let mut stood = false;
        loop {
            self.holding.retain(|step| !self.attendance.is_closed(*step));
            if self.holding.is_empty() && !self.attendance.is_held() {
                break;
            }
            if !std::mem::replace(&mut stood, true) {
                self.attendance.stand(done + 1);
            }
            if self.control.cancel.load(Ordering::Relaxed) {
                return Ok(true);
            }
            endpoint.idle()?;
            std::thread::sleep(LOOK);
        }
        if stood {
            self.attendance.stand(0);
        }
        Ok(false)
    }
}

/// Waits until the steps before the start have their answers; false if the run is to end before it begins.
///
/// # Errors
/// If the scenario has steps, and nobody attends to the run.
pub(crate) fn before_start(scenario: &Scenario, control: &Control) -> Result<bool, SetupError> {
    let Some(first) = scenario.operator.first() else { return Ok(true) };
    let Some(attendance) = control.attendance.get() else {
        return Err(SetupError::Unattended { id: first.id.clone() });
    };
    let of_start = |number: &usize| scenario.operator[*number].trigger.is_none();
    let mut open: Vec<usize> = (0..scenario.operator.len()).filter(of_start).collect();
    open.iter().for_each(|number| attendance.ask(*number, 0));
    loop {
        if control.cancel.load(Ordering::Relaxed) {
            return Ok(false);
        }
        open.retain(|number| !attendance.is_closed(*number));
        if open.is_empty() {
            return Ok(true);
        }
        std::thread::sleep(LOOK);
    }
}
