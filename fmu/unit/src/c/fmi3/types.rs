//! Getting and setting by type.

use super::entry::enter;
use crate::c::access::Arrays;
use crate::c::call::ok;
use crate::c::types::{self as c, Type};
use octant_fmi::fmi3::{Boolean, Instance as Handle, Status, ValueReference, signature};
use octant_fmi::fmi3_types;

fn get<T: Type>(
    i: Handle,
    function: &'static str,
    references: *const ValueReference,
    count: usize,
    values: *mut T::Value,
    value_count: usize,
) -> Status {
    enter(i, function, |instance| {
        ok(instance.get::<T, true>(Arrays { references, count, values, value_count }))
    })
}

fn set<T: Type>(
    i: Handle,
    function: &'static str,
    references: *const ValueReference,
    count: usize,
    values: *const T::Value,
    value_count: usize,
) -> Status {
    enter(i, function, |instance| {
        ok(instance.set::<T, true>(Arrays { references, count, values, value_count }))
    })
}

macro_rules! types {
    ($($type:ident $value:ident: $get:ident $set:ident;)*) => {
        export! {$(
            /// Gets variables of the type.
            fn $get(
                i: Handle,
                references: *const ValueReference,
                count: usize,
                values: *mut $value,
                value_count: usize,
            ) -> Status {
                get::<c::$type>(i, stringify!($get), references, count, values, value_count)
            }

            /// Sets variables of the type.
            fn $set(
                i: Handle,
                references: *const ValueReference,
                count: usize,
                values: *const $value,
                value_count: usize,
            ) -> Status {
                set::<c::$type>(i, stringify!($set), references, count, values, value_count)
            }
        )*}
    };
}
fmi3_types!(types);
