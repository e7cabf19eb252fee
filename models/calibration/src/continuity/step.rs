//! Step filter that suppresses polynomials.

/// Blocks of the filter.
pub(crate) const POINTS: usize = 20;

/// Degree up to which polynomials are suppressed: a ship's sway of 6 s leaves 1e-6 of its rate.
pub(super) const DEGREE: usize = 7;

/// Weights of a step from which the polynomials up to the degree are removed, of norm one.
pub(super) fn weights() -> [f64; POINTS] {
    let at = |i: usize| (2.0 * i as f64 + 1.0) / POINTS as f64 - 1.0;
    let dot =
        |a: &[f64; POINTS], b: &[f64; POINTS]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut bases = [[0.0; POINTS]; DEGREE + 1];
    let mut step: [f64; POINTS] = core::array::from_fn(|i| if 2 * i < POINTS { -1.0 } else { 1.0 });
    for power in 0..=DEGREE {
        // Made from the last basis vector, not from the power, and orthogonalised twice, which is
        // enough (Giraud and others, 2005).
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
