//! Communication steps of one sample period, and of several with calls of the importer in between.

use super::entry::enter;
use crate::c::call::put;
use crate::c::instance::Instance;
use crate::c::mode::{Mode, Modes, Refusal};
use core::ffi::c_void;
use octant_fmi::fmi3::{
    Boolean, DISCARD, Environment, FALSE, IntermediateUpdate, OK, Status, TRUE, WARNING,
};

const NAME: &str = "fmi3DoStep";

/// The importer's pointers for the results of a step.
pub(super) struct Places {
    pub event_handling_needed: *mut Boolean,
    pub terminate: *mut Boolean,
    pub early_return: *mut Boolean,
    pub last_successful_time: *mut f64,
}

impl Places {
    /// Checks the pointers, before the step begins.
    #[inline]
    fn check(&self) -> Result<(), Refusal> {
        let Self { event_handling_needed, terminate, early_return, last_successful_time } = self;
        if event_handling_needed.is_null()
            || terminate.is_null()
            || early_return.is_null()
            || last_successful_time.is_null()
        {
            return Err(Refusal::error("the place for a result is a null pointer"));
        }
        Ok(())
    }

    #[inline]
    fn fill(&self, instance: &Instance, event: bool, early: bool) -> Result<(), Refusal> {
        put(self.event_handling_needed, event.into(), "eventHandlingNeeded")?;
        put(self.terminate, FALSE, "terminateSimulation")?;
        put(self.early_return, early.into(), "earlyReturn")?;
        put(self.last_successful_time, instance.time_s(), "lastSuccessfulTime")
    }
}

/// Data of a step of several periods that are needed outside of the instance.
#[derive(Clone, Copy)]
struct Long {
    periods: u64,
    end_s: f64,
    early_return_allowed: bool,
    /// False for a model whose outputs belong to the whole step.
    returns_at_events: bool,
    callback: Option<IntermediateUpdate>,
    environment: Environment,
}

#[inline]
pub(super) fn do_step(handle: *mut c_void, time_s: f64, step_s: f64, places: &Places) -> Status {
    let mut long = None;
    let status = enter(handle, NAME, |instance| {
        places.check()?;
        let agreed = instance.agree(time_s, step_s)?;
        if agreed.periods == 1 {
            let event = instance.step_period(true)?;
            places.fill(instance, event, false)?;
        } else if agreed.periods == 0 {
            let event = instance.step_to(time_s + step_s);
            places.fill(instance, event, false)?;
        } else {
            long = Some(Long {
                periods: agreed.periods,
                end_s: time_s + step_s,
                early_return_allowed: instance.options.early_return_allowed,
                returns_at_events: !instance.model().sums_periods,
                callback: instance.options.intermediate_update,
                environment: instance.outlet.environment,
            });
        }
        Ok(OK)
    });
    match long {
        Some(long) if status == OK => step_long(handle, &long, places),
        _ => status,
    }
}

/// Result of a period.
#[derive(Clone, Copy)]
struct Period {
    event: bool,
    time_s: f64,
    /// True if the model can't continue; the reason is logged.
    stuck: bool,
}

/// Makes one period after another. After each the importer is asked whether it wants to return
/// early; the step also returns early at an event, if the importer can handle that.
fn step_long(handle: *mut c_void, long: &Long, places: &Places) -> Status {
    let mut last = Period { event: false, time_s: f64::NAN, stuck: false };
    let mut until_s = long.end_s;
    let mut done = 0;
    while done < long.periods {
        let within = done + 1 < long.periods && long.callback.is_some();
        let status = enter(handle, NAME, |instance| {
            last = step_within(instance, long, done, within)?;
            Ok(OK)
        });
        if status != OK {
            return status;
        }
        if last.stuck {
            break;
        }
        done += 1;
        if within {
            let wanted_s = ask(long, last.time_s);
            let status = enter(handle, NAME, |instance| {
                // The callback may have called functions of this instance.
                instance.require(Modes::of(&[Mode::IntermediateUpdate]))?;
                instance.run.mode = Mode::Step;
                Ok(OK)
            });
            if status != OK {
                return status;
            }
            until_s = wanted_s.unwrap_or(until_s);
        }
        if done == long.periods {
            break;
        }
        let period_s = (long.end_s - last.time_s) / (long.periods - done) as f64;
        let event = last.event && long.early_return_allowed && long.returns_at_events;
        if event || last.time_s + 0.5 * period_s > until_s {
            break;
        }
    }
    enter(handle, NAME, |instance| {
        places.fill(instance, last.event, done < long.periods)?;
        Ok(if last.stuck { WARNING } else { OK })
    })
}

/// Makes one period of several.
fn step_within(
    instance: &mut Instance,
    long: &Long,
    done: u64,
    within: bool,
) -> Result<Period, Refusal> {
    let event = match instance.step_period(done == 0) {
        Ok(event) => event,
        // The step was begun and can't be undone.
        Err(refusal) if done > 0 && refusal.status == DISCARD => {
            if !long.early_return_allowed {
                return Err(Refusal::error(refusal.reason));
            }
            instance.log.say(WARNING, format!("{NAME}: returned early: {}", refusal.reason));
            return Ok(Period { event: false, time_s: instance.time_s(), stuck: true });
        }
        Err(refusal) => return Err(refusal),
    };
    if within {
        instance.run.mode = Mode::IntermediateUpdate;
    }
    Ok(Period { event, time_s: instance.time_s(), stuck: false })
}

/// Calls the importer between two periods; returns the time at which it wants the step to end.
fn ask(long: &Long, time_s: f64) -> Option<f64> {
    let callback = long.callback?;
    let (mut requested, mut wanted_s) = (FALSE, time_s);
    let can_return = long.early_return_allowed.into();
    // No variable is available within a step, and periods already stepped are final.
    // SAFETY: the importer vouches for its callback; the places live until after the call.
    unsafe {
        callback(
            long.environment,
            time_s,
            FALSE,
            FALSE,
            TRUE,
            can_return,
            &raw mut requested,
            &raw mut wanted_s,
        );
    }
    (long.early_return_allowed && requested != FALSE).then_some(wanted_s)
}
