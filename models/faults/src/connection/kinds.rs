//! The kinds of faults on connections.

use crate::catalogue::{Dimension, Example, FaultParameter, Lasts, ParameterBounds, Takes};
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::{Value, Values};
use alloc::vec;
use alloc::vec::Vec;
use octant_random::normal::{Ziggurat, uniform};
use octant_random::philox::block;
use octant_random::stream::Phase;

/// A kind of fault on connections.
#[derive(Debug)]
pub struct ConnectionFaultKind {
    /// Name in lists of faults.
    pub name: &'static str,
    /// Summary in one sentence.
    pub summary: &'static str,
    /// Exact effect on values. Paragraphs are separated by empty lines, equations stand on indented
    /// lines.
    pub model: &'static str,
    /// Parameters, beside those that every fault has.
    pub parameters: &'static [FaultParameter],
    /// Duration of faults of this kind.
    pub lasts: Lasts,
    /// Example of the kind.
    pub example: Example,
    /// Types of inputs that it can act on.
    pub on: On,
    build: fn(&Values, &Setup, &[Target]) -> Result<Rule, FaultBuildError>,
}

/// Types of inputs that a kind can act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    /// Floating-point numbers.
    Floats,
    /// Numbers: not Booleans and enumerations.
    Numbers,
    /// Numbers, Booleans and enumerations.
    All,
}

/// Type of an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// 64-bit floating point.
    Float64,
    /// 32-bit floating point.
    Float32,
    /// Whole numbers, from and to.
    Integer(f64, f64),
    /// 0 or 1.
    Boolean,
    /// Values of named items, which only the receiver knows.
    Enumeration,
}

impl Target {
    /// Converts a value to one that the input can have: whole numbers are rounded to the nearest,
    /// ties to even, and limited to the range of the type.
    fn fitted(self, value: f64) -> f64 {
        match self {
            Self::Float64 => value,
            Self::Float32 => f64::from(value as f32),
            Self::Integer(from, to) => libm::rint(value).clamp(from, to),
            Self::Boolean | Self::Enumeration => value,
        }
    }

    /// Returns whether a kind for these types can act on this one.
    #[must_use]
    pub const fn takes(self, on: On) -> bool {
        match on {
            On::Floats => matches!(self, Self::Float64 | Self::Float32),
            On::Numbers => !matches!(self, Self::Boolean | Self::Enumeration),
            On::All => true,
        }
    }
}

/// Finds a kind by its name.
#[must_use]
pub fn named(name: &str) -> Option<&'static ConnectionFaultKind> {
    KINDS.iter().copied().find(|kind| kind.name == name)
}

/// All kinds, in the order of the documentation.
pub static KINDS: &[&ConnectionFaultKind] = &[&STUCK, &BIAS, &SCALE, &NOISE, &DELAY, &DROP, &NAN];

static STUCK: ConnectionFaultKind = ConnectionFaultKind {
    name: "stuck",
    summary: "The input stays at one value.",
    model: "While it lasts, the input gets the same value at every communication point: `value`, or, \
            where that is left out, what was transferred last before the onset. At an onset with the \
            first step there is nothing before; then it is what is transferred first.",
    parameters: &[FaultParameter {
        name: "value",
        takes: Takes::Value,
        default: Some("last"),
        doc: "The value, in the unit of the input or with a unit, or \"last\".",
    }],
    lasts: Lasts::Span,
    example: Example::NONE,
    on: On::All,
    build: |values, _, targets| {
        let value = match values.get("value") {
            Some(Value::Number(value)) => Some(value),
            _ => None,
        };
        Ok(Rule::Stuck { value, held: vec![0.0; targets.len()] })
    },
};

static BIAS: ConnectionFaultKind = ConnectionFaultKind {
    name: "bias",
    summary: "A constant is added.",
    model: "While it lasts,\n\n    y = x + strength · value\n\nwith strength 1, falling to 0 over the \
            recovery. Whole numbers are rounded to the nearest, ties to even, and end at the limits \
            of their type.",
    parameters: &[FaultParameter {
        name: "value",
        takes: Takes::Difference(ParameterBounds::NotZero),
        default: None,
        doc: "What is added, in the unit of the input or with a unit.",
    }],
    lasts: Lasts::Fading,
    example: Example::of(&[("value", r#""0.01 arcsec""#)]),
    on: On::Numbers,
    build: |values, _, _| Ok(Rule::Bias(values.number("value")?)),
};

static SCALE: ConnectionFaultKind = ConnectionFaultKind {
    name: "scale",
    summary: "The value is multiplied.",
    model: "While it lasts,\n\n    y = x + strength · (factor − 1) · x\n\nwith strength 1, falling to \
            0 over the recovery. Whole numbers are rounded to the nearest, ties to even, and end at \
            the limits of their type.",
    parameters: &[FaultParameter {
        name: "factor",
        takes: Takes::Number(ParameterBounds::Any),
        default: None,
        doc: "The factor; 1 would do nothing.",
    }],
    lasts: Lasts::Fading,
    example: Example::of(&[("factor", "1.01")]),
    on: On::Numbers,
    build: |values, _, _| {
        let factor = values.number("factor")?;
        if factor == 1.0 {
            return Err(FaultBuildError::value(
                "factor",
                "found 1, with which nothing would happen",
            ));
        }
        Ok(Rule::Scale(factor))
    },
};

static NOISE: ConnectionFaultKind = ConnectionFaultKind {
    name: "noise",
    summary: "White noise is added.",
    model: "While it lasts,\n\n    y = x + strength · sigma · n\n\nwith n standard normal, drawn anew \
            at every communication point and for every element, and strength 1, falling to 0 over \
            the recovery. n depends on the seed, the id of the fault, the number of the step and \
            that of the element, and on nothing else. Whole numbers are rounded to the nearest, ties \
            to even, and end at the limits of their type.",
    parameters: &[FaultParameter {
        name: "sigma",
        takes: Takes::Difference(ParameterBounds::Positive),
        default: None,
        doc: "Standard deviation, in the unit of the input or with a unit.",
    }],
    lasts: Lasts::Fading,
    example: Example::of(&[("sigma", r#""0.01 arcsec""#)]),
    on: On::Numbers,
    build: |values, setup, targets| {
        let sigma = values.number("sigma")?;
        // Three elements share a stream, which has three numbers for each counter.
        let streams = targets.len().div_ceil(3);
        let stream = |triad| match triad {
            0 => setup.stream("noise"),
            more => setup.stream(&alloc::format!("noise.{more}")),
        };
        Ok(Rule::Noise { sigma, streams: (0..streams).map(stream).collect() })
    },
};

static DELAY: ConnectionFaultKind = ConnectionFaultKind {
    name: "delay",
    summary: "Values arrive late.",
    model: "While it lasts, the input gets at every communication point what would have been \
            transferred `delay` before. In the first steps, when there is nothing so old, it gets \
            what was transferred first. At the end the input jumps to the present value: what was on \
            its way is lost.",
    parameters: &[FaultParameter {
        name: "delay",
        takes: Takes::Quantity(&[Dimension::Time, Dimension::Samples], ParameterBounds::Positive),
        default: None,
        doc: "How late: a time, rounded to whole steps, or a number of steps, \"3 samples\".",
    }],
    lasts: Lasts::Span,
    example: Example::of(&[("delay", r#""10 ms""#)]),
    on: On::All,
    build: |values, setup, targets| {
        let (delay, dimension) = values.quantity_and_dimension("delay")?;
        let steps = match dimension {
            Dimension::Samples => delay,
            _ => libm::rint(delay * 1e9 / setup.sample_period_ns as f64),
        };
        if !(1.0..=DELAY_MAX as f64).contains(&steps) {
            let problem = alloc::format!("it is {steps} steps, expected 1 to {DELAY_MAX}");
            return Err(FaultBuildError::value("delay", problem));
        }
        let steps = steps as usize;
        Ok(Rule::Delay { steps, kept: vec![0.0; (steps + 1) * targets.len()], first: 0 })
    },
};

/// Longest delay, steps.
pub const DELAY_MAX: usize = 1_000_000;

static DROP: ConnectionFaultKind = ConnectionFaultKind {
    name: "drop",
    summary: "Values don't arrive.",
    model: "While it lasts, the transfer at a communication point is lost with `probability`, and \
            the input keeps what it got last (`hold`), or gets 0 (`zero`). All elements of the \
            connection are lost together. Which transfers are lost depends on the seed, the id of \
            the fault and the number of the step, and on nothing else.",
    parameters: &[
        FaultParameter {
            name: "probability",
            takes: Takes::Number(ParameterBounds::Within(
                f64::MIN_POSITIVE,
                1.0,
                "above 0, up to 1",
            )),
            default: Some("1"),
            doc: "Probability that a transfer is lost.",
        },
        FaultParameter {
            name: "becomes",
            takes: Takes::Choice(&[
                ("hold", "the input keeps what it got last"),
                ("zero", "the input gets 0, or false"),
            ]),
            default: Some("hold"),
            doc: "What the input has instead.",
        },
    ],
    lasts: Lasts::Span,
    example: Example::NONE,
    on: On::All,
    build: |values, setup, targets| {
        Ok(Rule::Drop {
            probability: values.number("probability")?,
            zero: values.choice("becomes")? == "zero",
            stream: setup.stream("drop"),
            delivered: vec![0.0; targets.len()],
            lost: false,
        })
    },
};

static NAN: ConnectionFaultKind = ConnectionFaultKind {
    name: "nan",
    summary: "The value is not a number, or infinite.",
    model: "While it lasts, the input gets NaN (quiet, positive, no payload: 7ff8000000000000), +∞ or \
            −∞. An FMU that refuses such a value keeps the one before; the summary counts that.",
    parameters: &[FaultParameter {
        name: "value",
        takes: Takes::Choice(&[
            ("not-a-number", "NaN"),
            ("infinity", "positive infinity"),
            ("minus-infinity", "negative infinity"),
        ]),
        default: Some("not-a-number"),
        doc: "What it becomes.",
    }],
    lasts: Lasts::Span,
    example: Example::NONE,
    on: On::Floats,
    build: |values, _, _| {
        Ok(Rule::Constant(match values.choice("value")? {
            "infinity" => f64::INFINITY,
            "minus-infinity" => f64::NEG_INFINITY,
            _ => f64::NAN,
        }))
    },
};

/// Rule of one fault, with its memory of each element.
#[derive(Debug)]
pub(super) enum Rule {
    Stuck {
        value: Option<f64>,
        held: Vec<f64>,
    },
    Bias(f64),
    Scale(f64),
    Noise {
        sigma: f64,
        streams: Vec<Stream>,
    },
    /// A ring of the values transferred at the epochs before, and the index of the present one.
    Delay {
        steps: usize,
        kept: Vec<f64>,
        first: usize,
    },
    Drop {
        probability: f64,
        zero: bool,
        stream: Stream,
        delivered: Vec<f64>,
        lost: bool,
    },
    Constant(f64),
}

/// State of a fault at an epoch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Now {
    /// Epoch, from 1.
    pub(super) epoch: u64,
    /// True if the fault acts.
    pub(super) acting: bool,
    /// True if the fault sets in at this epoch.
    pub(super) onset: bool,
    /// 1, or less while the fault fades.
    pub(super) strength: f64,
}

impl Rule {
    pub(super) fn new(
        kind: &ConnectionFaultKind,
        values: &Values,
        setup: &Setup,
        targets: &[Target],
    ) -> Result<Self, FaultBuildError> {
        (kind.build)(values, setup, targets)
    }

    /// Returns whether the rule has to see transfers also while the fault doesn't act.
    pub(super) const fn remembers(&self) -> bool {
        matches!(self, Self::Stuck { value: None, .. } | Self::Delay { .. } | Self::Drop { .. })
    }

    /// Begins an epoch, before its transfers.
    pub(super) fn begin(&mut self, now: &Now) {
        match self {
            Self::Delay { steps, first, .. } => *first = (*first + 1) % (*steps + 1),
            Self::Drop { probability, stream, lost, .. } => {
                let key = stream.key(Phase::Calibration);
                let draw = || uniform(block(key, [now.epoch - 1, 0, 0, 0])[0]);
                *lost = now.acting && (*probability >= 1.0 || draw() < *probability);
            }
            _ => {}
        }
    }

    /// Alters a value on its way to an element; `again`: the epoch's transfer of this element was
    /// made before, as when a step is made in parts.
    pub(super) fn transfer(
        &mut self,
        element: usize,
        value: f64,
        target: Target,
        now: &Now,
        again: bool,
    ) -> f64 {
        match self {
            Self::Stuck { value: Some(at), .. } => *at,
            Self::Stuck { value: None, held } => {
                let held = &mut held[element];
                // At an onset at the first step there is no earlier value.
                if !again && (!now.acting || (now.onset && now.epoch == 1)) {
                    *held = value;
                }
                if now.acting { *held } else { value }
            }
            Self::Bias(bias) => target.fitted(value + now.strength * *bias),
            Self::Scale(factor) => target.fitted(value + now.strength * (*factor - 1.0) * value),
            Self::Noise { sigma, streams } => {
                let key = streams[element / 3].key(Phase::Calibration);
                let noise = Ziggurat::shared().three(key, now.epoch - 1)[element % 3];
                target.fitted(value + now.strength * *sigma * noise)
            }
            Self::Delay { steps, kept, first } => {
                let ring = &mut kept[element * (*steps + 1)..][..*steps + 1];
                if !again {
                    ring[*first] = value;
                    if now.epoch == 1 {
                        ring.fill(value);
                    }
                }
                if now.acting { ring[(*first + 1) % (*steps + 1)] } else { value }
            }
            Self::Drop { zero, delivered, lost, .. } => {
                let delivered = &mut delivered[element];
                if !*lost {
                    *delivered = value;
                    return value;
                }
                if *zero {
                    return 0.0;
                }
                if now.epoch == 1 && !again {
                    // Without an earlier value the input keeps its start value, which is this one.
                    *delivered = value;
                }
                *delivered
            }
            Self::Constant(value) => target.fitted(*value),
        }
    }
}
