//! The operator's page of a run: `octant run --page`.

/// Default address: any free port, reachable from this host only.
pub(crate) const DEFAULT_ADDRESS: &str = "127.0.0.1:0";

use crate::failure::Failure;
use octant_operator::Desk;
use std::sync::Arc;

/// The page, served until it is dropped.
#[cfg(feature = "dashboard")]
pub(crate) struct OperatorPage {
    _page: octant_operator::page::Page,
}

/// Uninhabited: this program is built without the page.
#[cfg(not(feature = "dashboard"))]
pub(crate) enum OperatorPage {}

impl OperatorPage {
    /// Serves the page of a desk.
    #[cfg(feature = "dashboard")]
    pub(crate) fn start(address: &str, title: &str, desk: &Arc<Desk>) -> Result<Self, Failure> {
        let page = octant_operator::page::Page::start(address, title, Arc::clone(desk))
            .map_err(|error| Failure::input(format!("failed to {error}")))?;
        crate::terminal::note!("octant: the operator's page is at {}", page.url());
        Ok(Self { _page: page })
    }

    /// Refuses the page.
    #[cfg(not(feature = "dashboard"))]
    pub(crate) fn start(_: &str, _: &str, _: &Arc<Desk>) -> Result<Self, Failure> {
        Err(Failure::input(
            "--page: this program was built without the operator's page, expected one built with cargo build \
             --release --features octant/dashboard",
        ))
    }
}
