//! Steps of the operator in a run whose unit sends on: each is asked at its time, and between two run-ups the run may stand
//! until it is answered.

use octant_base::attendance::Attendance;
use octant_base::control::Control;
use octant_faults::trigger::Trigger;
use octant_scenario::Scenario;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Steps that are still to come, and those that hold the run.
#[derive(Debug)]
pub(super) struct DueSteps<'a> {
    attendance: Option<&'a Arc<Attendance>>,
    control: &'a Control,
    /// Number, epoch, and whether the run stands until it is answered.
    waiting: Vec<(usize, u64, bool)>,
    holding: Vec<usize>,
    period: Duration,
}

impl<'a> DueSteps<'a> {
    pub(super) fn of(scenario: &Scenario, control: &'a Control) -> Self {
        let epoch = |trigger: &Trigger| match trigger {
            Trigger::Epoch(epoch) => Some(*epoch),
            // Refused when the scenario is read.
            _ => None,
        };
        let steps = scenario.operator.iter().enumerate();
        let waiting = steps
            .filter_map(|(number, step)| Some((number, epoch(step.trigger.as_ref()?)?, step.holds)))
            .collect();
        let period = Duration::from_nanos(scenario.sample_period_ns);
        Self { attendance: control.attendance.get(), control, waiting, holding: Vec::new(), period }
    }

    /// Asks what is due at a time since the first switching on.
    pub(super) fn ask(&mut self, at: Duration) {
        let period_ns = self.period.as_nanos().max(1);
        let epochs = u64::try_from(at.as_nanos() / period_ns).unwrap_or(u64::MAX);
        self.control.epochs.store(epochs, Ordering::Relaxed);
        let Some(attendance) = self.attendance else { return };
        let holding = &mut self.holding;
        self.waiting.retain(|(number, epoch, holds)| {
            // Steps of one time are asked together.
            let is_due = epochs + 1 >= *epoch;
            if is_due {
                attendance.ask(*number, *epoch);
                if *holds {
                    holding.push(*number);
                }
            }
            !is_due
        });
    }

    /// Returns whether the run stands.
    pub(super) fn hold(&mut self) -> bool {
        let Some(attendance) = self.attendance else { return false };
        self.holding.retain(|number| !attendance.is_closed(*number));
        let holds = !self.holding.is_empty();
        let sample = self.control.epochs.load(Ordering::Relaxed) + 1;
        attendance.stand(if holds { sample } else { 0 });
        holds
    }
}
