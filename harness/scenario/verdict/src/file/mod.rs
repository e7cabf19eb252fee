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

mod accounts;
mod entries;
mod read;
mod write;

pub use read::{misfit, read};
pub use write::write;

use crate::requirement::Limit;

/// Version of the file's schema.
pub const SCHEMA: i64 = 1;

/// Checker of what the file has from elsewhere: measures, limits, which have units, and formatted texts, which are
/// XHTML. Errors are in plain words.
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

    /// Checks that this is a formatted text.
    ///
    /// # Errors
    /// Reason why it is none.
    fn formatted(&self, xhtml: &str) -> Result<(), String>;
}
