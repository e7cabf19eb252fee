//! Many comparisons at once: of enough of them, some look as if something were there.

/// Probabilities adjusted by Holm's step-down procedure (Scandinavian Journal of Statistics 6, 1979): those
/// at most α together have a false one among them with at most α, however they depend on each other.
/// The least is multiplied by their number, the next by one less, and none falls below the one before
/// it. What is not a number counts as 1.
#[must_use]
pub fn holm(probabilities: &[f64]) -> Vec<f64> {
    let known = |p: f64| if p.is_nan() { 1.0 } else { p };
    let mut order: Vec<usize> = (0..probabilities.len()).collect();
    order.sort_by(|a, b| known(probabilities[*a]).total_cmp(&known(probabilities[*b])));
    let mut adjusted = vec![1.0; probabilities.len()];
    let mut least = 0.0_f64;
    for (rank, index) in order.into_iter().enumerate() {
        let factor = (probabilities.len() - rank) as f64;
        least = least.max((factor * known(probabilities[index])).min(1.0));
        adjusted[index] = least;
    }
    adjusted
}
