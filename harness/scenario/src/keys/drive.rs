//! Keys of a real table.

use super::definition::{Bounds, Default, Kind, Section, key, section};
use crate::quantity::Dimension;

const fn time(from: f64, words: &'static str) -> Kind {
    Kind::Quantity(&[Dimension::TIME], Bounds::Within(from, 3600.0, words))
}

const RANGE: Kind = Kind::Quantities(Dimension::ANGLE, 2);

pub(crate) static DRIVE: Section = section(&[
    key(
        "port",
        Kind::Text,
        Default::Required,
        "Port of its controller: tcp:HOST:PORT or serial:DEVICE?baud=RATE.",
    ),
    key(
        "dialect",
        Kind::Text,
        Default::Value("aerotech-ensemble"),
        "What the controller speaks: aerotech-ensemble, or a file with a table of patterns.",
    ),
    key(
        "azimuth",
        RANGE,
        Default::Required,
        "Least and greatest angle to which azimuth may turn. How fast both may turn is turntable.rate and turntable.acceleration.",
    ),
    key("roll", RANGE, Default::Required, "Least and greatest angle to which roll may turn."),
    key(
        "home",
        Kind::Boolean,
        Default::Value("false"),
        "Whether both axes find their reference before the run.",
    ),
    key(
        "start",
        time(1.0, "from 1 s to 1 h"),
        Default::Value("2 min"),
        "How long homing may take, and the way to zero, where every run begins.",
    ),
    key(
        "tolerance",
        Kind::Quantity(&[Dimension::SMALL_ANGLE], Bounds::Positive),
        Default::Value("36 arcsec"),
        "How far from zero a gimbal may rest at the start.",
    ),
    key(
        "look",
        time(1e-3, "from 1 ms to 1 h"),
        Default::Value("20 ms"),
        "Pause from one look at the table to the next; set points are told with a look.",
    ),
    key(
        "oldest",
        time(1e-3, "from 1 ms to 1 h"),
        Default::Value("100 ms"),
        "How far a sample may be from the nearest look and still get its gimbal angles; beyond it they are flagged invalid.",
    ),
    key(
        "reply",
        time(1e-3, "from 1 ms to 1 h"),
        Default::Value("500 ms"),
        "How long a reply of the controller is waited for; then the table is stopped.",
    ),
    key(
        "guard",
        time(0.0, "from 0 s to 1 h"),
        Default::Derived("1 s where the system has guards, 0 s elsewhere"),
        "Silence of the program after which a process of its own stops the table. 0 s: there is none.",
    ),
    key(
        "watchdog",
        time(0.0, "from 0 s to 1 h"),
        Default::Value("0 s"),
        "Silence after which the controller stops the table by itself. 0 s: it isn't told to.",
    ),
]);
