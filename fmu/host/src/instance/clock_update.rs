//! Callbacks of scheduled execution (FMI 3.0, 5.2.1): within one of them the FMU is in clock update
//! mode, the only one in which it tells which clocks have ticked and which countdowns have begun.
#![allow(unsafe_code, reason = "functions of a library are called, and C calls back")]

use octant_fmi::fmi3;
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::sync::Arc;

/// Ticks and countdowns that an FMU reported while a model partition was active.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClockNews {
    /// Output clocks that ticked.
    pub ticked: Vec<u32>,
    /// Countdown clocks, and the time from the activation to their tick, s.
    pub countdowns: Vec<(u32, f64)>,
}

/// Clocks that are asked when the FMU calls back.
#[derive(Clone, Debug, Default)]
pub(crate) struct WatchedClocks {
    /// Output clocks.
    pub(crate) outputs: Vec<u32>,
    /// Countdown clocks.
    pub(crate) countdowns: Vec<u32>,
}

/// The activation that runs on a thread.
pub(crate) struct RunningActivation {
    functions: fmi3::Functions,
    instance: fmi3::Instance,
    watched: Arc<WatchedClocks>,
    news: ClockNews,
    /// Function that failed, and its status; `None`: the library doesn't have it.
    failed: Option<(&'static str, Option<i32>)>,
}

thread_local! {
    static RUNNING: RefCell<Option<RunningActivation>> = const { RefCell::new(None) };
}

impl RunningActivation {
    /// Begins an activation on this thread.
    pub(crate) fn begin(
        functions: fmi3::Functions,
        instance: fmi3::Instance,
        watched: &Arc<WatchedClocks>,
    ) {
        let watched = Arc::clone(watched);
        let (news, failed) = (ClockNews::default(), None);
        RUNNING.set(Some(Self { functions, instance, watched, news, failed }));
    }

    /// Ends the activation on this thread; returns what was said, or the function that failed.
    pub(crate) fn end() -> Result<ClockNews, (&'static str, Option<i32>)> {
        match RUNNING.take() {
            Some(Self { failed: Some(failed), .. }) => Err(failed),
            Some(Self { news, .. }) => Ok(news),
            None => Ok(ClockNews::default()),
        }
    }

    /// Asks the watched clocks.
    fn ask(&mut self) -> Result<(), (&'static str, Option<i32>)> {
        let check = |function, status| match status {
            fmi3::OK | fmi3::WARNING => Ok(()),
            other => Err((function, Some(other))),
        };
        for clock in &self.watched.outputs {
            let get = self.functions.fmi3GetClock.ok_or(("fmi3GetClock", None))?;
            let mut ticked = 0;
            // SAFETY: the FMU called back from an activation of this instance, so that it is alive,
            // and it allows this call there; the pointers are to one value each.
            check("fmi3GetClock", unsafe { get(self.instance, clock, 1, &mut ticked) })?;
            if ticked != 0 {
                self.news.ticked.push(*clock);
            }
        }
        for clock in &self.watched.countdowns {
            let function = "fmi3GetIntervalDecimal";
            let get = self.functions.fmi3GetIntervalDecimal.ok_or((function, None))?;
            let (mut interval_s, mut qualifier) = (0.0, fmi3::INTERVAL_NOT_YET_KNOWN);
            // SAFETY: as above.
            let status = unsafe { get(self.instance, clock, 1, &mut interval_s, &mut qualifier) };
            check(function, status)?;
            if qualifier == fmi3::INTERVAL_CHANGED {
                self.news.countdowns.push((*clock, interval_s));
            }
        }
        Ok(())
    }
}

/// `fmi3ClockUpdateCallback`. A call at another time than during an activation, or from another
/// thread, says nothing that could be asked for, and is passed over.
pub(crate) unsafe extern "C" fn clock_update(_environment: fmi3::Environment) {
    let _ = RUNNING.try_with(|running| {
        let Ok(mut running) = running.try_borrow_mut() else { return };
        if let Some(running) = running.as_mut()
            && let Err(failed) = running.ask()
        {
            running.failed = Some(failed);
        }
    });
}

/// `fmi3LockPreemptionCallback` and `fmi3UnlockPreemptionCallback`: partitions are activated one after
/// another, so that there is nothing to lock.
pub(crate) unsafe extern "C" fn preemption() {}
