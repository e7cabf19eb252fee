//! Frames that are lost, late, doubled, in another order, or foreign.

use super::rule::{SHARE, WAYS, count, number, rule, time, wire};
use crate::catalogue::{FaultKind, FaultParameter, Lasts};
use crate::wire::WireAction;

const PARAMETERS: &[FaultParameter] = &[WAYS, SHARE];

pub(super) static LOSS: FaultKind = wire(
    "wire-loss",
    "Frames are lost: all of them, or some at random.",
    "While it lasts, each frame is lost with the probability `share`, each on its own: a datagram that \
     never arrives, a stretch of a line that is drowned in noise, a CAN frame for which a receiver had no \
     room. In lock-step it is asked for again. Where all are lost for longer than the scenario waits for \
     an answer, the run ends as a failure of the bench.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Lose),
);

pub(super) static DUPLICATE: FaultKind = wire(
    "wire-duplicate",
    "Frames come twice.",
    "While it lasts, each frame that it acts on is sent twice, one right after the other. A device never \
     steps twice on a step: it answers again what it answered, and counts it.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Duplicate),
);

pub(super) static REORDER: FaultKind = wire(
    "wire-reorder",
    "Frames overtake each other.",
    "While it lasts, each frame that it acts on is held back until the next one of its way was sent. In \
     lock-step that may be the same request, asked for again.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Reorder),
);

pub(super) static DELAY: FaultKind = wire(
    "wire-delay",
    "Frames come late, by a time and a jitter.",
    "While it lasts, each frame that it acts on arrives later by\n\n\
     \u{20}   by + jitter · u,  u uniform from 0 to 1\n\n\
     of host time. Those of a way stay in order: none overtakes another. In lock-step the run takes \
     longer; in real time the answer is late, and where it comes after the next sample was due, so is \
     the set point.",
    &[
        WAYS,
        SHARE,
        time("by", "2 ms", "By how much each is late, at least; host time."),
        time("jitter", "0 s", "By up to how much more; host time."),
    ],
    Lasts::Span,
    |values, setup| {
        let action = WireAction::Delay {
            by_s: values.quantity("by")?,
            jitter_s: values.quantity("jitter")?,
        };
        rule(values, setup, action)
    },
);

pub(super) static REPLAY: FaultKind = wire(
    "wire-replay",
    "An old frame comes again.",
    "While it lasts, before each frame that it acts on comes one again that was sent `age` frames ago on \
     the same way, intact: a bridge that empties an old buffer. It has the step that it had. A device \
     does nothing on a step that was, or answers the last one again; an old output answers nothing that is \
     asked for.",
    &[WAYS, SHARE, count("age", 1, 32, "4", "How many frames ago it was sent.")],
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Replay { age: number(values, "age")? }),
);

pub(super) static SPLIT: FaultKind = wire(
    "wire-split",
    "A frame comes in pieces with pauses between them.",
    "While it lasts, each frame that it acts on comes in pieces of about the same length, with pauses \
     of host time between them: an adapter that sends what it has whenever its timer runs out. No byte is \
     altered. On a serial line alone: a datagram and a CAN frame arrive whole or not at all.",
    &[
        WAYS,
        SHARE,
        count("pieces", 2, 64, "3", "How many pieces."),
        time("pause", "1 ms", "Time between two pieces; host time."),
    ],
    Lasts::Span,
    |values, setup| {
        let action = WireAction::Split {
            pieces: number(values, "pieces")?,
            apart_s: values.quantity("pause")?,
        };
        rule(values, setup, action)
    },
);

pub(super) static COALESCE: FaultKind = wire(
    "wire-coalesce",
    "Frames wait for the next one, and come together.",
    "While it lasts, each frame that it acts on waits until the next one of its way is sent, and both \
     come at once, in order and unaltered; of UDP in one datagram. In lock-step the next one may be the \
     same request, asked for again. Not on a CAN bus, where frames are sent one by one.",
    PARAMETERS,
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Coalesce),
);

pub(super) static BABBLE: FaultKind = wire(
    "wire-babble",
    "Something else is sent between the frames.",
    "While it lasts, before each frame that it acts on come `count` bytes that are drawn, zeros among \
     them; on UDP a datagram of them; on a CAN bus so many frames with identifiers and data that are \
     drawn, of the format of the bus. A receiver finds the next frame after any of it, and counts what \
     was none.",
    &[WAYS, SHARE, count("count", 1, 512, "64", "How many bytes, or CAN frames.")],
    Lasts::Span,
    |values, setup| rule(values, setup, WireAction::Babble { count: number(values, "count")? }),
);
