//! Faults of a CAN bus.

use super::rule::{SHARE, WAYS, count, number, rule, time, wire};
use crate::catalogue::{FaultKind, Lasts};
use crate::wire::WireAction;

pub(super) static ERROR_FRAME: FaultKind = wire(
    "can-error-frame",
    "Error frames break up frames on the bus.",
    "While it lasts, each frame that it acts on is broken up by an error frame: its sender sends it again \
     at once, so that it arrives unaltered and in order, 0.2 ms later; and the controller reports the \
     error, which the harness counts.",
    &[WAYS, SHARE],
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::ErrorFrame),
);

pub(super) static ARBITRATION: FaultKind = wire(
    "can-arbitration-lost",
    "Frames lose the arbitration against another node.",
    "While it lasts, before each frame that it acts on another node sends one with an identifier that wins: \
     slot 0, which is nobody's. Ours follows unaltered, and the controller reports that it lost.",
    &[WAYS, SHARE],
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::ArbitrationLost),
);

pub(super) static OFF: FaultKind = wire(
    "can-bus-off",
    "The harness's controller leaves the bus for a time.",
    "At its onset the controller reports that it has left the bus. For `off` of host time nothing is sent \
     and nothing received, what would have been is lost; then it reports that it is back. In lock-step \
     what was lost is asked for again; where that takes longer than the scenario waits for an answer, the \
     run ends as a failure of the bench that says that the controller is off the bus.",
    &[time("off", "200 ms", "How long it is off the bus; host time.")],
    Lasts::Instant,
    |values, setup| rule(values, setup, WireAction::BusOff { off_s: values.quantity("off")? }),
);

pub(super) static COLLISION: FaultKind = wire(
    "can-id-collision",
    "Another node sends under our identifiers.",
    "While it lasts, before each frame that it acts on comes one of another node with the same identifier \
     and length and data that are drawn. The message that it falls into is one of two senders: its \
     checksum tells, and it is dropped.",
    &[WAYS, SHARE],
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Collision),
);

pub(super) static OVERLOAD: FaultKind = wire(
    "can-overload",
    "The bus is full of frames of others.",
    "While it lasts, each frame that it acts on waits until `frames` others have been sent, which take \
     `each` of host time: of 8 bytes at 500 kbit/s that is 0.27 ms. They have an identifier that wins, \
     slot 0, and the harness receives them.",
    &[
        WAYS,
        SHARE,
        count("frames", 1, 256, "10", "How many frames of others come before each."),
        time("each", "270 us", "How long one of them takes; host time."),
    ],
    Lasts::Span,
    |values, setup| {
        let action = WireAction::Overload {
            frames: number(values, "frames")?,
            each_s: values.quantity("each")?,
        };
        rule(values, setup, action)
    },
);
