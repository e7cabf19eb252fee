//! Keys of a list of requirements on a system of FMUs.

use super::definition::SCHEMA;
use super::run::RequirementKeys;
use super::table::{integer, keys, tables};

keys! {
    /// A list of requirements on a system.
    pub(crate) struct SystemRequirementsKeys {
        #[expect(dead_code, reason = "it has one value")]
        schema: u32 = integer(SCHEMA, SCHEMA), required, "Version of the format: 1.";
        requirements: Option<Vec<RequirementKeys>>
            = tables::<RequirementKeys>(0, 10_000), absent("none"),
            "Limits that signals of the system have to keep.";
    }
}
