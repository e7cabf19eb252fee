//! Words for the properties of kinds of faults.

use octant_faults::catalogue::{Acts, Lasts};

/// Describes where a kind acts.
pub(crate) fn acts(acts: Acts) -> &'static str {
    match acts {
        Acts::Plant => "inside the simulated instrument, before its sensors measure",
        Acts::Command => "on set points on their way from the core to the turntable",
        Acts::Samples => "on samples and aiding on their way to the core",
        Acts::Delivery => "on the delivery of samples: lost, late, in another order",
        Acts::Unit => "on the unit under test itself",
        Acts::Wire => "on the wire between the harness and a device",
        Acts::Host => "on the host that the harness runs on",
        Acts::Power => "on the supply of a device",
        _ => "elsewhere",
    }
}

/// Describes how long a kind lasts.
pub(crate) fn lasts(lasts: Lasts) -> &'static str {
    match lasts {
        Lasts::Span => "for its duration (by default to the end of the run), then ends",
        Lasts::Fading => {
            "for its duration (by default to the end of the run), then fades linearly over its recovery"
        }
        Lasts::Instant => "an instant: it takes no duration",
    }
}
