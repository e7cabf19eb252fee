//! Options of a session.

use octant_wire::Text;
use octant_wire::message::StepPacing;
use std::time::Duration;

/// Options of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionOptions {
    /// Pacing of the steps.
    pub pacing: StepPacing,
    /// Sample period, ns.
    pub sample_period_ns: u64,
    /// Hash of the configuration that the core should have; zeros: any.
    pub configuration: [u8; 32],
    /// Name of this program.
    pub name: Text<24>,
    /// Name and version of this program.
    pub firmware: Text<24>,
    /// Timeouts.
    pub patience: Patience,
}

impl SessionOptions {
    /// A session in lock-step with a device of this sample period.
    #[must_use]
    pub fn lock_step(sample_period_ns: u64) -> Self {
        Self {
            pacing: StepPacing::LockStep,
            sample_period_ns,
            configuration: [0; 32],
            name: Text::fitting("octant"),
            firmware: Text::fitting(concat!("octant ", env!("CARGO_PKG_VERSION"))),
            patience: Patience::default(),
        }
    }
}

/// Timeouts of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Wait for the first hello.
    pub hello: Duration,
    /// Wait for an answer, all repetitions included.
    pub answer: Duration,
    /// Wait for an answer before the request is repeated. A slow device is given longer.
    pub repeat: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        Self {
            hello: Duration::from_secs(10),
            answer: Duration::from_secs(5),
            repeat: Duration::from_millis(200),
        }
    }
}
