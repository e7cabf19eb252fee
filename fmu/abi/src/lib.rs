//! Types and function signatures of the Functional Mock-up Interface, as in C.
//!
//! [`fmi2`] is FMI 2.0 (2.0.5), [`fmi3`] is FMI 3.0 (3.0.2). There is no code here: exporter and
//! importer of the functions share these declarations, and can't disagree.
//!
//! Booleans are integers here: a value from C needn't be 0 or 1, and a Rust `bool` with any other
//! value is undefined behaviour.
#![no_std]

pub mod fmi2;
pub mod fmi3;

/// Declares the functions of a standard: a signature type for each, and a table of all that a
/// library may have.
macro_rules! functions {
    ($($field:ident $name:literal: $alias:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)?;)*) => {
        /// The signature of each function, named as in the standard without its prefix.
        pub mod signature {
            #[allow(clippy::wildcard_imports, reason = "the types of the signatures")]
            use super::*;
            $(
                #[doc = concat!("`", $name, "`.")]
                pub type $alias = unsafe extern "C" fn($($argument: $kind),*) $(-> $result)?;
            )*
        }

        /// The functions that a library exports.
        #[derive(Clone, Copy, Debug, Default)]
        pub struct Functions {
            $(
                #[doc = concat!("`", $name, "`.")]
                pub $field: Option<signature::$alias>,
            )*
        }

        /// Names of all functions of the standard.
        pub const NAMES: &[&str] = &[$($name),*];

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
                        $field: unsafe {
                            core::mem::transmute::<
                                *const core::ffi::c_void,
                                Option<signature::$alias>,
                            >(find($name))
                        },
                    )*
                }
            }
        }
    };
}
use functions;
