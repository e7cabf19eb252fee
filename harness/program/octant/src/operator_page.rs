//! The operator's page of a run: `octant run --page`.

/// Default address: any free port, reachable from this host only.
pub(crate) const DEFAULT_ADDRESS: &str = "127.0.0.1:0";

use crate::failure::Failure;
use octant_operator::Desk;
use std::sync::Arc;

/// The page, whose address is taken before anything is written.
#[cfg(feature = "dashboard")]
#[derive(Debug)]
pub(crate) struct BoundOperatorPage {
    page: octant_operator::page::BoundPage,
}

/// The page, served until it is dropped.
#[cfg(feature = "dashboard")]
pub(crate) struct OperatorPage {
    _page: octant_operator::page::ServedPage,
}

#[cfg(feature = "dashboard")]
impl BoundOperatorPage {
    /// Takes an address.
    pub(crate) fn bind(address: &str) -> Result<Self, Failure> {
        let page = octant_operator::page::BoundPage::bind(address);
        let page = page.map_err(|error| Failure::input(format!("failed to {error}")))?;
        Ok(Self { page })
    }

    /// Serves the page of a desk.
    pub(crate) fn serve(self, title: &str, desk: &Arc<Desk>) -> Result<OperatorPage, Failure> {
        let url = self.page.url().to_owned();
        let page = self.page.serve(title, Arc::clone(desk));
        let _page = page.map_err(|error| Failure::bench(format!("failed to {error}")))?;
        crate::terminal::note!("octant: the operator's page is at {url}");
        Ok(OperatorPage { _page })
    }
}

/// Uninhabited: this program is built without the page.
#[cfg(not(feature = "dashboard"))]
#[derive(Debug)]
pub(crate) enum BoundOperatorPage {}

/// Uninhabited: this program is built without the page.
#[cfg(not(feature = "dashboard"))]
pub(crate) enum OperatorPage {}

#[cfg(not(feature = "dashboard"))]
impl BoundOperatorPage {
    /// Refuses the page.
    pub(crate) fn bind(_: &str) -> Result<Self, Failure> {
        Err(Failure::input(
            "--page: this program was built without the operator's page, expected one built with cargo build \
             --release --features octant/dashboard",
        ))
    }

    /// Serves no page: there is none.
    pub(crate) fn serve(self, _: &str, _: &Arc<Desk>) -> Result<OperatorPage, Failure> {
        match self {}
    }
}
