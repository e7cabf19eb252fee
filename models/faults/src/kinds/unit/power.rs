//! Loss of the state of the unit under test.

use crate::catalogue::{Acts, Example, Family, FaultKind, Lasts};
use crate::rule::{Context, FaultRule, UnitEvent, UnitRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;

pub(super) static RESTART: FaultKind = FaultKind {
    name: "restart",
    family: Family::Unit,
    acts: Acts::Unit,
    summary: "The unit under test restarts, in calibration, in navigation or when its trigger says.",
    model: "At its onset the unit under test starts anew, as at power on, without losing an epoch: \
            the sample of the onset is the first of its new life. It forgets attitude, estimates, \
            covariance and its place in the procedure, and begins with alignment and the first \
            position, wherever the turntable stands; the turntable gets the set points of the new \
            life. The source doesn't notice: numbers and stamps go on, and a unit that takes its \
            clock for that of the run is wrong. An attitude that was handed over for the start of \
            the run is handed over again, whether it still holds or not.\n\n\
            When it happens is its trigger: in the calibration with \
            `trigger = { position = 5, after = \"60 s\" }` or, in a move, \
            `trigger = { moving_to = 5 }`; at the start of the navigation with \
            `trigger = { mode = \"navigating\" }`. A watchdog that bites again and again is one \
            that repeats. The samples are untouched: the epoch counts as altered in which the \
            unit restarted. One without power doesn't restart.",
    parameters: &[],
    lasts: Lasts::Instant,
    example: Example::NONE,
    build: build_restart,
};

fn build_restart(_: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Unit(Box::new(Once { event: UnitEvent::Restart })))
}

/// One event at each onset.
#[derive(Clone, Debug)]
pub(crate) struct Once {
    pub(crate) event: UnitEvent,
}

octant_state::state! { Once { values: ; parts: ; kept: event } }

impl UnitRule for Once {
    fn on_epoch(&mut self, now: &Context<'_>) -> Option<UnitEvent> {
        (now.since_onset == 0).then_some(self.event)
    }
}

/// Loss of power for a time; of a device with a supply it is a real one.
pub static BROWN_OUT: FaultKind = FaultKind {
    name: "brown-out",
    family: Family::Unit,
    acts: Acts::Unit,
    summary: "The unit under test loses power for a time, and its state with it.",
    model: "While it lasts, the unit under test is without power: no epoch reaches it and it \
            answers nothing; the turntable keeps its set point. At its end the unit starts anew, \
            as at `restart`, and the epoch of the end is the first of its new life. Instrument, \
            turntable and reference keep their power: time, numbers and motion go on.\n\n\
            Of several faults that cut the power, it goes with the first onset and comes back with \
            the last end; what else would happen to the unit meanwhile doesn't. Every epoch that \
            it missed counts as altered. Without a duration the unit stays off.\n\n\
            A device with `[power]` loses real power: its supply or relay is switched off before the \
            epoch of the onset and on before that of the end, and a new session begins when the device \
            has started. It is off for no less than the fault's duration in time of the host as well: \
            in lock-step the source waits.",
    parameters: &[],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""5 s""#)]),
    build: build_brown_out,
};

fn build_brown_out(_: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    Ok(FaultRule::Unit(Box::new(BrownOut)))
}

#[derive(Clone, Debug)]
struct BrownOut;

octant_state::state! { BrownOut { values: ; parts: ; kept: } }

impl UnitRule for BrownOut {
    fn on_epoch(&mut self, _: &Context<'_>) -> Option<UnitEvent> {
        None
    }

    fn cuts_power(&self) -> bool {
        true
    }
}
