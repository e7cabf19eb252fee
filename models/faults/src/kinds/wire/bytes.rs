//! Frames that arrive damaged.

use super::rule::{SHARE, WAYS, rule, wire};
use crate::catalogue::{FaultKind, FaultParameter, Lasts};
use crate::wire::WireAction;

const PARAMETERS: &[FaultParameter] = &[WAYS, SHARE];

pub(super) static FLIP: FaultKind = wire(
    "wire-flip",
    "A bit of a frame is the other one.",
    "While it lasts, one bit of each frame that it acts on is the other one; which one is drawn, each \
     as likely as the next. On a line of bytes and on UDP the frame's checksum finds it, or, where the \
     bit ends the frame too early, its stuffing. On a CAN bus it is a bit of the data of a frame that the \
     controller has passed: a gateway or a driver that spoils it. The checksum over the whole message \
     finds that.\n\n\
     In lock-step what is damaged is asked for again: the outputs stay what they are to the last bit, \
     and the run takes longer. In real time a sample or an answer is lost.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Flip),
);

pub(super) static INSERT: FaultKind = wire(
    "wire-insert",
    "A byte is put into a frame.",
    "While it lasts, a byte is put into each frame that it acts on, at a place and of a value that are \
     drawn; it isn't zero. What comes after it moves on by one. Not on a CAN bus, whose frames have \
     their length in them.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Insert),
);

pub(super) static DROP: FaultKind = wire(
    "wire-drop",
    "A byte is left out of a frame.",
    "While it lasts, a byte of each frame that it acts on is left out, at a place that is drawn: the way \
     of a receiver whose buffer ran over. If it is one of the zeros around the frame, nothing is lost, as \
     the next frame brings its own. Not on a CAN bus, whose frames have their length in them.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Drop),
);

pub(super) static TRUNCATE: FaultKind = wire(
    "wire-truncate",
    "The end of a frame is cut off.",
    "While it lasts, each frame that it acts on ends early, at a place that is drawn. On a line what is \
     left of it runs into the next frame, whose leading zero ends it: so the next one is whole. Not on a \
     CAN bus, whose frames have their length in them.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Truncate),
);

pub(super) static CHECKSUM: FaultKind = wire(
    "wire-checksum",
    "The checksum of a frame is wrong.",
    "While it lasts, a bit of the last byte before the end of each frame that it acts on is the other \
     one: that byte is of the checksum, and all before it is intact. Not on a CAN bus: a controller drops \
     such a frame, see `can-error-frame`.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Checksum),
);
