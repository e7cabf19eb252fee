//! Deviations of a structure that have one meaning all the same, and are read with a warning.

use super::SspError;
use std::cell::RefCell;

/// Warnings about the files of a structure, each once.
#[derive(Debug, Default)]
pub(super) struct SspWarnings {
    all: RefCell<Vec<String>>,
    /// Files and units in them that were warned about.
    units: RefCell<Vec<(String, String)>>,
}

impl SspWarnings {
    /// Adds a warning in the form of an error, whose message says what is read instead.
    pub(super) fn add(&self, warning: &SspError) {
        self.all.borrow_mut().push(warning.to_string());
    }

    /// Adds a warning about a unit, if it is the first of the file about this unit.
    pub(super) fn unit(&self, unit: &str, warning: &SspError) {
        let place = (warning.file.clone(), unit.to_owned());
        if !self.units.borrow().contains(&place) {
            self.units.borrow_mut().push(place);
            self.add(warning);
        }
    }

    /// Takes all warnings, in their order.
    pub(super) fn take(&self) -> Vec<String> {
        self.units.take();
        self.all.take()
    }
}
