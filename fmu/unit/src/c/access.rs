//! Getting and setting of variables: one implementation for both standards.

#![allow(unsafe_code, reason = "the importer's arrays are read and written")]

use super::instance::Instance;
use super::layout::{Cell, EXACT_MAX, Settable, Slot};
use super::mode::{self, Mode, Refusal};
use super::types::Type;
use crate::values::CellValues;

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

    /// End of the values of a variable that begin at `first`; `None`: there are fewer.
    #[inline]
    fn end(&self, first: usize, length: usize) -> Option<usize> {
        first.checked_add(length).filter(|end| *end <= self.value_count)
    }

    #[inline]
    fn reference(&self, i: usize) -> usize {
        // SAFETY: `check` has seen that the array is there; the importer vouches for its length.
        unsafe { self.references.add(i).read_unaligned() as usize }
    }
}

impl<V: Copy> Arrays<*const V> {
    /// Reads value `k` of the variable whose values begin at `first`, below the length of the
    /// importer's array.
    #[inline]
    fn value(&self, first: usize, k: usize) -> V {
        // SAFETY: `check` has seen that the array is there; the importer vouches for its length,
        // and the caller for the place.
        unsafe { self.values.add(first).add(k).read_unaligned() }
    }
}

impl<V: Copy> Arrays<*mut V> {
    /// Writes value `k` of the variable whose values begin at `first`, below the length of the
    /// importer's array.
    #[inline]
    fn put(&self, first: usize, k: usize, value: V) {
        // SAFETY: `check` has seen that the array is there; the importer vouches for its length,
        // and the caller for the place.
        unsafe { self.values.add(first).add(k).write_unaligned(value) };
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
                arrays.put(i, 0, T::get(cells[reference], slot.cell));
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
            let Some(end) = arrays.end(next, length) else {
                return Err(self.wrong_length(&arrays));
            };
            // Most variables have one element or three: these avoid the preparations of a loop.
            match &cells[reference..reference + length] {
                [bits] => arrays.put(next, 0, T::get(*bits, slot.cell)),
                [x, y, z] => {
                    arrays.put(next, 0, T::get(*x, slot.cell));
                    arrays.put(next, 1, T::get(*y, slot.cell));
                    arrays.put(next, 2, T::get(*z, slot.cell));
                }
                all => {
                    for (k, bits) in all.iter().enumerate() {
                        arrays.put(next, k, T::get(*bits, slot.cell));
                    }
                }
            }
            next = end;
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
        let before = matches!(self.mode(), Mode::Instantiated | Mode::Initialization);
        let slots = self.slots();
        let (mut next, mut tunes) = (0, false);
        for i in 0..arrays.count {
            let reference = arrays.reference(i);
            let Some(slot) = found::<T, ARRAYS>(slots, reference) else {
                return Err(self.unknown::<T>(reference));
            };
            tunes |= slot.tunable;
            // Without arrays there is one value for each reference.
            let (first, length) = if ARRAYS { (next, usize::from(slot.elements)) } else { (i, 1) };
            if ARRAYS {
                let Some(end) = arrays.end(first, length) else {
                    return Err(self.wrong_length(&arrays));
                };
                next = end;
            }
            if !(slot.settable == Settable::Always || before && slot.settable == Settable::Fixed) {
                return Err(self.not_settable(reference));
            }
            for k in 0..length {
                let value = arrays.value(first, k);
                if !T::fits(value, slot) {
                    return Err(self.out_of_range(reference + k, value));
                }
            }
        }
        if ARRAYS && next != arrays.value_count {
            return Err(self.wrong_length(&arrays));
        }
        let before = (tunes && !before).then(|| self.run.values.clone());
        let (slots, cells) = self.slots_and_cells();
        let cells = &mut cells[..slots.len()];
        let mut next = 0;
        for i in 0..arrays.count {
            let reference = arrays.reference(i);
            let slot = &slots[reference];
            if !ARRAYS {
                cells[reference] = T::set(arrays.value(i, 0), slot.cell);
                continue;
            }
            let length = usize::from(slot.elements);
            match &mut cells[reference..reference + length] {
                [bits] => *bits = T::set(arrays.value(next, 0), slot.cell),
                [x, y, z] => {
                    *x = T::set(arrays.value(next, 0), slot.cell);
                    *y = T::set(arrays.value(next, 1), slot.cell);
                    *z = T::set(arrays.value(next, 2), slot.cell);
                }
                all => {
                    for (k, bits) in all.iter_mut().enumerate() {
                        *bits = T::set(arrays.value(next, k), slot.cell);
                    }
                }
            }
            next += length;
        }
        self.values_changed();
        match before {
            Some(before) => self.tune(before),
            None => Ok(()),
        }
    }

    /// Hands tunable parameters that were set to the model; one that refuses them has those of before.
    #[cold]
    fn tune(&mut self, before: CellValues) -> Result<(), Refusal> {
        let run = &mut self.run;
        // A parameter that is set to its value changes nothing, whatever the model makes of it.
        if run.values.cells() == before.cells() {
            return Ok(());
        }
        let Some(component) = &mut run.component else { return Ok(()) };
        component.tune(&run.values).map_err(|reason| {
            run.values = before;
            Refusal::discard(reason)
        })
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
