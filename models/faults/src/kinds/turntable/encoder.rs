//! Encoders that read a wrong angle; no part moves.

use super::gimbal::{GIMBAL, chosen, happens, limited};
use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::{Context, FaultRule, PlantRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use octant_sample::disturbance::{Disturbance, Gimbal, GimbalAction, Motor};

pub(super) static ENCODER_SLIP: FaultKind = FaultKind {
    name: "encoder-slip",
    family: Family::Turntable,
    acts: Acts::Plant,
    summary: "The encoder of a gimbal slips on its shaft: it reads another angle, and nothing moves.",
    model: "While the fault lasts the encoder reads as if its gimbal were turned further by the \
            angle a:\n\n\
            \u{20}   reading = angle + a + error curve at (angle + a)\n\n\
            from the stamp at the end of the first interval on. Gyros, accelerometers and truth are \
            bit for bit those without it, and no flag is set. When the fault ends the encoder has \
            been set right and reads as before.\n\n\
            It is a loose coupling or disc, or counts that were lost to dirt on an incremental \
            encoder: then a is a whole number of its lines.",
    parameters: &[
        GIMBAL,
        FaultParameter {
            name: "angle",
            takes: Takes::Quantity(&[Dimension::Angle], ParameterBounds::NotZero),
            default: None,
            doc: "Angle a, at most a turn.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("angle", r#""0.5 deg""#), ("duration", r#""10 s""#)]),
    build: build_slip,
};

fn build_slip(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let angle_rad = limited(values, "angle", 2.0 * core::f64::consts::PI, "rad")?;
    happens(values, GimbalAction::EncoderSlip { angle_rad, flagged: false })
}

pub(super) static INDEX_LOSS: FaultKind = FaultKind {
    name: "index-loss",
    family: Family::Turntable,
    acts: Acts::Plant,
    summary: "The encoder of a gimbal loses its index and counts from zero where it stands.",
    model: "An incremental encoder that loses power, or its index, starts anew: it counts from zero \
            at the angle α0 at which its drive stood at the onset, and while the fault lasts it \
            reads\n\n\
            \u{20}   reading = angle − α0 + error curve at (angle − α0)\n\n\
            from the stamp at the end of the first interval on. With α0 = 0 nothing but the flag \
            changes. An encoder that knows that it has no index flags it: every sample then says \
            that its gimbal angles are not to be used (the flag is one for both gimbals). Gyros, \
            accelerometers and truth are bit for bit those without it. When the fault ends the index \
            has been found: angle and flag are as before.\n\n\
            The drive of the turntable is not disturbed: it has its own feedback.",
    parameters: &[
        GIMBAL,
        FaultParameter {
            name: "flagged",
            takes: Takes::Flag,
            default: Some("true"),
            doc: "Whether the encoder knows that it has no index.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[
        ("trigger", r#"{ position = 3, after = "20 s" }"#),
        ("duration", r#""10 s""#),
    ]),
    build: build_index,
};

fn build_index(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let (gimbal, flagged) = (chosen(values)?, values.flag("flagged")?);
    Ok(FaultRule::Plant(Box::new(IndexLoss { gimbal, flagged })))
}

#[derive(Clone, Debug)]
struct IndexLoss {
    gimbal: Gimbal,
    flagged: bool,
}

octant_state::state! { IndexLoss { values: ; parts: ; kept: gimbal, flagged } }

impl PlantRule for IndexLoss {
    fn begin(&mut self, _: &Context<'_>, motor: &Motor) -> Disturbance {
        let angle_rad = -motor.angle_rad[self.gimbal.index()];
        let action = GimbalAction::EncoderSlip { angle_rad, flagged: self.flagged };
        Disturbance::Gimbal { gimbal: self.gimbal, action }
    }
}
