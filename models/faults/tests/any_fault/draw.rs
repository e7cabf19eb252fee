//! Draws faults from the catalogue: any kind, any values within the bounds, any trigger.

// `super` is the module that includes this file: the harness's tests include it too.
use super::EPOCHS;
use octant_faults::catalogue::{Acts, Dimension, FaultKind, Lasts, ParameterBounds, Takes};
use octant_faults::trigger::{Repeat, Schedule, Signal, ThresholdSide, Trigger};
use octant_faults::{Channels, FaultSpec, Value, Values, kinds};
use octant_sample::{Health, Mode};
use proptest::prelude::*;
use proptest::sample::select;

/// Usual size for a dimension, SI: values from a thousandth to a thousand times of it are drawn.
pub(crate) fn usual(dimension: Dimension) -> f64 {
    match dimension {
        Dimension::Time => 0.1,
        Dimension::Samples | Dimension::Frequency => 10.0,
        Dimension::Angle | Dimension::Length | Dimension::Temperature => 1.0,
        Dimension::SmallAngle | Dimension::GyroBias | Dimension::AngleRandomWalk => 1e-5,
        Dimension::RateRandomWalk | Dimension::GDependent | Dimension::GyroBiasPerK => 1e-6,
        _ => 1e-2,
    }
}

fn quantity(dimensions: &'static [Dimension], bounds: ParameterBounds) -> BoxedStrategy<Value> {
    let size = |dimension| {
        prop_oneof![
            8 => (-3.0..3.0f64).prop_map(move |power| usual(dimension) * 10f64.powf(power)),
            1 => Just(1e-30),
            1 => Just(1e30),
        ]
    };
    select(dimensions)
        .prop_flat_map(move |dimension| {
            let size = size(dimension);
            let value = match bounds {
                ParameterBounds::NotZero => {
                    (size, any::<bool>()).prop_map(|(v, minus)| if minus { -v } else { v }).boxed()
                }
                ParameterBounds::Any => {
                    prop_oneof![Just(0.0), size.clone(), size.prop_map(|v| -v)].boxed()
                }
                ParameterBounds::Positive => size.boxed(),
                ParameterBounds::NotNegative => prop_oneof![Just(0.0), size].boxed(),
                ParameterBounds::Within(from, to, _) => prop_oneof![
                    1 => Just(from),
                    1 => Just(to),
                    3 => from..=to,
                    3 => (-6.0..0.0f64).prop_map(move |p| from + (to - from) * 10f64.powf(p)),
                ]
                .boxed(),
            };
            value.prop_map(move |value| Value::Quantity(value, dimension))
        })
        .boxed()
}

fn channels() -> impl Strategy<Value = Channels> {
    let one = || select(&Channels::NAMES[..]).prop_map(|(_, channels)| channels);
    prop_oneof![4 => one(), 1 => (one(), one()).prop_map(|(a, b)| a.union(b))]
}

fn value(takes: Takes) -> BoxedStrategy<Value> {
    match takes {
        Takes::Quantity(dimensions, bounds) => quantity(dimensions, bounds),
        Takes::Vector(dimensions) => {
            let part = || quantity(dimensions, ParameterBounds::Any);
            (select(dimensions), part(), part(), part())
                .prop_map(|(dimension, x, y, z)| {
                    let size = |value| match value {
                        Value::Quantity(value, _) => value,
                        _ => unreachable!(),
                    };
                    Value::Vector([size(x), size(y), size(z)], dimension)
                })
                .boxed()
        }
        Takes::Integer(from, to) => {
            let few = to.min(from.saturating_add(20));
            prop_oneof![3 => from..=few, 1 => from..=to].prop_map(Value::Integer).boxed()
        }
        Takes::Flag => any::<bool>().prop_map(Value::Flag).boxed(),
        Takes::Choice(names) => select(names).prop_map(|(name, _)| Value::Choice(name)).boxed(),
        Takes::Channels => channels().prop_map(Value::Channels).boxed(),
        Takes::Number(_) | Takes::Value | Takes::Difference(_) => {
            unreachable!("only kinds on connections take these")
        }
    }
}

/// Values for every parameter of a kind, within their bounds.
pub(crate) fn values(kind: &'static FaultKind) -> BoxedStrategy<Values> {
    let names = kind.parameters.iter().map(|parameter| parameter.name);
    let names: Vec<_> = names.collect();
    let each: Vec<_> = kind.parameters.iter().map(|parameter| value(parameter.takes)).collect();
    each.prop_map(move |each| {
        let mut values = Values::default();
        names.iter().zip(each).for_each(|(name, value)| values.set(name, value));
        values
    })
    .boxed()
}

fn trigger() -> impl Strategy<Value = Trigger> {
    let epoch = || 0..EPOCHS;
    let delay = || 0..30u64;
    let last = || proptest::option::of(0..EPOCHS);
    let mode = || select(&[Mode::Calibrating, Mode::Navigating][..]);
    let signal = prop_oneof![
        Just(Signal::Nis),
        any::<u32>().prop_map(|bits| Signal::Health(Health::from_bits_truncate(bits))),
        (0..3usize).prop_map(Signal::Velocity),
        Just(Signal::LatitudeError),
        Just(Signal::LongitudeError),
        (0..2usize).prop_map(Signal::TrueGimbal),
        (0..3usize).prop_map(Signal::TrueVelocity),
    ];
    let comparison = select(&[ThresholdSide::Above, ThresholdSide::Below][..]);
    prop_oneof![
        3 => epoch().prop_map(Trigger::Epoch),
        1 => (0..10u16, mode(), delay())
            .prop_map(|(stop, mode, delay)| Trigger::Position { stop, mode, delay }),
        1 => (0..10u16, mode(), delay())
            .prop_map(|(stop, mode, delay)| Trigger::Move { stop, mode, delay }),
        1 => (mode(), delay()).prop_map(|(mode, delay)| Trigger::Mode { mode, delay }),
        1 => (signal, comparison, select(&[-1.0, 0.5, 15.0][..]), delay()).prop_map(
            |(signal, comparison, value, delay)| {
                Trigger::Condition { signal, comparison, value, delay }
            }
        ),
        1 => (epoch(), 0..60u64, last())
            .prop_map(|(first, period, last)| Trigger::Periodic { first, period, last }),
        1 => (epoch(), 0.1..60.0, last())
            .prop_map(|(first, mean, last)| Trigger::Poisson { first, mean, last }),
        1 => delay().prop_map(|delay| Trigger::After { fault: "f0".into(), delay }),
        1 => Just(Trigger::Manual),
    ]
}

fn schedule(lasts: Lasts) -> impl Strategy<Value = Schedule> {
    let recovery = match lasts {
        Lasts::Fading => prop_oneof![Just(0), 1..40u64].boxed(),
        Lasts::Span | Lasts::Instant => Just(0).boxed(),
    };
    let repeat = prop_oneof![
        3 => Just(Repeat::Once),
        1 => (1..5u32, 0..60u64).prop_map(|(times, every)| Repeat::Times { times, every }),
        1 => Just(Repeat::EveryTime),
    ];
    (trigger(), proptest::option::weighted(0.8, 1..100u64), recovery, repeat).prop_map(
        |(trigger, duration, recovery, repeat)| Schedule { trigger, duration, recovery, repeat },
    )
}

fn spec_of(kind: &'static FaultKind) -> impl Strategy<Value = FaultSpec> {
    (values(kind), schedule(kind.lasts)).prop_map(move |(values, schedule)| FaultSpec {
        id: "f0".into(),
        kind,
        values,
        schedule,
    })
}

/// A fault of any kind.
pub(crate) fn spec() -> impl Strategy<Value = FaultSpec> {
    // Faults of the wire alter frames, of which there are none here; those of the host alter no
    // sample.
    let here =
        kinds::all().filter(|kind| !matches!(kind.acts, Acts::Wire | Acts::Host | Acts::Power));
    select(here.collect::<Vec<_>>()).prop_flat_map(spec_of)
}
