//! NaN and infinity where a port has real numbers.

use crate::catalogue::{Acts, Example, Family, FaultKind, FaultParameter, Lasts, Takes};
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::{Epoch, Reference};

pub(super) static AIDING_NAN: FaultKind = FaultKind {
    name: "aiding-nan",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "The reference is not a number, or infinite.",
    model: "While it lasts the chosen components of every aiding message are NaN (quiet, positive, \
            no payload: 7ff8000000000000), +∞ or −∞. First, second and third are velocity north, \
            east, down, or latitude, longitude, height. Samples aren't altered, nor are epochs \
            without aiding: a fault that is shorter than the distance of two aiding messages may \
            alter nothing.\n\n\
            Inertial counts and gimbal angles are integers and have no such values; the reference \
            comes as 64-bit floating point, and a division by zero in the system that computes it \
            arrives like this.",
    parameters: &[
        FaultParameter {
            name: "component",
            takes: Takes::Choice(&[
                ("all", "all three"),
                ("first", "north, or the latitude"),
                ("second", "east, or the longitude"),
                ("third", "down, or the height"),
            ]),
            default: Some("all"),
            doc: "Which components.",
        },
        FaultParameter {
            name: "value",
            takes: Takes::Choice(&[
                ("not-a-number", "NaN"),
                ("infinity", "positive infinity"),
                ("minus-infinity", "negative infinity"),
            ]),
            default: Some("not-a-number"),
            doc: "What they become.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("duration", r#""10 s""#)]),
    build,
};

fn build(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let hit = match values.choice("component")? {
        "first" => [true, false, false],
        "second" => [false, true, false],
        "third" => [false, false, true],
        _ => [true; 3],
    };
    let value = match values.choice("value")? {
        "infinity" => f64::INFINITY,
        "minus-infinity" => f64::NEG_INFINITY,
        _ => f64::NAN,
    };
    Ok(FaultRule::Samples(Box::new(AidingNan { hit, value })))
}

#[derive(Clone, Debug)]
struct AidingNan {
    hit: [bool; 3],
    value: f64,
}

octant_state::state! { AidingNan { values: ; parts: ; kept: hit, value } }

impl SampleRule for AidingNan {
    fn on_epoch(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        let Some(aiding) = &mut epoch.aiding else { return };
        let components = match &mut aiding.reference {
            Reference::Velocity([north, east, down]) => [north, east, down],
            Reference::Position { latitude_rad, longitude_rad, height_m } => {
                [latitude_rad, longitude_rad, height_m]
            }
        };
        for (component, hit) in components.into_iter().zip(self.hit) {
            if hit {
                *component = self.value;
            }
        }
    }
}
