//! Keys of a device at the other end of a wire.

use super::definition::{Bounds, Default, Kind, Section, key, section};
use crate::quantity::Dimension;

const WAIT: Kind =
    Kind::Quantity(&[Dimension::TIME], Bounds::Within(1e-3, 3600.0, "from 1 ms to 1 h"));

pub(crate) static ENDPOINT_LINK: Section = section(&[
    key(
        "hello",
        WAIT,
        Default::Value("10 s"),
        "How long the device's first hello is waited for, such as while it is switched on.",
    ),
    key(
        "answer",
        WAIT,
        Default::Value("5 s"),
        "How long an answer is waited for, however often it is asked for; then the device is gone.",
    ),
    key(
        "repeat",
        WAIT,
        Default::Value("200 ms"),
        "After how long an answer that isn't there is asked for again.",
    ),
    key(
        "reconnect",
        Kind::Quantity(&[Dimension::TIME], Bounds::Within(0.0, 3600.0, "from 0 s to 1 h")),
        Default::Value("0 s"),
        "How long a port that was unplugged is waited for; the device has to have kept its state. 0 s: the run ends at once.",
    ),
]);
