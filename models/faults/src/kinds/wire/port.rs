//! Faults of a port.

use super::rule::{SHARE, WAYS, rule, time, wire};
use crate::catalogue::{FaultKind, Lasts};
use crate::wire::WireAction;

pub(super) static BREAK: FaultKind = wire(
    "serial-break",
    "A serial line is held in a break.",
    "From its onset the line is held for `length` of host time. What is sent in that time is lost, and \
     the receiver reads one zero byte for all of it, as a serial port does that isn't asked to tell \
     breaks from data. The zero ends whatever was begun.",
    &[WAYS, time("length", "5 ms", "How long the line is held; host time.")],
    Lasts::Instant,
    |values, setup| rule(values, setup, WireAction::Break { lasts_s: values.quantity("length")? }),
);

pub(super) static FRAMING: FaultKind = wire(
    "serial-framing",
    "Bytes of a serial line have no stop bit.",
    "While it lasts, one byte of each frame that it acts on, at a place that is drawn, is read as a zero: \
     its stop bit wasn't there, as with two rates that differ by a few percent. A zero ends a frame: what \
     was one becomes two pieces of none.",
    &[WAYS, SHARE],
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Framing),
);

pub(super) static HANG_UP: FaultKind = wire(
    "wire-hang-up",
    "The port goes away, as when its plug is pulled, and comes back.",
    "At its onset the harness's port is closed, and can't be opened again before `away` of host time has \
     passed. What is on its way then is lost. By default the run ends there, as a failure of the bench; \
     with `endpoint.link.reconnect` longer than `away` it goes on, asks for the answer again, and the gap \
     is counted. The device keeps its power and its session.",
    &[time("away", "1 s", "How long the port is away; host time.")],
    Lasts::Instant,
    |values, setup| rule(values, setup, WireAction::HangUp { away_s: values.quantity("away")? }),
);

pub(super) static SLOW_READER: FaultKind = wire(
    "wire-slow-reader",
    "The harness takes nothing from its port for a time.",
    "From its onset nothing is read for `pause` of host time: what the device sends fills the buffers on \
     the way, and then its own. Afterwards all comes at once, as far as it was kept.",
    &[time("pause", "500 ms", "How long nothing is read; host time.")],
    Lasts::Instant,
    |values, setup| {
        rule(values, setup, WireAction::SlowReader { pause_s: values.quantity("pause")? })
    },
);
