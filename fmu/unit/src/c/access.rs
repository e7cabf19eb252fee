//! Getting and setting of variables: one implementation for both standards.

#![allow(unsafe_code, reason = "the importer's arrays are read and written")]

use super::instance::Instance;
use super::layout::{Cell, EXACT_MAX, Settable, Slot};
use super::mode::{self, Mode, Refusal};
use super::types::Type;

/// Arrays of the importer: value references, and the values.
pub(super) struct Arrays<V> {
    pub references: *const u32,
    pub count: usize,
    pub values: V,
    /// Length of the values in FMI 3.0; in FMI 2.0 there are as many as references.
    pub value_count: usize,
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

impl<V: Copy> Arrays<*mut V> {
    /// Writes an element below the length of the importer's array.
    #[inline]
    fn put(&self, i: usize, value: V) {
        // SAFETY: `check` has seen that the array is there; the importer vouches for its length,
        // and the caller for the place.
        unsafe { self.values.add(i).write_unaligned(value) };
    }
}

impl Instance {
    /// Reads variables into the importer's array. With `ARRAYS` a value reference is that of a
    /// variable, as in FMI 3.0; without it is that of an element, as in FMI 2.0.
    ///
    /// The importer's arrays must have the lengths given.
    #[inline]
    pub(super) fn get<T: Type, const ARRAYS: bool>(
        &mut self,
        arrays: Arrays<*mut T::Value>,
    ) -> Result<(), Refusal> {
        self.require(mode::get(self.standard()))?;
        arrays.check(arrays.values.is_null(), self.slots().len())?;
        if self.outputs_are_stale() {
            self.compute_outputs(&arrays)?;
        }
        let slots = self.slots();
        // As many cells as slots: an index within the one is within the other.
        let cells = &self.cells()[..slots.len()];
        if !ARRAYS {
            for i in 0..arrays.count {
                let reference = arrays.reference(i);
                let Some(slot) = found::<T, ARRAYS>(slots, reference) else {
                    return Err(self.unknown::<T>(reference));
                };
                arrays.put(i, T::get(cells[reference], slot.cell));
            }
            return Ok(());
        }
        let mut next = 0;
        for i in 0..arrays.count {
            let reference = arrays.reference(i);
            let Some(slot) = found::<T, ARRAYS>(slots, reference) else {
                return Err(self.unknown::<T>(reference));
            };
            let length = usize::from(slot.elements);
            if length > arrays.value_count - next {
                return Err(self.wrong_length(&arrays));
            }
            // Most variables have one element or three: these avoid the preparations of a loop.
            match &cells[reference..reference + length] {
                [bits] => arrays.put(next, T::get(*bits, slot.cell)),
                [x, y, z] => {
                    arrays.put(next, T::get(*x, slot.cell));
                    arrays.put(next + 1, T::get(*y, slot.cell));
                    arrays.put(next + 2, T::get(*z, slot.cell));
                }
                bits => {
                    for (k, bits) in bits.iter().enumerate() {
                        arrays.put(next + k, T::get(*bits, slot.cell));
                    }
                }
            }
            next += length;
        }
        if next == arrays.value_count { Ok(()) } else { Err(self.wrong_length(&arrays)) }
    }

    /// Sets variables from the importer's array: all of them, or none. `ARRAYS` as in
    /// [`Self::get`].
    ///
    /// The importer's arrays must have the lengths given.
    #[inline]
    pub(super) fn set<T: Type, const ARRAYS: bool>(
        &mut self,
        arrays: Arrays<*const T::Value>,
    ) -> Result<(), Refusal> {
        self.require(mode::SET)?;
        arrays.check(arrays.values.is_null(), self.slots().len())?;
        // SAFETY: it is asked for elements below the length of the importer's array.
        let value = |i: usize| unsafe { arrays.values.add(i).read_unaligned() };
        let before = matches!(self.mode(), Mode::Instantiated | Mode::Initialization);
        let slots = self.slots();
        let mut next = 0;
        for i in 0..arrays.count {
            let reference = arrays.reference(i);
            let Some(slot) = found::<T, ARRAYS>(slots, reference) else {
                return Err(self.unknown::<T>(reference));
            };
            let length = if ARRAYS { usize::from(slot.elements) } else { 1 };
            if ARRAYS && length > arrays.value_count - next {
                return Err(self.wrong_length(&arrays));
            }
            if !(slot.settable == Settable::Always || before && slot.settable == Settable::Fixed) {
                return Err(self.not_settable(reference));
            }
            for k in 0..length {
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
        let cells = &mut cells[..slots.len()];
        let mut next = 0;
        for i in 0..arrays.count {
            let reference = arrays.reference(i);
            let slot = &slots[reference];
            if !ARRAYS || slot.elements == 1 {
                cells[reference] = T::set(value(next), slot.cell);
                next += 1;
                continue;
            }
            for bits in &mut cells[reference..reference + usize::from(slot.elements)] {
                *bits = T::set(value(next), slot.cell);
                next += 1;
            }
        }
        self.values_changed();
        Ok(())
    }

    /// Computes the outputs, which follow from the parameters before the end of initialization, if
    /// any of them is requested.
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

/// Text of a limit of a range.
fn shown(end: f64, open: &str) -> String {
    if end.abs() == f64::MAX { open.to_owned() } else { end.to_string() }
}

/// Finds the slot of a value reference; `None`: there is no variable of this type. All elements of
/// a variable are alike.
#[inline]
fn found<T: Type, const ARRAYS: bool>(slots: &[Slot], reference: usize) -> Option<&Slot> {
    slots.get(reference).filter(|slot| T::has(slot.cell) && (!ARRAYS || slot.elements > 0))
}
