//! The functions of FMI 3.0 for model exchange.
#![allow(unsafe_code, reason = "functions of a library are called")]

use super::super::instance::InstanceError;
use super::super::instance::call::{Answer, call};
use super::super::instance::fmi3::Component;
use super::super::instance::unit::Continuous;

impl Continuous for Component {
    /// Asks the FMU: structural parameters may have changed the numbers in the description.
    fn counts(&mut self) -> Result<(usize, usize), InstanceError> {
        let (mut states, mut indicators) = (0, 0);
        let status = call!(self.get_number_of_continuous_states "fmi3GetNumberOfContinuousStates"(
            &mut states));
        self.base.check("fmi3GetNumberOfContinuousStates", status)?;
        let status = call!(self.get_number_of_event_indicators "fmi3GetNumberOfEventIndicators"(
            &mut indicators));
        self.base.check("fmi3GetNumberOfEventIndicators", status)?;
        Ok((states, indicators))
    }

    fn enter_continuous_time_mode(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.enter_continuous_time_mode "fmi3EnterContinuousTimeMode"());
        self.base.check("fmi3EnterContinuousTimeMode", status)
    }

    fn set_time(&mut self, time_s: f64) -> Result<(), InstanceError> {
        let status = call!(self.set_time "fmi3SetTime"(time_s));
        self.base.check("fmi3SetTime", status)
    }

    fn set_states(&mut self, states: &[f64]) -> Result<bool, InstanceError> {
        let status = call!(self.set_continuous_states "fmi3SetContinuousStates"(
            states.as_ptr(), states.len()));
        Ok(self.base.answer("fmi3SetContinuousStates", status)? == Answer::Fine)
    }

    fn states(&mut self, states: &mut [f64]) -> Result<(), InstanceError> {
        let status = call!(self.get_continuous_states "fmi3GetContinuousStates"(
            states.as_mut_ptr(), states.len()));
        self.base.check("fmi3GetContinuousStates", status)
    }

    fn derivatives(&mut self, derivatives: &mut [f64]) -> Result<bool, InstanceError> {
        let status = call!(self.get_continuous_state_derivatives "fmi3GetContinuousStateDerivatives"(
                derivatives.as_mut_ptr(), derivatives.len()));
        Ok(self.base.answer("fmi3GetContinuousStateDerivatives", status)? == Answer::Fine)
    }

    fn indicators(&mut self, indicators: &mut [f64]) -> Result<bool, InstanceError> {
        let status = call!(self.get_event_indicators "fmi3GetEventIndicators"(
            indicators.as_mut_ptr(), indicators.len()));
        Ok(self.base.answer("fmi3GetEventIndicators", status)? == Answer::Fine)
    }

    fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), InstanceError> {
        let status = call!(self.get_nominals_of_continuous_states "fmi3GetNominalsOfContinuousStates"(
                nominals.as_mut_ptr(), nominals.len()));
        self.base.check("fmi3GetNominalsOfContinuousStates", status)
    }

    fn completed_step(&mut self) -> Result<(bool, bool), InstanceError> {
        let (mut event, mut terminate) = (0, 0);
        let keep = u8::from(!self.restorable);
        let status = call!(self.completed_integrator_step "fmi3CompletedIntegratorStep"(
            keep, &mut event, &mut terminate));
        self.base.check("fmi3CompletedIntegratorStep", status)?;
        Ok((event != 0, terminate != 0))
    }
}
