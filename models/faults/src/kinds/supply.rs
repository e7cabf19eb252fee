//! The supply of a device. The list is behind the others: FMUs number kinds by their place.

use super::unit::Once;
use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::{FaultRule, UnitEvent};
use alloc::boxed::Box;

pub(super) static KINDS: &[&FaultKind] = &[&VOLTAGE_DIP];

static VOLTAGE_DIP: FaultKind = FaultKind {
    name: "voltage-dip",
    family: Family::Unit,
    acts: Acts::Power,
    summary: "The supply of the device under test gives less voltage for a time.",
    model: "At its onset the supply of `[power]` is set to `voltage`, and after `length` back to its own \
            voltage, before the epoch of the onset is sent. Both are real: a length in time of the host, \
            in which the source waits and the device idles, and a supply whose voltage can be set, which \
            a relay's can't. With the settling of the supply and its measurements the dip is longer than \
            `length`; the times and voltages measured are in the recording and in the manifest.\n\n\
            Then the device is asked for its time. One that answers within `endpoint.link.answer` has \
            ridden through, and the run goes on with no bit changed. One that has lost its session \
            restarted: a new one begins, and the run goes on as after `restart`. The epoch of the onset \
            counts as altered in both cases.",
    parameters: &[
        FaultParameter {
            name: "voltage",
            takes: Takes::Quantity(&[Dimension::Voltage], ParameterBounds::Positive),
            default: None,
            doc: "Voltage of the supply while it lasts, below its own.",
        },
        FaultParameter {
            name: "length",
            takes: Takes::Quantity(
                &[Dimension::Time],
                ParameterBounds::Within(0.0, 600.0, "from 0 s to 10 min"),
            ),
            default: Some("100 ms"),
            doc: "How long the lowered voltage is held once it is measured; host time.",
        },
    ],
    lasts: Lasts::Instant,
    example: Example::of(&[("voltage", r#""9 V""#)]),
    build: |values, _| {
        let event = UnitEvent::VoltageDip {
            voltage_v: values.quantity("voltage")?,
            length_s: values.quantity("length")?,
        };
        Ok(FaultRule::Unit(Box::new(Once { event })))
    },
};
