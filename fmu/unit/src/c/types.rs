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

/// FMI 2.0: Real. Counts are whole numbers.
pub(super) struct Real2;

impl Type for Real2 {
    type Value = f64;
    const NAME: &'static str = "Real";

    #[inline]
    fn has(cell: Cell) -> bool {
        matches!(cell, Cell::Real | Cell::Count)
    }

    #[inline]
    fn get(bits: u64, cell: Cell) -> f64 {
        if cell == Cell::Real { f64::from_bits(bits) } else { bits as f64 }
    }

    #[inline]
    fn fits(value: f64, slot: &Slot) -> bool {
        if slot.cell == Cell::Real {
            return real_fits(value, slot);
        }
        let (min, max) = (slot.min.max(0.0), slot.max.min(EXACT_MAX));
        value >= min && value <= max && value as u64 as f64 == value
    }

    #[inline]
    fn set(value: f64, cell: Cell) -> u64 {
        if cell == Cell::Real { value.to_bits() } else { value as u64 }
    }
}

/// FMI 3.0: Float64.
pub(super) struct Float64;

impl Type for Float64 {
    type Value = f64;
    const NAME: &'static str = "Float64";

    #[inline]
    fn has(cell: Cell) -> bool {
        cell == Cell::Real
    }

    #[inline]
    fn get(bits: u64, _: Cell) -> f64 {
        f64::from_bits(bits)
    }

    #[inline]
    fn fits(value: f64, slot: &Slot) -> bool {
        real_fits(value, slot)
    }

    #[inline]
    fn set(value: f64, _: Cell) -> u64 {
        value.to_bits()
    }
}

/// FMI 2.0: Integer, with which enumerations are accessed, too.
pub(super) struct Integer2;

impl Type for Integer2 {
    type Value = i32;
    const NAME: &'static str = "Integer or Enumeration";

    #[inline]
    fn has(cell: Cell) -> bool {
        matches!(cell, Cell::Integer | Cell::Enumeration)
    }

    #[inline]
    fn get(bits: u64, _: Cell) -> i32 {
        bits as i32
    }

    #[inline]
    fn fits(value: i32, slot: &Slot) -> bool {
        integer_fits(value, slot)
    }

    #[inline]
    fn set(value: i32, _: Cell) -> u64 {
        i64::from(value) as u64
    }
}

/// FMI 3.0: Int32.
pub(super) struct Int32;

impl Type for Int32 {
    type Value = i32;
    const NAME: &'static str = "Int32";

    #[inline]
    fn has(cell: Cell) -> bool {
        cell == Cell::Integer
    }

    #[inline]
    fn get(bits: u64, _: Cell) -> i32 {
        bits as i32
    }

    #[inline]
    fn fits(value: i32, slot: &Slot) -> bool {
        integer_fits(value, slot)
    }

    #[inline]
    fn set(value: i32, _: Cell) -> u64 {
        i64::from(value) as u64
    }
}

/// FMI 3.0: Enumeration, which is accessed as Int64.
pub(super) struct Int64;

impl Type for Int64 {
    type Value = i64;
    const NAME: &'static str = "Int64 or Enumeration";

    #[inline]
    fn has(cell: Cell) -> bool {
        cell == Cell::Enumeration
    }

    #[inline]
    fn get(bits: u64, _: Cell) -> i64 {
        bits as i64
    }

    #[inline]
    fn fits(value: i64, slot: &Slot) -> bool {
        i32::try_from(value).is_ok_and(|value| integer_fits(value, slot))
    }

    #[inline]
    fn set(value: i64, _: Cell) -> u64 {
        value as u64
    }
}

/// FMI 3.0: UInt64.
pub(super) struct UInt64;

impl Type for UInt64 {
    type Value = u64;
    const NAME: &'static str = "UInt64";

    #[inline]
    fn has(cell: Cell) -> bool {
        cell == Cell::Count
    }

    #[inline]
    fn get(bits: u64, _: Cell) -> u64 {
        bits
    }

    #[inline]
    fn fits(value: u64, slot: &Slot) -> bool {
        (slot.min..=slot.max).contains(&(value as f64))
    }

    #[inline]
    fn set(value: u64, _: Cell) -> u64 {
        value
    }
}

/// Boolean, of 32 bits in FMI 2.0 and of 8 in FMI 3.0.
pub(super) struct Boolean<T>(PhantomData<T>);

impl<T: Copy + From<bool> + PartialEq + core::fmt::Display> Type for Boolean<T> {
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

/// A type that no variable has.
pub(super) struct Absent<T>(PhantomData<T>);

/// Names of types that no variable has.
pub(super) trait Named: Copy + PartialEq + core::fmt::Display {
    const NAME: &'static str;
}

macro_rules! named {
    ($($kind:ty: $name:literal),*) => {$(
        impl Named for $kind {
            const NAME: &'static str = $name;
        }
    )*};
}
named!(f32: "Float32", i8: "Int8", u8: "UInt8", i16: "Int16", u16: "UInt16", u32: "UInt32");

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
