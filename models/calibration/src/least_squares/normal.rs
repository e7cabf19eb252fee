//! Normal equations of a fixed size: solution, covariance, and undetermined entries.

use nalgebra::{Cholesky, SMatrix, SVector};

/// Largest variance inflation: the factor by which the variance of a parameter may grow because the
/// others are unknown too. Sequences made for the purpose stay below 10. An undetermined direction
/// shows 1e7 and more: 1e13 from the rounding of the sums, less where noise and errors at the point
/// of linearisation simulate information.
const INFLATION_MAX: f64 = 1e6;

/// Solves the normal equations for the `estimated` entries, with the covariance; the others are
/// zero.
///
/// # Errors
/// The index of the least determined entry, if the equations don't determine all of them.
pub(crate) fn solve<const N: usize>(
    information: &SMatrix<f64, N, N>,
    right: &SVector<f64, N>,
    estimated: &[bool; N],
) -> Result<(SVector<f64, N>, SMatrix<f64, N, N>), usize> {
    // Scaled to a unit diagonal, so that one threshold serves all units.
    let mut scale = SVector::<f64, N>::zeros();
    for i in 0..N {
        if estimated[i] {
            let diagonal = information[(i, i)];
            if !(diagonal > 0.0 && diagonal.is_finite()) {
                return Err(i);
            }
            scale[i] = 1.0 / libm::sqrt(diagonal);
        }
    }
    let scaled = SMatrix::<f64, N, N>::from_fn(|i, j| {
        if i == j {
            // The ridge lets the factorisation continue, so that the inflation can be reported.
            1.0 + 1e-14
        } else {
            information[(i, j)] * scale[i] * scale[j]
        }
    });
    let inverse = Cholesky::new(scaled).ok_or(worst(&scaled))?.inverse();
    let mut at = 0;
    for i in 0..N {
        if inverse[(i, i)] > inverse[(at, at)] {
            at = i;
        }
    }
    let determined = inverse[(at, at)] < INFLATION_MAX;
    if !determined {
        return Err(at);
    }
    let covariance = SMatrix::<f64, N, N>::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]);
    Ok((covariance * right, covariance))
}

/// Index of the entry that is nearest to a combination of the others, where the factorisation
/// failed.
fn worst<const N: usize>(scaled: &SMatrix<f64, N, N>) -> usize {
    let mut found = (0, 0.0);
    for i in 0..N {
        for j in 0..i {
            if scaled[(i, j)].abs() > found.1 {
                found = (i, scaled[(i, j)].abs());
            }
        }
    }
    found.0
}
