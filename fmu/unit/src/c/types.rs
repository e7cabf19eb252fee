//! Types of the interface, and their conversion from and to cells.

use super::layout::{Cell, EXACT_MAX, Slot};
use core::marker::PhantomData;

/// Type of the interface, with its conversion from and to cells.
pub(super) trait Type {
    /// Type of an element in C.
    type Value: Copy + PartialEq + core::fmt::Display;

    /// Name of the type.
    const NAME: &'static str;

    /// Returns whether variables with such cells are of this type.
    fn has(cell: Cell) -> bool;

    /// Converts a cell to a value.
    fn get(bits: u64, cell: Cell) -> Self::Value;

    /// Returns whether a value fits.
    fn fits(value: Self::Value, slot: &Slot) -> bool;

    /// Converts a value that fits to a cell.
    fn set(value: Self::Value, cell: Cell) -> u64;
}

#[inline]
fn real_fits(value: f64, slot: &Slot) -> bool {
    (value >= slot.min && value <= slot.max) || slot.any
}

#[inline]
fn integer_fits(value: i32, slot: &Slot) -> bool {
    match slot.enumeration {
        None => (slot.min..=slot.max).contains(&f64::from(value)),
        Some(of) => of.items.iter().any(|(item, ..)| *item == value),
    }
}

/// Declares types: the name of each, its name in messages, the type of a value, the cells, and the
/// conversions.
macro_rules! types {
    ($(
        $(#[$doc:meta])*
        $name:ident $text:literal $value:ty: $cells:pat,
        get |$bits:ident, $of:pat_param| $get:expr,
        fits |$new:ident, $slot:ident| $fits:expr,
        set |$from:ident, $to:pat_param| $set:expr;
    )*) => {$(
        $(#[$doc])*
        pub(super) struct $name;

        impl Type for $name {
            type Value = $value;
            const NAME: &'static str = $text;

            #[inline]
            fn has(cell: Cell) -> bool {
                matches!(cell, $cells)
            }

            #[inline]
            fn get($bits: u64, $of: Cell) -> $value {
                $get
            }

            #[inline]
            fn fits($new: $value, $slot: &Slot) -> bool {
                $fits
            }

            #[inline]
            fn set($from: $value, $to: Cell) -> u64 {
                $set
            }
        }
    )*};
}

types! {
    /// FMI 2.0: Real. Counts are whole numbers.
    Real2 "Real" f64: Cell::Real | Cell::Count,
    get |bits, cell| if cell == Cell::Real { f64::from_bits(bits) } else { bits as f64 },
    fits |value, slot| {
        if slot.cell == Cell::Real {
            return real_fits(value, slot);
        }
        let (min, max) = (slot.min.max(0.0), slot.max.min(EXACT_MAX));
        value >= min && value <= max && value as u64 as f64 == value
    },
    set |value, cell| if cell == Cell::Real { value.to_bits() } else { value as u64 };

    /// FMI 3.0: Float64.
    Float64 "Float64" f64: Cell::Real,
    get |bits, _| f64::from_bits(bits),
    fits |value, slot| real_fits(value, slot),
    set |value, _| value.to_bits();

    /// FMI 2.0: Integer, with which enumerations are accessed, too.
    Integer2 "Integer or Enumeration" i32: Cell::Integer | Cell::Enumeration,
    get |bits, _| bits as i32,
    fits |value, slot| integer_fits(value, slot),
    set |value, _| i64::from(value) as u64;

    /// FMI 3.0: Int32.
    Int32 "Int32" i32: Cell::Integer,
    get |bits, _| bits as i32,
    fits |value, slot| integer_fits(value, slot),
    set |value, _| i64::from(value) as u64;

    /// FMI 3.0: Enumeration, which is accessed as Int64.
    Int64 "Int64 or Enumeration" i64: Cell::Enumeration,
    get |bits, _| bits as i64,
    fits |value, slot| i32::try_from(value).is_ok_and(|value| integer_fits(value, slot)),
    set |value, _| value as u64;

    /// FMI 3.0: UInt64.
    UInt64 "UInt64" u64: Cell::Count,
    get |bits, _| bits,
    fits |value, slot| (slot.min..=slot.max).contains(&(value as f64)),
    set |value, _| value;
}

/// Boolean, of 32 bits in FMI 2.0 and of 8 in FMI 3.0.
pub(super) struct BooleanOf<T>(PhantomData<T>);

impl<T: Copy + From<bool> + PartialEq + core::fmt::Display> Type for BooleanOf<T> {
    type Value = T;
    const NAME: &'static str = "Boolean";

    #[inline]
    fn has(cell: Cell) -> bool {
        cell == Cell::Boolean
    }

    #[inline]
    fn get(bits: u64, _: Cell) -> T {
        (bits != 0).into()
    }

    #[inline]
    fn fits(value: T, _: &Slot) -> bool {
        value == T::from(true) || value == T::from(false)
    }

    #[inline]
    fn set(value: T, _: Cell) -> u64 {
        u64::from(value == T::from(true))
    }
}

/// FMI 3.0: Boolean.
pub(super) type Boolean = BooleanOf<octant_fmi::fmi3::Boolean>;

/// A type that no variable has.
pub(super) struct Absent<T>(PhantomData<T>);

/// Names of types that no variable has.
pub(super) trait Named: Copy + PartialEq + core::fmt::Display {
    const NAME: &'static str;
}

macro_rules! absent {
    ($($name:ident $value:ty;)*) => {$(
        #[doc = concat!("FMI 3.0: ", stringify!($name), ".")]
        pub(super) type $name = Absent<$value>;

        impl Named for $value {
            const NAME: &'static str = stringify!($name);
        }
    )*};
}
absent! {
    Float32 f32;
    Int8 i8;
    UInt8 u8;
    Int16 i16;
    UInt16 u16;
    UInt32 u32;
}

impl<T: Named> Type for Absent<T> {
    type Value = T;
    const NAME: &'static str = T::NAME;

    fn has(_: Cell) -> bool {
        false
    }

    fn get(_: u64, _: Cell) -> T {
        unreachable!("no cell is of this type")
    }

    fn fits(_: T, _: &Slot) -> bool {
        false
    }

    fn set(_: T, _: Cell) -> u64 {
        unreachable!("no cell is of this type")
    }
}
