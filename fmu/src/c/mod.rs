//! The C interface of FMI 2.0 and FMI 3.0.
//!
//! Thin: a function checks its arguments, enters its instance, and does there what is the same for
//! both standards and every model.
//!
//! | module | idea |
//! |---|---|
//! | [`fmi2`], [`fmi3`] | the exported functions |
//! | `call` | how every function enters an instance and leaves it; panics end here |
//! | `registry` | instances by handle; a handle is looked up, never followed |
//! | `mode` | the standards' state machines |
//! | `instance` | one instance: its life |
//! | `access`, `layout`, `types` | getting and setting variables |
//! | `clocked` | clocks, and variables that have a value at their ticks |
//! | `step` | communication steps |
//! | `state` | FMU states, kept and as bytes |
//! | `log` | messages to the importer |
//! | `models`, `token` | which models there are, and what ties a description to them |
//!
//! What is not in it: model exchange and scheduled execution (their functions are there, and refuse),
//! directional and adjoint derivatives (the models are sampled: there is nothing to differentiate),
//! derivatives of inputs and outputs, structural parameters, periodic clocks, asynchronous steps.

macro_rules! export {
    ($($(#[$doc:meta])* $alias:ident: fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)? $body:block)*) => {$(
        $(#[$doc])*
        ///
        /// # Safety
        /// Pointers have to be null, or lead to what the standard says; handles may be anything.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $kind),*) $(-> $result)? $body

        // The signature is the standard's, or this doesn't compile.
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
mod state;
mod step;
#[cfg(test)]
#[allow(unsafe_code, reason = "C functions are called")]
mod tests;
mod token;
mod types;

pub use log::CATEGORIES;
pub use mode::Standard;
pub use token::token;
