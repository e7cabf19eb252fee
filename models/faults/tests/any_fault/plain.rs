//! Plain values of every kind, the same on every run.

use super::draw::usual;
use octant_faults::catalogue::{FaultKind, ParameterBounds, Takes};
use octant_faults::{Channels, Value, Values};

/// The first values of a small grid with which a fault of the kind can be built, the same on every
/// run.
pub(crate) fn plain(kind: &'static FaultKind) -> Values {
    for scale in [1.0, 0.1, 10.0, 0.01, 100.0, 1e-3] {
        for turn in 0..12 {
            let mut values = Values::default();
            for (index, parameter) in kind.parameters.iter().enumerate() {
                let found = plain_value(parameter.takes, scale, turn, index);
                values.set(parameter.name, found);
            }
            if (kind.build)(&values, &crate::common::setup()).is_ok() {
                return values;
            }
        }
    }
    panic!("no values for {}", kind.name)
}

fn plain_value(takes: Takes, scale: f64, turn: usize, index: usize) -> Value {
    // A later value is larger (the upper corner of a band, for example) and on another axis.
    let size = |dimension| usual(dimension) * scale * (1.0 + index as f64);
    let axis = turn / 2 + index;
    match takes {
        Takes::Quantity(dimensions, bounds) => {
            let dimension = dimensions[turn % dimensions.len()];
            let value = match bounds {
                ParameterBounds::Within(from, to, _) => size(dimension).clamp(from, to),
                _ => size(dimension),
            };
            Value::Quantity(value, dimension)
        }
        Takes::Vector(dimensions) => {
            let dimension = dimensions[turn % dimensions.len()];
            Value::Vector([size(dimension), 0.0, 0.0], dimension)
        }
        Takes::Integer(from, to) => Value::Integer((from + 2).min(to)),
        Takes::Flag => Value::Flag(axis.is_multiple_of(2)),
        Takes::Choice(names) => Value::Choice(names[axis % names.len()].0),
        // The dimensions too have gyros first.
        Takes::Channels if turn.is_multiple_of(2) => Value::Channels(Channels::gyro(axis)),
        Takes::Channels => Value::Channels(Channels::accelerometer(axis)),
        Takes::Number(_) | Takes::Value | Takes::Difference(_) => {
            unreachable!("only kinds on connections take these")
        }
    }
}
