//! A recorded run with faults and the run without them, which share the beginning.
//!
//! The recorded run is the trunk here, with its station at its side. Before the first fault sets in the twin
//! branches off, on a thread of its own.

use super::beginning::{Beginning, Simulated, beginning};
use super::once::as_far_as_it_goes;
use crate::bench::Bench;
use crate::bench::error::MethodError;
use crate::bench::plan::Plan;
use crate::bench::records::CONTROL_EPOCHS;
use crate::bench::set_up::SetUp;
use crate::observers::Charts;
use crate::results::method::MethodRun;
use octant_base::pool::spawn;
use octant_scenario::resolve::DrawnValues;
use std::sync::Arc;

/// Runs a scenario with faults and its twin: both plans are of one method and seed, the second without the faults.
/// A failure in the middle ends the first as [`run_as_far_as_it_goes`](super::once::run_as_far_as_it_goes) says.
///
/// `None` if the two can't share their beginning, and have to run one by one.
///
/// # Errors
/// If a run can't be set up, or a recorder fails.
pub(super) fn run_with_twin(
    plan: &Plan<'_>,
    twin: &Plan<'_>,
) -> Option<Result<MethodRun, MethodError>> {
    let (begun, draws) = beginning(plan)?;
    if beginning(twin)?.0 != begun {
        return None;
    }
    Some(both(plan, twin, &begun, &draws))
}

// Apart from its caller, whose frame would have room for two runs in any case.
#[inline(never)]
fn both(
    plan: &Plan<'_>,
    twin: &Plan<'_>,
    begun: &Beginning,
    draws: &DrawnValues,
) -> Result<MethodRun, MethodError> {
    let ready = plan.ready()?;
    if ready.faulted.is_none() {
        return as_far_as_it_goes(plan);
    }
    let mut bench = Bench::open(plan, ready, begun.set_up(draws), SetUp::simulated)?;
    bench.run_until(|bench| {
        let number = bench.steps.number();
        let due = bench.faulted.as_ref().is_some_and(|faulted| bench.is_fault_due(faulted));
        if !due && number.is_multiple_of(CONTROL_EPOCHS) {
            // The end of the other one is asked for together with that of this one.
            _ = twin.control.look(number);
        }
        due
    });
    // A recorder that fails here fails in the run too, which says so.
    let branch = match &bench.ended {
        Some(Err(_)) => None,
        _ => bench.branch(None, twin.control).ok(),
    };
    let twin = std::thread::scope(|scope| {
        let other = spawn(scope, || match branch {
            Some(branch) => without_faults(twin, branch),
            None => as_far_as_it_goes(twin),
        });
        bench.run();
        other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    let run = MethodRun::scored(plan.scenario, plan.method, bench.close()?)?;
    Ok(MethodRun { twin: Some(Arc::new(twin?)), ..run })
}

/// Goes on as the twin, which has nothing of what only the report of a recorded run shows.
fn without_faults(plan: &Plan<'_>, mut bench: Simulated<'_>) -> Result<MethodRun, MethodError> {
    bench.keeper.observers.charts = Charts::default();
    bench.run();
    MethodRun::scored(plan.scenario, plan.method, bench.close()?)
}
