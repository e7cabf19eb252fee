//! Motion of the case prescribed from outside, piece by piece: for a ship that is simulated
//! elsewhere.
//!
//! A piece is a polynomial of the fifth degree in each degree of freedom, so that value, rate and
//! acceleration can be continuous from one piece to the next. Rate and specific force follow from
//! it on the ellipsoid as from the plant's own sway, so that the sensors feel the same motion that
//! truth reports.

use super::kinematics::{Dof, SixDof};

/// One piece of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Course {
    /// Start, s since the start of the run.
    pub start_s: f64,
    /// Length, s, above 0.
    pub duration_s: f64,
    /// Roll, pitch, yaw (rad), surge, sway, heave (m) about mean attitude and site: coefficients of
    /// the powers 0 to 5 of (time − start) / duration.
    pub coefficients: [[f64; 6]; 6],
}

/// Value, rate and acceleration of one degree of freedom at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoursePoint {
    /// Value, rad or m.
    pub value: f64,
    /// First derivative.
    pub rate: f64,
    /// Second derivative.
    pub acceleration: f64,
}

impl Course {
    /// Makes the piece that starts at the points `from` and ends at the points `to`.
    #[must_use]
    pub fn between(
        start_s: f64,
        duration_s: f64,
        from: &[CoursePoint; 6],
        to: &[CoursePoint; 6],
    ) -> Self {
        let coefficients = core::array::from_fn(|dof| {
            let (a, b) = (&from[dof], &to[dof]);
            // Derivatives by the elapsed fraction of the piece.
            let (v0, v1) = (a.rate * duration_s, b.rate * duration_s);
            let square = duration_s * duration_s;
            let (a0, a1) = (a.acceleration * square, b.acceleration * square);
            let way = b.value - a.value;
            [
                a.value,
                v0,
                0.5 * a0,
                10.0 * way - 6.0 * v0 - 4.0 * v1 - 0.5 * (3.0 * a0 - a1),
                -15.0 * way + 8.0 * v0 + 7.0 * v1 + 0.5 * (3.0 * a0 - 2.0 * a1),
                6.0 * way - 3.0 * (v0 + v1) - 0.5 * (a0 - a1),
            ]
        });
        Self { start_s, duration_s, coefficients }
    }

    /// Returns whether every number is finite and the duration is above 0.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.start_s.is_finite()
            && self.duration_s.is_finite()
            && self.duration_s > 0.0
            && self.coefficients.iter().flatten().all(|value| value.is_finite())
    }

    /// Adds the motion of the piece at a time.
    pub(crate) fn add_to(&self, six: &mut SixDof, time_s: f64) {
        let x = (time_s - self.start_s) / self.duration_s;
        for (dof, c) in six.iter_mut().zip(&self.coefficients) {
            let value = c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))));
            let rate =
                c[1] + x * (2.0 * c[2] + x * (3.0 * c[3] + x * (4.0 * c[4] + x * 5.0 * c[5])));
            let acceleration = 2.0 * c[2] + x * (6.0 * c[3] + x * (12.0 * c[4] + x * 20.0 * c[5]));
            *dof = Dof {
                value: dof.value + value,
                rate: dof.rate + rate / self.duration_s,
                acceleration: dof.acceleration + acceleration / (self.duration_s * self.duration_s),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_has_the_points_at_its_ends() {
        let point = |k: f64| CoursePoint { value: 0.3 * k, rate: -0.2 * k, acceleration: 1.0 - k };
        let from = core::array::from_fn(|dof| point(dof as f64));
        let to = core::array::from_fn(|dof| point(2.5 - dof as f64));
        let course = Course::between(7.0, 0.5, &from, &to);
        for (time_s, points) in [(7.0, from), (7.5, to)] {
            let mut six = SixDof::default();
            course.add_to(&mut six, time_s);
            for (found, point) in six.iter().zip(points) {
                assert!((found.value - point.value).abs() < 1e-14);
                assert!((found.rate - point.rate).abs() < 1e-13);
                assert!((found.acceleration - point.acceleration).abs() < 1e-12);
            }
        }
        assert!(course.is_sound() && !Course { duration_s: 0.0, ..course }.is_sound());
    }
}
