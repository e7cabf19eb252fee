//! Codes that the functions return.

use core::ffi::CStr;

/// Declares the codes: name, value and text.
macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident $value:literal $text:literal;)*) => {
        $($(#[$doc])* pub const $name: i32 = $value;)*

        /// Text of a code.
        #[must_use]
        pub const fn text(code: i32) -> &'static CStr {
            match code {
                $($value => $text,)*
                _ => c"no code of this library",
            }
        }

        /// All codes with their names in the header.
        pub const ALL: &[(&str, i32)] = &[$((concat!("OCTANT_", stringify!($name)), $value)),*];
    };
}

codes! {
    /// Done.
    OK 0 c"done";
    /// A pointer is null.
    NULL 1 c"a pointer is null";
    /// The memory is too small, or its address no multiple of the alignment.
    MEMORY 2 c"the memory is too small, or its address is not a multiple of the alignment";
    /// A pointer leads to no core.
    NO_CORE 3 c"the pointer does not lead to a core";
    /// A field of a structure that has named values has another one.
    NO_ITEM 4 c"a field with named values has another value";
    /// The stops are no sequence.
    SEQUENCE 5 c"the stops are not a sequence";
    /// The configuration contradicts itself, or changes what can't change.
    CONFIG 6 c"the configuration contradicts itself, or changes what can not change";
    /// The bytes are no state of this version.
    STATE 7 c"the bytes are not a state of this version";
    /// The buffer is too small.
    ROOM 8 c"the buffer is too small";
}
