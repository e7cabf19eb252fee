//! The beginning of a run with faults, kept for runs with some of its faults.

use super::beginning::{Simulated, beginning};
use crate::bench::Bench;
use crate::bench::error::MethodError;
use crate::bench::faulted::Faulted;
use crate::bench::host::RunHost;
use crate::bench::plan::Plan;
use crate::bench::recording::StreamKeeping;
use crate::bench::set_up::SetUp;
use crate::results::method::MethodRun;
use octant_recorder::Recorder;

/// A run up to the epoch before its first fault sets in; nothing is recorded.
#[derive(Debug)]
pub struct Stem {
    bench: Simulated<'static>,
}

impl Stem {
    /// Runs up to the first fault; `None` for a run without faults, and for one that can't be divided.
    ///
    /// # Errors
    /// If the run can't be set up, or fails before.
    pub fn of(plan: &Plan<'_>) -> Result<Option<Self>, MethodError> {
        let Some((begun, draws)) = beginning(plan) else { return Ok(None) };
        let plan = Plan { recording: StreamKeeping::None, trace: true, charts: false, ..*plan };
        let ready = plan.ready()?;
        if ready.faulted.is_none() {
            return Ok(None);
        }
        let mut bench = Bench::open(&plan, ready, begun.set_up(&draws), SetUp::simulated)?;
        bench.run_until(|bench| {
            bench.faulted.as_ref().is_some_and(|faulted| bench.is_fault_due(faulted))
        });
        if let Some(Err(error)) = bench.ended {
            return Err(error.into());
        }
        Ok(Some(Self { bench: bench.under_nobody() }))
    }

    /// Runs on with some of the faults, selected by their numbers from 0; the plan's scenario has the same ones.
    ///
    /// # Errors
    /// As for an undivided run.
    pub fn run(
        &self,
        plan: &Plan<'_>,
        keep: impl Fn(usize) -> bool,
    ) -> Result<MethodRun, MethodError> {
        let faulted = self.bench.faulted.as_ref().map(|all| Faulted {
            station: all.station.with_only(keep),
            fires: all.fires.clone(),
            host: RunHost::default(),
        });
        let mut bench = self.bench.copy(Recorder::none(), faulted, plan.control);
        bench.run();
        let closed = bench.close().map_err(MethodError::from)?;
        MethodRun::scored(plan.scenario, plan.method, closed)?.whole()
    }
}
