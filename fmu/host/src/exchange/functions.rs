//! The functions of both standards for model exchange.
#![allow(unsafe_code, reason = "functions of a library are called")]

use super::super::instance::call::{Answer, ask, call};
use super::super::instance::unit::Continuous;
use super::super::instance::{InstanceError, fmi2, fmi3};

/// The functions that differ between the standards in their names alone.
macro_rules! functions_of_both {
    (
        $enter_continuous_time_mode:ident $set_time:ident $set_states:ident $get_states:ident
        $get_derivatives:ident $get_indicators:ident $completed_step:ident
    ) => {
        fn enter_continuous_time_mode(&mut self) -> Result<(), InstanceError> {
            call!(self.$enter_continuous_time_mode())
        }

        fn set_time(&mut self, time_s: f64) -> Result<(), InstanceError> {
            call!(self.$set_time(time_s))
        }

        fn set_states(&mut self, states: &[f64]) -> Result<bool, InstanceError> {
            Ok(ask!(self.$set_states(states.as_ptr(), states.len()))? == Answer::Fine)
        }

        fn states(&mut self, states: &mut [f64]) -> Result<(), InstanceError> {
            call!(self.$get_states(states.as_mut_ptr(), states.len()))
        }

        fn derivatives(&mut self, values: &mut [f64]) -> Result<bool, InstanceError> {
            Ok(ask!(self.$get_derivatives(values.as_mut_ptr(), values.len()))? == Answer::Fine)
        }

        fn indicators(&mut self, values: &mut [f64]) -> Result<bool, InstanceError> {
            Ok(ask!(self.$get_indicators(values.as_mut_ptr(), values.len()))? == Answer::Fine)
        }

        fn completed_step(&mut self) -> Result<(bool, bool), InstanceError> {
            let (mut event, mut terminate) = (0, 0);
            let keep = (!self.restorable).into();
            call!(self.$completed_step(keep, &mut event, &mut terminate))?;
            Ok((event != 0, terminate != 0))
        }
    };
}

impl Continuous for fmi2::Component {
    functions_of_both! {
        fmi2EnterContinuousTimeMode fmi2SetTime fmi2SetContinuousStates fmi2GetContinuousStates
        fmi2GetDerivatives fmi2GetEventIndicators fmi2CompletedIntegratorStep
    }

    fn counts(&mut self) -> Result<(usize, usize), InstanceError> {
        let description = &self.base.description;
        Ok((description.structure.derivatives.len(), description.event_indicators))
    }

    fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), InstanceError> {
        // Many FMUs of older tools lack the function: then all nominals are 1.
        if self.functions.fmi2GetNominalsOfContinuousStates.is_none() {
            nominals.fill(1.0);
            return Ok(());
        }
        call!(self.fmi2GetNominalsOfContinuousStates(nominals.as_mut_ptr(), nominals.len()))
    }
}

impl Continuous for fmi3::Component {
    functions_of_both! {
        fmi3EnterContinuousTimeMode fmi3SetTime fmi3SetContinuousStates fmi3GetContinuousStates
        fmi3GetContinuousStateDerivatives fmi3GetEventIndicators fmi3CompletedIntegratorStep
    }

    /// Asks the FMU: structural parameters may have changed the numbers in the description.
    fn counts(&mut self) -> Result<(usize, usize), InstanceError> {
        let (mut states, mut indicators) = (0, 0);
        call!(self.fmi3GetNumberOfContinuousStates(&mut states))?;
        call!(self.fmi3GetNumberOfEventIndicators(&mut indicators))?;
        Ok((states, indicators))
    }

    fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), InstanceError> {
        call!(self.fmi3GetNominalsOfContinuousStates(nominals.as_mut_ptr(), nominals.len()))
    }
}
