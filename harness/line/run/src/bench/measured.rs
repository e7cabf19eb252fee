//! Innovation and covariance that go with the NIS of an output.

use octant_endpoint::Endpoint;
use octant_sample::{Innovation, NavigationCovariance, Output};

/// Innovation of a measurement, and the covariance of the solution after it; `None` without a
/// measurement, and from a core that answers with outputs alone.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Measured {
    pub(crate) innovation: Option<Innovation>,
    pub(crate) covariance: Option<NavigationCovariance>,
}

impl Measured {
    /// Asks the endpoint, whose last output this is.
    #[inline(always)]
    pub(crate) fn of<E: Endpoint + ?Sized>(endpoint: &E, output: &Output) -> Self {
        if !output.nis.is_finite() {
            return Self::default();
        }
        Self { innovation: endpoint.innovation(), covariance: endpoint.navigation_covariance() }
    }
}
