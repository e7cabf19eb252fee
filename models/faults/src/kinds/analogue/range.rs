//! Saturation and dead zone: the ends and the middle of the range.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::{counts_per_si, fitting};
use crate::kinds::channel::{read, saturated, write};
use crate::kinds::mapped::Mapped;
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static SATURATION: FaultKind = FaultKind {
    name: "saturation",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "The range of one or more channels becomes smaller: what lies beyond is lost.",
    model: "With the limit R every sample of the channels becomes\n\n\
            \u{20}   Δθ' = max(−n, min(n, Δθ))  counts,      n = whole counts in R dt   (Δv alike)\n\n\
            The excess is lost, not carried. Where a count is cut, the saturation flag of its \
            triad is set, or, with `flag` false, it is left as it was: the instrument then lies. \
            Samples within the range aren't altered.\n\n\
            A rebalance loop or a readout that has lost a part of its power limits in this way. \
            The mean over the sample is limited: a peak within a sample passes.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Channels with the smaller range: gyros or accelerometers.",
        },
        FaultParameter {
            name: "limit",
            takes: Takes::Quantity(
                &[Dimension::AngularRate, Dimension::Acceleration],
                ParameterBounds::Positive,
            ),
            default: None,
            doc: "R: largest magnitude that is still measured.",
        },
        FaultParameter {
            name: "flag",
            takes: Takes::Flag,
            default: Some("true"),
            doc: "Whether the instrument says that it saturates.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[
        ("channels", r#""gyro z""#),
        ("limit", r#""8 deg/s""#),
        ("trigger", "{ moving_to = 3 }"),
        ("duration", r#""12 s""#),
    ]),
    build: build_saturation,
};

pub(super) static DEAD_ZONE: FaultKind = FaultKind {
    name: "dead-zone",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "Small input gives no output.",
    model: "With the threshold D a sample of the channels whose magnitude is at most D dt becomes \
            zero. Beyond it, by choice, the whole input comes through or only what exceeds the \
            threshold:\n\n\
            \u{20}   |Δ| ≤ D dt:  Δ' = 0;      beyond:  Δ' = Δ      or      Δ' = Δ − sign(Δ) D dt\n\n\
            The change Δ' − Δ is multiplied by s, 1 while the fault lasts and falling linearly to \
            0 over its recovery, and added in counts with the remainder carried. No flag \
            changes.\n\n\
            It is the dead band (threshold) of IEEE Std 528: stiction in an accelerometer's \
            suspension, a counter that ignores single pulses. For the lock-in of ring lasers take \
            `lock-in`. The threshold is applied to what the sample holds, the instrument's bias \
            and noise included.",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Channels with the dead zone: gyros or accelerometers.",
        },
        FaultParameter {
            name: "threshold",
            takes: Takes::Quantity(
                &[Dimension::GyroBias, Dimension::AccelBias],
                ParameterBounds::Positive,
            ),
            default: None,
            doc: "D: largest magnitude that gives no output.",
        },
        FaultParameter {
            name: "beyond",
            takes: Takes::Choice(&[
                ("whole", "the whole input comes through: the output jumps at the threshold"),
                ("excess", "what exceeds the threshold comes through: the output is continuous"),
            ]),
            default: Some("whole"),
            doc: "What comes through beyond the threshold.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("threshold", r#""20 deg/h""#)]),
    build: build_dead_zone,
};

fn build_saturation(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let limit = fitting(values, channels, "limit")?;
    let channel = if channels.gyros_only() { 0 } else { 3 };
    let counts = limit * setup.dt_s() * counts_per_si(channel);
    if !(1.0..f64::from(i32::MAX)).contains(&counts) {
        let problem = alloc::format!(
            "{counts} counts a sample were found, from 1 to {} are expected: the format's own \
             range ends there",
            i32::MAX - 1
        );
        return Err(FaultBuildError::value("limit", problem));
    }
    let flag = values.flag("flag")?;
    Ok(FaultRule::Samples(Box::new(Saturation { channels, limit: counts as i32, flag })))
}

#[derive(Clone, Debug)]
struct Saturation {
    channels: Channels,
    /// Limit, counts.
    limit: i32,
    flag: bool,
}

octant_state::state! { Saturation { values: ; parts: ; kept: channels, limit, flag } }

impl SampleRule for Saturation {
    fn on_epoch(&mut self, epoch: &mut Epoch, _: &Context<'_>) {
        for channel in self.channels.iter() {
            let count = read(&epoch.sample, channel);
            let clamped = count.clamp(-self.limit, self.limit);
            if clamped != count {
                write(&mut epoch.sample, channel, clamped);
                if self.flag {
                    epoch.sample.status |= saturated(channel);
                }
            }
        }
    }
}

fn build_dead_zone(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let threshold = fitting(values, channels, "threshold")? * setup.dt_s();
    let excess = values.choice("beyond")? == "excess";
    Ok(Mapped::rule(channels, move |channel, count: f64| {
        let limit = threshold * counts_per_si(channel);
        if count.abs() <= limit {
            -count
        } else if excess {
            -libm::copysign(limit, count)
        } else {
            0.0
        }
    }))
}
