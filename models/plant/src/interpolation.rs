//! Interpolation of Lagrange on Chebyshev's nodes of the first kind, on (−1, 1) (Trefethen, 2013,
//! Approximation Theory and Approximation Practice, ch. 4 and 5).

/// Number of nodes: polynomials of a lower degree are interpolated exactly.
pub const NODES: usize = 10;

/// Weights of the nodes in a sum over them.
pub type Weights = [f64; NODES];

/// Returns the nodes, from the highest to the lowest.
#[must_use]
#[inline(never)]
pub fn nodes() -> Weights {
    core::array::from_fn(|i| libm::cos(core::f64::consts::PI * (i as f64 + 0.5) / NODES as f64))
}

/// Returns the weights with which values at the nodes give the value at `x`.
#[must_use]
pub fn weights(nodes: &Weights, x: f64) -> Weights {
    core::array::from_fn(|i| {
        (0..NODES).filter(|k| *k != i).map(|k| (x - nodes[k]) / (nodes[i] - nodes[k])).product()
    })
}
