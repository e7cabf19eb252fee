//! Types and function signatures of the Functional Mock-up Interface, as in C.
//!
//! [`fmi2`] is FMI 2.0 (2.0.5), [`fmi3`] is FMI 3.0 (3.0.2). There is no code here: exporter and
//! importer of the functions share these declarations, and can't disagree. Functions have the names
//! of the standard, with its prefix.
//!
//! Booleans are integers here: a value from C needn't be 0 or 1, and a Rust `bool` with any other
//! value is undefined behaviour.
#![no_std]

/// Declares the functions of a standard: a signature type for each, and a table of all that a
/// library may have. The second form takes the rows of [`fmi3_types!`] between other functions.
macro_rules! functions {
    ($($name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)?;)*) => {
        /// The signature of each function.
        #[allow(non_camel_case_types, reason = "names of the standard")]
        pub mod signature {
            #[allow(clippy::wildcard_imports, reason = "the types of the signatures")]
            use super::*;
            $(
                #[doc = concat!("`", stringify!($name), "`.")]
                pub type $name = unsafe extern "C" fn($($argument: $kind),*) $(-> $result)?;
            )*
        }

        /// The functions that a library exports.
        #[derive(Clone, Copy, Debug, Default)]
        #[allow(non_snake_case, reason = "names of the standard")]
        pub struct Functions {
            $(
                #[doc = concat!("`", stringify!($name), "`.")]
                pub $name: Option<signature::$name>,
            )*
        }

        /// Names of all functions of the standard.
        pub const NAMES: &[&str] = &[$(stringify!($name)),*];

        impl Functions {
            /// Loads the functions that `find` finds under their names.
            ///
            /// # Safety
            /// `find` has to return null, or the address of a function with the signature that the
            /// standard gives to this name; the address has to stay valid for as long as the table
            /// is used.
            #[allow(unsafe_code, reason = "an address becomes a function")]
            pub unsafe fn load(mut find: impl FnMut(&str) -> *const core::ffi::c_void) -> Self {
                Self {
                    $(
                        // SAFETY: `Option` of a function pointer is the nullable pointer, and the
                        // caller vouches for what is behind it.
                        $name: unsafe {
                            core::mem::transmute::<
                                *const core::ffi::c_void,
                                Option<signature::$name>,
                            >(find(stringify!($name)))
                        },
                    )*
                }
            }
        }
    };
    ({ $($before:tt)* } { $($after:tt)* } $($kind:ident $value:ident: $get:ident $set:ident;)*) => {
        functions! {
            $($before)*
            $(
                $get(
                    i: Instance, references: *const ValueReference, count: usize,
                    values: *mut $value, value_count: usize
                ) -> Status;
                $set(
                    i: Instance, references: *const ValueReference, count: usize,
                    values: *const $value, value_count: usize
                ) -> Status;
            )*
            $($after)*
        }
    };
}

pub mod fmi2;
pub mod fmi3;

/// `fmi2ValueReference`, `fmi3ValueReference`.
pub type ValueReference = u32;
/// `fmi2String`, `fmi3String`.
pub type String = *const core::ffi::c_char;

/// `fmi2Status`, `fmi3Status`.
pub type Status = i32;
/// `fmi2OK`, `fmi3OK`.
pub const OK: Status = 0;
/// `fmi2Warning`, `fmi3Warning`.
pub const WARNING: Status = 1;
/// `fmi2Discard`, `fmi3Discard`.
pub const DISCARD: Status = 2;
/// `fmi2Error`, `fmi3Error`.
pub const ERROR: Status = 3;
/// `fmi2Fatal`, `fmi3Fatal`.
pub const FATAL: Status = 4;
