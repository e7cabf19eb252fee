//! The file `requirements.toml`.
//!
//! ```toml
//! schema = 1
//! title = "Navigation"
//!
//! [[requirements]]
//! id = "NAV-1"
//! text = "The longitude error stays below 20 arcmin over 24 hours."
//! measure = "navigation.longitude_error_arcmin.max"
//! limit = "20 arcmin"
//! pass = "95 %"
//! confidence = "95 %"
//! clause = "SSS-INS 3.2.1"
//! ```

mod read;
mod write;

pub use read::{misfit, read};
pub use write::write;

use crate::requirement::Limit;

/// Version of the file's schema.
pub const SCHEMA: i64 = 1;

/// Checker of measures and limits, which knows the units. Errors are in plain words.
pub trait Checker {
    /// Checks that a run can have this measure.
    ///
    /// # Errors
    /// The part of the name that leads nowhere, and the names that exist.
    fn measure(&self, measure: &str) -> Result<(), String>;

    /// Checks that this is a limit for the measure, in a unit of its kind.
    ///
    /// # Errors
    /// Limit found and limit expected.
    fn limit(&self, measure: &str, limit: &Limit) -> Result<(), String>;
}

/// Accepts every measure and every limit: for moving requirements between formats.
#[derive(Clone, Copy, Debug)]
pub struct Anything;

impl Checker for Anything {
    fn measure(&self, _: &str) -> Result<(), String> {
        Ok(())
    }

    fn limit(&self, _: &str, _: &Limit) -> Result<(), String> {
        Ok(())
    }
}
