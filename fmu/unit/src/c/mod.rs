//! The C interface of FMI 2.0 and FMI 3.0.
//!
//! The functions are thin: each checks its arguments, enters its instance, and calls the
//! implementation shared by both standards and every model.
//!
//! | module | idea |
//! |---|---|
//! | [`fmi2`], [`fmi3`] | the exported functions |
//! | `call` | entry into an instance and exit from it; panics end here |
//! | `registry` | instances by handle; a handle is looked up, never followed |
//! | `mode` | the standards' state machines |
//! | `instance`, `run` | one instance: its life cycle, and its data |
//! | `access`, `layout`, `types` | getting and setting variables |
//! | `clocked`, `ticks` | clocks, and variables that have a value only at their ticks |
//! | `step` | communication steps |
//! | `state`, `snapshots` | FMU states, stored and as bytes |
//! | `log` | messages to the importer |
//! | `models`, `token` | the models, and the link between a description and its model |
//!
//! Not supported: model exchange and scheduled execution (their functions are exported, and
//! refuse), directional and adjoint derivatives (the models are sampled: there is nothing to
//! differentiate), derivatives of inputs and outputs, structural parameters, periodic clocks,
//! asynchronous steps.

macro_rules! export {
    ($($(#[$doc:meta])* $alias:ident: fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? $body:block)*) => {$(
        $(#[$doc])*
        ///
        /// # Safety
        /// Pointers have to be null, or lead to what the standard says; handles may be anything.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $kind),*) $(-> $result)? $body

        // A signature other than the standard's doesn't compile.
        const _: signature::$alias = $name;
    )*};
}

mod access;
mod call;
mod clocked;
pub mod fmi2;
pub mod fmi3;
mod instance;
mod layout;
mod log;
mod mode;
mod models;
mod registry;
mod run;
mod snapshots;
mod state;
mod step;
#[cfg(test)]
#[allow(unsafe_code, reason = "C functions are called")]
mod tests;
mod ticks;
mod token;
mod types;

pub use log::CATEGORIES;
pub use mode::ServedStandard;
pub use token::token;
