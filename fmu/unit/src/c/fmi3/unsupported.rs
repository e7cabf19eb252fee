//! Functions that are exported but that no model supports.

use super::entry::enter;
use crate::c::mode::{self, Modes, Refusal, ServedStandard};
use core::ffi::c_void;
use octant_fmi::fmi3::{
    Boolean, Instance as Handle, OK, Status, String, ValueReference, signature,
};

/// Answers for variables of a type that no model has: none of them can be got or set.
fn no_variables(
    i: Handle,
    function: &'static str,
    modes: Modes,
    count: usize,
    value_count: usize,
    of: &str,
) -> Status {
    enter(i, function, |instance| {
        instance.require(modes)?;
        if count == 0 && value_count == 0 {
            return Ok(OK);
        }
        Err(Refusal::error(format!("there are no {of}")))
    })
}

const GET: Modes = mode::get(ServedStandard::Fmi3);
/// Modes in which clocks may be read.
pub(super) const CLOCKS: Modes = Modes::of(&[mode::Mode::Initialization, mode::Mode::Event]);

/// Functions of other clocks; triggered clocks, and those with an interval in seconds, don't need
/// them.
const OTHER_CLOCKS: &str = "clocks with fractions, shifts or intervals of the importer";

const NO_STRUCTURE: &str = "there are no structural parameters";

refused! {
    mode::ALIVE, mode::NO_DERIVATIVES =>
        fmi3GetDirectionalDerivative(
            *const ValueReference, usize, *const ValueReference, usize,
            *const f64, usize, *mut f64, usize)
        fmi3GetAdjointDerivative(
            *const ValueReference, usize, *const ValueReference, usize,
            *const f64, usize, *mut f64, usize)
        fmi3GetOutputDerivatives(*const ValueReference, usize, *const i32, *mut f64, usize);
    mode::ALIVE, NO_STRUCTURE => fmi3EnterConfigurationMode();
    mode::NEVER, NO_STRUCTURE => fmi3ExitConfigurationMode();
    mode::ALIVE, mode::NO_MODEL_EXCHANGE =>
        fmi3EnterContinuousTimeMode()
        fmi3CompletedIntegratorStep(Boolean, *mut Boolean, *mut Boolean)
        fmi3SetTime(f64)
        fmi3SetContinuousStates(*const f64, usize)
        fmi3GetContinuousStateDerivatives(*mut f64, usize)
        fmi3GetEventIndicators(*mut f64, usize)
        fmi3GetContinuousStates(*mut f64, usize)
        fmi3GetNominalsOfContinuousStates(*mut f64, usize)
        fmi3GetNumberOfEventIndicators(*mut usize)
        fmi3GetNumberOfContinuousStates(*mut usize);
    mode::ALIVE, "there is no scheduled execution, only co-simulation" =>
        fmi3ActivateModelPartition(ValueReference, f64);
}

/// Exports functions for variables of types that no model has: the types of the arguments after the
/// number of value references, and `value_count` if the function has it.
macro_rules! absent {
    ($($modes:expr, $of:expr => $($name:ident($($kind:ty),* $(; $value_count:ident)?))*;)*) => {
        export! {$($(
            /// Succeeds for no variables; no model has variables of the type.
            fn $name(
                i: Handle,
                _: *const ValueReference,
                count: usize
                $(, _: $kind)*
                $(, $value_count: usize)?
            ) -> Status {
                let value_count: usize = 0 $(+ $value_count)?;
                no_variables(i, stringify!($name), $modes, count, value_count, $of)
            }
        )*)*}
    };
}

absent! {
    GET, "variables of type String" => fmi3GetString(*mut String; value_count);
    mode::SET, "variables of type String" => fmi3SetString(*const String; value_count);
    CLOCKS, OTHER_CLOCKS =>
        fmi3GetIntervalFraction(*mut u64, *mut u64, *mut i32)
        fmi3GetShiftDecimal(*mut f64)
        fmi3GetShiftFraction(*mut u64, *mut u64)
        fmi3SetIntervalDecimal(*const f64)
        fmi3SetIntervalFraction(*const u64, *const u64)
        fmi3SetShiftDecimal(*const f64)
        fmi3SetShiftFraction(*const u64, *const u64);
}
