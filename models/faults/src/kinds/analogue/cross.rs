//! Cross-coupling of axes.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::added::{Adder, counts_per_si};
use crate::kinds::channel::{gyros, pair, read};
use crate::rule::{Context, FaultRule, Onset, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static CROSS_AXIS: FaultKind = FaultKind {
    name: "cross-axis",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "A sensor tilts and feels a part of another axis: a step of misalignment.",
    model: "Every sample becomes\n\n\
            \u{20}   Δ'_into = Δ_into + s γ Δ_from\n\n\
            with both channels of one triad: the element (into, from) of the misalignment matrix \
            jumps by γ (small angles: the loss γ²/2 on the axis itself is left out). The change is \
            added in counts with the remainder carried; `from` isn't altered. s is 1 while the \
            fault lasts and falls linearly to 0 over its recovery. A sum outside the format \
            saturates and sets the saturation flag of its triad.\n\n\
            A mounting that gives way under shock or heat does this: misalignment of the input \
            axis, IEEE Std 952; cross-axis sensitivity, IEEE Std 1293.",
    parameters: &[
        FaultParameter {
            name: "from",
            takes: Takes::Channels,
            default: None,
            doc: "The axis that is felt: one gyro or one accelerometer.",
        },
        FaultParameter {
            name: "into",
            takes: Takes::Channels,
            default: None,
            doc: "The sensor that tilts: another of the same triad.",
        },
        FaultParameter {
            name: "angle",
            takes: Takes::Quantity(&[Dimension::SmallAngle], ParameterBounds::NotZero),
            default: None,
            doc: "γ: angle by which it tilts towards the other axis.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[
        ("from", r#""gyro z""#),
        ("into", r#""gyro x""#),
        ("trigger", "{ moving_to = 3 }"),
        ("duration", r#""12 s""#),
    ]),
    build: build_cross,
};

pub(super) static G_SENSITIVITY: FaultKind = FaultKind {
    name: "g-sensitivity",
    family: Family::Analogue,
    acts: Acts::Samples,
    summary: "The g-dependent bias of one or more gyros changes.",
    model: "Every sample of the gyros becomes\n\n\
            \u{20}   Δθ' = Δθ + s (Gx Δvx + Gy Δvy + Gz Δvz)\n\n\
            with the increments Δv of the same sample as they reach the fault: G is added to the \
            gyro's row of the g-dependent matrix. For several elements in different rows take \
            several faults. The change is added in counts with the remainder carried. s is 1 while \
            the fault lasts and falls linearly to 0 over its recovery. A sum outside the format \
            saturates and sets the saturation flag of the gyros.\n\n\
            The specific force is the measured one, with the accelerometers' own errors (at \
            Table 1 values 1e-4 of G). It is the acceleration-sensitive drift of IEEE Std 952, \
            which the two tilted positions make observable (Zheng, Han and Zheng, 2015).",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Gyros whose row changes.",
        },
        FaultParameter {
            name: "coefficients",
            takes: Takes::Vector(&[Dimension::GDependent]),
            default: None,
            doc: "G: what is added to the row, for specific force along x, y and z.",
        },
    ],
    lasts: Lasts::Fading,
    example: Example::of(&[("coefficients", r#"["0 deg/h/g", "0 deg/h/g", "0.05 deg/h/g"]"#)]),
    build: build_g,
};

fn build_cross(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let [from, into] = pair(values, "from", "into")?;
    let mut row = [0.0; 6];
    row[from] = values.quantity("angle")?;
    let only = if into < 3 { Channels::gyro(into) } else { Channels::accelerometer(into - 3) };
    Ok(Cross::rule(only, row))
}

fn build_g(values: &Values, _: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = gyros(values, "channels")?;
    let g = values.vector("coefficients")?;
    if g == [0.0; 3] {
        let problem = "three zeros were found, at least one that isn't zero is expected";
        return Err(FaultBuildError::value("coefficients", problem));
    }
    let mut row = [0.0; 6];
    for axis in 0..3 {
        row[3 + axis] = g[axis] * counts_per_si(0) / counts_per_si(3);
    }
    Ok(Cross::rule(channels, row))
}

/// Adds the same linear combination of counts to every channel.
#[derive(Clone, Debug)]
struct Cross {
    channels: Channels,
    row: [f64; 6],
    adder: Adder,
    onset: Onset,
}

octant_state::state! { Cross { values: adder, onset; parts: ; kept: channels, row } }

impl Cross {
    fn rule(channels: Channels, row: [f64; 6]) -> FaultRule {
        let (adder, onset) = (Adder::default(), Onset::default());
        FaultRule::Samples(Box::new(Self { channels, row, adder, onset }))
    }
}

impl SampleRule for Cross {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        if self.onset.is_new(now) {
            self.adder.clear();
        }
        // No altered channel has a part in the row.
        let felt: f64 =
            (0..6).map(|channel| self.row[channel] * f64::from(read(&epoch.sample, channel))).sum();
        for channel in self.channels.iter() {
            self.adder.add(&mut epoch.sample, channel, now.strength * felt);
        }
    }
}
