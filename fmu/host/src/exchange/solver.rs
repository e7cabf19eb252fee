//! Integration of an FMU's equations: Dormand and Prince's method of order 8 with error control and
//! dense output.

use super::super::instance::InstanceError;
use super::super::instance::unit::Continuous;
use differential_equations::error::Error;
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::{DormandPrince, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;
use std::cell::{Cell, RefCell};

type Method = ExplicitRungeKutta<Ordinary, DormandPrince, f64, Vec<f64>, 8, 12, 16>;

/// Smallest relative tolerance: below it rounding dominates.
const TOLERANCE_MIN: f64 = 1e-13;

/// A solver that goes from the FMU's present time to a target, step by step.
pub(super) struct Solver {
    method: Method,
    /// True if the solver has the FMU's present state; otherwise it has to start from that.
    ready: bool,
}

/// The FMU as a right-hand side.
struct Equations<'a, U> {
    unit: RefCell<&'a mut U>,
    failed: RefCell<Option<InstanceError>>,
    /// True if a value could not be computed.
    refused: Cell<bool>,
}

impl<'a, U: Continuous> Equations<'a, U> {
    fn new(unit: &'a mut U) -> Self {
        Self { unit: RefCell::new(unit), failed: RefCell::new(None), refused: Cell::new(false) }
    }

    fn evaluate(&self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<bool, InstanceError> {
        let mut unit = self.unit.borrow_mut();
        unit.set_time(t)?;
        Ok(unit.set_states(x)? && unit.derivatives(dx)?)
    }
}

impl<U: Continuous> ODE<f64, Vec<f64>> for Equations<'_, U> {
    /// Computes the derivatives; NaN if the FMU can't, upon which the method rejects the step.
    fn diff(&self, t: f64, x: &Vec<f64>, dx: &mut Vec<f64>) {
        // A solver without an initial step tries one that isn't finite, which the FMU must not see.
        let sound = t.is_finite() && x.iter().all(|x| x.is_finite());
        if !sound || self.failed.borrow().is_some() {
            dx.fill(f64::NAN);
            return;
        }
        match self.evaluate(t, x, dx) {
            Ok(true) => {}
            Ok(false) => {
                self.refused.set(true);
                dx.fill(f64::NAN);
            }
            Err(error) => {
                self.failed.replace(Some(error));
                dx.fill(f64::NAN);
            }
        }
    }
}

impl Solver {
    /// Makes a solver with a relative tolerance, and the usual size of each state.
    pub(super) fn new(tolerance: f64, nominals: &[f64]) -> Self {
        let tolerance = tolerance.max(TOLERANCE_MIN);
        let mut method = Method::dop853().rtol(tolerance).max_steps(usize::MAX);
        method.atol = absolute(tolerance, nominals).into();
        Self { method, ready: false }
    }

    /// Changes the usual sizes of the states.
    pub(super) fn set_nominals(&mut self, tolerance: f64, nominals: &[f64]) {
        self.method.atol = absolute(tolerance.max(TOLERANCE_MIN), nominals).into();
    }

    /// Discards the history: the equations, inputs or states have jumped.
    pub(super) fn forget(&mut self) {
        self.ready = false;
    }

    /// Next step that the solver would take, s; 0: not known yet.
    pub(super) fn natural_s(&self) -> f64 {
        self.method.h()
    }

    /// Sets the next step to try, s.
    pub(super) fn set_natural(&mut self, step_s: f64) {
        self.method.set_h(step_s);
    }

    /// Tries one step towards the target; returns true if it was accepted, with its interval in
    /// [`Self::span`].
    pub(super) fn step<U: Continuous>(
        &mut self,
        unit: &mut U,
        time_s: f64,
        states: &[f64],
        target_s: f64,
    ) -> Result<bool, InstanceError> {
        let name = unit.base().name.clone();
        let cannot =
            |reason: String| InstanceError::Integration { fmu: name.clone(), time_s, reason };
        let equations = Equations::new(unit);
        if !self.ready {
            self.start(&equations, time_s, states, target_s)
                .map_err(|reason| equations.failed.take().unwrap_or_else(|| cannot(reason)))?;
        }
        let left_s = target_s - self.method.t();
        let natural_s = self.method.h();
        // The last step ends at the target, also if the natural step is slightly shorter.
        let last = natural_s >= 0.99 * left_s;
        if last {
            self.method.set_h(left_s);
        }
        let done = self.method.step(&equations);
        if let Some(error) = equations.failed.take() {
            return Err(error);
        }
        match done {
            Ok(_) => {}
            // A hint, not a failure: small steps remain correct, and their number is limited.
            Err(Error::Stiffness { .. }) => {
                self.ready = false;
                return Ok(false);
            }
            Err(error) => return Err(cannot(reason(&error))),
        }
        if matches!(self.method.status(), Status::RejectedStep) {
            let smallest_s = 8.0 * f64::EPSILON * time_s.abs().max(left_s);
            if self.method.h() < smallest_s {
                return Err(cannot(if equations.refused.get() {
                    "its equations can't be evaluated there".into()
                } else {
                    "the step that it takes is too small; there is a pole, or a jump that is no \
                     event"
                        .into()
                }));
            }
            return Ok(false);
        }
        if last && self.method.h() < natural_s {
            self.method.set_h(natural_s);
        }
        Ok(true)
    }

    /// Starts at the FMU's present state, with the last natural step.
    fn start<U: Continuous>(
        &mut self,
        equations: &Equations<U>,
        time_s: f64,
        states: &[f64],
        target_s: f64,
    ) -> Result<(), String> {
        let states = states.to_vec();
        let mut derivatives = vec![0.0; states.len()];
        equations.diff(time_s, &states, &mut derivatives);
        if !derivatives.iter().all(|value| value.is_finite()) {
            return Err("its derivatives are no numbers there".into());
        }
        let left_s = target_s - time_s;
        let natural_s = self.method.h();
        self.method.h0 = if natural_s > 0.0 { natural_s.min(left_s) } else { 0.0 };
        self.method.h_max = left_s;
        let started = self.method.init(equations, time_s, target_s, &states);
        self.method.h_max = f64::INFINITY;
        started.map_err(|error| reason(&error))?;
        if natural_s > 0.0 {
            self.method.set_h(natural_s);
        }
        self.ready = true;
        Ok(())
    }

    /// Start and end of the last accepted step, s.
    pub(super) fn span(&self) -> (f64, f64) {
        (self.method.t_prev(), self.method.t())
    }

    /// States at the end of the last accepted step.
    pub(super) fn states(&self) -> &[f64] {
        self.method.y()
    }

    /// Interpolates the states at a time within the last accepted step.
    pub(super) fn states_at(&mut self, time_s: f64, states: &mut [f64]) {
        // Times outside of the step by rounding are moved to its ends.
        let (from_s, to_s) = self.span();
        if let Ok(within) = self.method.interpolate(time_s.clamp(from_s, to_s)) {
            states.copy_from_slice(&within);
        }
    }
}

/// Absolute tolerances as proposed by the standard.
fn absolute(tolerance: f64, nominals: &[f64]) -> Vec<f64> {
    nominals.iter().map(|nominal| 0.01 * tolerance * nominal.abs().max(1e-300)).collect()
}

fn reason(error: &Error<f64, Vec<f64>>) -> String {
    match error {
        Error::BadInput { msg } | Error::LinearAlgebra { msg, .. } => msg.clone(),
        Error::StepSize { .. } => "the step that it takes is too small".into(),
        Error::MaxSteps { .. } => "it takes too many steps".into(),
        Error::Stiffness { .. } => "its equations are stiff".into(),
        _ => "the solver has no result".into(),
    }
}
