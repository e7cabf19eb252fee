//! Drives that don't follow their commands.

use super::gimbal::{GIMBAL, happens, limited};
use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::FaultRule;
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use octant_sample::disturbance::GimbalAction;

pub(super) static STALL: FaultKind = FaultKind {
    name: "stall",
    family: Family::Turntable,
    acts: Acts::Plant,
    summary: "The drive of a gimbal stops and stands, whatever it is told.",
    model: "At the onset the drive brakes with the turntable's acceleration limit to a stop, and \
            stands while the fault lasts; set points are remembered and nothing is done about them. \
            When the fault ends it goes to the last set point from where it stands, with the usual \
            trapezoidal rate. Gyros, accelerometers, encoder and truth tell what really happens. In \
            a dwell nothing is to be seen until the next move.\n\n\
            The rest of a move is late by the time for which it stood; a core that waits for a time, \
            not for the encoder, calibrates in attitudes it doesn't believe to be in. A real stall \
            (overload, current limit) can also let the gimbal be turned back: see gimbal-slip.",
    parameters: &[GIMBAL],
    lasts: Lasts::Span,
    example: Example::of(&[
        ("trigger", r#"{ moving_to = 3, after = "3 s" }"#),
        ("duration", r#""5 s""#),
    ]),
    build: build_stall,
};

fn build_stall(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    happens(values, GimbalAction::Stall)
}

pub(super) static RUNAWAY: FaultKind = FaultKind {
    name: "runaway",
    family: Family::Turntable,
    acts: Acts::Plant,
    summary: "The drive of a gimbal turns on with a rate, whatever it is told.",
    model: "At the onset the drive goes to the given rate with the turntable's acceleration limit, \
            and turns on with it while the fault lasts; set points are remembered and nothing is \
            done about them. When the fault ends it brakes and goes to the last set point with the \
            usual trapezoidal rate, back over all turns that it has made. Gyros, accelerometers, \
            encoder and truth tell what really happens; beyond ±16 rad the encoder's count \
            saturates.\n\n\
            It is a servo that has lost its feedback. A real table has limit switches or a power \
            cut-off: give the fault the duration after which they act.",
    parameters: &[
        GIMBAL,
        FaultParameter {
            name: "rate",
            takes: Takes::Quantity(&[Dimension::AngularRate], ParameterBounds::NotZero),
            default: None,
            doc: "Rate, signed, at most 10 rad/s (573 deg/s).",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("rate", r#""5 deg/s""#), ("duration", r#""3 s""#)]),
    build: build_runaway,
};

fn build_runaway(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let rate_radps = limited(values, "rate", 10.0, "rad/s")?;
    happens(values, GimbalAction::Runaway { rate_radps })
}

pub(super) static OVERSHOOT: FaultKind = FaultKind {
    name: "overshoot",
    family: Family::Turntable,
    acts: Acts::Plant,
    summary: "Every move of a gimbal goes beyond its target and comes back.",
    model: "Every move of the gimbal that begins while the fault lasts goes to its target and beyond \
            by the angle a, in the direction in which it arrives, stops there and comes back: two \
            moves with the usual trapezoidal rate, the second one of 2 √(a/α) at an acceleration \
            limit α where it doesn't reach the largest rate. Gyros, accelerometers, encoder and \
            truth tell what really happens. A move that is under way at the onset is not affected, \
            one that is under way at the end is completed. In the position it reaches nothing is \
            left of it.\n\n\
            A core that takes the dwell as begun after the nominal time of the move meets a table \
            that still turns. A real overshoot is that of the servo loop, smoother than this one.",
    parameters: &[
        GIMBAL,
        FaultParameter {
            name: "angle",
            takes: Takes::Quantity(&[Dimension::Angle], ParameterBounds::Positive),
            default: None,
            doc: "Angle a beyond the target, at most 1 rad.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[
        ("angle", r#""0.5 deg""#),
        ("trigger", "{ moving_to = 3 }"),
        ("duration", r#""15 s""#),
    ]),
    build: build_overshoot,
};

fn build_overshoot(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let angle_rad = limited(values, "angle", 1.0, "rad")?;
    happens(values, GimbalAction::Overshoot { angle_rad })
}
