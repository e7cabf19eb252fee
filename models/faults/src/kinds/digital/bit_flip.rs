//! Single bits of counts.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::kinds::channel::{read, write};
use crate::kinds::parameters::Six;
use crate::rule::{Context, FaultRule, SampleRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::{Channels, Values};
use alloc::boxed::Box;
use octant_sample::Epoch;

pub(super) static BIT_FLIP: FaultKind = FaultKind {
    name: "bit-flip",
    family: Family::Digital,
    acts: Acts::Samples,
    summary: "A bit of one or more channels flips, or sticks at 1 or 0.",
    model: "While it lasts the bit n of the channels' counts (32-bit two's complement, 0 the \
            least significant, 31 the sign) is inverted, set or cleared. Each sample of each \
            channel is hit by itself with the given probability. A bit that sticks where it \
            already stands alters nothing. No flag changes, and no checksum fails: the bit flips \
            before the message is made.\n\n\
            Bit n of a gyro is 2ⁿ·2⁻³⁶ rad a sample, of an accelerometer 2ⁿ·2⁻³⁰ m/s: at 200 Hz \
            bit 10 is 0.61 deg/h and 19 µg, bit 20 is 0.17 deg/s and 20 mg.\n\n\
            A stuck line of a parallel bus or a register hit by radiation does this (single \
            events: a small probability, or a short duration).",
    parameters: &[
        FaultParameter {
            name: "channels",
            takes: Takes::Channels,
            default: None,
            doc: "Channels whose counts are hit.",
        },
        FaultParameter {
            name: "bit",
            takes: Takes::Integer(0, 31),
            default: None,
            doc: "n: number of the bit, 0 the least significant, 31 the sign.",
        },
        FaultParameter {
            name: "becomes",
            takes: Takes::Choice(&[
                ("inverted", "1 becomes 0 and 0 becomes 1"),
                ("set", "the bit sticks at 1"),
                ("cleared", "the bit sticks at 0"),
            ]),
            default: Some("inverted"),
            doc: "What becomes of the bit.",
        },
        FaultParameter {
            name: "probability",
            takes: Takes::Quantity(
                &[Dimension::Ratio],
                ParameterBounds::Within(0.0, 1.0, "above 0, up to 1 (100 %)"),
            ),
            default: Some("100 %"),
            doc: "Probability that a sample of a channel is hit; above 0.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::of(&[("bit", "20"), ("duration", r#""0.1 s""#)]),
    build,
};

fn build(values: &Values, setup: &Setup) -> Result<FaultRule, FaultBuildError> {
    let channels = values.channels("channels")?;
    let bit = values.integer("bit")?;
    let Some(mask) = u32::try_from(bit).ok().and_then(|bit| 1u32.checked_shl(bit)) else {
        let problem = alloc::format!("{bit} was found, 0 to 31 is expected");
        return Err(FaultBuildError::value("bit", problem));
    };
    let probability = values.quantity("probability")?;
    if !(probability > 0.0) {
        let problem = alloc::format!("{probability} was found, more than 0 is expected");
        return Err(FaultBuildError::value("probability", problem));
    }
    let becomes = match values.choice("becomes")? {
        "set" => Becomes::Set,
        "cleared" => Becomes::Cleared,
        _ => Becomes::Inverted,
    };
    // With certainty no random number is needed.
    let dice = (probability < 1.0).then(|| (Six::new(setup, channels, "hit"), probability));
    Ok(FaultRule::Samples(Box::new(BitFlip { channels, mask: mask as i32, becomes, dice })))
}

#[derive(Clone, Copy, Debug)]
enum Becomes {
    Inverted,
    Set,
    Cleared,
}

#[derive(Clone, Debug)]
struct BitFlip {
    channels: Channels,
    mask: i32,
    becomes: Becomes,
    dice: Option<(Six, f64)>,
}

octant_state::state! { BitFlip { values: ; parts: ; kept: channels, mask, becomes, dice } }

impl SampleRule for BitFlip {
    fn on_epoch(&mut self, epoch: &mut Epoch, now: &Context<'_>) {
        let thrown = self.dice.map(|(six, probability)| (six.uniforms(now), probability));
        for channel in self.channels.iter() {
            if thrown.is_some_and(|(thrown, probability)| thrown[channel] >= probability) {
                continue;
            }
            let count = read(&epoch.sample, channel);
            let count = match self.becomes {
                Becomes::Inverted => count ^ self.mask,
                Becomes::Set => count | self.mask,
                Becomes::Cleared => count & !self.mask,
            };
            write(&mut epoch.sample, channel, count);
        }
    }
}
