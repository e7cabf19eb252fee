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
//! | `room` | room on the stack, where an importer's thread has little |
//! | `models`, `token` | the models, and the link between a description and its model |
//!
//! Not supported: model exchange and scheduled execution (their functions are exported, and
//! refuse), directional and adjoint derivatives (the models are sampled: there is nothing to
//! differentiate), derivatives of inputs and outputs, structural parameters, periodic clocks,
//! asynchronous steps.

/// Exports functions of a standard.
macro_rules! export {
    ($($(#[$doc:meta])* fn $name:ident($($argument:tt: $kind:ty),* $(,)?) $(-> $result:ty)? $body:block)*) => {$(
        $(#[$doc])*
        ///
        /// # Safety
        /// Pointers have to be null, or lead to what the standard says; handles may be anything.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $kind),*) $(-> $result)? $body

        // A signature other than the standard's doesn't compile.
        const _: signature::$name = $name;
    )*};
}

/// Exports the functions that differ between the standards in their names and types alone. The
/// types, `FALSE` and `enter` are those of the module that calls the macro.
macro_rules! functions_of_both {
    (
        $free_instance:ident $set_debug_logging:ident
        $exit_initialization:ident $terminate:ident $reset:ident
        $get_state:ident $set_state:ident $free_state:ident
        $state_size:ident $serialize:ident $deserialize:ident($byte:ty)
    ) => {
        export! {
            /// Ends an instance.
            fn $free_instance(handle: *mut c_void) {
                free(handle, STANDARD);
            }

            /// Switches categories of messages.
            fn $set_debug_logging(
                handle: *mut c_void,
                on: Boolean,
                count: usize,
                categories: *const String,
            ) -> Status {
                enter(handle, stringify!($set_debug_logging), |instance| {
                    // SAFETY: null, or so many strings.
                    unsafe { instance.set_debug_logging(on != FALSE, count, categories) }
                })
            }

            /// Ends the initialization: the model is made from its parameters.
            fn $exit_initialization(handle: *mut c_void) -> Status {
                enter(handle, stringify!($exit_initialization), |instance| {
                    ok(instance.exit_initialization())
                })
            }

            /// Ends the simulation.
            fn $terminate(handle: *mut c_void) -> Status {
                enter(handle, stringify!($terminate), |instance| ok(instance.terminate()))
            }

            /// Returns to the state after instantiation.
            fn $reset(handle: *mut c_void) -> Status {
                enter(handle, stringify!($reset), |instance| ok(instance.reset()))
            }

            /// Stores the state.
            fn $get_state(handle: *mut c_void, state: *mut State) -> Status {
                enter(handle, stringify!($get_state), |instance| ok(instance.get_state(state)))
            }

            /// Continues from a stored state.
            fn $set_state(handle: *mut c_void, state: State) -> Status {
                enter(handle, stringify!($set_state), |instance| ok(instance.set_state(state)))
            }

            /// Frees a stored state.
            fn $free_state(handle: *mut c_void, state: *mut State) -> Status {
                enter(handle, stringify!($free_state), |instance| ok(instance.free_state(state)))
            }

            /// Returns the number of bytes of a stored state.
            fn $state_size(handle: *mut c_void, state: State, size: *mut usize) -> Status {
                enter(handle, stringify!($state_size), |instance| {
                    ok(put(size, instance.state_bytes(state)?.len(), "the size"))
                })
            }

            /// Writes a stored state as bytes.
            fn $serialize(
                handle: *mut c_void, state: State, bytes: *mut $byte, size: usize,
            ) -> Status {
                enter(handle, stringify!($serialize), |instance| {
                    ok(instance.serialize_state(state, bytes.cast(), size))
                })
            }

            /// Stores a state given as bytes.
            fn $deserialize(
                handle: *mut c_void, bytes: *const $byte, size: usize, state: *mut State,
            ) -> Status {
                enter(handle, stringify!($deserialize), |instance| {
                    ok(instance.deserialize_state(bytes.cast(), size, state))
                })
            }
        }
    };
}

/// Exports functions that no model supports: the modes in which a call is answered, the reason, and
/// the functions with the types of their arguments.
macro_rules! refused {
    ($($modes:expr, $why:expr => $($name:ident($($kind:ty),*))*;)*) => {
        export! {$($(
            /// Not available: answered with an error.
            fn $name(handle: *mut c_void $(, _: $kind)*) -> Status {
                enter(handle, stringify!($name), |instance| {
                    instance.require($modes)?;
                    Err(Refusal::error($why))
                })
            }
        )*)*}
    };
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
mod room;
mod run;
mod state;
mod step;
mod ticks;
mod token;
mod types;

pub use log::CATEGORIES;
pub use mode::ServedStandard;
pub use token::{fnv_1a, token};

// For tests with a model of their own, which the library doesn't list.
#[doc(hidden)]
pub use call::instance_of;
#[doc(hidden)]
pub use instance::InstanceOptions;
#[doc(hidden)]
pub use models::Maker;
