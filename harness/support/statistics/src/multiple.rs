//! Corrections for many comparisons, some of which look significant by chance.

/// Probabilities adjusted by Holm's step-down procedure (Scandinavian Journal of Statistics 6, 1979):
/// rejecting all hypotheses with at most α makes any false rejection with a probability of at most α,
/// for any dependence between them. The smallest is multiplied by their number, the next by one less,
/// and none is below the one before it. A NaN counts as 1.
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
