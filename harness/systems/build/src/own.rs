//! One of our models, with the data for its FMUs.

use super::reference::Reference;
use octant_fmu::table::Model;

/// One of our models, with the data for its FMUs.
pub(super) struct Own {
    pub(super) model: &'static Model,
    /// Inputs and results with which users check their tools. A model on a bus has none: tables of
    /// values have no columns for clocked variables.
    pub(super) reference: Option<Reference>,
}
