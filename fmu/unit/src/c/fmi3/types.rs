//! Getting and setting by type.

use super::entry::enter;
use crate::c::access::Arrays;
use crate::c::call::ok;
use crate::c::types::{Absent, Boolean as BooleanOf, Float64, Int32, Int64, Type, UInt64};
use octant_fmi::fmi3::{Boolean, Instance as Handle, Status, ValueReference, signature};

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
    ($($type:ty, $value:ty: $get_alias:ident fn $get:ident, $set_alias:ident fn $set:ident;)*) => {
        export! {$(
            /// Gets variables of the type.
            $get_alias: fn $get(
                i: Handle,
                references: *const ValueReference,
                count: usize,
                values: *mut $value,
                value_count: usize,
            ) -> Status {
                get::<$type>(i, stringify!($get), references, count, values, value_count)
            }

            /// Sets variables of the type.
            $set_alias: fn $set(
                i: Handle,
                references: *const ValueReference,
                count: usize,
                values: *const $value,
                value_count: usize,
            ) -> Status {
                set::<$type>(i, stringify!($set), references, count, values, value_count)
            }
        )*}
    };
}

types! {
    Absent<f32>, f32: GetFloat32 fn fmi3GetFloat32, SetFloat32 fn fmi3SetFloat32;
    Float64, f64: GetFloat64 fn fmi3GetFloat64, SetFloat64 fn fmi3SetFloat64;
    Absent<i8>, i8: GetInt8 fn fmi3GetInt8, SetInt8 fn fmi3SetInt8;
    Absent<u8>, u8: GetUint8 fn fmi3GetUInt8, SetUint8 fn fmi3SetUInt8;
    Absent<i16>, i16: GetInt16 fn fmi3GetInt16, SetInt16 fn fmi3SetInt16;
    Absent<u16>, u16: GetUint16 fn fmi3GetUInt16, SetUint16 fn fmi3SetUInt16;
    Int32, i32: GetInt32 fn fmi3GetInt32, SetInt32 fn fmi3SetInt32;
    Absent<u32>, u32: GetUint32 fn fmi3GetUInt32, SetUint32 fn fmi3SetUInt32;
    Int64, i64: GetInt64 fn fmi3GetInt64, SetInt64 fn fmi3SetInt64;
    UInt64, u64: GetUint64 fn fmi3GetUInt64, SetUint64 fn fmi3SetUInt64;
    BooleanOf<Boolean>, Boolean: GetBoolean fn fmi3GetBoolean, SetBoolean fn fmi3SetBoolean;
}
