//! Where event indicators change their sign, found on the dense output of a step.

use super::super::instance::InstanceError;
use super::super::instance::unit::Continuous;
use super::solver::Solver;

/// Points of a step at which the indicators are looked at, its end among them: a step of a method
/// of high order is long, and an indicator can go there and back within it.
const POINTS: u32 = 5;

/// The indicators, and on which side of zero each was when it was last looked at.
pub(super) struct Indicators {
    values: Vec<f64>,
    above: Vec<bool>,
    states: Vec<f64>,
}

impl Indicators {
    pub(super) fn new(count: usize, states: usize) -> Self {
        Self { values: vec![0.0; count], above: vec![false; count], states: vec![0.0; states] }
    }

    /// Takes the sides on which they are now: after a start or an event.
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

    /// The first time within a step at which an indicator is on another side than before; the FMU is
    /// then there. `None`: there is none, and the FMU is anywhere within the step.
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

    /// Halves the time in which a crossing lies until there is nothing to halve.
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
                // The FMU has to be on the far side of its event, or it doesn't see it.
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

    /// Brings the FMU to a time within the step; true: an indicator is on another side there. Where
    /// the FMU can't compute them, nothing is seen.
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
