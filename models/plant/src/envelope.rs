//! Growth and decay of a ship's motion: a factor on all six degrees of freedom.

use crate::config::MotionTimes;
use crate::kinematics::SixDof;

/// Factor from 0, at rest, to 1 over time, with two continuous derivatives.
#[derive(Clone, Debug)]
pub(crate) struct Envelope {
    times: MotionTimes,
}

impl Envelope {
    /// Makes an envelope; `None` for a motion that is always there.
    pub(crate) fn of(times: &MotionTimes) -> Option<Box<Self>> {
        (!times.is_always()).then(|| Box::new(Self { times: times.clone() }))
    }

    /// Factor and its first two derivatives at a time, s since the start.
    fn at(&self, time_s: f64) -> [f64; 3] {
        let MotionTimes { during_s, ramp_s } = &self.times;
        // Intervals follow one another: the last one that has begun is the one that counts.
        let begun = during_s.partition_point(|[from_s, _]| *from_s <= time_s);
        let Some([from_s, to_s]) = begun.checked_sub(1).map(|index| during_s[index]) else {
            return [0.0; 3];
        };
        let (since_s, left_s) = (time_s - from_s, to_s - time_s);
        if left_s <= 0.0 {
            [0.0; 3]
        } else if since_s < *ramp_s {
            step(since_s, *ramp_s)
        } else if left_s < *ramp_s {
            let [value, rate, acceleration] = step(left_s, *ramp_s);
            [value, -rate, acceleration]
        } else {
            [1.0, 0.0, 0.0]
        }
    }

    /// Multiplies a motion by the factor at a time, s since the start.
    pub(crate) fn scale(&self, six: &mut SixDof, time_s: f64) {
        let [factor, rate, acceleration] = self.at(time_s);
        for dof in six {
            dof.acceleration =
                factor * dof.acceleration + 2.0 * rate * dof.rate + acceleration * dof.value;
            dof.rate = factor * dof.rate + rate * dof.value;
            dof.value *= factor;
        }
    }
}

/// Polynomial of fifth degree from 0 to 1 over a length, whose first two derivatives are zero at both ends; with its
/// derivatives.
fn step(time_s: f64, length_s: f64) -> [f64; 3] {
    let x = time_s / length_s;
    [
        x * x * x * (10.0 + x * (6.0 * x - 15.0)),
        30.0 * x * x * (1.0 - x) * (1.0 - x) / length_s,
        60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (length_s * length_s),
    ]
}
