//! `requirements.toml`.
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

pub(crate) use read::misfit;
pub use read::read;
pub use write::write;

use crate::requirement::Limit;

/// Version of the form of the file.
pub const SCHEMA: i64 = 1;

/// Who knows measures and units. Each answers with what is wrong, in plain words.
pub trait Checker {
    /// Whether a run can have this measure.
    ///
    /// # Errors
    /// What of the name leads nowhere, and what there is.
    fn measure(&self, measure: &str) -> Result<(), String>;

    /// Whether this is a limit of the measure, in a unit of its kind.
    ///
    /// # Errors
    /// What was found, and what was expected.
    fn limit(&self, measure: &str, limit: &Limit) -> Result<(), String>;
}

/// Takes every measure and every limit: for who only moves requirements between formats.
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
