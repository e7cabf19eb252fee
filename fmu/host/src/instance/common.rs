//! The part that co-simulation and model exchange have in common: an instance with the fields `unit`,
//! `own` (with its phase) and `kept` (stored states), and a function `with_access`.

/// The functions of [`super::Instance`] that are those of the unit.
macro_rules! functions_of_unit {
    () => {
        fn name(&self) -> &str {
            &self.unit.base().name
        }

        fn description(&self) -> &Description {
            &self.unit.base().description
        }

        fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
            self.unit.get(group, values).map_err(|error| {
                crate::instance::group::of_variables(error, &self.unit.base().description, group)
            })
        }

        fn set_strings(
            &mut self,
            group: &VariableGroup,
            values: &[String],
        ) -> Result<(), InstanceError> {
            self.with_access(group, |unit| unit.set_strings(group, values))
        }

        fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
            self.unit.get_strings(group)
        }

        fn set_binaries(
            &mut self,
            group: &VariableGroup,
            values: &[Vec<u8>],
        ) -> Result<(), InstanceError> {
            self.with_access(group, |unit| unit.set_binaries(group, values))
        }

        fn get_binaries(&mut self, group: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError> {
            self.unit.get_binaries(group)
        }

        fn forget_state(&mut self, state: u64) -> Result<(), InstanceError> {
            self.kept.forget(&mut self.unit, state)
        }

        fn state_to_bytes(&mut self, state: u64) -> Result<Vec<u8>, InstanceError> {
            self.kept.save(&mut self.unit, state)
        }

        fn state_from_bytes(&mut self, bytes: &[u8]) -> Result<u64, InstanceError> {
            self.kept.load(&mut self.unit, bytes)
        }

        fn terminate(&mut self) -> Result<(), InstanceError> {
            self.expect("the end", &[Phase::Step, Phase::Event])?;
            self.unit.terminate()?;
            self.own.phase = Phase::End;
            Ok(())
        }

        fn messages(&mut self) -> Vec<FmuMessage> {
            self.unit.base().messages()
        }
    };
}
pub(crate) use functions_of_unit;

/// The order of calls by the phase, and the end of an instance when it is dropped.
macro_rules! instance_of_unit {
    ($instance:ident, $unit:ident) => {
        impl<U: $unit> $instance<U> {
            fn expect(&self, what: &str, phases: &[Phase]) -> Result<(), InstanceError> {
                if phases.contains(&self.own.phase) {
                    Ok(())
                } else {
                    Err(self.unit.base().order(what, self.own.phase.words()))
                }
            }
        }

        impl<U: $unit> Drop for $instance<U> {
            fn drop(&mut self) {
                let runs = matches!(self.own.phase, Phase::Step | Phase::Event);
                if runs && self.unit.base().condition == Condition::Sound {
                    // The instance is freed in any case, so that the answer doesn't matter.
                    let _ = self.unit.terminate();
                }
                self.kept.clear(&mut self.unit);
            }
        }
    };
}
pub(crate) use instance_of_unit;
