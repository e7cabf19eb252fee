//! Functions that are exported but that no model supports.

use super::entry::enter;
use crate::c::mode::{self, Modes, Refusal, ServedStandard};
use octant_fmi::fmi3::{
    Boolean, Instance as Handle, OK, Status, String, ValueReference, signature,
};

/// Answers with an error.
fn refuse(i: Handle, function: &'static str, modes: Modes, why: &str) -> Status {
    enter(i, function, |instance| {
        instance.require(modes)?;
        Err(Refusal::error(why))
    })
}

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

const NO_DERIVATIVES: &str = "the model is sampled: its variables have no derivatives";
const NO_STRUCTURE: &str = "there are no structural parameters";
const NO_MODEL_EXCHANGE: &str = "there is no model exchange, only co-simulation";

macro_rules! refused {
    ($($modes:expr, $why:expr; $alias:ident: fn $name:ident($($argument:ident: $kind:ty),* $(,)?);)*) => {
        export! {$(
            /// Not available: answered with an error.
            $alias: fn $name(i: Handle $(, $argument: $kind)*) -> Status {
                $(let _ = $argument;)*
                refuse(i, stringify!($name), $modes, $why)
            }
        )*}
    };
}

refused! {
    mode::ALIVE, NO_DERIVATIVES; GetDirectionalDerivative: fn fmi3GetDirectionalDerivative(
        unknowns: *const ValueReference,
        unknown_count: usize,
        knowns: *const ValueReference,
        known_count: usize,
        seed: *const f64,
        seed_count: usize,
        sensitivity: *mut f64,
        sensitivity_count: usize,
    );
    mode::ALIVE, NO_DERIVATIVES; GetAdjointDerivative: fn fmi3GetAdjointDerivative(
        unknowns: *const ValueReference,
        unknown_count: usize,
        knowns: *const ValueReference,
        known_count: usize,
        seed: *const f64,
        seed_count: usize,
        sensitivity: *mut f64,
        sensitivity_count: usize,
    );
    mode::ALIVE, NO_DERIVATIVES; GetOutputDerivatives: fn fmi3GetOutputDerivatives(
        references: *const ValueReference,
        count: usize,
        orders: *const i32,
        values: *mut f64,
        value_count: usize,
    );
    mode::ALIVE, NO_STRUCTURE; EnterConfigurationMode: fn fmi3EnterConfigurationMode();
    mode::NEVER, NO_STRUCTURE; ExitConfigurationMode: fn fmi3ExitConfigurationMode();
    mode::ALIVE, NO_MODEL_EXCHANGE; EnterContinuousTimeMode: fn fmi3EnterContinuousTimeMode();
    mode::ALIVE, NO_MODEL_EXCHANGE; CompletedIntegratorStep: fn fmi3CompletedIntegratorStep(
        no_set_prior: Boolean,
        enter_event_mode: *mut Boolean,
        terminate: *mut Boolean,
    );
    mode::ALIVE, NO_MODEL_EXCHANGE; SetTime: fn fmi3SetTime(time: f64);
    mode::ALIVE, NO_MODEL_EXCHANGE; SetContinuousStates: fn fmi3SetContinuousStates(
        states: *const f64, count: usize,
    );
    mode::ALIVE, NO_MODEL_EXCHANGE; GetContinuousStateDerivatives:
        fn fmi3GetContinuousStateDerivatives(derivatives: *mut f64, count: usize);
    mode::ALIVE, NO_MODEL_EXCHANGE; GetEventIndicators: fn fmi3GetEventIndicators(
        indicators: *mut f64, count: usize,
    );
    mode::ALIVE, NO_MODEL_EXCHANGE; GetContinuousStates: fn fmi3GetContinuousStates(
        states: *mut f64, count: usize,
    );
    mode::ALIVE, NO_MODEL_EXCHANGE; GetNominalsOfContinuousStates:
        fn fmi3GetNominalsOfContinuousStates(nominals: *mut f64, count: usize);
    mode::ALIVE, NO_MODEL_EXCHANGE; GetNumberOfEventIndicators: fn fmi3GetNumberOfEventIndicators(
        count: *mut usize,
    );
    mode::ALIVE, NO_MODEL_EXCHANGE; GetNumberOfContinuousStates:
        fn fmi3GetNumberOfContinuousStates(count: *mut usize);
    mode::ALIVE, "there is no scheduled execution, only co-simulation"; ActivateModelPartition:
        fn fmi3ActivateModelPartition(clock: ValueReference, activation_time: f64);
}

macro_rules! absent {
    ($($modes:expr, $of:expr, $count:ident $(, $value_count:ident)?; $alias:ident: fn $name:ident($($argument:ident: $kind:ty),* $(,)?);)*) => {
        export! {$(
            /// Succeeds for no variables; no model has variables of the type.
            $alias: fn $name(i: Handle $(, $argument: $kind)*) -> Status {
                $(let _ = $argument;)*
                let value_count: usize = 0 $(+ $value_count)?;
                no_variables(i, stringify!($name), $modes, $count, value_count, $of)
            }
        )*}
    };
}

absent! {
    GET, "variables of type String", count, value_count; GetString: fn fmi3GetString(
        references: *const ValueReference, count: usize, values: *mut String, value_count: usize,
    );
    mode::SET, "variables of type String", count, value_count; SetString: fn fmi3SetString(
        references: *const ValueReference, count: usize, values: *const String, value_count: usize,
    );
    CLOCKS, OTHER_CLOCKS, count; GetIntervalFraction: fn fmi3GetIntervalFraction(
        references: *const ValueReference,
        count: usize,
        counters: *mut u64,
        resolutions: *mut u64,
        qualifiers: *mut i32,
    );
    CLOCKS, OTHER_CLOCKS, count; GetShiftDecimal: fn fmi3GetShiftDecimal(
        references: *const ValueReference, count: usize, shifts: *mut f64,
    );
    CLOCKS, OTHER_CLOCKS, count; GetShiftFraction: fn fmi3GetShiftFraction(
        references: *const ValueReference,
        count: usize,
        counters: *mut u64,
        resolutions: *mut u64,
    );
    CLOCKS, OTHER_CLOCKS, count; SetIntervalDecimal: fn fmi3SetIntervalDecimal(
        references: *const ValueReference, count: usize, intervals: *const f64,
    );
    CLOCKS, OTHER_CLOCKS, count; SetIntervalFraction: fn fmi3SetIntervalFraction(
        references: *const ValueReference,
        count: usize,
        counters: *const u64,
        resolutions: *const u64,
    );
    CLOCKS, OTHER_CLOCKS, count; SetShiftDecimal: fn fmi3SetShiftDecimal(
        references: *const ValueReference, count: usize, shifts: *const f64,
    );
    CLOCKS, OTHER_CLOCKS, count; SetShiftFraction: fn fmi3SetShiftFraction(
        references: *const ValueReference,
        count: usize,
        counters: *const u64,
        resolutions: *const u64,
    );
}
