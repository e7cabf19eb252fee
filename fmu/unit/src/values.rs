//! The values of all variables of an instance.

use crate::table::{DeclaredCausality, ElementType, Model};

/// Values with one cell per slot; the model's table defines the content of a cell.
#[derive(Clone, Debug)]
pub struct CellValues {
    cells: Box<[u64]>,
}

impl CellValues {
    /// Makes all variables with their start values; those without one are zero.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let mut cells = vec![0u64];
        for variable in model.variables {
            for element in 0..variable.slots() {
                let start = variable.start_of(element).unwrap_or(0.0);
                cells.push(match variable.kind {
                    ElementType::Real => start.to_bits(),
                    ElementType::Count => start as u64,
                    ElementType::Integer | ElementType::Enumeration(_) => {
                        i64::from(start as i32) as u64
                    }
                    ElementType::Boolean => u64::from(start != 0.0),
                    // The values of these kinds are not stored in cells.
                    ElementType::Binary(_) | ElementType::Clock(_) => 0,
                });
            }
        }
        Self { cells: cells.into() }
    }

    /// Returns the name of each parameter, and a number for each of its elements: numbers
    /// unchanged, counts as whole numbers (exact up to 2⁵³), enumerations by their values, Booleans
    /// as 0 and 1.
    #[must_use]
    pub fn parameters(&self, model: &'static Model) -> Vec<(&'static str, Vec<f64>)> {
        let of = |slot: usize, kind: ElementType| match kind {
            ElementType::Real => self.real(slot),
            ElementType::Count => self.count(slot) as f64,
            ElementType::Integer | ElementType::Enumeration(_) => f64::from(self.integer(slot)),
            ElementType::Boolean => f64::from(u8::from(self.boolean(slot))),
            // No parameter is of these kinds.
            ElementType::Binary(_) | ElementType::Clock(_) => 0.0,
        };
        model
            .with_slots()
            .filter(|(_, variable)| variable.causality == DeclaredCausality::Parameter)
            .map(|(slot, variable)| {
                let elements = slot..slot + variable.slots();
                (variable.name, elements.map(|slot| of(slot, variable.kind)).collect())
            })
            .collect()
    }

    /// Cells of all slots.
    #[must_use]
    pub fn cells(&self) -> &[u64] {
        &self.cells
    }

    /// Cells of all slots, for writing.
    pub fn cells_mut(&mut self) -> &mut [u64] {
        &mut self.cells
    }

    /// Reads a Real.
    #[must_use]
    pub fn real(&self, slot: usize) -> f64 {
        f64::from_bits(self.cells[slot])
    }

    /// Reads `N` Reals.
    #[must_use]
    pub fn reals<const N: usize>(&self, slot: usize) -> [f64; N] {
        core::array::from_fn(|i| self.real(slot + i))
    }

    /// Reads an Integer or an enumeration's value.
    #[must_use]
    pub fn integer(&self, slot: usize) -> i32 {
        self.cells[slot] as i32
    }

    /// Reads a Count.
    #[must_use]
    pub fn count(&self, slot: usize) -> u64 {
        self.cells[slot]
    }

    /// Reads a Boolean.
    #[must_use]
    pub fn boolean(&self, slot: usize) -> bool {
        self.cells[slot] != 0
    }

    /// Sets a Real.
    pub fn set_real(&mut self, slot: usize, value: f64) {
        self.cells[slot] = value.to_bits();
    }

    /// Sets `N` Reals.
    pub fn set_reals<const N: usize>(&mut self, slot: usize, values: &[f64; N]) {
        for (cell, value) in self.cells[slot..slot + N].iter_mut().zip(values) {
            *cell = value.to_bits();
        }
    }

    /// Sets an Integer or an enumeration's value.
    pub fn set_integer(&mut self, slot: usize, value: i32) {
        self.cells[slot] = i64::from(value) as u64;
    }

    /// Sets a Count.
    pub fn set_count(&mut self, slot: usize, value: u64) {
        self.cells[slot] = value;
    }

    /// Sets a Boolean.
    pub fn set_boolean(&mut self, slot: usize, value: bool) {
        self.cells[slot] = u64::from(value);
    }
}
