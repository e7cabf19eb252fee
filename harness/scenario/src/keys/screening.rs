//! Keys of the screening.

use super::definition::{Bounds, Default, Kind, Section, key, section};
use crate::quantity::Dimension;

pub(crate) static SCREENING: Section = section(&[
    key(
        "gate",
        Kind::Either(&[Kind::Choice(&[("off", "every measurement is used")]), Kind::Table(&GATE)]),
        Default::Value("{}"),
        "Innovation gate.",
    ),
    key(
        "stuck_samples",
        Kind::Either(&[Kind::Choice(&[("off", "no test")]), Kind::Integer(2, 1_000_000)]),
        Default::Value("8"),
        "Identical counts in a row that make a channel stuck.",
    ),
    key(
        "jumps",
        ON_OFF,
        Default::Derived("recordings as text: \"off\"; else \"on\""),
        "Samples that jump as no motion of turntable and base can are not believed.",
    ),
    key(
        "bridging",
        ON_OFF,
        Default::Value("on"),
        "Samples missing, invalid, stuck or not believed are bridged by what is known of the motion; \
         off: used as they are.",
    ),
    key(
        "gimbals",
        ON_OFF,
        Default::Value("on"),
        "Turns by gyros and by encoders are compared, and encoders with the set point.",
    ),
    key(
        "drift",
        Kind::Either(&[Kind::Choice(&[("off", "no test")]), Kind::Number(Bounds::Positive)]),
        Default::Derived("static: 6; dockside: 8"),
        "Correction of a parameter over a stretch of the calibration, in its standard deviations, \
         above which the calibration is refused.",
    ),
    key(
        "checkpoints",
        ON_OFF,
        Default::Value("on"),
        "A recovery goes back to the parameters of one to two minutes before it.",
    ),
    key(
        "aiding_stamps",
        ON_OFF,
        Default::Value("on"),
        "Aiding that doesn't carry the stamp of its sample is not used.",
    ),
]);

const ON_OFF: Kind = Kind::Choice(&[("on", "done"), ("off", "not done")]);

static GATE: Section = section(&[
    key(
        "nis",
        Kind::Number(Bounds::Positive),
        Default::Value("36.0"),
        "Normalized innovation squared (three axes) above which a measurement is rejected.",
    ),
    key(
        "rejections",
        Kind::Integer(1, 1_000_000),
        Default::Value("5"),
        "Rejections in a row that start a recovery.",
    ),
    key(
        "recovery",
        Kind::Either(&[
            Kind::Choice(&[(
                "widening",
                "attitude, velocity, position re-open as wide as the innovation says",
            )]),
            Kind::Table(&RESET),
        ]),
        Default::Value("widening"),
        "What a recovery does: widening, or a reset to given standard deviations.",
    ),
]);

static RESET: Section = section(&[
    key(
        "attitude",
        Kind::Quantity(&[Dimension::SMALL_ANGLE], Bounds::Positive),
        Default::Value("600 arcsec"),
        "Attitude after a reset.",
    ),
    key(
        "velocity",
        Kind::Quantity(&[Dimension::VELOCITY], Bounds::Positive),
        Default::Value("1 m/s"),
        "Velocity after a reset.",
    ),
    key(
        "position",
        Kind::Quantity(&[Dimension::LENGTH], Bounds::Positive),
        Default::Value("10 m"),
        "Position after a reset.",
    ),
]);
