//! Getting and setting variables: one way for both standards.

#![allow(unsafe_code, reason = "the importer's arrays are read and written")]

use super::instance::Instance;
use super::layout::{Cell, EXACT_MAX, Settable, Slot};
use super::mode::{self, Mode, Refusal};
use core::marker::PhantomData;

/// A type of the interface, and what it does with cells.
pub(super) trait Type {
    /// What an element is in C.
    type Value: Copy + PartialEq + core::fmt::Display;

    /// Name of the type.
    const NAME: &'static str;

    /// Whether variables with such cells are of this type.
    fn has(cell: Cell) -> bool;

    /// The value of a cell.
    fn get(bits: u64, cell: Cell) -> Self::Value;

    /// Whether a value fits.
    fn fits(value: Self::Value, slot: &Slot) -> bool;

    /// The cell for a value that fits.
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

/// FMI 2.0: Integer, which enumerations are accessed by, too.
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

/// A type of which there are no variables here.
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

/// How value references count: by element in FMI 2.0, by variable in FMI 3.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Counting {
    Elements,
    Variables,
}

/// Arrays of the importer: value references, and where the values are.
pub(super) struct Arrays<V> {
    pub references: *const u32,
    pub count: usize,
    pub values: V,
    /// Length of the values in FMI 3.0; in FMI 2.0 there are as many as references.
    pub value_count: usize,
    pub counting: Counting,
}

impl<V> Arrays<V> {
    /// Refuses arrays that are missing, or longer than all variables together.
    fn check(&self, missing: bool, slots: usize) -> Result<(), Refusal> {
        if self.count > 0 && self.references.is_null() {
            return Err(Refusal::error("the value references are a null pointer"));
        }
        if missing && (self.value_count > 0 || self.count > 0) {
            return Err(Refusal::error("the values are a null pointer"));
        }
        if self.count > slots || self.value_count > slots {
            let (count, values) = (self.count, self.value_count);
            return Err(Refusal::error(format!(
                "{count} value references and {values} values are more than the model has"
            )));
        }
        Ok(())
    }

    #[inline]
    fn reference(&self, i: usize) -> usize {
        // SAFETY: `check` has seen that the array is there; the importer vouches for its length.
        unsafe { self.references.add(i).read_unaligned() as usize }
    }
}

impl Instance {
    /// Reads variables into the importer's array.
    ///
    /// The arrays have to be as long as they say.
    #[inline]
    pub(super) fn get<T: Type>(&mut self, arrays: Arrays<*mut T::Value>) -> Result<(), Refusal> {
        self.require(mode::get(self.standard()))?;
        arrays.check(arrays.values.is_null(), self.slots().len())?;
        if self.outputs_are_stale() {
            self.compute_outputs(&arrays)?;
        }
        let (slots, cells) = (self.slots(), self.cells());
        let mut next = 0;
        for i in 0..arrays.count {
            let reference = arrays.reference(i);
            let length = length::<T>(slots, reference, arrays.counting)
                .ok_or_else(|| self.unknown::<T>(reference))?;
            if length > arrays.value_count - next {
                return Err(self.wrong_length(&arrays));
            }
            let end = reference + length;
            for (slot, bits) in slots[reference..end].iter().zip(&cells[reference..end]) {
                // SAFETY: `next` is below the length of the importer's array.
                unsafe { arrays.values.add(next).write_unaligned(T::get(*bits, slot.cell)) };
                next += 1;
            }
        }
        if next == arrays.value_count { Ok(()) } else { Err(self.wrong_length(&arrays)) }
    }

    /// Sets variables from the importer's array: all of them, or none.
    ///
    /// The arrays have to be as long as they say.
    #[inline]
    pub(super) fn set<T: Type>(&mut self, arrays: Arrays<*const T::Value>) -> Result<(), Refusal> {
        self.require(mode::SET)?;
        arrays.check(arrays.values.is_null(), self.slots().len())?;
        // SAFETY: it is asked for elements below the length of the importer's array.
        let value = |i: usize| unsafe { arrays.values.add(i).read_unaligned() };
        let before = matches!(self.mode(), Mode::Instantiated | Mode::Initialization);
        let slots = self.slots();
        let mut next = 0;
        for i in 0..arrays.count {
            let reference = arrays.reference(i);
            let length = length::<T>(slots, reference, arrays.counting)
                .ok_or_else(|| self.unknown::<T>(reference))?;
            if length > arrays.value_count - next {
                return Err(self.wrong_length(&arrays));
            }
            let settable = slots[reference].settable;
            if !(settable == Settable::Always || before && settable == Settable::Fixed) {
                return Err(self.not_settable(reference));
            }
            for (k, slot) in slots[reference..reference + length].iter().enumerate() {
                if !T::fits(value(next), slot) {
                    return Err(self.out_of_range(reference + k, value(next)));
                }
                next += 1;
            }
        }
        if next != arrays.value_count {
            return Err(self.wrong_length(&arrays));
        }
        let (slots, cells) = self.slots_and_cells();
        let mut next = 0;
        for i in 0..arrays.count {
            let reference = arrays.reference(i);
            let length = match arrays.counting {
                Counting::Elements => 1,
                Counting::Variables => usize::from(slots[reference].elements),
            };
            let end = reference + length;
            for (slot, bits) in slots[reference..end].iter().zip(&mut cells[reference..end]) {
                *bits = T::set(value(next), slot.cell);
                next += 1;
            }
        }
        self.values_changed();
        Ok(())
    }

    /// Outputs before the end of initialization follow from the parameters: makes them if any of
    /// them is asked for.
    #[cold]
    fn compute_outputs<V>(&mut self, arrays: &Arrays<V>) -> Result<(), Refusal> {
        let wanted = (0..arrays.count)
            .any(|i| self.slots().get(arrays.reference(i)).is_some_and(|slot| slot.computed));
        if wanted { self.initialize() } else { Ok(()) }
    }

    #[cold]
    fn unknown<T: Type>(&self, reference: usize) -> Refusal {
        let (kind, of) = (T::NAME, self.model().name);
        Refusal::error(format!(
            "{of} has no variable of type {kind} with value reference {reference}"
        ))
    }

    #[cold]
    fn wrong_length<V>(&self, arrays: &Arrays<V>) -> Refusal {
        let expected: usize = (0..arrays.count)
            .filter_map(|i| self.slots().get(arrays.reference(i)))
            .map(|slot| usize::from(slot.elements))
            .sum();
        Refusal::error(format!(
            "{} values were given, the variables have {expected}",
            arrays.value_count
        ))
    }

    #[cold]
    fn not_settable(&self, slot: usize) -> Refusal {
        let name = super::layout::name(self.model(), slot);
        Refusal::error(match self.slots()[slot].settable {
            Settable::Fixed => {
                format!("{name} is a fixed parameter, and {}", self.mode().name())
            }
            _ => format!("{name} can't be set"),
        })
    }

    #[cold]
    fn out_of_range(&self, slot: usize, value: impl core::fmt::Display) -> Refusal {
        let name = super::layout::name(self.model(), slot);
        let slot = &self.slots()[slot];
        Refusal::discard(match (slot.cell, slot.enumeration) {
            (_, Some(of)) => {
                let items: Vec<_> =
                    of.items.iter().map(|(value, name, _)| format!("{value} ({name})")).collect();
                format!("{name} can't be {value}; it is one of {}", items.join(", "))
            }
            (Cell::Boolean, _) => format!("{name} can't be {value}; it is 0 or 1"),
            (Cell::Count, _) => format!(
                "{name} can't be {value}; a whole number from {} to {} is expected",
                slot.min.max(0.0),
                slot.max.min(EXACT_MAX)
            ),
            (Cell::Real, _) if slot.min == -f64::MAX && slot.max == f64::MAX => {
                format!("{name} can't be {value}; a finite number is expected")
            }
            _ => format!(
                "{name} can't be {value}; it is from {} to {}",
                shown(slot.min, "anything"),
                shown(slot.max, "anything")
            ),
        })
    }
}

/// An end of a range.
fn shown(end: f64, open: &str) -> String {
    if end.abs() == f64::MAX { open.to_owned() } else { end.to_string() }
}

/// Elements that a value reference stands for; `None`: it is of no variable of this type.
#[inline]
fn length<T: Type>(slots: &[Slot], reference: usize, counting: Counting) -> Option<usize> {
    let slot = slots.get(reference)?;
    match counting {
        _ if !T::has(slot.cell) => None,
        Counting::Elements => Some(1),
        Counting::Variables => (slot.elements > 0).then_some(slot.elements.into()),
    }
}
