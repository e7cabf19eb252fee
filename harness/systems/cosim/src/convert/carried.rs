//! A value on its way: operations on real numbers, and on whole numbers of any size.

use crate::flat::HopEntry;
use crate::values::{has, is_float, rounded};
use octant_fmu_host::instance::whole;

/// One operation on a value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    /// factor · value + offset.
    Linear(f64, f64),
    /// Table from value to value: of whole numbers, and of Booleans as 0 and 1.
    Map(Vec<(i128, i128)>),
    /// Passage through an entry of a signal dictionary, which has a type.
    Entry(HopEntry),
}

/// A value on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CarriedNumber {
    Real(f64),
    Whole(i128),
}

impl CarriedNumber {
    pub(super) fn real(self) -> Option<f64> {
        match self {
            Self::Real(number) => Some(number),
            Self::Whole(whole) => whole::exact(whole),
        }
    }

    pub(super) fn whole(self) -> Option<i128> {
        match self {
            Self::Real(number) => whole::of(number),
            Self::Whole(whole) => Some(whole),
        }
    }
}

impl Step {
    /// Applies the operation.
    pub(super) fn apply(value: CarriedNumber, step: &Self) -> Option<CarriedNumber> {
        Some(match step {
            // Adding 0 would turn −0 into 0.
            Self::Linear(factor, 0.0) => CarriedNumber::Real(factor * value.real()?),
            Self::Linear(factor, offset) => CarriedNumber::Real(factor * value.real()? + offset),
            Self::Map(entries) => {
                let whole = value.whole()?;
                let found = entries.iter().find(|(source, _)| *source == whole);
                CarriedNumber::Whole(found?.1)
            }
            Self::Entry(entry) => entry.passed(value)?,
        })
    }
}

impl HopEntry {
    /// Returns a value as the entry's type has it.
    fn passed(&self, value: CarriedNumber) -> Option<CarriedNumber> {
        if is_float(self.kind) {
            return Some(CarriedNumber::Real(rounded(value.real()?, self.kind)));
        }
        let whole = value.whole()?;
        let known =
            self.items.is_empty() || self.items.iter().any(|item| i128::from(item.0) == whole);
        (known && has(self.kind, whole)).then_some(CarriedNumber::Whole(whole))
    }
}
