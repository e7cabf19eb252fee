//! The functions of FMI 2.0 for model exchange.
#![allow(unsafe_code, reason = "functions of a library are called")]

use super::super::instance::InstanceError;
use super::super::instance::call::{Answer, call};
use super::super::instance::fmi2::Component;
use super::super::instance::unit::Continuous;
use octant_fmi::fmi2;

impl Continuous for Component {
    fn counts(&mut self) -> Result<(usize, usize), InstanceError> {
        let description = &self.base.description;
        Ok((description.structure.derivatives.len(), description.event_indicators))
    }

    fn enter_continuous_time_mode(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.enter_continuous_time_mode "fmi2EnterContinuousTimeMode"());
        self.base.check("fmi2EnterContinuousTimeMode", status)
    }

    fn set_time(&mut self, time_s: f64) -> Result<(), InstanceError> {
        let status = call!(self.set_time "fmi2SetTime"(time_s));
        self.base.check("fmi2SetTime", status)
    }

    fn set_states(&mut self, states: &[f64]) -> Result<bool, InstanceError> {
        let status = call!(self.set_continuous_states "fmi2SetContinuousStates"(
            states.as_ptr(), states.len()));
        Ok(self.base.answer("fmi2SetContinuousStates", status)? == Answer::Fine)
    }

    fn states(&mut self, states: &mut [f64]) -> Result<(), InstanceError> {
        let status = call!(self.get_continuous_states "fmi2GetContinuousStates"(
            states.as_mut_ptr(), states.len()));
        self.base.check("fmi2GetContinuousStates", status)
    }

    fn derivatives(&mut self, derivatives: &mut [f64]) -> Result<bool, InstanceError> {
        let status = call!(self.get_derivatives "fmi2GetDerivatives"(
            derivatives.as_mut_ptr(), derivatives.len()));
        Ok(self.base.answer("fmi2GetDerivatives", status)? == Answer::Fine)
    }

    fn indicators(&mut self, indicators: &mut [f64]) -> Result<bool, InstanceError> {
        let status = call!(self.get_event_indicators "fmi2GetEventIndicators"(
            indicators.as_mut_ptr(), indicators.len()));
        Ok(self.base.answer("fmi2GetEventIndicators", status)? == Answer::Fine)
    }

    fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), InstanceError> {
        // Many FMUs of older tools lack the function: then all nominals are 1.
        if self.functions.get_nominals_of_continuous_states.is_none() {
            nominals.fill(1.0);
            return Ok(());
        }
        let status = call!(self.get_nominals_of_continuous_states "fmi2GetNominalsOfContinuousStates"(
                nominals.as_mut_ptr(), nominals.len()));
        self.base.check("fmi2GetNominalsOfContinuousStates", status)
    }

    fn completed_step(&mut self) -> Result<(bool, bool), InstanceError> {
        let (mut event, mut terminate) = (fmi2::FALSE, fmi2::FALSE);
        let keep = i32::from(!self.restorable);
        let status = call!(self.completed_integrator_step "fmi2CompletedIntegratorStep"(
            keep, &mut event, &mut terminate));
        self.base.check("fmi2CompletedIntegratorStep", status)?;
        Ok((event != fmi2::FALSE, terminate != fmi2::FALSE))
    }
}
