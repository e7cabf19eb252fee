//! Detection of sign changes of event indicators, on the dense output of a step.

use super::super::instance::InstanceError;
use super::super::instance::unit::Continuous;
use super::solver::Solver;

/// Points of a step at which the indicators are evaluated, its end among them: a step of a method
/// of high order is long, and an indicator can change twice within it.
const POINTS: u32 = 5;

/// The indicators, and the side of zero of each at its last evaluation.
pub(super) struct Indicators {
    values: Vec<f64>,
    above: Vec<bool>,
    states: Vec<f64>,
}

impl Indicators {
    pub(super) fn new(count: usize, states: usize) -> Self {
        Self { values: vec![0.0; count], above: vec![false; count], states: vec![0.0; states] }
    }

    /// Records the present sides: after a start or an event.
    pub(super) fn settle(&mut self, unit: &mut impl Continuous) -> Result<(), InstanceError> {
        if self.values.is_empty() {
            return Ok(());
        }
        if !unit.indicators(&mut self.values)? {
            let reason = "its event indicators can't be computed after an event";
            return Err(InstanceError::unsupported(&unit.base().name, "go on", reason));
        }
        for (above, value) in self.above.iter_mut().zip(&self.values) {
            *above = *value > 0.0;
        }
        Ok(())
    }

    /// Finds the first time within a step at which an indicator has changed its side, and leaves
    /// the FMU there. `None`: there is no such time, and the FMU is at any time within the step.
    pub(super) fn first_crossing(
        &mut self,
        unit: &mut impl Continuous,
        mut solver: Option<&mut Solver>,
        from_s: f64,
        to_s: f64,
    ) -> Result<Option<f64>, InstanceError> {
        if self.values.is_empty() {
            return Ok(None);
        }
        let mut before_s = from_s;
        for point in 1..=POINTS {
            let share = f64::from(point) / f64::from(POINTS);
            let at_s = if point == POINTS { to_s } else { from_s + share * (to_s - from_s) };
            if self.crossed(unit, solver.as_deref_mut(), at_s)? {
                return self.bisect(unit, solver, before_s, at_s).map(Some);
            }
            before_s = at_s;
        }
        Ok(None)
    }

    /// Bisects the interval of a crossing until it can't be divided further.
    fn bisect(
        &mut self,
        unit: &mut impl Continuous,
        mut solver: Option<&mut Solver>,
        mut before_s: f64,
        mut after_s: f64,
    ) -> Result<f64, InstanceError> {
        loop {
            let middle_s = before_s + 0.5 * (after_s - before_s);
            if middle_s <= before_s || middle_s >= after_s {
                // The FMU has to be on the far side of its event, otherwise it doesn't detect the
                // event.
                self.crossed(unit, solver.as_deref_mut(), after_s)?;
                return Ok(after_s);
            }
            if self.crossed(unit, solver.as_deref_mut(), middle_s)? {
                after_s = middle_s;
            } else {
                before_s = middle_s;
            }
        }
    }

    /// Brings the FMU to a time within the step; returns true if an indicator has changed its side
    /// there. If the FMU can't compute the indicators, no change is detected.
    fn crossed(
        &mut self,
        unit: &mut impl Continuous,
        solver: Option<&mut Solver>,
        at_s: f64,
    ) -> Result<bool, InstanceError> {
        unit.set_time(at_s)?;
        if let Some(solver) = solver {
            solver.states_at(at_s, &mut self.states);
            if !unit.set_states(&self.states)? {
                return Ok(false);
            }
        }
        if !unit.indicators(&mut self.values)? {
            return Ok(false);
        }
        Ok(self.values.iter().zip(&self.above).any(|(value, above)| (*value > 0.0) != *above))
    }
}
