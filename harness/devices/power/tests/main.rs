//! Tests of supplies and relays, in one program.
#![allow(clippy::unwrap_used)]

mod dialogue;
mod outlet;
mod serial;

use octant_power::simulate::SimulatedInstrument;
use octant_power::{Outlet, PowerPlan, SupplySetting};
use std::time::Duration;

/// A plan for channel 2 of a simulated supply: 24 V, at most 2 A, left off.
fn plan(of: &SimulatedInstrument) -> PowerPlan {
    PowerPlan {
        port: of.port(),
        outlet: Outlet::Supply(SupplySetting {
            channel: Some(2),
            voltage_v: 24.0,
            current_limit_a: 2.0,
            tolerance: 0.05,
        }),
        reply: octant_test_processes::HANGS,
        settle: octant_test_processes::HANGS,
        remote: false,
        rest: Duration::ZERO,
        lead: Duration::ZERO,
        end_on: false,
    }
}
