//! Motion of one rigid body against another: displacement and rotation vector with their
//! derivatives, and the rate and specific force that sensors feel under it.

use nalgebra::Vector3;

/// Displacement r and rotation vector θ of a moving frame against a base frame, in the axes of the
/// base frame, with first and second derivatives. For the case: r along the mean heading, to
/// starboard and down; θ roll, pitch and heading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    pub(crate) displacement: [Vector3<f64>; 3],
    pub(crate) turn: [Vector3<f64>; 3],
}

impl Motion {
    pub(super) fn add(&mut self, other: &Self) {
        for order in 0..3 {
            self.displacement[order] += other.displacement[order];
            self.turn[order] += other.turn[order];
        }
    }
}

/// Rate and specific force in the axes of the moving frame, from those of the base frame (Titterton
/// and Weston, 2004; Shuster, 1993, for the rotation vector's derivative):
///
/// `ω' = Exp(−θ) ω + J θ̇`, `J = I − (1 − cos θ)/θ² [θ×] + (θ − sin θ)/θ³ [θ×]²`, and
/// `f' = Exp(−θ) (f + r̈ + 2 ω × ṙ + ω̇ × r + ω × (ω × r))`.
pub(super) fn felt(
    motion: &Motion,
    rate: &Vector3<f64>,
    acceleration: &Vector3<f64>,
    force: &Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let [r, r_rate, r_acc] = &motion.displacement;
    let [angle, angle_rate, _] = &motion.turn;
    let moved = force
        + r_acc
        + rate.cross(r_rate) * 2.0
        + acceleration.cross(r)
        + rate.cross(&rate.cross(r));
    let back = octant_earth::rotation::exp(&-angle);
    (back * rate + turned_rate(angle, angle_rate), back * moved)
}

/// Angular rate in the turned axes of a rotation vector and its derivative.
fn turned_rate(angle: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    let square = angle.norm_squared();
    let (a, b) = if square < 1e-4 {
        // Series: the next terms are below 1e-16.
        (
            0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0 - square / 40320.0)),
            1.0 / 6.0 - square * (1.0 / 120.0 - square * (1.0 / 5040.0 - square / 362_880.0)),
        )
    } else {
        let norm = libm::sqrt(square);
        let (s, c) = libm::sincos(norm);
        ((1.0 - c) / square, (norm - s) / (square * norm))
    };
    let across = angle.cross(rate);
    rate - across * a + angle.cross(&across) * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_earth::rotation::exp;

    /// Compares the rate of a rotation vector with the difference of its rotations.
    #[test]
    fn turned_rate_is_the_rate_of_the_rotation() {
        let h = 1e-6;
        for size in [1e-3, 0.3, 2.0] {
            let at = |t: f64| Vector3::new(0.3 + t, -0.7 * t + 0.2, 0.5 - 2.0 * t * t) * size;
            for k in 0..10 {
                let t = f64::from(k) * 0.1;
                let difference = exp(&at(t - h)).inverse() * exp(&at(t + h));
                let expected = difference.scaled_axis() / (2.0 * h);
                let rate = Vector3::new(1.0, -0.7, -4.0 * t) * size;
                let error = (turned_rate(&at(t), &rate) - expected).norm();
                assert!(error < 1e-9 * (1.0 + size * size), "{size} {t} {error}");
            }
        }
    }
}
