//! A step filter that polynomials don't pass.

use super::POINTS;

/// Degree up to which the filter is blind to polynomials: a ship's sway of 6 s leaves 1e-6 of its rate.
pub(super) const DEGREE: usize = 7;

/// A step with everything taken out that polynomials up to the degree have, of norm one.
pub(super) fn weights() -> [f64; POINTS] {
    let at = |i: usize| (2.0 * i as f64 + 1.0) / POINTS as f64 - 1.0;
    let dot =
        |a: &[f64; POINTS], b: &[f64; POINTS]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut bases = [[0.0; POINTS]; DEGREE + 1];
    let mut step: [f64; POINTS] = core::array::from_fn(|i| if 2 * i < POINTS { -1.0 } else { 1.0 });
    for power in 0..=DEGREE {
        // From the last one, not from the power: twice is enough (Giraud and others, 2005).
        let mut basis: [f64; POINTS] = match power {
            0 => [1.0; POINTS],
            _ => core::array::from_fn(|i| bases[power - 1][i] * at(i)),
        };
        for _ in 0..2 {
            for other in &bases[..power] {
                let share = dot(&basis, other);
                basis.iter_mut().zip(other).for_each(|(value, other)| *value -= share * other);
            }
        }
        let norm = libm::sqrt(dot(&basis, &basis));
        bases[power] = basis.map(|value| value / norm);
        let share = dot(&step, &bases[power]);
        step.iter_mut().zip(&bases[power]).for_each(|(value, basis)| *value -= share * basis);
    }
    let norm = libm::sqrt(dot(&step, &step));
    step.map(|value| value / norm)
}
