//! Steps: time is an integer number of sample periods, and the importer's time is checked against it.

use super::instance::Instance;
use super::mode::{self, Mode, Refusal};

/// Largest distance of a communication step from a whole number of sample periods, in sample
/// periods: far more than rounding, far less than any intention.
const STEP_TOLERANCE: f64 = 1e-6;

/// Largest difference of two times of an event-driven model that count as equal, s.
const TIME_TOLERANCE_S: f64 = 1e-9;

/// A step that was accepted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Agreed {
    /// Number of sample periods; 0: only time advances.
    pub periods: u64,
}

impl Instance {
    /// Time of a tick, s.
    #[inline]
    fn tick_s(&self, tick: u64) -> f64 {
        self.run.experiment.start_s + tick as f64 * self.period_s()
    }

    #[inline]
    pub(super) fn period_s(&self) -> f64 {
        self.period_ns() as f64 * 1e-9
    }

    #[inline]
    fn period_ns(&self) -> u64 {
        self.run.component.as_ref().map_or(1, |component| component.period_ns())
    }

    /// Time of the next event, which is the next sample; for an event-driven model its clocks
    /// decide.
    pub(super) fn next_event_s(&self) -> Option<f64> {
        (!self.model().is_event_driven()).then(|| self.tick_s(self.run.tick + 1))
    }

    /// Checks whether a step from `time_s` by `step_s` is possible; nothing is changed.
    #[inline]
    pub(super) fn agree(&self, time_s: f64, step_s: f64) -> Result<Agreed, Refusal> {
        self.require(mode::STEP)?;
        let period_s = self.period_s();
        let (least, most) = self.model().periods_per_step;
        if !(step_s > 0.0 && step_s.is_finite()) {
            return Err(Refusal::error(format!(
                "the communication step is {step_s} s, a positive number is expected"
            )));
        }
        let found = step_s / period_s;
        // The cast saturates; a length beyond any number of periods is then far from it.
        let periods = (found + 0.5) as u64;
        if !((found - periods as f64).abs() <= STEP_TOLERANCE && (least..=most).contains(&periods))
        {
            return self.agree_to_any(time_s, step_s);
        }
        let own_s = self.tick_s(self.run.tick);
        if !((time_s - own_s).abs() <= 0.5 * period_s) {
            return Err(Refusal::discard(format!(
                "the communication point is {time_s} s, the model is at {own_s} s"
            )));
        }
        if let Some(stop_s) = self.run.experiment.stop_s {
            let end_s = self.tick_s(self.run.tick + periods);
            if end_s > stop_s + 0.5 * period_s {
                return Err(Refusal::error(format!(
                    "the step ends at {end_s} s, after the stop time of {stop_s} s"
                )));
            }
        }
        Ok(Agreed { periods })
    }

    /// Accepts a step of any length for an event-driven model.
    #[cold]
    fn agree_to_any(&self, time_s: f64, step_s: f64) -> Result<Agreed, Refusal> {
        if !self.model().is_event_driven() {
            return Err(self.wrong_step(step_s));
        }
        let own_s = self.time_s();
        // Sums in another order differ in the last bits.
        let tolerance_s = TIME_TOLERANCE_S.max(own_s.abs() * 4.0 * f64::EPSILON);
        if !((time_s - own_s).abs() <= tolerance_s) {
            return Err(Refusal::discard(format!(
                "the communication point is {time_s} s, the model is at {own_s} s"
            )));
        }
        let end_s = time_s + step_s;
        if !end_s.is_finite() {
            return Err(Refusal::discard(format!("the step ends at {end_s} s")));
        }
        if let Some(stop_s) = self.run.experiment.stop_s
            && end_s > stop_s + tolerance_s
        {
            return Err(Refusal::error(format!(
                "the step ends at {end_s} s, after the stop time of {stop_s} s"
            )));
        }
        Ok(Agreed { periods: 0 })
    }

    /// Advances the time of an event-driven model. Returns true if the model wants to send and the
    /// importer handles events.
    pub(super) fn step_to(&mut self, time_s: f64) -> bool {
        self.set_time(time_s);
        let due_s = self.due_s();
        self.options.event_mode_used && due_s.is_some_and(|due_s| due_s <= time_s)
    }

    #[cold]
    fn wrong_step(&self, step_s: f64) -> Refusal {
        let period_s = self.period_s();
        let expected = match self.model().periods_per_step {
            (1, 1) => format!("the sample period of {period_s} s is expected"),
            (1, most) => format!(
                "a whole number of sample periods of {period_s} s is expected, {most} of them at most"
            ),
            (least, most) => format!(
                "a whole number of sample periods of {period_s} s, {least} to {most} of them, is \
                 expected"
            ),
        };
        let expected = format!("{expected}: {}", settings(period_s));
        let reason = format!("the communication step is {step_s} s, {expected}");
        Refusal { always_said: true, ..Refusal::discard(reason) }
    }

    /// Makes one sample period, the first or a further one of a communication step. Returns true if outputs have changed and the importer handles
    /// events.
    #[inline]
    pub(super) fn step_period(&mut self, is_first: bool) -> Result<bool, Refusal> {
        if self.options.event_mode_used {
            return self.step_watched(is_first);
        }
        self.advance(is_first)?;
        Ok(false)
    }

    /// Makes a period and finds out whether outputs have changed.
    fn step_watched(&mut self, is_first: bool) -> Result<bool, Refusal> {
        let outputs = &self.layout().outputs;
        let mut before = core::mem::take(&mut self.before);
        before.clear();
        before.extend(outputs.iter().map(|slot| self.run.values.cells()[*slot as usize]));
        let advanced = self.advance(is_first);
        let cells = self.run.values.cells();
        let changed =
            outputs.iter().zip(&before).any(|(slot, before)| cells[*slot as usize] != *before);
        self.before = before;
        advanced.map(|()| changed)
    }

    #[inline]
    fn advance(&mut self, is_first: bool) -> Result<(), Refusal> {
        let Some(component) = &mut self.run.component else {
            return Err(Refusal::error("the instance has not been initialized"));
        };
        let stepped = match is_first {
            true => component.step(&mut self.run.values),
            false => component.step_further(&mut self.run.values),
        };
        stepped.map_err(Refusal::discard)?;
        self.run.tick += 1;
        self.set_time(self.tick_s(self.run.tick));
        self.remark();
        Ok(())
    }

    /// Marks a discarded step in FMI 2.0, after which only a stored state can be continued.
    pub(super) fn step_failed(&mut self, refusal: &Refusal) {
        self.run.mode = Mode::StepFailed;
        self.step_refused.clone_from(&refusal.reason);
    }
}

/// Names the settings that give the communication step in tools whose own step is another.
fn settings(period_s: f64) -> String {
    format!(
        "output_interval={period_s} in FMPy, --output-interval {period_s} in fmusim, communication step size {period_s} \
         in Simulink, --stepSize={period_s} in OMSimulator"
    )
}
